// How a particle reads the nodes: the bilinear field of one element, and the point where the pair's vector applies.
// Inner loop of Tracker: no allocation, no calls into other files but for elements that have lost nodes.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "pivnp/np/errors/reading_error.hpp"
#include "pivnp/np/support.hpp"

namespace pivnp::np {

/// One component of an element's field, a + b xi + c eta + e xi eta, (xi, eta) in [0, 1] from the lower left node.
struct Bilinear {
  double a, b, c, e;
  double at(double xi, double eta) const { return (a + b * xi) + (c + e * xi) * eta; }
  double along_xi(double eta) const { return b + e * eta; }
  double along_eta(double xi) const { return c + e * xi; }
};

enum class Outcome : std::uint8_t { good, unsettled, left_grid, no_vectors, no_solution };

/// Where a particle's vector applies, and the field there.
struct Reading {
  Outcome outcome = Outcome::good;
  Support support = Support::measured;
  int i = 0, j = 0;
  double xi = 0, eta = 0;
  double dx = 0, dy = 0;                          // increment, length
  double gxx = 0, gxy = 0, gyx = 0, gyy = 0;      // its gradient
  std::array<double, 3> cov{0, 0, 0};             // its covariance
  double bx = 0, by = 0;                          // expected error of the reading: what is there less what is read
  double gradient_variance = 0;                   // of a component
};

/// What the element states of the errors: E = (rho + (1 - rho) sum w^2) C, where weights sum to 1. `squares`: sum w^2.
template <class Real>
void read_errors(const Nodes<Real>& nodes, int i, int j, double correlation, double squares, Reading& r) {
  const ElementError& e = nodes.errors[std::size_t(j) * std::size_t(nodes.grid.nx - 1) + std::size_t(i)];
  const double factor = correlation + (1 - correlation) * squares;
  r.cov = {factor * double(e.uu), factor * double(e.vv), factor * double(e.uv)};
  r.bx = double(e.u), r.by = double(e.v);
  r.gradient_variance = double(e.gradient);
}

template <class Real>
class Gather {
 public:
  Gather(const Nodes<Real>& nodes, const SupportMap& support, bool centre_gradient, double error_correlation)
      : nodes_(nodes), support_(support), ox_(nodes.grid.origin.x()), oy_(nodes.grid.origin.y()),
        ihx_(1 / nodes.grid.spacing.x()), ihy_(1 / nodes.grid.spacing.y()), nx_(nodes.grid.nx), ny_(nodes.grid.ny),
        centre_gradient_(centre_gradient), correlation_(error_correlation) {}

  bool measured(std::size_t element) const { return support_.at(element) == Support::measured; }

  /// The field at the particle's place `x`.
  Reading forward(const Vec2& x) const {
    Reading r;
    Element el;
    const double sx = (x.x() - ox_) * ihx_, sy = (x.y() - oy_) * ihy_;
    if (!inside_grid(sx, sy)) return failed(Outcome::left_grid);
    if (!open(sx, sy, el)) return failed(Outcome::no_vectors);
    read(el, sx, sy, r);
    return r;
  }

  /// The field at the mid-point xm = x + d(xm)/2 of the particle's path.
  Reading central(const Vec2& x) const {
    const double sx = (x.x() - ox_) * ihx_, sy = (x.y() - oy_) * ihy_;
    Element el;
    if (!inside_grid(sx, sy)) return failed(Outcome::left_grid);
    if (!open(sx, sy, el)) return failed(Outcome::no_vectors);
    Reading r;
    double mx = sx, my = sy;
    bool astray = false;  // the iterate has left all elements that hold a field; the last one is extrapolated
    bool settled = false;
    for (int n = 0; n < max_iterations && !settled; ++n) {
      const double left = improve(el, sx, sy, n < newton_iterations, mx, my);
      const bool here = el.contains(mx, my);
      astray = !here && !(inside_grid(mx, my) && open(mx, my, el));
      settled = left <= tolerance(sx, sy) && (here || astray);
    }
    if (astray && !settled) return failed(Outcome::no_solution);
    if (!inside_grid(mx, my)) return failed(Outcome::left_grid);
    if (astray) return failed(Outcome::no_vectors);
    read(el, mx, my, r);
    if (!settled && r.outcome == Outcome::good) r.outcome = Outcome::unsettled;
    return r;
  }

 private:
  struct Element {
    int i, j;
    Support support;
    Bilinear u, v;
    bool contains(double sx, double sy) const {
      constexpr double edge = 1e-12;
      const double xi = sx - i, eta = sy - j;
      return xi >= -edge && xi <= 1 + edge && eta >= -edge && eta <= 1 + edge;
    }
  };

  static constexpr int newton_iterations = 12;
  static constexpr int max_iterations = 50;

  static Reading failed(Outcome outcome) {
    Reading r;
    r.outcome = outcome;
    return r;
  }

  // In spacings. The position itself carries the round-off of its distance from the origin.
  static double tolerance(double sx, double sy) {
    return 1e-14 + 4 * std::numeric_limits<double>::epsilon() * (sx + sy);
  }

  bool inside_grid(double sx, double sy) const {
    constexpr double edge = 1e-9;  // as locate() in core/grid
    return sx >= -edge && sx <= nx_ - 1 + edge && sy >= -edge && sy <= ny_ - 1 + edge;
  }

  // Loads the element at a place inside the grid; false, `el` untouched, if it holds no field.
  bool open(double sx, double sy, Element& el) const {
    const int i = std::min(int(sx), nx_ - 2), j = std::min(int(sy), ny_ - 2);
    const std::size_t index = std::size_t(j) * std::size_t(nx_ - 1) + std::size_t(i);
    const Support support = support_.at(index);
    if (support == Support::none) return false;
    el.i = i;
    el.j = j;
    el.support = support;
    if (support == Support::fitted) {
      const LocalFit& fit = support_.fit(index);
      const Vec2 corner = fit.value - fit.slope * fit.centroid;
      el.u = {corner.x(), fit.slope(0, 0), fit.slope(0, 1), 0};
      el.v = {corner.y(), fit.slope(1, 0), fit.slope(1, 1), 0};
      return true;
    }
    const std::array<Real, 2>* below = nodes_.displacement + (std::size_t(j) * std::size_t(nx_) + std::size_t(i));
    const std::array<Real, 2>* above = below + nx_;
    el.u = component(below[0][0], below[1][0], above[0][0], above[1][0]);
    el.v = component(below[0][1], below[1][1], above[0][1], above[1][1]);
    return true;
  }

  static Bilinear component(Real lower_left, Real lower_right, Real upper_left, Real upper_right) {
    const double a = double(lower_left), b = double(lower_right) - a;
    return {a, b, double(upper_left) - a, (double(upper_right) - double(upper_left)) - b};
  }

  // One step towards m = s + d(m)/2 within the element's own polynomial, natural coordinates. Returns a bound of what
  // is left of the equation after it: a Newton step leaves exactly the product term of the bilinear field, a fixed
  // point step less than its own length. Newton for speed; plain fixed point, which contracts for |G| < 2, if Newton
  // has not come to rest (a kink between elements).
  double improve(const Element& el, double sx, double sy, bool newton, double& mx, double& my) const {
    const double xi = mx - el.i, eta = my - el.j;
    const double hx = 0.5 * ihx_, hy = 0.5 * ihy_;
    const double rx = sx + hx * el.u.at(xi, eta) - mx, ry = sy + hy * el.v.at(xi, eta) - my;
    const double a = 1 - hx * el.u.along_xi(eta), b = -hx * el.u.along_eta(xi);
    const double c = -hy * el.v.along_xi(eta), d = 1 - hy * el.v.along_eta(xi);
    const double det = a * d - b * c;
    if (!newton || !(det > 0.05)) {
      mx += rx;
      my += ry;
      return std::max(std::abs(rx), std::abs(ry));
    }
    const double inverse = 1 / det;
    const double px = (d * rx - b * ry) * inverse, py = (a * ry - c * rx) * inverse;
    mx += px;
    my += py;
    return std::max(std::abs(hx * el.u.e), std::abs(hy * el.v.e)) * std::abs(px * py);
  }

  void read(const Element& el, double sx, double sy, Reading& r) const {
    r.i = el.i;
    r.j = el.j;
    r.support = el.support;
    r.xi = sx - el.i;
    r.eta = sy - el.j;
    r.dx = el.u.at(r.xi, r.eta);
    r.dy = el.v.at(r.xi, r.eta);
    const double gx = centre_gradient_ ? 0.5 : r.xi, gy = centre_gradient_ ? 0.5 : r.eta;
    r.gxx = el.u.along_xi(gy) * ihx_;
    r.gxy = el.u.along_eta(gx) * ihy_;
    r.gyx = el.v.along_xi(gy) * ihx_;
    r.gyy = el.v.along_eta(gx) * ihy_;
    if (el.support == Support::fitted) {
      read_fitted(r);
    } else if (nodes_.errors != nullptr) {
      const double x0 = 1 - r.xi, y0 = 1 - r.eta;
      read_errors(nodes_, r.i, r.j, correlation_, (x0 * x0 + r.xi * r.xi) * (y0 * y0 + r.eta * r.eta), r);
    }
  }

  // E = rho (sum |w|) sum |w_i| C_i + (1 - rho) sum w_i^2 C_i. With rho = 1 no correlation of the nodes' errors can
  // make the variance of sum w_i e_i larger (Cauchy-Schwarz).
  double share(double w, double weight_sum) const {
    return correlation_ * weight_sum * std::abs(w) + (1 - correlation_) * w * w;
  }

  // The rare rest for a fit: may the particle use it, and how well is it known (misfit and nodal errors).
  [[gnu::noinline]] void read_fitted(Reading& r) const {
    const LocalFit& fit = support_.fit(std::size_t(r.j) * std::size_t(nx_ - 1) + std::size_t(r.i));
    if (!fit.reaches(r.xi, r.eta)) {
      r.outcome = Outcome::no_vectors;
      return;
    }
    if (nodes_.cov == nullptr) return;
    double weight_sum = 0;
    for (int k = 0; k < 16; ++k) weight_sum += std::abs(fit.influence(k, r.xi, r.eta));
    r.cov = fit.misfit;
    for (int k = 0; k < 16; ++k) {
      if ((fit.nodes >> k & 1) == 0) continue;
      const std::size_t at = nodes_.grid.node(r.i - 1 + k % 4, r.j - 1 + k / 4);
      const auto& c = nodes_.cov[at];
      const double along = nodes_.path_factor != nullptr ? double(nodes_.path_factor[at]) : 1;
      const double w = along * share(fit.influence(k, r.xi, r.eta), weight_sum);
      for (std::size_t n = 0; n < 3; ++n) r.cov[n] += w * double(c[n]);
    }
    // Of an affine fit over some three cells.
    const double h = nodes_.grid.spacing.minCoeff();
    r.gradient_variance = (r.cov[0] + r.cov[1]) / (2 * h * h);
  }

  Nodes<Real> nodes_;
  const SupportMap& support_;
  double ox_, oy_, ihx_, ihy_;
  int nx_, ny_;
  bool centre_gradient_;
  double correlation_;
};

}  // namespace pivnp::np
