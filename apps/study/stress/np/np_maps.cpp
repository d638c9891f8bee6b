#include "apps/study/stress/np/np_maps.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "apps/case/fields.hpp"
#include "apps/study/stress/np/followed.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/np/analytic.hpp"

namespace pivnp::app {

namespace {

constexpr double square_side = 20 * element_px, middle = square_side / 2;  // of the measured square
constexpr double no_place = std::numeric_limits<double>::quiet_NaN();

Region square(double half) {
  return {"material", Polygon({{middle - half, middle - half}, {middle + half, middle - half}, {middle + half, middle + half}, {middle - half, middle + half}}, "material")};
}

KnownPaths paths_of(const np::NpOptions& options, double half) {
  KnownPaths paths{.options = options, .grid = {{0, 0}, {element_px, element_px}, 21, 21}, .region = square(half), .increment = {}, .position = {}};
  paths.options.drift = np::DriftScheme::none;  // its maps are of sums
  return paths;
}

// A motion along x alone that depends on y alone: both anchors see the same, and paths add up exactly.
void stream(KnownPaths& paths, const std::function<double(double y)>& speed) {
  paths.increment = [=](const Vec2& x, int) -> Vec2 { return {speed(x.y()), 0}; };
  paths.position = [=](const Vec2& x0, double frames) -> Vec2 { return {x0.x() + frames * speed(x0.y()), x0.y()}; };
}

// A wave across y of this greatest gradient a frame, on top of an even motion.
std::function<double(double)> waved(double even, double gradient, double length_px) {
  const double k = 2 * M_PI / length_px;
  return [=](double y) { return even + gradient / k * std::sin(k * (y - middle)); };
}

void follow(KnownPaths& paths, std::shared_ptr<const np::AnalyticMotion> motion) {
  paths.increment = [=](const Vec2& x, int pair) { return motion->central_increment(x, pair, pair + 1); };
  paths.position = [=](const Vec2& x0, double frames) { return motion->position(x0, frames); };
}

struct Adding {
  const np::NpOptions& options;
  std::vector<MapPlan> all;

  template <class Put>
  void add(const std::string& name, const std::string& title, const std::string& motion, MapAxis x, MapAxis y, std::vector<LimitLine> theory, double half, Put put) {
    MapPlan plan;
    plan.map = {name, title,
                motion + ". Vectors " + number(element_px) + " px apart" +
                    (name.starts_with("np_drift") ? "" : " with a standard error of 0.02 px") + ". Right: less than " + number(path_bounds.right) + " px off at the end; wrong: more than " +
                    number(path_bounds.wrong) + " px. Flagged: the particle has ended, is flagged, or states a standard error above " + number(most_stated_px) + " px.",
                std::move(x), std::move(y), {}, std::move(theory)};
    plan.settings = write_fields(options);
    plan.result = [=, own = options, xs = plan.map.x.levels, ys = plan.map.y.levels](std::size_t i, std::size_t j, Progress& progress) {
      KnownPaths paths = paths_of(own, half);
      put(paths, xs[i], ys.empty() ? double(j) : ys[j]);
      return followed(paths, 1000 + 37 * i + j, progress);
    };
    all.push_back(std::move(plan));
  }
};

}  // namespace

std::vector<MapPlan> np_maps(const np::NpOptions& options) {
  Adding maps{options, {}};
  const double whole = middle - element_px;
  const auto turning = [](KnownPaths& paths, double frames) {
    paths.frames = int(frames);
    follow(paths, std::make_shared<np::AffineMotion>(np::AffineMotion::rotation(0.005, {middle, middle})));
  };
  const std::vector<double> frames = {10, 30, 100, 300, 1000};
  LimitLine summed{"twice the sum's standard error is 0.5 px", {}};
  for (const double n : frames) summed.points.push_back({n, most_stated_px / std::sqrt(n)});
  maps.add("np_drift_noise", "Drift: frames and errors of vectors", "Material that turns by 0.3 degrees a frame", {"frames", frames},
           {"standard error of a vector (px)", {0.005, 0.01, 0.02, 0.05, 0.1}}, {summed}, 80, [=](KnownPaths& p, double x, double y) {
             turning(p, x);
             p.error_px = y;
           });
  maps.add("np_drift_repeated", "Drift: frames and errors that repeat", "The same, with vectors whose standard error is 0.02 px, a part of it the same in every pair, as the closing of chains has told", {"frames", frames},
           {"share of the variance that repeats", {0, 0.1, 0.25, 0.5, 1}}, {}, 80, [=](KnownPaths& p, double x, double y) {
             turning(p, x);
             p.repeated_share = y;
           });
  // Of linear interpolation: h^2/8 times the Laplacian, which in this vortex is 2.76 turns over its radius at most.
  LimitLine bent{"interpolation is off by 0.5 px", {}};
  for (const double turn : {0.25, 0.5, 0.72}) bent.points.push_back({turn, turn * 2.76 / 8 * element_px / path_bounds.wrong});
  maps.add("np_curved", "Curved motion: turn and size of a vortex", "A vortex that turns its middle in 20 frames", {"turn (rad)", {0.25, 0.5, 1, 2, 4}},
           {"radius (elements)", {1.5, 2, 3, 4, 6, 8}}, {bent}, whole, [](KnownPaths& p, double x, double y) {
             p.frames = 20;
             follow(p, std::make_shared<np::ReversingVortex>(Vec2(middle, middle), y * element_px, x, 40));
           });
  std::vector<std::string> shapes;
  for (const auto& shape : np::shape_functions_names) shapes.emplace_back(shape.name);
  maps.add("np_shape", "Curved motion: shape functions", "A shear wave of 5 % a frame, ten frames", {"wavelength (elements)", {2, 3, 4, 6, 8, 12, 20}}, {"shape functions", {}, shapes},
           {{"two elements a wave", {{2, 0}, {2, double(shapes.size())}}}}, whole, [](KnownPaths& p, double x, double y) {
             p.options.shape = np::shape_functions_names[std::size_t(y)].value;
             stream(p, waved(0, 0.05, x * element_px));
           });
  maps.add("np_hole", "Empty elements", "A shear wave of 16 elements, four frames, and a square in which no vector is valid", {"side of the square without vectors (elements)", {0, 1, 2, 3, 4, 6, 8}},
           {"displacement gradient a frame", {0, 0.01, 0.02, 0.05, 0.1}}, {{"a fit reaches an element's diagonal", {{3, 0}, {3, 0.1}}}}, whole, [](KnownPaths& p, double x, double y) {
             p.frames = 4;
             stream(p, waved(0, y, 16 * element_px));
             p.status = [half = x * element_px / 2](const Vec2& at, int) {
               return std::abs(at.x() - middle) < half && std::abs(at.y() - middle) < half ? VectorStatus::rejected : VectorStatus::valid;
             };
           });
  maps.add("np_fold", "Folding", "Material that is compressed in waves, in one pair with forward vectors; beyond a gradient of 1 it would pass through itself", {"greatest gradient", {0.2, 0.5, 0.8, 0.95, 1.1, 1.5, 2}},
           {"wavelength (elements)", {4, 8, 16, 32}}, {{"the material folds", {{1, 4}, {1, 32}}}}, whole, [](KnownPaths& p, double x, double y) {
             const double k = 2 * M_PI / (y * element_px);
             p.frames = 1;
             p.anchor = Anchor::forward;
             const auto by = [=](double at) { return -x / k * std::sin(k * (at - middle)); };
             p.increment = [=](const Vec2& at, int) -> Vec2 { return {by(at.x()), 0}; };
             p.position = [=](const Vec2& x0, double) -> Vec2 { return {1 - x * std::cos(k * (x0.x() - middle)) > 0 ? x0.x() + by(x0.x()) : no_place, x0.y()}; };
           });
  maps.add("np_leave", "Leaving the view", "Material that moves out of the grid, with a shear wave of 0.5 % a frame", {"elements a frame", {0.02, 0.05, 0.1, 0.25, 0.5, 1, 2}}, {"frames", {5, 10, 20, 40}},
           {{"half of it has left", {{2, 5}, {1, 10}, {0.5, 20}, {0.25, 40}}}}, whole, [](KnownPaths& p, double x, double y) {
             p.frames = int(y);
             stream(p, waved(x * element_px, 0.005, 16 * element_px));
           });
  maps.add("np_masked", "Masked zones", "Material that passes behind a mask across its whole way, with a shear wave of 1 % a frame, 20 frames", {"width of the mask (elements)", {0.5, 1, 2, 3, 4, 6}},
           {"elements a frame", {0.02, 0.05, 0.1, 0.2, 0.4}}, {}, whole, [](KnownPaths& p, double x, double y) {
             p.frames = 20;
             stream(p, waved(y * element_px, 0.01, 16 * element_px));
             p.status = [half = x * element_px / 2](const Vec2& at, int) { return std::abs(at.x() - middle - 1) <= half ? VectorStatus::masked : VectorStatus::valid; };
           });
  maps.add("np_births", "Births", "Particles born where material enters, 20 frames", {"elements a frame", {0.1, 0.25, 0.5, 1, 2}}, {"displacement gradient a frame", {0, 0.005, 0.01, 0.02, 0.05}}, {},
           middle, [](KnownPaths& p, double x, double y) {
             p.frames = 20;
             p.births_alone = true;
             stream(p, waved(x * element_px, y, 32 * element_px));
           });
  return std::move(maps.all);
}

}  // namespace pivnp::app
