#include "apps/study/frontier/np/np_frontier.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "apps/study/frontier/work.hpp"
#include "apps/study/synth/truth.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/particles/seeding.hpp"
#include "pivnp/core/particles/strain.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/np/analytic.hpp"
#include "pivnp/np/tracker.hpp"

namespace pivnp::app {

namespace {

constexpr int grid_side = 48, grid_rim = 12;  // elements of the grid, and about the material
constexpr int probes = 5;  // an element and side: no number of particles has them where it has its own

// A motion, and the vectors that a measurement would give of it.
struct Sequence {
  std::string name;
  std::unique_ptr<np::AnalyticMotion> motion;
  std::vector<VectorField> steps;
};

double normal(std::uint64_t seed, std::uint64_t index) {
  return std::sqrt(-2 * std::log(1 - uniform(seed, 2 * index))) * std::cos(2 * M_PI * uniform(seed, 2 * index + 1));
}

// Errors of one component at the nodes: white noise, averaged as a window averages. A mean over a width of 2 a is correlated over
// distances of standard deviation .82 a, and so is a Gaussian mean of .58 a.
std::vector<double> errors_of_vectors(const Followed& f, const Grid& grid, std::uint64_t seed) {
  const double s = 0.58 * f.alike / f.spacing;
  const int reach = int(std::ceil(3 * s)), nx = grid.nx + 2 * reach, ny = grid.ny + 2 * reach;
  std::vector<double> weights, white(std::size_t(nx) * std::size_t(ny)), rows(std::size_t(grid.nx) * std::size_t(ny)), out(grid.node_count());
  double squares = 0;
  for (int k = -reach; k <= reach; ++k) {
    weights.push_back(reach ? std::exp(-0.5 * k * k / (s * s)) : 1);
    squares += weights.back() * weights.back();
  }
  for (double& w : weights) w /= std::sqrt(squares);
  for (std::size_t n = 0; n < white.size(); ++n) white[n] = f.noise * normal(seed, n);
  const auto averaged = [&](const std::vector<double>& from, std::size_t at, std::size_t stride) {
    double sum = 0;
    for (std::size_t k = 0; k < weights.size(); ++k) sum += weights[k] * from[at + k * stride];
    return sum;
  };
  for (std::size_t j = 0; j < std::size_t(ny); ++j)
    for (std::size_t i = 0; i < std::size_t(grid.nx); ++i) rows[j * std::size_t(grid.nx) + i] = averaged(white, j * std::size_t(nx) + i, 1);
  for (std::size_t n = 0; n < out.size(); ++n) out[n] = averaged(rows, n, std::size_t(grid.nx));
  return out;
}

Grid grid_of(const Followed& f) { return {{0, 0}, {f.spacing, f.spacing}, grid_side + 1, grid_side + 1}; }

std::vector<Sequence> sequences(const Followed& f) {
  const double middle = 0.5 * grid_side * f.spacing, radius = grid_side * f.spacing / 8;
  constexpr double steepest = 0.7358;  // 2 q^2 exp(-q^2) at q = 1: the vortex's shear for a turn of one
  const double turn = f.slope * 2 * f.steps / (M_PI * steepest);  // its first step shears by `slope`
  std::vector<Sequence> all;
  all.push_back({"vortex", std::make_unique<np::ReversingVortex>(Vec2(middle, middle), radius, turn, 2.0 * f.steps), {}});
  all.push_back({"band", std::make_unique<np::ShearBand>(f.slope, middle + 0.3 * f.spacing, 1.5 * f.spacing), {}});
  all.push_back({"rotation", std::make_unique<np::AffineMotion>(np::AffineMotion::rotation(0.5 * f.slope, {middle, middle})), {}});
  for (std::size_t m = 0; m < all.size(); ++m)
    for (int k = 0; k < f.steps; ++k) {
      VectorField field = np::vector_field(
          np::sample_increments(*all[m].motion, grid_of(f), f.central ? Anchor::central : Anchor::forward, k, k + 1), {k, k + 1});
      for (std::size_t c = 0; c < 2; ++c) {
        const std::vector<double> errors = errors_of_vectors(f, field.grid, 7001 + 262 * m + 2 * std::uint64_t(k) + c);
        for (std::size_t n = 0; n < errors.size(); ++n) field.displacement[n][c] += float(errors[n]);
      }
      field.correlation_length = float(f.alike);
      const float variance = float(f.noise * f.noise);
      field.cov.assign(field.displacement.size(), {variance, variance, 0});
      all[m].steps.push_back(std::move(field));
    }
  return all;
}

ParticleSet particles(const Grid& grid, const np::NpOptions& options) {
  const double lo = grid_rim * grid.spacing.x(), hi = (grid_side - grid_rim) * grid.spacing.x();
  return seed(grid, {{"material", Polygon({{lo, lo}, {hi, lo}, {hi, hi}, {lo, hi}}, "material")}}, options.per_element, options.seeding, 0,
              "np.per_element");
}

struct ProbeErrors {
  double path = 0, strain = 0;  // sums of squares over the probes
  double places = 0, found = 0;
  double worst_path = 0, worst_strain = 0;  // rms of the worst motion
};

// The probes of one motion at its end.
void add_errors(const np::Tracker& tracker, const Grid& grid, const np::AnalyticMotion& motion, double end, ProbeErrors& e) {
  std::vector<std::vector<std::size_t>> of_element(std::size_t(grid_side) * grid_side);
  const std::vector<Vec2>& x0 = tracker.particles().x0;
  const auto element = [&](const Vec2& X) {
    return std::size_t(X.y() / grid.spacing.y()) * grid_side + std::size_t(X.x() / grid.spacing.x());
  };
  const auto state = tracker.state();
  for (std::size_t p = 0; p < x0.size(); ++p)
    if (alive(state[p].status)) of_element[element(x0[p])].push_back(p);
  double path = 0, strain = 0, found = 0;
  for (int j = grid_rim * probes; j < (grid_side - grid_rim) * probes; ++j)
    for (int i = grid_rim * probes; i < (grid_side - grid_rim) * probes; ++i) {
      const Vec2 X = Vec2((i + 0.41) / probes, (j + 0.57) / probes).cwiseProduct(grid.spacing);
      const std::vector<std::size_t>& here = of_element[element(X)];
      ++e.places;
      const auto near = std::min_element(here.begin(), here.end(),
                                         [&](auto a, auto b) { return (x0[a] - X).squaredNorm() < (x0[b] - X).squaredNorm(); });
      if (near == here.end()) continue;
      ++found;
      const auto now = state[*near];
      path += (now.x + now.F * (X - x0[*near]) - motion.position(X, end)).squaredNorm();
      const Strain got = log_strain(now.F), real = log_strain(motion.deformation(X, end));
      strain += std::pow(got.xx - real.xx, 2) + std::pow(got.yy - real.yy, 2) + 2 * std::pow(got.xy - real.xy, 2);
    }
  e.path += path, e.strain += strain, e.found += found;
  e.worst_path = std::max(e.worst_path, std::sqrt(path / found));
  e.worst_strain = std::max(e.worst_strain, std::sqrt(strain / found));
}

struct NpSetting {
  std::string name, keys;
  np::NpOptions options;
  bool standard = false, own = false;
};

// What distinguishes settings of this stage.
bool same(const np::NpOptions& a, const np::NpOptions& b) {
  return a.shape == b.shape && a.gradient == b.gradient && a.per_element == b.per_element && a.seeding == b.seeding;
}

std::vector<NpSetting> settings(const np::NpOptions& base, bool own) {
  const np::NpOptions plain;
  std::vector<NpSetting> all;
  const auto add = [&](np::ShapeFunctions shape, int per_element, np::GradientPlace gradient, SeedPattern seeding) {
    np::NpOptions o = base;
    o.shape = shape, o.per_element = per_element, o.gradient = gradient, o.seeding = seeding;
    o.reseed = false;
    if (std::any_of(all.begin(), all.end(), [&](const NpSetting& s) { return same(s.options, o); })) return;
    NpSetting s{std::string(name_of(shape)) + ", " + std::to_string(per_element) + " an element",
              "np.shape=" + std::string(name_of(shape)) + " np.per_element=" + std::to_string(per_element), o, same(o, plain), own && same(o, base)};
    if (gradient == np::GradientPlace::element) s.name += ", gradient at its centre", s.keys += " np.gradient=element";
    if (seeding != plain.seeding) s.name += ", " + std::string(name_of(seeding)), s.keys += " np.seeding=" + std::string(name_of(seeding));
    all.push_back(std::move(s));
  };
  for (const auto& shape : np::shape_functions_names) add(shape.value, 4, plain.gradient, plain.seeding);
  for (const int n : {1, 9, 16})
    for (const np::ShapeFunctions shape : {np::ShapeFunctions::bilinear, np::ShapeFunctions::bspline3}) add(shape, n, plain.gradient, plain.seeding);
  add(np::ShapeFunctions::bilinear, 4, np::GradientPlace::element, plain.seeding);
  if (own) add(base.shape, base.per_element, base.gradient, base.seeding);
  return all;
}

}  // namespace

std::vector<FrontierStage> np_frontier(const np::NpOptions& base, const Followed& followed, int repeats, int threads, Progress& progress) {
  const Grid grid = grid_of(followed);
  const std::vector<Sequence> all = sequences(followed);
  const std::vector<NpSetting> wanted = settings(base, followed.of_case);
  const double elements = double(grid_side - 2 * grid_rim) * (grid_side - 2 * grid_rim), steps = double(all.size()) * followed.steps;
  FrontierStage paths, strains;
  paths.name = "np", strains.name = "np_strain";
  paths.title = "Numerical particles: paths", strains.title = "Numerical particles: strains";
  paths.made_of = "Vectors at nodes " + number(followed.spacing, 3) + " px apart of a vortex that winds up, a shear band and a rotation, known in closed form, with gradients of up to " +
                  number(100 * followed.slope, 2) + " % from frame to frame over " + std::to_string(followed.steps) + " steps and noise of " +
                  number(followed.noise, 2) + " px, alike within " + number(followed.alike, 3) + " px" + (followed.of_case ? " (as the case's frames show)" : "") +
                  ". Errors are of the material's places, 25 an element, for each of which the nearest particle of its element stands.";
  strains.made_of = "The same runs.";
  paths.error_label = "error of the path, rms (px)";
  strains.error_label = "error of log strain, rms";
  paths.time_label = strains.time_label = "time per step and element (µs)";
  paths.time_unit = strains.time_unit = 1e-6;
  paths.columns = {{"worst_px", "worst (px)", "rms error of the path in the motion where it is greatest"},
                   {"ns_particle_step", "ns", "time per particle and step, nanoseconds"},
                   {"followed", "followed", "share of the places that have a particle at the end"}};
  strains.columns = paths.columns;
  strains.columns.front() = {"worst_motion", "worst", "rms error of strain in the motion where it is greatest"};

  const int before = omp_get_max_threads();
  omp_set_num_threads(threads);
  std::vector<std::vector<double>> seconds(wanted.size());
  std::vector<ProbeErrors> errors(wanted.size());
  std::vector<Effort> works(wanted.size());
  std::vector<double> count(wanted.size());
  const std::int64_t total = std::int64_t(wanted.size()) * (repeats + 1);  // the first fills caches, and is scored
  std::int64_t done = 0;
  const auto follow_all = [&](const NpSetting& s, bool score, std::size_t k) {
    for (const Sequence& sequence : all) {
      np::Tracker tracker(s.options, particles(grid, s.options), 0);
      count[k] = double(tracker.particles().size());
      for (std::size_t n = 0; n < sequence.steps.size(); ++n) tracker.step(sequence.steps[n], double(n + 1));
      if (score) add_errors(tracker, grid, *sequence.motion, followed.steps, errors[k]);
    }
  };
  for (int repeat = 0; repeat <= repeats; ++repeat)
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      progress.update("particles", done++, total);
      if (progress.stop_requested()) {
        omp_set_num_threads(before);
        throw Interrupted();
      }
      if (repeat == 0) {
        works[k] = measured(threads, [&] { follow_all(wanted[k], true, k); });
      } else {
        seconds[k].push_back(seconds_of(threads, [&] { follow_all(wanted[k], false, k); }) / (steps * elements));
      }
    }
  omp_set_num_threads(before);
  progress.update("particles", total, total);
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const ProbeErrors& e = errors[k];
    FrontierPoint p;
    p.name = wanted[k].name, p.keys = wanted[k].keys;
    p.standard = wanted[k].standard, p.own = wanted[k].own;
    set_times(seconds[k], p);
    p.bytes = works[k].bytes, p.instructions = works[k].instructions;
    p.complete = e.found > 0.98 * e.places;
    const double each = 1e9 * p.seconds * elements / count[k];
    FrontierPoint q = p;
    p.error = std::sqrt(e.path / e.found), q.error = std::sqrt(e.strain / e.found);
    p.worst = e.worst_path, q.worst = e.worst_strain;
    p.columns = {e.worst_path, each, e.found / e.places};
    q.columns = {e.worst_strain, each, e.found / e.places};
    paths.points.push_back(std::move(p));
    strains.points.push_back(std::move(q));
  }
  find_front(paths.points);
  find_front(strains.points);
  return {std::move(paths), std::move(strains)};
}

}  // namespace pivnp::app
