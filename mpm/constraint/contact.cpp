#include "mpm/constraint/contact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "mpm/grid/sweeps.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::mpm {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double touching = 0.25;  // cells between bodies that touch in the initial equilibrium
constexpr double overlap = 0.02;   // cells by which points may stand across a face that is taken as found
constexpr int sweeps = 10;         // where three bodies may meet at a node

// The bodies' laws as the options state them; labels by their place.
struct Stated {
  std::string key;
  std::set<std::size_t> one, other;  // labels; other empty: all else
  double friction;
};

std::set<std::size_t> labels_of(const std::string& key, const std::vector<std::string>& regions,
                                const std::vector<std::string>& labels) {
  std::set<std::size_t> found;
  for (const std::string& region : regions) {
    const auto at = std::find(labels.begin(), labels.end(), region);
    if (at == labels.end())
      throw InputError(key + ": there is no region '" + region + "'" + did_you_mean(region, labels));
    if (!found.insert(std::size_t(at - labels.begin())).second)
      throw InputError(key + ": found '" + region + "' twice");
  }
  return found;
}

}  // namespace

Contacts::Contacts(const std::vector<std::pair<std::string, ContactOptions>>& contacts,
                   const std::vector<std::string>& labels)
    : field_of_label_(labels.size(), 0) {
  if (contacts.empty()) return;
  std::vector<Stated> stated;
  std::vector<std::set<std::size_t>> bodies;
  const auto take = [&](const std::string& key, const std::set<std::size_t>& body) {
    for (const auto& other : bodies) {
      if (other == body) return;
      for (const std::size_t label : body)
        if (other.count(label))
          throw InputError(key + ": '" + labels[label] + "' belongs to another body elsewhere, expected the same list");
    }
    bodies.push_back(body);
  };
  for (const auto& [name, o] : contacts) {
    const std::string key = "contact." + name;
    if (o.regions.empty()) throw InputError(key + ".regions: missing; expected the names of one or more regions");
    if (o.friction && !(*o.friction >= 0 && std::isfinite(*o.friction)))
      throw InputError(key + ".friction: found " + number(*o.friction) + ", expected 0 or more");
    stated.push_back({key, labels_of(key + ".regions", o.regions, labels), labels_of(key + ".against", o.against, labels),
                      o.friction.value_or(infinite)});
    for (const std::size_t label : stated.back().one)
      if (stated.back().other.count(label))
        throw InputError(key + ".against: found '" + labels[label] + "', which is in regions too");
    take(key + ".regions", stated.back().one);
    if (!stated.back().other.empty()) take(key + ".against", stated.back().other);
  }
  // What no list names comes first.
  std::size_t named = 0;
  for (const auto& body : bodies) named += body.size();
  if (named < labels.size()) {
    std::set<std::size_t> rest;
    for (std::size_t label = 0; label < labels.size(); ++label)
      if (std::none_of(bodies.begin(), bodies.end(), [&](const auto& b) { return b.count(label) > 0; })) rest.insert(label);
    bodies.insert(bodies.begin(), rest);
  }
  if (bodies.size() < 2) throw InputError(stated.front().key + ".regions: there is no other region to be in contact with");
  velocity_fields_ = int(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b)
    for (const std::size_t label : bodies[b]) field_of_label_[label] = int(b);

  // A law that names both bodies goes before one that names one.
  for (int a = 0; a < velocity_fields_; ++a)
    for (int b = a + 1; b < velocity_fields_; ++b) {
      const auto &first = bodies[std::size_t(a)], &second = bodies[std::size_t(b)];
      std::vector<const Stated*> exact, general;
      for (const Stated& s : stated) {
        if ((s.one == first && s.other == second) || (s.one == second && s.other == first)) exact.push_back(&s);
        else if (s.other.empty() && (s.one == first || s.one == second)) general.push_back(&s);
      }
      const auto& laws = exact.empty() ? general : exact;
      if (laws.size() > 1)
        throw InputError(laws[1]->key + ": '" + labels[*first.begin()] + "' and '" + labels[*second.begin()] +
                         "' meet by " + laws[0]->key + " already, expected one law for them");
      if (laws.empty())
        throw InputError(stated.front().key + ": no law states the contact of '" + labels[*first.begin()] + "' and '" +
                         labels[*second.begin()] + "', expected a [contact.NAME] for them");
      laws_.push_back({{a, b}, laws[0]->friction, std::size_t(laws[0] - stated.data()), laws[0]->one == first ? 0 : 1});
    }
}

namespace {

// Outward from the body, over the mass of a full cell; per cell side.
Vec2 mass_gradient(const GridState& g, std::size_t n, double per_mass) {
  const std::size_t nx = std::size_t(g.grid.nx), in = n % g.field_nodes(), i = in % nx, j = in / nx;
  const unsigned wall = g.walls[n];
  const auto along = [&](bool low, bool high, std::size_t step, bool behind, bool ahead) {
    if (low || high) return 0.0;  // the mirror's value
    const double before = behind ? g.node[n - step].mass : 0, after = ahead ? g.node[n + step].mass : 0;
    return 0.5 * per_mass * (before - after);
  };
  return {along(wall & wall_left, wall & wall_right, 1, i > 0, i + 1 < nx),
          along(wall & wall_down, wall & wall_up, nx, j > 0, j + 1 < std::size_t(g.field_grid.ny))};
}

// The points that a shared node sees of both bodies, and how they face each other there.
class View {
 public:
  void look(const Particles& p, const GridState& g, const std::uint32_t node[2]) {
    const std::size_t nx = std::size_t(g.grid.nx), width = std::size_t(g.width);
    const Vec2 at = g.place(node[0]);
    per_line_ = 4 / g.grid.spacing.minCoeff();
    for (std::size_t side = 0; side < 2; ++side) {
      seen_[side].clear();
      const std::size_t i = node[side] % nx, j = node[side] / nx;
      for (std::size_t b = 0; b < width && b <= j; ++b)
        for (std::size_t a = 0; a < width && a <= i; ++a) {
          const Range points = g.cells.points_in(std::int32_t(node[side] - b * nx - a));
          for (std::size_t q = points.begin; q < points.end; ++q) {
            const std::size_t k = g.cells.order[q];
            seen_[side].push_back({p.x[k] - at.x(), p.y[k] - at.y(), 0.5 * std::sqrt(p.volume0[k] * p.J[k])});
          }
        }
    }
  }
  /// Between all points, along a normal from the first to the second: what a plane across it leaves free.
  double margin(const Vec2& normal) const {
    double front = -infinite, back = infinite;
    for (const Point& a : seen_[0]) front = std::max(front, a.x * normal.x() + a.y * normal.y() + a.half);
    for (const Point& b : seen_[1]) back = std::min(back, b.x * normal.x() + b.y * normal.y() - b.half);
    return back - front;
  }
  /// Mean over the lines parallel to the normal; infinite: nothing faces anything.
  double gap(const Vec2& normal) const {
    std::array<double, lines> front, back;
    front.fill(-infinite);
    back.fill(infinite);
    for (const Point& a : seen_[0])
      across(a, normal, [&](std::size_t k, double out) { front[k] = std::max(front[k], out + a.half); });
    for (const Point& b : seen_[1])
      across(b, normal, [&](std::size_t k, double out) { back[k] = std::min(back[k], out - b.half); });
    static constexpr double weight[lines / 2] = {0.734375, 0.609375, 0.3828125, 0.1953125};  // 3/4 - t^2; (3/2 - t)^2/2
    double sum = 0, total = 0;
    for (std::size_t k = 0; k < lines; ++k) {
      if (!std::isfinite(front[k]) || !std::isfinite(back[k])) continue;
      const double w = weight[k < lines / 2 ? lines / 2 - 1 - k : k - lines / 2];
      sum += w * (back[k] - front[k]);
      total += w;
    }
    return total > 0 ? sum / total : infinite;
  }

 private:
  static constexpr std::size_t lines = 8;  // a quarter of a cell apart, the middle two an eighth beside the node
  struct Point {
    double x, y, half;  // from the node; half the side of its square
  };
  template <class Each>
  void across(const Point& p, const Vec2& normal, Each&& each) const {
    const double on = (p.y * normal.x() - p.x * normal.y()) * per_line_ + 0.5 * (lines - 1), reach = p.half * per_line_;
    const int first = std::max(0, int(std::ceil(on - reach))), last = std::min(int(lines) - 1, int(std::floor(on + reach)));
    for (int k = first; k <= last; ++k) each(std::size_t(k), p.x * normal.x() + p.y * normal.y());
  }
  std::vector<Point> seen_[2];
  double per_line_ = 0;
};

}  // namespace

void Contacts::find(const Particles& p, const GridState& g, const std::vector<double>& density, double dt, int threads) {
  nodes_.clear();
  dt_ = dt;
  std::vector<double> per_mass(std::size_t(velocity_fields_), 0.0);
  for (std::size_t label = 0; label < density.size(); ++label) {
    double& full = per_mass[std::size_t(field_of_label_[label])];
    full = std::max(full, density[label] * g.grid.spacing.prod());
  }
  for (double& m : per_mass) m = 1 / m;
  const double near = (dt > 0 ? 1.0 : touching) * g.grid.spacing.minCoeff();
  for (const Law& law : laws_) {
    const std::size_t from = law.field[0] * g.field_nodes(), apart = (law.field[1] - law.field[0]) * g.field_nodes();
    std::vector<ContactNode> found;
    for (auto n = std::lower_bound(g.active.nodes.begin(), g.active.nodes.end(), from); n != g.active.nodes.end() && *n < from + g.field_nodes(); ++n)
      if (g.node[*n].mass > 0 && g.node[*n + apart].mass > 0) {
        ContactNode m;
        m.node[0] = *n;
        m.node[1] = std::uint32_t(*n + apart);
        m.friction = law.friction;
        m.law = int(&law - laws_.data());
        found.push_back(m);
      }
    for_each(found.size(), threads, [&](std::size_t k) {
      ContactNode& m = found[k];
      static thread_local View view;
      view.look(p, g, m.node);
      const Vec2 first = mass_gradient(g, m.node[0], per_mass[std::size_t(law.field[0])]);
      const Vec2 second = -mass_gradient(g, m.node[1], per_mass[std::size_t(law.field[1])]);
      m.gap = infinite;
      double widest = -infinite;
      for (const Vec2& direction : {Vec2(first + second), first, second}) {
        if (!(direction.norm() > 0)) continue;
        const Vec2 normal = direction.normalized();
        const double margin = view.margin(normal);
        if (!(margin > widest)) continue;
        widest = margin;
        m.normal = normal;
      }
      if (!std::isfinite(widest)) return;
      // No plane between the points yet (a free edge beside the face): turned as long as it helps.
      for (double turn = 0.4; widest < -overlap * g.grid.spacing.minCoeff() && turn > 0.02; turn *= 0.5)
        for (const double by : {turn, -turn}) {
          const Vec2 normal(std::cos(by) * m.normal.x() - std::sin(by) * m.normal.y(),
                            std::sin(by) * m.normal.x() + std::cos(by) * m.normal.y());
          const double margin = view.margin(normal);
          if (!(margin > widest)) continue;
          widest = margin;
          m.normal = normal;
          break;
        }
      m.gap = view.gap(m.normal);
    });
    for (const ContactNode& m : found)
      if (m.gap < near) nodes_.push_back(m);
  }
}

void Contacts::apply(GridState& g, const Restraints& restraints, std::vector<Reaction>& reactions, std::span<Impulse> of_contacts) {
  for (ContactNode& m : nodes_) {
    m.normal_impulse = m.tangential_impulse = m.closing = 0;
    m.sticks = false;
    for (int side = 0; side < 2; ++side)
      m.mobility[side] = restraints.mobility(m.node[side]) / g.node[m.node[side]].mass;
  }
  for (int sweep = 0; sweep < (velocity_fields_ > 2 ? sweeps : 1); ++sweep)
    for (ContactNode& m : nodes_) enforce(m, g);
  for (ContactNode& m : nodes_) {
    if (!(m.normal_impulse > 0)) continue;
    const Vec2 along(-m.normal.y(), m.normal.x()), impulse = m.normal_impulse * m.normal + m.tangential_impulse * along;
    for (int side = 0; side < 2; ++side) {
      Node& node = g.node[m.node[side]];
      node.hold();
      const Vec2 given = side == 0 ? Vec2(-impulse) : impulse;
      reactions.push_back({m.node[side], given.x(), given.y(), 0, 0});
      // What a wall behind the node takes of it; it may move.
      const Vec2 taken = node.mass * (m.mobility[side] * given) - given;
      if (taken.x() != 0 || taken.y() != 0)
        reactions.push_back({m.node[side], taken.x(), taken.y(), node.nx, node.ny});
    }
    if (const Law& law = laws_[std::size_t(m.law)]; !of_contacts.empty())
      of_contacts[law.option].add(law.side == 0 ? Vec2(-impulse) : impulse, g.place(m.node[law.side]));
    m.closing = m.normal.dot(Vec2(g.node[m.node[0]].nx - g.node[m.node[1]].nx, g.node[m.node[0]].ny - g.node[m.node[1]].ny));
  }
}

void Contacts::press(std::span<const double> impulses) {
  for (std::size_t k = 0; k < nodes_.size(); ++k) nodes_[k].pressed = impulses.empty() ? 0 : impulses[k];
}

// Coulomb's law for the sums of a step's impulses, of which the skeletons bear what the water does not. (What is rough
// sticks.)
void Contacts::enforce(ContactNode& m, GridState& g) const {
  Node &a = g.node[m.node[0]], &b = g.node[m.node[1]];
  const Mat2 both = m.mobility[0] + m.mobility[1];
  const Vec2 along(-m.normal.y(), m.normal.x());
  const auto give = [&](const Vec2& impulse) {
    const Vec2 da = m.mobility[0] * impulse, db = m.mobility[1] * impulse;
    a.nx -= da.x();
    a.ny -= da.y();
    b.nx += db.x();
    b.ny += db.y();
  };
  const auto relative = [&] { return Vec2(a.nx - b.nx, a.ny - b.ny); };
  const double across = m.normal.dot(both * m.normal), beside = along.dot(both * along);
  const double free = dt_ > 0 ? std::max(0.0, m.gap) / dt_ : 0;
  if (across > 0) {
    const double impulse = std::max(0.0, m.normal_impulse + (relative().dot(m.normal) - free) / across);
    give((impulse - m.normal_impulse) * m.normal);
    m.normal_impulse = impulse;
  }
  if (beside > 0) {
    const double wanted = m.tangential_impulse + relative().dot(along) / beside;
    const double borne = m.normal_impulse > 0 ? std::max(0.0, m.normal_impulse - m.pressed) : 0;
    const double most = borne > 0 ? m.friction * borne : 0;
    m.sticks = m.normal_impulse > 0 && std::abs(wanted) <= most;
    const double impulse = std::clamp(wanted, -most, most);
    give((impulse - m.tangential_impulse) * along);
    m.tangential_impulse = impulse;
  }
}

void Contacts::apply_to_strain_velocity(GridState& g) const {
  for (const ContactNode& m : nodes_) {
    if (!(m.normal_impulse > 0)) continue;
    const GridState::StrainVelocity a = g.strain_velocity(m.node[0]), b = g.strain_velocity(m.node[1]);
    const Mat2 both = m.mobility[0] + m.mobility[1];
    const Vec2 along(-m.normal.y(), m.normal.x());
    const auto give = [&](const Vec2& direction, double left) {
      const double per = direction.dot(both * direction);
      if (!(per > 0)) return;
      const Vec2 impulse = (direction.dot(Vec2(a.x - b.x, a.y - b.y)) - left) / per * direction;
      const Vec2 da = m.mobility[0] * impulse, db = m.mobility[1] * impulse;
      a.x -= da.x();
      a.y -= da.y();
      b.x += db.x();
      b.y += db.y();
    };
    give(m.normal, m.closing);
    if (m.sticks) give(along, 0);
  }
}

}  // namespace pivnp::mpm
