// The water at time 0: at rest below a surface, or in steady flow. docs/theory/mpm_water.md#start
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "mpm/grid/sweeps.hpp"
#include "mpm/water/pore_elements.hpp"
#include "mpm/water/pore_water.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::mpm {

double PoreWater::surface_at(double x) const {
  const Points& at = options_.surface_m;
  if (at.empty()) return *level_;
  std::size_t k = 0;
  while (k < at.size() && at[k][0] <= x) ++k;
  if (k == 0 || k == at.size()) return at[k == 0 ? 0 : k - 1][1];
  return at[k - 1][1] + (at[k][1] - at[k - 1][1]) * (x - at[k - 1][0]) / (at[k][0] - at[k - 1][0]);
}

void PoreWater::check_start(const Vec2& gravity) const {
  const Points& at = options_.surface_m;
  for (std::size_t k = 0; k < at.size(); ++k)
    if (!std::isfinite(at[k][0]) || !std::isfinite(at[k][1]) || (k > 0 && !(at[k][0] > at[k - 1][0])))
      throw InputError("water.surface_m: point " + std::to_string(k + 1) + " is not finite or not to the right of the one before, expected rising x");
  if (!at.empty() && options_.start && options_.start != WaterStart::hydrostatic)
    throw InputError("water.surface_m: given beside water.start = \"" + std::string(name_of(*options_.start)) + "\", expected \"hydrostatic\" or one of them");
  if (!at.empty() && !(gravity.y() < 0 && std::abs(gravity.x()) <= 1e-3 * -gravity.y()))
    throw InputError("water.surface_m: given where gravity is not downwards, expected vertical gravity or no surface");
  if (!at.empty() && projected())
    throw InputError("water.surface_m: given beside mpm.pressure = \"projected\", expected \"explicit\"");
  if (options_.start == WaterStart::hydrostatic && !has_surface())
    throw InputError("water.start: found 'hydrostatic' without a level, expected water.level_m, level_history or surface_m");
  if (options_.start == WaterStart::zero && level_)
    throw InputError("water.start: found 'zero' beside a level, expected one of them");
  if (imposed() && projected())
    throw InputError("water.groundwater: found 'level' beside mpm.pressure = \"projected\", expected \"explicit\"");
  if (options_.start != WaterStart::seepage) return;
  if (imposed()) throw InputError("water.start: found 'seepage' beside water.groundwater = \"level\", expected 'hydrostatic'");
  if (ties_->any()) throw InputError("water.start: found 'seepage' beside a tied boundary, expected 'hydrostatic' or 'zero'");
  if (projected() && (level_ || boundaries_.any_level()))
    throw InputError("water.start: found 'seepage' with a level beside mpm.pressure = \"projected\", expected \"explicit\"");
}

void PoreWater::start(Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity,
                      std::span<const double> given, int threads) {
  check_start(gravity);
  std::vector<std::uint8_t> full(g.grid.node_count(), 0);
  for (std::size_t k = 0; k < p.size(); ++k) {
    const Vec2 at = (Vec2(p.x[k], p.y[k]) - g.field_grid.origin).cwiseQuotient(g.field_grid.spacing);
    full[g.field_grid.node(std::min(int(at.x()), g.field_grid.nx - 2), std::min(int(at.y()), g.field_grid.ny - 2))] = 1;
  }
  boundaries_.check_outside(g, [&](std::size_t n) { return full[n] != 0; });
  take_soils(p);
  fill_below_surface(p, gravity);
  if (options_.start == WaterStart::seepage) fill_by_seepage(p, g, tractions, gravity, threads);
  fill_as_given(p, gravity, given);
  for (std::size_t k = 0; k < p.size(); ++k)
    if (const PoreSoil& soil = soil_of(p, k); soil.has_pores())
      p.mass[k] = p.volume0[k] * (soil.dry_density() + options_.density_kg_m3 * p.content[k]);
  const bool collapses = std::any_of(soils_.begin(), soils_.end(), [](const PoreSoil& s) { return s.collapse > 0; });
  p.wetted.assign(collapses ? p.size() : 0, 0.0);
  for (std::size_t k = 0; k < p.wetted.size(); ++k)
    if (soil_of(p, k).has_pores()) p.wetted[k] = std::min(1.0, filled(p, k));
  if (has_front(p, gravity, threads)) front_.resize(g.arrays.pores.size());  // (from then on dry points count, too)
  refresh(p, gravity, threads);
  check_inertia(p, gravity);
}

void PoreWater::fill_below_surface(Particles& p, const Vec2& gravity) const {
  const bool air = sees_air(gravity);
  for (std::size_t k = 0; k < p.size(); ++k) {
    const PoreSoil& soil = soil_of(p, k);
    const double above = has_surface() ? p.y[k] - surface_at(p.x[k]) : 0, weight = options_.density_kg_m3 * -gravity.y();
    const bool full = soil.has_pores() && (!has_surface() || above < 0 || (imposed() && soil.holds_water()));
    p.content[k] = full ? soil.porosity * (1 + (has_surface() ? std::max(0.0, -above) * weight : 0) / options_.bulk_modulus_pa) : 0;
    if (full && soil.drained) p.content[k] = soil.porosity;
    if (!full && soil.holds_water() && air)  // what the surface cuts
      p.content[k] = soil.porosity * std::max(0.0, 1 - above / std::sqrt(section(p, k, p.volume0[k])));
  }
}

// Beside a level, a pressure below zero is the part of the pores that is empty (as in steady flow).
void PoreWater::fill_as_given(Particles& p, const Vec2& gravity, std::span<const double> given) const {
  if (given.empty()) return;
  const bool air = sees_air(gravity);
  for (std::size_t k = 0; k < p.size(); ++k) {
    const double pressure = given[p.index[k]];
    if (std::isnan(pressure)) continue;
    const PoreSoil& soil = soil_of(p, k);
    const auto where = [&] {
      return "initial." + set_->label_names[std::size_t(set_->label[p.index[k]])] +
             ": a pressure of the pores is given ";
    };
    if (!soil.holds_water())
      throw InputError(where() +
                       "to material whose pores hold no water of their own, expected a porosity, and drained = false");
    if (pressure < 0 && imposed())
      throw InputError(where() + "below zero beside water.groundwater = \"level\", expected zero or more");
    const double beyond = pressure / (pressure < 0 && air ? fringe(p, k, gravity) : options_.bulk_modulus_pa);
    if (!air && 1 + beyond <= 0) throw InputError(where() + "below minus water.bulk_modulus_pa, expected more");
    p.content[k] = soil.porosity * std::max(0.0, 1 + beyond);
  }
}

namespace {

constexpr double of_dry = 1e-3;       // of the permeability: lets a potential be found where there is no water
constexpr double to_lowest = 1e-9;    // of a node's exchange: what no given potential reaches stands at the lowest of those
constexpr int most_rounds = 400;
constexpr double settled = 1e-5, near = 1e-3;  // change of the potential in a round, over rho g times the height of the material; near: will do
constexpr int rounds_at_once = 8;     // before what changes is mixed with what was

}  // namespace

// Steady flow between the nodes of the grid, by the two-point flux of the flow in time (pore_flow.cpp). A point conducts in proportion to
// the share of its pores that is full, which falls over its own height from where the pressure is zero. What is open to the air gives
// its potential where water would come out, and nothing enters there.
class PoreWater::Seepage {
 public:
  Seepage(PoreWater& water, const Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity, int threads)
      : w_(water), p_(p), g_(g), gravity_(gravity), air_(water.sees_air(gravity)) {
    w_.map_front(p, g, tractions, gravity, 0, threads);
    index_.assign(w_.front_.size(), -1);
    double top = -1e300, bottom = 1e300;
    for (const std::uint32_t n : g.active.nodes) {
      if (!(w_.front_[n].all > 0)) continue;
      index_[n] = int(nodes_.size());
      const double height = -w_.head(g.position(n), gravity);
      const std::optional<Opening> open = w_.opening(g, n, gravity, 0);
      Node node{n, height, open ? open->pressure + height : 0, 0, open.has_value(), open && (open->stands || !air_)};
      if (!open) node.flux = w_.flux_into(g, n, 0, [&](std::ptrdiff_t element) { return element >= 0 && w_.front_[std::size_t(element)].holds; });
      node.held = node.open;
      nodes_.push_back(node);
      top = std::max(top, height);
      bottom = std::min(bottom, height);
    }
    scale_ = std::max(top - bottom, 1e-6);
    for (std::size_t k = 0; k < p.size(); ++k)
      if (p.cell[k] != Particles::ended && w_.flows(p, k)) points_.push_back({k, w_.front_point(p, g, k, gravity), 1.0});
    for_nodes(g, threads, [&](mpm::Node&, std::uint32_t n) { w_.front_[n] = {}; });
  }

  void solve() {
    double lowest = 1e300;
    for (const Node& node : nodes_)
      if (node.open) lowest = std::min(lowest, node.given);
    if (lowest == 1e300)
      throw InputError("water.start: found 'seepage', but no pressure is given anywhere, expected a level, or a boundary with pressure_pa, water_level_m or drained");
    potential_ = Eigen::VectorXd::Constant(Eigen::Index(nodes_.size()), lowest);
    double change = 0;
    for (int round = 0; round < most_rounds; ++round) {
      const Eigen::VectorXd before = potential_;
      flow(lowest);
      const bool switched = switch_faces();
      change = (potential_ - before).cwiseAbs().maxCoeff() / scale_;
      if (!air_ || (round > 0 && !switched && change < settled)) return;
      conduct(round < rounds_at_once ? 1.0 : 0.3);
    }
    if (!(change < near))
      throw RunError("water.start: no steady flow was found, expected 'hydrostatic', or a surface_m");
  }

  void fill(Particles& p) const {
    for (const Point& point : points_) {
      const double porosity = w_.soil_of(p, point.k).porosity, pressure = potential_at(point.at) + w_.head({p.x[point.k], p.y[point.k]}, gravity_);
      const double beyond = pressure / (pressure < 0 && air_ ? point.at.height : w_.options_.bulk_modulus_pa);
      p.content[point.k] = porosity * std::max(0.0, 1 + beyond);
    }
  }

 private:
  struct Node {
    std::size_t n;
    double height, given, flux;
    bool open, stands, held = false;
  };
  struct Point {
    std::size_t k;
    FrontPoint at;
    double share;
  };

  double potential_at(const FrontPoint& at) const {
    double e = 0;
    for (int c = 0; c < 4; ++c) e += at.w[c] * potential_[index_[at.at[c]]];
    return e;
  }

  void conduct(double mixed) {
    for (Point& point : points_) {
      const double pressure = potential_at(point.at) + w_.head({p_.x[point.k], p_.y[point.k]}, gravity_);
      point.share += mixed * (std::clamp(1 + pressure / point.at.height, of_dry, 1.0) - point.share);
    }
  }

  void flow(double lowest) {
    const auto row = std::size_t(g_.grid.nx);
    std::vector<double> conducts(index_.size(), 0.0);
    for (const Point& point : points_) conducts[point.at.at[0]] += point.at.volume * point.at.mobility * point.share;
    std::vector<Eigen::Triplet<double>> entries;
    std::vector<double> diagonal(nodes_.size(), 0.0);
    const auto edge = [&](std::size_t a, std::size_t b, double k) {
      const int i = index_[a], j = index_[b];
      if (i < 0 || j < 0) return;
      entries.emplace_back(i, j, -k);
      entries.emplace_back(j, i, -k);
      diagonal[std::size_t(i)] += k;
      diagonal[std::size_t(j)] += k;
    };
    const double kx = 0.5 * g_.per_hx * g_.per_hx, ky = 0.5 * g_.per_hy * g_.per_hy;
    for (std::size_t n = 0; n + row + 1 < conducts.size(); ++n) {
      if (!(conducts[n] > 0)) continue;
      edge(n, n + 1, kx * conducts[n]);
      edge(n + row, n + row + 1, kx * conducts[n]);
      edge(n, n + row, 2 * ky * w_.share_of_right(std::ptrdiff_t(n)) * conducts[n]);
      edge(n + 1, n + row + 1, 2 * ky * w_.share_of_left(std::ptrdiff_t(n) + 1) * conducts[n]);
    }
    const auto size = Eigen::Index(nodes_.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i) entries.emplace_back(int(i), int(i), diagonal[i]);
    matrix_.resize(size, size);
    matrix_.setFromTriplets(entries.begin(), entries.end());
    // What is held goes to the right side; rows and columns stay symmetric.
    Eigen::VectorXd right(size);
    for (Eigen::Index i = 0; i < size; ++i) {
      const Node& node = nodes_[std::size_t(i)];
      right[i] = node.held ? node.given : node.flux + to_lowest * diagonal[std::size_t(i)] * lowest;
    }
    Eigen::SparseMatrix<double> reduced = matrix_;
    for (Eigen::Index column = 0; column < size; ++column)
      for (Eigen::SparseMatrix<double>::InnerIterator at(reduced, column); at; ++at) {
        const bool row_held = nodes_[std::size_t(at.row())].held, column_held = nodes_[std::size_t(column)].held;
        if (at.row() == column) {
          at.valueRef() = row_held ? 1 : at.value() * (1 + to_lowest) + (at.value() > 0 ? 0 : 1);
        } else if (row_held || column_held) {
          if (!row_held) right[at.row()] -= at.value() * nodes_[std::size_t(column)].given;
          at.valueRef() = 0;
        }
      }
    if (!analysed_) solver_.analyzePattern(reduced);
    analysed_ = true;
    solver_.factorize(reduced);
    potential_ = solver_.solve(right);
    if (solver_.info() != Eigen::Success || !potential_.allFinite())
      throw RunError("water.start: the steady flow has no solution, expected a permeability above zero and a pressure that is given somewhere");
  }

  bool switch_faces() {
    const Eigen::VectorXd leaving = -(matrix_ * potential_);  // into the node from its neighbours: out through a face
    bool switched = false;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      Node& node = nodes_[i];
      if (!node.open || node.stands) continue;
      const bool holds = node.held ? leaving[Eigen::Index(i)] >= 0 : potential_[Eigen::Index(i)] > node.given + 1e-9 * scale_;
      switched = switched || holds != node.held;
      node.held = holds;
    }
    return switched;
  }

  PoreWater& w_;
  const Particles& p_;
  const GridState& g_;
  Vec2 gravity_;
  bool air_, analysed_ = false;
  double scale_ = 0;
  std::vector<int> index_;  // of the grid's nodes among those that hold water; -1
  std::vector<Node> nodes_;
  std::vector<Point> points_;
  Eigen::SparseMatrix<double> matrix_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
  Eigen::VectorXd potential_;
};

void PoreWater::fill_by_seepage(Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity, int threads) {
  for (std::size_t k = 0; k < p.size(); ++k)
    if (soil_of(p, k).holds_water()) p.content[k] = soil_of(p, k).porosity;
  front_.resize(g.arrays.pores.size());
  Seepage seepage(*this, p, g, tractions, gravity, threads);
  seepage.solve();
  seepage.fill(p);
  if (!sees_air(gravity)) front_.clear();
}

}  // namespace pivnp::mpm
