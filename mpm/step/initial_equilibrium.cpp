#include "mpm/step/initial_equilibrium.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <sstream>

#include "mpm/step/energy.hpp"
#include "mpm/step/thread_choice.hpp"
#include "mpm/transfer/transfer.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::mpm {

namespace {

// A wave needs a few steps a cell, and some tens of crossings die out: ten times what was seen to suffice.
int most_iterations(const Grid& grid) { return std::max(20000, 200 * std::max(grid.nx, grid.ny)); }

constexpr double most_strain = 0.5;  // of a point in one pseudo-step

// Kinetic over elastic energy that only a mass that slides off reaches: what swings about an equilibrium has less
// kinetic energy than it stores.
constexpr double most_kinetic = 10;
// It is looked at once waves have crossed some five times, at half a cell an iteration at most: at first a load has
// little to store its work in.
int first_crossings(const Grid& grid) { return most_iterations(grid) / 20; }

// Strength and dilatancy of soil that has not yielded.
void keep_strength(Particles& p) {
  if (Array* strain = p.history.find(plastic_strain.name)) std::fill(strain->begin(), strain->end(), 0.0);
}

// Gershgorin: the sum over a row of sum_p V0 M |grad N_i| |grad N_j| bounds the largest eigenvalue times the mass. (The
// averages against locking only take stiffness away.)
std::vector<double> fictitious_masses(const Particles& p, const Materials& materials, const GridState& g) {
  std::vector<double> modulus(p.size());
  for (const Particles::Body& body : p.bodies)
    std::fill(modulus.begin() + std::ptrdiff_t(body.begin), modulus.begin() + std::ptrdiff_t(body.end),
              materials[std::size_t(body.material)]->elastic().p_wave_modulus());
  return stiffness_bound(p, g, modulus);
}

class Relaxation {
 public:
  Relaxation(const EquilibriumOptions& options, const StaticSystem& system)
      : o_(options), s_(system), p_(system.particles), g_(system.grid), choice_(options.threads),
        mass_(fictitious_masses(p_, system.materials, g_)), velocity_(g_.active.nodes.size(), Vec2::Zero()) {}

  /// One pseudo-step; the ratio of unbalanced to applied force before it.
  double iterate() {
    choice_.begin_step();
    g_.join_strain_velocities();
    const int threads = choice_.threads();
    average_mean_stress(p_, g_, s_.scheme, threads);
    map_momentum(p_, g_, s_.scheme, true, threads);
    if (!s_.contacts.empty() && !found_) s_.contacts.find(p_, g_, s_.density, 0, threads);  // points stay
    found_ = true;
    const double applied = propose();
    reactions_.clear();
    s_.restraints.apply(0, 0, g_, reactions_);
    s_.contacts.apply(g_, s_.restraints, reactions_);
    s_.bodies.apply(-1, 0, 0, {}, p_, g_, reactions_);  // at rest
    const double unbalanced = accelerate();
    strain_points(p_, g_, s_.scheme, 1.0, false, threads);
    std::fill(p_.spin.begin(), p_.spin.end(), 0.0);  // displacements are small against the rotations that would matter
    strained_too_far_ = any_beyond(most_strain);
    if (!strained_too_far_) {
      update_stress(s_.materials, p_, threads);
      keep_strength(p_);
      if (s_.water) s_.water->refresh(p_, o_.gravity, threads);
    }
    choice_.end_step();
    return applied > 0 ? unbalanced / applied : 0;
  }

  void require_held() const {
    std::vector<std::uint32_t> gripped;
    for (const Reaction& r : reactions_)
      if (r.body >= 0) gripped.push_back(std::uint32_t(r.node));
    mpm::require_held(p_, g_, s_.restraints, gripped, o_.gravity, s_.set);
  }
  double kinetic() const { return kinetic_; }
  /// Of the last pseudo-step: no equilibrium is near, and laws that work by substeps would take long over such strains.
  bool strained_too_far() const { return strained_too_far_; }

 private:
  // Undamped velocities, to be restrained; returns the applied force.
  double propose() {
    double applied = 0;
    for (std::size_t a = 0; a < g_.active.nodes.size(); ++a) {
      Node& node = g_.node[g_.active.nodes[a]];
      const Vec2 weight =
          node.mass * (o_.variation ? Vec2(o_.gravity + o_.variation(g_.place(g_.active.nodes[a]))) : o_.gravity);
      applied += weight.norm();
      const double bound = mass_[g_.active.nodes[a]], per_mass = bound > 0 ? 1 / bound : 0;
      node.mass = mass_[g_.active.nodes[a]];
      node.nx = velocity_[a].x() + per_mass * (node.fx + weight.x());
      node.ny = velocity_[a].y() + per_mass * (node.fy + weight.y());
    }
    return applied;
  }

  // Cundall's damping, but for velocities below a step's change, where it would depend on the sign of round-off: so the
  // state that is found is a continuous function of the scene.
  double damped(double change, double v) const {
    const double most = std::abs(change);
    return o_.damping * std::clamp(v, -most, most);
  }

  bool any_beyond(double strain) const {
    double most = 0;
    for (const Array* of : {&p_.de_xx, &p_.de_yy, &p_.de_xy, &p_.hoop})
      for (const double e : *of) most = std::max(most, std::abs(e));
    return most > strain;
  }

  // What the restraints left of the acceleration is the unbalanced force; it is damped and applied.
  double accelerate() {
    double unbalanced = 0;
    kinetic_ = 0;
    for (std::size_t a = 0; a < g_.active.nodes.size(); ++a) {
      Node& node = g_.node[g_.active.nodes[a]];
      Vec2& v = velocity_[a];
      const Vec2 change(node.nx - v.x(), node.ny - v.y());
      unbalanced += node.mass * change.norm();
      const Vec2 reached(node.nx, node.ny);
      const GridState::StrainVelocity u = g_.strain_velocity(g_.active.nodes[a]);
      u.x = reached.x() - damped(change.x(), v.x());
      u.y = reached.y() - damped(change.y(), v.y());
    }
    s_.bodies.separate_strain_velocities(g_);
    s_.restraints.apply_to_strain_velocity(0, g_, true);
    s_.contacts.apply_to_strain_velocity(g_);
    s_.bodies.apply_to_strain_velocity(-1, g_);
    for (std::size_t a = 0; a < g_.active.nodes.size(); ++a) {
      velocity_[a] = std::as_const(g_).strain_velocity(g_.active.nodes[a]);
      kinetic_ += 0.5 * g_.node[g_.active.nodes[a]].mass * velocity_[a].squaredNorm();
    }
    return unbalanced;
  }

  const EquilibriumOptions& o_;
  const StaticSystem& s_;
  Particles& p_;
  GridState& g_;
  ThreadChoice choice_;
  std::vector<double> mass_;
  std::vector<Vec2> velocity_;  // of the active nodes
  std::vector<Reaction> reactions_;
  double kinetic_ = 0;
  bool found_ = false, strained_too_far_ = false;
};

// The stresses of a state in equilibrium.
class Found {
 public:
  Found(const Particles& p, int n) : iterations(n), stress_{p.tau_xx, p.tau_yy, p.tau_zz, p.tau_xy} {}
  void put_back(Particles& p) const {
    const std::array<Array*, 4> to{&p.tau_xx, &p.tau_yy, &p.tau_zz, &p.tau_xy};
    for (std::size_t c = 0; c < to.size(); ++c) *to[c] = stress_[c];
  }

  int iterations;  // after which it was found

 private:
  std::array<Array, 4> stress_;
};

// Which nodes hang together.
class Pieces {
 public:
  explicit Pieces(std::size_t nodes) : above_(nodes) { std::iota(above_.begin(), above_.end(), 0u); }
  std::uint32_t of(std::uint32_t n) {
    while (above_[n] != n) n = above_[n] = above_[above_[n]];
    return n;
  }
  void join(std::uint32_t a, std::uint32_t b) { above_[of(b)] = of(a); }

 private:
  std::vector<std::uint32_t> above_;
};

// The way along gravity that a piece is free to go: what is left of it without the directions in which its nodes are
// held, the ranges of `held` (a sum of projections).
bool may_move(const Mat2& held, const Vec2& gravity) {
  const Eigen::SelfAdjointEigenSolver<Mat2> axes(held);
  for (int k = 0; k < 2; ++k)
    if (axes.eigenvalues()[k] < 1e-6 && std::abs(axes.eigenvectors().col(k).dot(gravity)) > 1e-6 * gravity.norm())
      return true;
  return false;
}

struct Piece {
  Mat2 held = Mat2::Zero();  // by walls and bodies: a sum of projections
  std::size_t points = 0;
  std::uint32_t lowest = 0;  // of them, in storage
};

std::map<std::uint32_t, Piece> pieces_of(const Particles& p, const GridState& g, const Restraints& restraints,
                                         const std::vector<std::uint32_t>& gripped, const Vec2& gravity) {
  Pieces joined(g.grid.node_count());
  std::size_t at[most_stencil_nodes];
  for (const std::int32_t cell : g.cells.index) {
    g.stencil_nodes(cell, at);
    for (int k = 1; k < g.stencil; ++k) joined.join(std::uint32_t(at[0]), std::uint32_t(at[k]));
  }
  const std::vector<std::uint32_t>& nodes = g.active.nodes;
  for (const std::uint32_t n : nodes)  // bodies in contact lie on each other
    if (const std::size_t first = n % g.field_nodes(); first != n)
      for (std::size_t below = first; below < n; below += g.field_nodes())
        if (std::binary_search(nodes.begin(), nodes.end(), std::uint32_t(below))) joined.join(std::uint32_t(below), n);
  std::map<std::uint32_t, Piece> pieces;
  for (const std::uint32_t n : nodes) pieces[joined.of(n)].held += restraints.hold(n, gravity);
  for (const std::uint32_t n : gripped) pieces[joined.of(n)].held += Mat2::Identity();
  if (g.axisymmetric)  // a ring holds itself
    for (const std::uint32_t n : nodes) pieces[joined.of(n)].held(0, 0) += 1;
  for (std::size_t s = 0; s < g.cells.size(); ++s) {
    g.stencil_nodes(g.cells.index[s], at);
    Piece& of = pieces[joined.of(std::uint32_t(at[0]))];
    for (std::uint32_t q = g.cells.begin[s]; q < g.cells.begin[s + 1]; ++q) {
      const std::uint32_t k = g.cells.order[q];
      if (of.points++ == 0 || p.y[k] < p.y[of.lowest]) of.lowest = k;
    }
  }
  return pieces;
}

}  // namespace

void require_held(const Particles& p, const GridState& g, const Restraints& restraints,
                  const std::vector<std::uint32_t>& gripped, const Vec2& gravity, const ParticleSet& set) {
  if (gravity.norm() == 0) return;
  for (const auto& [node, piece] : pieces_of(p, g, restraints, gripped, gravity)) {
    if (piece.points == 0 || !may_move(piece.held, gravity)) continue;
    const auto label = std::size_t(set.label[p.index[piece.lowest]]);
    std::ostringstream text;
    text << "mpm.initial_equilibrium: found true, but nothing holds " << piece.points << " particles";
    if (label < set.label_names.size()) text << " of '" << set.label_names[label] << "'";
    text << " against gravity, the lowest at (" << p.x[piece.lowest] << ", " << p.y[piece.lowest]
         << "); expected a boundary below them, or initial_equilibrium = false";
    throw InputError(text.str());
  }
}

namespace {

// Of every column of cells the share that walls between lines of nodes leave it.
std::vector<double> open_shares(const GridState& g) {
  std::vector<double> open(std::size_t(g.domain.nx - 1), 1.0);
  for (std::size_t n = 0; n < std::min(g.shift.size(), g.field_nodes()); ++n) {
    const double s = g.shift[n].x() * g.per_hx;
    const auto column = std::ptrdiff_t(n % std::size_t(g.grid.nx)) - 1 - (s < 0 ? 1 : 0);
    if (s == 0 || column < 0 || std::size_t(column) >= open.size()) continue;
    const double to_the_left = s < 0 ? 1 + s : s;
    open[std::size_t(column)] = g.walls[n] & wall_left ? 1 - to_the_left : to_the_left;
  }
  return open;
}

}  // namespace

// Sums run down a column in storage order.
void stress_from_columns(Particles& p, const Materials& materials, const GridState& g, double gravity_y,
                         std::optional<double> k0, const PoreWater* water) {
  const std::vector<double> displaced = water ? water->displaced_mass(p) : std::vector<double>{};
  const auto across = std::size_t(g.domain.nx - 1);
  std::vector<std::vector<std::uint32_t>> columns(across, std::vector<std::uint32_t>{});
  for (const std::uint32_t k : g.cells.order)
    columns[std::min(across - 1, std::size_t(std::max(0.0, (p.x[k] - g.domain.origin.x()) * g.per_hx)))].push_back(k);
  std::vector<double> rest(p.size());
  for (const Particles::Body& body : p.bodies) {
    const double poisson = materials[std::size_t(body.material)]->elastic().poisson;
    std::fill(rest.begin() + std::ptrdiff_t(body.begin), rest.begin() + std::ptrdiff_t(body.end),
              k0.value_or(poisson / (1 - poisson)));
  }
  const std::vector<double> open = open_shares(g);
  for (auto& column : columns) {
    const double per_width = g.per_hx / open[std::size_t(&column - columns.data())];
    std::stable_sort(column.begin(), column.end(), [&](std::uint32_t a, std::uint32_t b) {
      return gravity_y < 0 ? p.y[a] > p.y[b] : p.y[a] < p.y[b];
    });
    double above = 0;
    for (std::size_t a = 0; a < column.size();) {
      std::size_t b = a;
      double here = 0;
      while (b < column.size() && p.y[column[b]] == p.y[column[a]]) {
        const double mass = p.mass_of(column[b]) - (displaced.empty() ? 0 : displaced[column[b]]);
        here += g.axisymmetric ? mass / p.x[column[b]] : mass;
        ++b;
      }
      const double vertical = -std::abs(gravity_y) * (above + 0.5 * here) * per_width;
      for (; a < b; ++a) {
        const std::uint32_t k = column[a];
        p.tau_yy[k] = vertical;
        p.tau_xx[k] = p.tau_zz[k] = rest[k] * vertical;
      }
      above += here;
    }
  }
}

int relax_to_equilibrium(const EquilibriumOptions& options, const StaticSystem& system, Progress& progress) {
  Particles& p = system.particles;
  GridState& g = system.grid;
  locate_all(p, g);
  if (!options.goes_on && std::abs(options.gravity.x()) <= 1e-3 * std::abs(options.gravity.y()))
    stress_from_columns(p, system.materials, g, options.gravity.y(), options.k0, system.water);
  for (std::size_t k = 0; k < p.size() && !options.given.empty(); ++k) {
    const auto& [xx, yy, zz, xy] = options.given[p.index[k]];
    if (std::isnan(xx)) continue;
    p.tau_xx[k] = xx;
    p.tau_yy[k] = yy;
    p.tau_zz[k] = zz;
    p.tau_xy[k] = xy;
  }
  p.resize_increments(p.size());
  update_stress(system.materials, p, options.threads);  // brings the first guess inside the yield surface
  keep_strength(p);
  if (system.water) system.water->refresh(p, options.gravity, options.threads);

  Relaxation relaxation(options, system);
  const int most = most_iterations(g.grid);
  // Points free to drift keep a little motion under forces that have long been balanced.
  constexpr int long_balanced = 2000;  // iterations
  constexpr double well_balanced = 0.1;  // of the tolerance
  constexpr int moves_on = 5000;         // iterations
  constexpr int times_more = 4, more_at_least = 4000;  // iterations beyond the tolerance, over those up to it
  const auto calm = [&](double within) { return relaxation.kinetic() <= within * stored_energy(p, g, system.materials).elastic; };
  std::optional<Found> found;
  double ratio = 0;
  int n = 1, balanced = 0, within = 0;
  for (; n <= most || found; ++n) {
    ratio = relaxation.iterate();
    balanced = ratio < well_balanced * (found ? options.wanted : options.tolerance) ? balanced + 1 : 0;
    if (n == 1) relaxation.require_held();
    if (!std::isfinite(ratio) || relaxation.strained_too_far()) break;
    if (!found && ratio < options.tolerance && n > 10 && calm(options.tolerance)) {
      if (!(options.wanted < options.tolerance)) return n;
      found.emplace(p, n);
    }
    if (found && ratio < options.wanted && calm(options.wanted)) return n;
    if (balanced >= long_balanced) return n;
    within = ratio < options.tolerance ? within + 1 : 0;
    if (options.leads_on && !found && within >= moves_on) return -n;
    if (found && n - found->iterations >= std::max(more_at_least, times_more * found->iterations)) break;
    if (n % 200 == 0) {
      if (!found && n >= first_crossings(g.grid) && ratio >= options.tolerance && !calm(most_kinetic)) break;
      progress.update("initial equilibrium", n, most);
      if (progress.stop_requested()) throw Interrupted();
    }
  }
  if (found) {
    if (ratio < options.tolerance && !relaxation.strained_too_far()) return n;
    found->put_back(p);
    if (system.water) system.water->refresh(p, options.gravity, options.threads);
    return found->iterations;
  }
  std::ostringstream text;
  const double elastic = stored_energy(p, g, system.materials).elastic;
  const bool slides = ratio < options.tolerance && n > most;  // under balanced forces, as what yields all along a surface
  text << "initial equilibrium: " << (slides ? "the forces are balanced but the material goes on moving: kinetic over elastic energy " : "unbalanced over applied force ");
  if (std::isfinite(ratio))
    text << "is still " << (slides ? relaxation.kinetic() / elastic : ratio);
  else
    text << "is no number";
  text << " after " << std::min(n, most) << " iterations, " << (n <= most ? "in which the material moves apart, " : "")
       << "expected below " << options.tolerance
       << " (is it held on all sides, and strong enough to carry its weight? mpm.initial_equilibrium = false starts "
          "without)";
  throw RunError(text.str());
}

}  // namespace pivnp::mpm
