#include "mpm/transfer/reference.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "mpm/grid/sweeps.hpp"
#include "mpm/transfer/finite_strain.hpp"

namespace pivnp::mpm::reference {

namespace {

// A point and one node of its cell: the node's weight N, its gradient, and where the node is from the point.
struct AtNode {
  std::size_t node;
  double weight;
  Vec2 gradient, arm;
  Vec2 affine;  // APIC: N D^-1 arm; where the functions are linear, the gradient
};

// APIC's share of an axis' node: w arm / (sum w arm^2), or the derivative where functions are linear.
template <class S>
double affine_share(const Line<double, S::width>& line, const double* arm, int a, [[maybe_unused]] bool beside_wall, double per_h) {
  if constexpr (S::centred)
    if (!beside_wall) return line.w[a] * arm[a] * S::per_moment(line, arm) * per_h;
  return line.g[a] * per_h;
}

// Calls each(point, nodes of its cell).
template <class Each>
void for_point_nodes(const Particles& p, const GridState& g, Each&& each) {
  Shapes::with(g.shape, [&](auto kind) {
    using S = decltype(kind);
    constexpr int W = S::width;
    for (std::size_t s = 0; s < g.cells.size(); ++s)
      for_points<S>(p, g, {s, s + 1}, [&](std::size_t k, const std::size_t* at, const auto& x, const auto& y) {
        const Vec2 place = g.natural(p, k);
        const MovedNodes by = g.moved_in(g.cells.index[s]) ? *g.moved_in(g.cells.index[s]) : MovedNodes{};
        const bool beside_x = g.marks[s] & (wall_left | wall_right) || by.low[0] != 0 || by.high[0] != 0;
        const bool beside_y = g.marks[s] & (wall_down | wall_up) || by.low[1] != 0 || by.high[1] != 0;
        double ax[W], ay[W];
        for (int a = 0; a < W; ++a) {
          ax[a] = a + S::first - place.x();
          ay[a] = a + S::first - place.y();
        }
        if constexpr (S::centred) {
          ax[g.marks[s] & wall_left ? 1 : 0] += by.low[0];
          ax[g.marks[s] & wall_right ? 1 : 2] -= by.high[0];
          ay[g.marks[s] & wall_down ? 1 : 0] += by.low[1];
          ay[g.marks[s] & wall_up ? 1 : 2] -= by.high[1];
        }
        std::array<AtNode, std::size_t(W * W)> nodes;
        for (int n = 0; n < W * W; ++n) {
          const int a = n % W, b = n / W;
          nodes[std::size_t(n)] = {at[n],
                                   x.w[a] * y.w[b],
                                   {x.g[a] * y.w[b] * g.per_hx, x.w[a] * y.g[b] * g.per_hy},
                                   {ax[a] / g.per_hx, ay[b] / g.per_hy},
                                   {affine_share<S>(x, ax, a, beside_x, g.per_hx) * y.w[b],
                                    x.w[a] * affine_share<S>(y, ay, b, beside_y, g.per_hy)}};
        }
        each(k, nodes);
      });
  });
}

// Of the node's mass, that which comes from the point; zero at a node that no point weighs on.
double share_of_mass(const Particles& p, const GridState& g, std::size_t k, const AtNode& i) {
  const double mass = g.node[i.node].mass;
  return mass > 0 ? p.mass_of(k) * i.weight / mass : 0;
}

// The gradient of a function of the four nodes at an element's centre, node by node.
std::array<Vec2, 4> centre_gradient(const GridState& g) {
  const double x = 0.5 * g.per_hx, y = 0.5 * g.per_hy;
  return {Vec2(-x, -y), Vec2(x, -y), Vec2(-x, y), Vec2(x, y)};
}

Mat2 stress_of(const Particles& p, std::size_t k) {
  return (Mat2() << p.tau_xx[k], p.tau_xy[k], p.tau_xy[k], p.tau_yy[k]).finished();
}
double mean_stress_of(const Particles& p, std::size_t k) { return (p.tau_xx[k] + p.tau_yy[k] + p.tau_zz[k]) / 3; }

// A point that stands apart from the others takes no part in F-bar's averages and keeps its own value.
bool is_apart(const Particles& p, std::size_t k) {
  const double* opening = p.view().opening;
  return opening && opening[k] > 0;
}

// The mean over each element, weights V0.
std::vector<double> average_over_elements(const Particles& p, const GridState& g, const std::vector<double>& of_point) {
  std::vector<double> out = of_point;
  for (std::size_t s = 0; s < g.cells.size(); ++s) {
    std::vector<std::size_t> joined;
    double sum = 0, volume = 0;
    for (std::size_t q = g.cells.begin[s]; q < g.cells.begin[s + 1]; ++q)
      if (const std::size_t k = g.cells.order[q]; !is_apart(p, k)) joined.push_back(k);
    for (const std::size_t k : joined) {
      sum += p.volume0[k] * of_point[k];
      volume += p.volume0[k];
    }
    for (const std::size_t k : joined) out[k] = sum / volume;
  }
  return out;
}

// averages.hpp, cell by cell: cells and their lower left corners go by the cells' indices.
class CornerAverage {
 public:
  CornerAverage(const Particles& p, const GridState& g)
      : p_(p), g_(g), up_(g.grid.nx), volume_(room()), shift_x_(room()), shift_y_(room()), shares_(room()) {
    std::vector<Edges> edges(room());
    for_joined([&](std::size_t k, std::ptrdiff_t cell, double s, double t) {
      const double v = p_.volume0[k];
      for (int n = 0; n < 4; ++n) at(volume_, corner(cell, n)) += v * hat(s, t, n);
      Edges& e = at(edges, cell);
      e.low += v * s * (1 - s) * (1 - t);
      e.high += v * s * (1 - s) * t;
      e.left += v * t * (1 - t) * (1 - s);
      e.right += v * t * (1 - t) * s;
    });
    std::vector<double> along_x(room()), along_y(room());  // of the edges to the right of a corner and up from it
    for_corners([&](std::ptrdiff_t n) {
      at(along_x, n) = at(edges, n).low + at(edges, n - up_).high;
      at(along_y, n) = at(edges, n).left + at(edges, n - 1).right;
    });
    for_corners([&](std::ptrdiff_t n) {
      if (!(at(volume_, n) > 0)) return;
      at(shift_x_, n) = (at(along_x, n - 1) - at(along_x, n)) / at(volume_, n);
      at(shift_y_, n) = (at(along_y, n - up_) - at(along_y, n)) / at(volume_, n);
    });
    const auto share = [](double edge, double across, double other) {
      return across + other > 0 ? edge * across / (across + other) : 0;
    };
    for_corners([&](std::ptrdiff_t n) {
      const double low = at(along_x, n), high = at(along_x, n + up_), left = at(along_y, n), right = at(along_y, n + 1);
      at(shares_, n) = {share(low, high, at(along_x, n - up_)), share(high, low, at(along_x, n + 2 * up_)),
                        share(left, right, at(along_y, n - 1)), share(right, left, at(along_y, n + 2))};
    });
  }

  std::vector<double> of(Averaging which, const std::vector<double>& of_point) const {
    std::vector<double> sum(room()), mean(room());
    for_joined([&](std::size_t k, std::ptrdiff_t cell, double s, double t) {
      for (int n = 0; n < 4; ++n) at(sum, corner(cell, n)) += p_.volume0[k] * hat(s, t, n) * of_point[k];
    });
    for_corners([&](std::ptrdiff_t n) {
      if (at(volume_, n) > 0) at(mean, n) = at(sum, n) / at(volume_, n);
    });
    std::vector<double> moved = sum;
    for_corners([&](std::ptrdiff_t n) {  // + F S^-1 F^T of the means
      const Edges& e = at(shares_, n);
      const double m[] = {at(mean, n), at(mean, n + 1), at(mean, n + up_), at(mean, n + up_ + 1)};
      const Vec2 slope(e.low * (m[1] - m[0]) + e.high * (m[3] - m[2]), e.left * (m[2] - m[0]) + e.right * (m[3] - m[1]));
      const Mat2 inverse = spread(n).inverse();
      const Vec2 flux = (which == Averaging::of_stress ? inverse : Mat2(inverse.transpose())) * slope;
      const double given[] = {-e.low * flux.x() - e.left * flux.y(), e.low * flux.x() - e.right * flux.y(),
                              -e.high * flux.x() + e.left * flux.y(), e.high * flux.x() + e.right * flux.y()};
      for (int c = 0; c < 4; ++c) at(moved, corner(n, c)) += given[c];
    });
    std::vector<double> out = of_point;
    for_joined([&](std::size_t k, std::ptrdiff_t cell, double s, double t) {
      out[k] = 0;
      for (int n = 0; n < 4; ++n)
        if (const std::ptrdiff_t c = corner(cell, n); at(volume_, c) > 0) out[k] += hat(s, t, n) * at(moved, c) / at(volume_, c);
    });
    return out;
  }

 private:
  struct Edges {
    double low = 0, high = 0, left = 0, right = 0;
  };
  static constexpr std::ptrdiff_t margin_rows = 3;

  // Room for what lies beside the grid too.
  std::size_t room() const { return g_.grid.node_count() + std::size_t(2 * margin_rows * up_); }
  template <class T>
  T& at(std::vector<T>& field, std::ptrdiff_t n) const {
    return field[std::size_t(n + margin_rows * up_)];
  }
  template <class T>
  const T& at(const std::vector<T>& field, std::ptrdiff_t n) const {
    return field[std::size_t(n + margin_rows * up_)];
  }
  std::ptrdiff_t corner(std::ptrdiff_t cell, int n) const { return cell + n / 2 * up_ + n % 2; }
  static double hat(double s, double t, int n) { return (n % 2 ? s : 1 - s) * (n / 2 ? t : 1 - t); }
  // Each point that material connects, with its place in its cell, from the lower left corner.
  template <class Each>
  void for_joined(Each&& each) const {
    for (std::size_t k = 0; k < p_.size(); ++k) {
      if (p_.cell[k] == Particles::ended || is_apart(p_, k)) continue;
      const Vec2 place = g_.natural(p_, k);
      each(k, std::ptrdiff_t(p_.cell[k]), 0.5 + place.x(), 0.5 + place.y());
    }
  }
  template <class Each>
  void for_corners(Each&& each) const {
    for (std::ptrdiff_t n = 0; n < std::ptrdiff_t(g_.grid.node_count()); ++n) each(n);
  }
  // S = F^T c, c the centres of the corners' points; its least eigenvalue raised where they are few.
  Mat2 spread(std::ptrdiff_t n) const {
    const Edges& e = at(shares_, n);
    const auto difference = [&](const std::vector<double>& shift, std::ptrdiff_t from, std::ptrdiff_t to) {
      return at(shift, n + to) - at(shift, n + from);
    };
    const bool no_x = !(e.low + e.high > 0), no_y = !(e.left + e.right > 0);
    const double x = no_x ? 1 : e.low + e.high, y = no_y ? 1 : e.left + e.right;
    Mat2 S;
    S(0, 0) = no_x ? 1 : x - e.low * difference(shift_x_, 0, 1) - e.high * difference(shift_x_, up_, up_ + 1);
    S(1, 1) = no_y ? 1 : y - e.left * difference(shift_y_, 0, up_) - e.right * difference(shift_y_, 1, up_ + 1);
    S(0, 1) = no_y ? 0 : -e.low * difference(shift_y_, 0, 1) - e.high * difference(shift_y_, up_, up_ + 1);
    S(1, 0) = no_x ? 0 : -e.left * difference(shift_x_, 0, up_) - e.right * difference(shift_x_, 1, up_ + 1);
    const double mean = 0.5 * (S(0, 0) * y + S(1, 1) * x), half = 0.5 * (S(0, 0) * y - S(1, 1) * x), off = 0.5 * (S(0, 1) + S(1, 0));
    const double least = mean - std::sqrt(half * half + off * off * x * y), lack = std::max(0.0, 0.05 * x * y - least) / (x * y);
    S(0, 0) += lack * x;
    S(1, 1) += lack * y;
    return S;
  }

  const Particles& p_;
  const GridState& g_;
  std::ptrdiff_t up_;
  std::vector<double> volume_, shift_x_, shift_y_;
  std::vector<Edges> shares_;
};

}  // namespace

std::vector<double> average(const Particles& p, const GridState& g, Averaging which, const std::vector<double>& of_point) {
  return g.centred ? CornerAverage(p, g).of(which, of_point) : average_over_elements(p, g, of_point);
}

std::vector<NodeSums> map_points(const Particles& p, const GridState& g, const Scheme& scheme) {
  std::vector<NodeSums> sums(g.grid.node_count());
  std::vector<double> mean(p.size(), 0.0);
  for (std::size_t k = 0; k < p.size(); ++k) mean[k] = mean_stress_of(p, k);
  std::vector<double> averaged = mean;
  if (scheme.locking == Locking::fbar) averaged = average(p, g, Averaging::of_stress, mean);
  const auto centre = g.centred ? std::array<Vec2, 4>{} : centre_gradient(g);
  for_point_nodes(p, g, [&](std::size_t k, const auto& nodes) {
    const Mat2 stress = stress_of(p, k), I = Mat2::Identity();
    // What acts by the gradient at the point, and what by that at the element's centre.
    Mat2 own = stress + (averaged[k] - mean[k]) * I, shared = Mat2::Zero();
    if (scheme.locking == Locking::selective) own = stress - mean[k] * I, shared = mean[k] * I;
    if (scheme.locking == Locking::full) own = Mat2::Zero(), shared = stress;
    const Vec2 v(p.vx[k], p.vy[k]);
    Mat2 C = Mat2::Zero();
    if (scheme.affine()) C << p.C_xx[k], p.C_xy[k], p.C_yx[k], p.C_yy[k];
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const AtNode& i = nodes[n];
      NodeSums& to = sums[i.node];
      const double m = p.mass_of(k) * i.weight;
      to.mass += m;
      to.momentum += m * (v + C * i.arm);
      to.force -= p.volume0[k] * (own * i.gradient);
      if (!g.centred) to.force -= p.volume0[k] * (shared * centre[n]);
      if (g.axisymmetric) to.force.x() -= p.volume0[k] * (p.tau_zz[k] + averaged[k] - mean[k]) * i.weight / p.x[k];
    }
  });
  return sums;
}

std::vector<MovedPoint> move_points(const Particles& p, const GridState& g, const Scheme& scheme, double dt) {
  std::vector<MovedPoint> moved(p.size());
  const double pic = scheme.pic_per_s > 0 ? 1 - std::exp(-scheme.pic_per_s * dt) : 0;
  std::vector<Vec2> filtered;
  if (scheme.transfer == TransferKind::xpic) filtered = filtered_velocity(p, g, scheme.xpic_order);
  for_point_nodes(p, g, [&](std::size_t k, const auto& nodes) {
    Vec2 mapped(0, 0), updated(0, 0), smooth(0, 0);
    MovedPoint& to = moved[k];
    for (const AtNode& i : nodes) {
      const Node& node = g.node[i.node];
      const Vec2 n(node.nx, node.ny);
      mapped += i.weight * Vec2(node.vx, node.vy);
      updated += i.weight * n;
      if (!filtered.empty()) smooth += i.weight * filtered[i.node];
      if (scheme.affine()) to.affine += n * i.affine.transpose();
    }
    to.place = Vec2(p.x[k], p.y[k]) + dt * updated;
    const Vec2 flip = Vec2(p.vx[k], p.vy[k]) + (updated - mapped);
    switch (scheme.transfer) {
      case TransferKind::flip:
      case TransferKind::aflip: to.velocity = flip + pic * (updated - flip); break;
      case TransferKind::apic: to.velocity = updated; break;
      case TransferKind::xpic: to.velocity = smooth + (updated - mapped); break;
    }
  });
  return moved;
}

std::vector<Vec2> map_again(const Particles& p, const GridState& g, const std::vector<MovedPoint>& moved) {
  std::vector<Vec2> velocity(g.grid.node_count(), Vec2::Zero());
  for_point_nodes(p, g, [&](std::size_t k, const auto& nodes) {
    for (const AtNode& i : nodes)
      velocity[i.node] += share_of_mass(p, g, k, i) * (moved[k].velocity + moved[k].affine * i.arm);
  });
  return velocity;
}

std::vector<Vec2> filtered_velocity(const Particles& p, const GridState& g, int order) {
  std::vector<Vec2> rest(g.grid.node_count(), Vec2::Zero());
  for (const std::uint32_t n : g.active.nodes) rest[n] = {g.node[n].vx, g.node[n].vy};
  std::vector<Vec2> sum = rest;
  for (int l = 1; l < order; ++l) {
    std::vector<Vec2> projected(rest.size(), Vec2::Zero());
    for_point_nodes(p, g, [&](std::size_t k, const auto& nodes) {
      Vec2 v(0, 0);
      for (const AtNode& i : nodes) v += i.weight * rest[i.node];
      for (const AtNode& i : nodes) projected[i.node] += share_of_mass(p, g, k, i) * v;
    });
    for (std::size_t n = 0; n < rest.size(); ++n) {
      rest[n] -= projected[n];
      sum[n] += rest[n];
    }
  }
  return sum;
}

std::vector<StrainIncrement> strain_points(const Particles& p, const GridState& g, const Scheme& scheme, double dt) {
  const auto gradient = [](const Mat2& L) { return Gradient{L(0, 0), L(0, 1), L(1, 0), L(1, 1)}; };
  std::vector<Mat2> own(p.size(), Mat2::Zero()), centred(p.size(), Mat2::Zero());
  std::vector<double> hoop(p.size(), 0.0);  // log
  const auto centre = g.centred ? std::array<Vec2, 4>{} : centre_gradient(g);
  for_point_nodes(p, g, [&](std::size_t k, const auto& nodes) {
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const Vec2 u = g.strain_velocity(nodes[n].node);
      own[k] += dt * u * nodes[n].gradient.transpose();
      if (!g.centred) centred[k] += dt * u * centre[n].transpose();
      if (g.axisymmetric) hoop[k] += dt * nodes[n].weight * u.x() / p.x[k];
    }
    hoop[k] = std::log1p(hoop[k]);
  });
  std::vector<double> theta(p.size(), 0.0);  // that takes the place of the points' own volumetric increment
  for (std::size_t k = 0; k < p.size(); ++k) theta[k] = log_det(gradient(own[k])) + hoop[k];
  if (scheme.locking == Locking::fbar) theta = average(p, g, Averaging::of_strain, theta);
  std::vector<StrainIncrement> out(p.size());
  for (std::size_t k = 0; k < p.size(); ++k) {
    if (p.cell[k] == Particles::ended) continue;
    const Polar e = polar(gradient(scheme.locking == Locking::full ? centred[k] : own[k]));
    double shift = 0;
    if (scheme.locking == Locking::selective) shift = (log_det(gradient(centred[k])) - (e.xx + e.yy)) / 3;
    if (scheme.locking == Locking::fbar && !is_apart(p, k)) shift = (theta[k] - (e.xx + e.yy + hoop[k])) / 3;
    out[k] = {e.xx + shift, e.yy + shift, hoop[k] + shift, e.xy, e.spin};
  }
  return out;
}

}  // namespace pivnp::mpm::reference
