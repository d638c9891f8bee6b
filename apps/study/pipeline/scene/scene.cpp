#include "apps/study/pipeline/scene/scene.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "apps/case/lengths.hpp"
#include "apps/study/pipeline/scene/sizes.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/region.hpp"
#include "pivnp/core/particles/seeding.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

std::string text(const Vec2& v) { return "(" + number(v.x()) + ", " + number(v.y()) + ")"; }

// An upright rectangle inside the image less a margin: exact for a plain camera, on the safe side for a homography. The
// sides of what a lens sees are bent, so that more than their ends are asked.
Extent inner_box(const image::Camera& camera, int width, int height, double margin) {
  const double left = margin, right = width - 1 - margin, top = margin, bottom = height - 1 - margin;
  Extent box{Vec2::Constant(-std::numeric_limits<double>::infinity()), Vec2::Constant(std::numeric_limits<double>::infinity())};
  const int pieces = camera.lens().straight() ? 1 : 32;
  for (int k = 0; k <= pieces; ++k) {
    const double column = left + (right - left) * k / pieces, row = top + (bottom - top) * k / pieces;
    box.lower.x() = std::max(box.lower.x(), camera.to_world({left, row}).x());
    box.upper.x() = std::min(box.upper.x(), camera.to_world({right, row}).x());
    box.upper.y() = std::min(box.upper.y(), camera.to_world({column, top}).y());
    box.lower.y() = std::max(box.lower.y(), camera.to_world({column, bottom}).y());
  }
  return box;
}

double spacing_of(const Case& c, const image::Camera& camera, int width, int height) {
  if (c.grid.spacing_m) return *c.grid.spacing_m;
  if (width == 0) throw InputError(of_file(c) + ": grid.spacing_m: expected the size of a cell, as there are no frames");
  const double window = c.piv ? c.piv->window_px : piv::PivOptions{}.window_px;
  const double px = c.grid.spacing_px.value_or(window / 4);
  // A homography's scale differs over the image: the centre's counts.
  return px * std::sqrt(std::abs(camera.jacobian({(width - 1) / 2.0, (height - 1) / 2.0}).determinant()));
}

double nodes_between(double extent, double spacing) { return std::floor(extent / spacing + round_off) + 1; }

Grid grid_of(const Case& c, const Vec2& origin, double h, double nx, double ny) {
  const GivenSpacing spacing = given_spacing(c);
  require_at_most(std::max(nx, 0.0) * std::max(ny, 0.0), most_nodes, "nodes (" + number(nx) + " x " + number(ny) + ")",
                  spacing.key, spacing.value);
  require_at_most(std::max(nx, ny), most_nodes, "nodes in a row", spacing.key, spacing.value);
  return {origin, {h, h}, int(nx), int(ny)};
}

// Nodes at whole multiples of the spacing from the world's (0, 0), so that a base or wall there falls on nodes.
Grid grid_from_origin(const Case& c, const Extent& box, double h) {
  const double i0 = std::ceil(box.lower.x() / h - round_off), i1 = std::floor(box.upper.x() / h + round_off);
  const double j0 = std::ceil(box.lower.y() / h - round_off), j1 = std::floor(box.upper.y() / h + round_off);
  return grid_of(c, {i0 * h, j0 * h}, h, i1 - i0 + 1, j1 - j0 + 1);
}

Grid grid_from_corner(const Case& c, const Extent& box, double h) {
  const Vec2 extent = box.upper - box.lower;
  return grid_of(c, box.lower, h, nodes_between(extent.x(), h), nodes_between(extent.y(), h));
}

void require_inside(const Case& c, const Grid& grid, const image::Camera& camera, int width, int height) {
  const Vec2 ends[4] = {grid.position(0, 0), grid.position(grid.nx - 1, 0), grid.position(0, grid.ny - 1), grid.upper()};
  for (const Vec2& end : ends) {
    const Vec2 px = camera.to_pixel(end);
    constexpr double eps = 1e-6;
    if (!(px.x() >= -eps && px.y() >= -eps && px.x() <= width - 1 + eps && px.y() <= height - 1 + eps))
      throw InputError(of_file(c) + ": grid: its corner " + text(end) + " lies at pixel " + text(px) +
                       ", outside the image of " + std::to_string(width) + " x " + std::to_string(height) + " px");
  }
}

Polygon world_polygon(const RegionOptions& options, const image::Camera& camera, const std::string& what) {
  std::vector<Vec2> vertices = positions_of(options.polygon_m);
  for (const Pair& p : options.polygon_px) vertices.push_back(camera.to_world({p[0], p[1]}));
  return Polygon(std::move(vertices), what);
}

Grid make_grid(const Case& c, const Setting& setting) {
  const double h = spacing_of(c, setting.camera, setting.width, setting.height);
  if (!c.grid.area_m.empty() && !c.grid.area_px.empty())
    throw InputError(of_file(c) + ": grid: area_m and area_px are both given, expected one");
  Grid grid;
  if (!c.grid.area_m.empty()) {
    grid = grid_from_corner(c, corners(c.grid.area_m, of_file(c) + ": grid.area_m"), h);
  } else if (setting.width == 0) {
    Extent box{Vec2::Constant(std::numeric_limits<double>::infinity()),
            Vec2::Constant(-std::numeric_limits<double>::infinity())};
    if (c.mpm && !c.mpm->domain_m.empty()) {
      box = corners(c.mpm->domain_m, of_file(c) + ": mpm.domain_m");
    } else {
      for (const Region& r : setting.regions) {
        box.lower = box.lower.cwiseMin(r.polygon.lower());
        box.upper = box.upper.cwiseMax(r.polygon.upper());
      }
      if (setting.regions.empty())
        throw InputError(of_file(c) + ": grid.area_m: expected two corners, as there are neither frames nor regions");
    }
    grid = grid_from_corner(c, box, h);
  } else if (!c.grid.area_px.empty()) {
    const Extent px = corners(c.grid.area_px, of_file(c) + ": grid.area_px");
    const Vec2 a = setting.camera.to_world(px.lower), b = setting.camera.to_world(px.upper);
    grid = grid_from_corner(c, {a.cwiseMin(b), a.cwiseMax(b)}, h);
  } else {
    const double window = c.piv ? c.piv->window_px : piv::PivOptions{}.window_px;
    const double margin = c.grid.margin_px.value_or(window / 2);
    const Extent box = inner_box(setting.camera, setting.width, setting.height, margin);
    grid = setting.camera.plain() ? grid_from_origin(c, box, h) : grid_from_corner(c, box, h);
  }
  if (grid.nx < 2 || grid.ny < 2)
    throw InputError(of_file(c) + ": grid: a spacing of " + number(h) + " " + setting.camera.length_unit() +
                     " leaves " + std::to_string(std::max(grid.nx, 0)) + " x " + std::to_string(std::max(grid.ny, 0)) +
                     " nodes, expected at least 2 x 2");
  if (setting.width > 0) require_inside(c, grid, setting.camera, setting.width, setting.height);
  return grid;
}

// A vertex further outside than the image is large is a slip of the pen, or of the scale.
void require_near(const Polygon& polygon, const Setting& setting, const std::string& what) {
  const double most = std::max(setting.width, setting.height);
  for (const Vec2& x : polygon.vertices()) {
    const Vec2 px = setting.camera.to_pixel(x);
    const double off = std::max({-px.x(), -px.y(), px.x() - setting.width, px.y() - setting.height});
    if (off > most)
      throw InputError(what + ": found a vertex " + text(x) + " at pixel " + text(px) + ", expected it near the image of " +
                       std::to_string(setting.width) + " x " + std::to_string(setting.height) + " px");
  }
}

// The nodes of vectors that were read from files, in the world.
Grid imported_grid(const Case& c, const Setting& setting, const Grid& given, bool pixels) {
  if (!pixels) {
    const auto metres = [&](const Vec2& v) { return Vec2(in_metres(v.x(), c.vectors->length_unit), in_metres(v.y(), c.vectors->length_unit)); };
    return {metres(given.origin), metres(given.spacing), given.nx, given.ny};
  }
  if (!c.vectors->length_unit.empty() && setting.camera.length_unit() == "px")
    throw InputError(of_file(c) + ": camera.metres_per_pixel: missing beside a unit of length, expected the scale of the pixels that "
                                  "the files of [vectors] hold");
  if (!setting.camera.plain())
    throw InputError(of_file(c) + ": camera.points_px: given together with [vectors] in pixels, whose grid would not be "
                                  "regular in the world; expected metres_per_pixel");
  const double scale = setting.camera.jacobian({0, 0})(0, 0);  // of world = scale (column, -row) + shift
  Grid grid = given;
  grid.origin = setting.camera.to_world({given.origin.x(), -given.origin.y()});
  grid.spacing = scale * given.spacing;
  require_inside(c, grid, setting.camera, setting.width, setting.height);
  return grid;
}

// What a case cannot say of vectors in lengths, which have no pixels.
void check_lengths(const Case& c, bool pictured) {
  const bool scaled = c.camera.metres_per_pixel || !c.camera.points_px.empty();
  if (pictured && !scaled)
    throw InputError(of_file(c) + ": camera.metres_per_pixel: left out, expected the scale of the frames, since the files "
                                  "of [vectors] hold lengths");
  if (pictured) return;
  if (scaled)
    throw InputError(of_file(c) + ": camera.metres_per_pixel: given, but there are no pixels: the files of [vectors] hold "
                                  "lengths, and there are no frames");
  for (const auto& [name, region] : c.regions)
    if (!region.polygon_px.empty())
      throw InputError(of_file(c) + ": region." + name + ".polygon_px: given, but there are no pixels: the files of "
                                    "[vectors] hold lengths, and there are no frames");
  if (c.np && !c.np->still_zone_px.empty())
    throw InputError(of_file(c) + ": np.still_zone_px: given, but there are no pixels: the files of [vectors] hold lengths, "
                                  "and there are no frames");
  if (!c.masks.empty())
    throw InputError(of_file(c) + ": mask." + c.masks.front().first + ": given, but there are no pixels: the files of "
                                  "[vectors] hold lengths, and there are no frames");
}

}  // namespace

std::string of_file(const Case& c) { return c.file.empty() ? c.name : c.file.string(); }

Extent corners(const Points& points, const std::string& what) {
  if (points.size() != 2)
    throw InputError(what + ": found " + std::to_string(points.size()) + " points, expected two opposite corners");
  const Vec2 a(points[0][0], points[0][1]), b(points[1][0], points[1][1]);
  return {a.cwiseMin(b), a.cwiseMax(b)};
}

void keep_only(ParticleSet& set, const std::vector<bool>& keep) {
  std::size_t out = 0;
  for (std::size_t p = 0; p < set.size(); ++p) {
    if (!keep[p]) continue;
    set.id[out] = set.id[p];
    set.label[out] = set.label[p];
    set.x0[out] = set.x0[p];
    set.area[out] = set.area[p];
    set.born[out] = set.born[p];
    set.end[out] = set.end[p];
    set.end_reason[out] = set.end_reason[p];
    ++out;
  }
  set.id.resize(out);
  set.label.resize(out);
  set.x0.resize(out);
  set.area.resize(out);
  set.born.resize(out);
  set.end.resize(out);
  set.end_reason.resize(out);
}

Image prepared(const Setting& setting, Image frame) {
  return setting.filter ? (*setting.filter)(std::move(frame)) : std::move(frame);
}

Setting make_setting(const Case& c, int width, int height, const io::VectorFiles* measured) {
  Setting setting;
  setting.imported = measured != nullptr;
  if (measured && !measured->pixels()) check_lengths(c, width > 0);
  if (measured && measured->pixels() && width == 0) {
    const Grid& nodes = measured->grid();
    width = int(std::ceil(nodes.upper().x())) + 1;
    height = int(std::ceil(-nodes.origin.y())) + 1;
  }
  setting.width = width;
  setting.height = height;
  const bool calibrated = c.camera.metres_per_pixel || !c.camera.points_px.empty();
  if (width > 0 || calibrated)
    setting.camera = image::make_camera(c.camera, width, height);
  else
    setting.camera = image::Camera(Mat3::Identity(), 0, c.camera.length_unit);  // simulation only: no pixels
  if (width > 0) {
    setting.mask = image::make_mask(c.masks, setting.camera, width, height, c.folder);
    const bool camera_moves = c.camera_motion.from != image::RestSource::none;
    setting.moving_masks = image::MovingMasks(c.masks, setting.camera, width, height, c.folder, camera_moves);
    if (setting.moving_masks.any_in_world())
      if (const auto fixed = image::fixed_in_image(c.masks); !fixed.empty())
        setting.image_mask = image::make_mask(fixed, setting.camera, width, height, c.folder);
  }
  for (const auto& [name, options] : c.regions) {
    const std::string what =
        of_file(c) + ": region." + name + (options.polygon_px.empty() ? ".polygon_m" : ".polygon_px");
    setting.regions.push_back({name, world_polygon(options, setting.camera, what)});
    if (width > 0) require_near(setting.regions.back().polygon, setting, what);
  }
  setting.grid = measured ? imported_grid(c, setting, measured->grid(), measured->pixels()) : make_grid(c, setting);
  if (setting.regions.empty()) {
    const Vec2 a = setting.grid.origin, b = setting.grid.upper();
    setting.regions.push_back({c.materials.size() == 1 ? c.materials.front().first : "all",
                               Polygon({a, {b.x(), a.y()}, b, {a.x(), b.y()}}, "the grid")});
  }
  return setting;
}

image::Mask mask_of(const Setting& setting, int k, const ImageView& frame) {
  image::Mask mask = setting.moving_masks.any_in_world() ? setting.image_mask : setting.mask;
  setting.moving_masks.apply(k, frame, mask);
  return mask;
}

void set_camera_motion(CameraMotion motion, Setting& setting) {
  setting.cameras.clear();
  for (std::size_t k = 0; k < motion.at.size(); ++k) setting.cameras.push_back(setting.camera.after(motion.matrix(k)));
  setting.moving_masks.set_cameras(setting.cameras);
  setting.camera_motion = std::move(motion);
}

std::array<double, 6> motion_at_rest(const Setting& setting, std::array<int, 2> pair) {
  const image::Camera &a = setting.camera_at(pair[0]), &b = setting.camera_at(pair[1]);
  const double w = setting.width - 1, h = setting.height - 1;
  // Linear about the middle of the image; a lens bends it by less than what is asked of it here.
  const auto moved = [&](double column, double row) { return Vec2(b.to_pixel(a.to_world({column, row})) - Vec2(column, row)); };
  const Vec2 middle = moved(w / 2, h / 2), dx = (moved(0.75 * w, h / 2) - moved(0.25 * w, h / 2)) / (0.5 * w),
             dy = (moved(w / 2, 0.75 * h) - moved(w / 2, 0.25 * h)) / (0.5 * h), zero = middle - dx * w / 2 - dy * h / 2;
  return {zero.x(), dx.x(), dy.x(), zero.y(), dx.y(), dy.y()};
}

piv::NodeLattice node_lattice(const Setting& setting) { return node_lattice(setting, {0, 0}, Anchor::forward); }

piv::NodeLattice node_lattice(const Setting& setting, std::array<int, 2> pair, Anchor anchor) {
  const Grid& g = setting.grid;
  piv::NodeLattice lattice;
  lattice.nx = g.nx;
  lattice.ny = g.ny;
  lattice.pixel.resize(g.node_count());
  for (int j = 0; j < g.ny; ++j)
    for (int i = 0; i < g.nx; ++i) {
      const Vec2 x = g.position(i, j);
      Vec2 px = setting.camera_at(pair[0]).to_pixel(x);
      if (!setting.cameras.empty() && anchor == Anchor::central) px = (px + setting.camera_at(pair[1]).to_pixel(x)) / 2;
      lattice.pixel[g.node(i, j)] = {float(px.x()), float(px.y())};
    }
  return lattice;
}

double node_spacing_px(const Setting& setting) {
  const Mat2 J = setting.camera.jacobian({(setting.width - 1) / 2.0, (setting.height - 1) / 2.0});
  return setting.grid.spacing.x() / std::sqrt(std::abs(J.determinant()));
}

VectorField world_vectors(const piv::PixelVectors& pixels, const piv::NodeLattice& lattice, const Setting& setting,
                          std::array<int, 2> pair) {
  VectorField out;
  out.pair = pair;
  out.anchor = pixels.anchor;
  out.grid = setting.grid;
  out.status = pixels.status;
  out.score = pixels.score;
  out.path_factor = pixels.path_factor;
  out.correlation_length = pixels.correlation_px * static_cast<float>(setting.grid.spacing.x() / node_spacing_px(setting));
  const image::Camera &first = setting.camera_at(pair[0]), &second = setting.camera_at(pair[1]);
  const std::size_t count = setting.grid.node_count();
  out.displacement.resize(count);
  out.cov.resize(count);
  for (std::size_t n = 0; n < count; ++n) {
    const Vec2 at(double(lattice.pixel[n][0]), double(lattice.pixel[n][1]));
    const Vec2 d(double(pixels.displacement[n][0]), double(pixels.displacement[n][1]));
    const Vec2 start = pixels.anchor == Anchor::central ? Vec2(at - d / 2) : at;
    const Vec2 moved = second.to_world(start + d) - first.to_world(start);
    out.displacement[n] = {float(moved.x()), float(moved.y())};
    Mat2 cov;
    const auto& s = pixels.cov[n];
    cov << double(s[0]), double(s[2]), double(s[2]), double(s[1]);
    if (!setting.cameras.empty())
      for (const int frame : pair) cov.diagonal().array() += setting.camera_motion.variance(std::size_t(frame), at);
    const Mat2 J = setting.camera_at(pair[0]).jacobian(at);
    const Mat2 world = J * cov * J.transpose();
    out.cov[n] = {float(world(0, 0)), float(world(1, 1)), float(world(0, 1))};
  }
  return out;
}

ParticleSet seed_particles(const Case& c, const Setting& setting) {
  const np::NpOptions options = c.np.value_or(np::NpOptions{});
  ParticleSet set = seed(setting.grid, setting.regions, options.per_element, options.seeding, 0.0,
                         of_file(c) + ": np.per_element");
  if (setting.width == 0) return set;
  const MaskView mask = setting.mask.view();
  std::vector<bool> keep(set.size());
  for (std::size_t p = 0; p < set.size(); ++p) {
    const Vec2 px = setting.camera.to_pixel(set.x0[p]);
    const int column = int(std::lround(px.x())), row = int(std::lround(px.y()));
    keep[p] = column >= 0 && row >= 0 && column < setting.width && row < setting.height && mask.usable(column, row);
  }
  keep_only(set, keep);
  if (set.size() == 0) throw InputError(of_file(c) + ": the masks leave no particle in any region");
  return set;
}

}  // namespace pivnp::app
