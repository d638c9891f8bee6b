// One pair's nodal field in a shape of higher order, and how a particle reads it.
#pragma once

#include <type_traits>
#include <vector>

#include "pivnp/np/basis.hpp"
#include "pivnp/np/gather.hpp"
#include "pivnp/np/spline_filter.hpp"

namespace pivnp::np {

/// A particle whose stencil (the nodes of its element of 9 or 16; the 4 x 4 nodes around it, for splines) is complete
/// reads the field of higher order. Where a node of the stencil is not usable it reads as Gather does: bilinear in a
/// cell whose own four are, else by the local fit.
template <class Basis, class Real>
class TensorGather {
 public:
  TensorGather(const Nodes<Real>& nodes, const SupportMap& support, bool centre_gradient, double error_correlation)
      : plain_(nodes, support, centre_gradient, error_correlation), nodes_(nodes), support_(support),
        ihx_(1 / nodes.grid.spacing.x()), ihy_(1 / nodes.grid.spacing.y()), nx_(nodes.grid.nx), ny_(nodes.grid.ny),
        wide_(nx_ + 2 * Basis::ghosts), centre_gradient_(centre_gradient), correlation_(error_correlation) {
    if (nx_ < Basis::least_nodes || ny_ < Basis::least_nodes) return;  // too small a grid: bilinear everywhere
    const std::size_t count = nodes.grid.node_count();
    coefficients_.resize(count);
    for (std::size_t n = 0; n < count; ++n)
      coefficients_[n] = {double(nodes.displacement[n][0]), double(nodes.displacement[n][1])};
    if constexpr (Basis::ghosts > 0) {
      fill_gaps(nodes.grid, support, coefficients_);
      coefficients_ = interpolate(Basis::count - 1, nx_, ny_, coefficients_);
    }
    find_complete_stencils();
  }

  Reading forward(const Vec2& x) const {
    const double sx = (x.x() - nodes_.grid.origin.x()) * ihx_, sy = (x.y() - nodes_.grid.origin.y()) * ihy_;
    return covered(sx, sy) ? read(sx, sy) : plain_.forward(x);
  }

  Reading central(const Vec2& x) const {
    const double sx = (x.x() - nodes_.grid.origin.x()) * ihx_, sy = (x.y() - nodes_.grid.origin.y()) * ihy_;
    const double enough = 1e-14 + 4 * std::numeric_limits<double>::epsilon() * (std::abs(sx) + std::abs(sy));
    double mx = sx, my = sy;
    for (int n = 0; n < 50; ++n) {
      if (!covered(mx, my)) return plain_.central(x);
      Reading r = read(mx, my);
      const double rx = sx + 0.5 * r.dx * ihx_ - mx, ry = sy + 0.5 * r.dy * ihy_ - my;
      if (std::max(std::abs(rx), std::abs(ry)) <= enough) return r;
      // Newton with the gradient at the place; plain fixed point, which contracts for |G| < 2, if that has not settled.
      const double hx = 0.5 * ihx_, hy = 0.5 * ihy_;
      Reading g = r;
      if (centre_gradient_) slopes(mx, my, g);
      const double a = 1 - hx * g.gxx / ihx_, b = -hx * g.gxy / ihy_;
      const double c = -hy * g.gyx / ihx_, d = 1 - hy * g.gyy / ihy_;
      const double det = a * d - b * c;
      const bool newton = n < 12 && det > 0.05;
      const double px = newton ? (d * rx - b * ry) / det : rx, py = newton ? (a * ry - c * rx) / det : ry;
      if (newton && std::max(std::abs(px), std::abs(py)) <= last_step) {
        r.dx += (g.gxx * px / ihx_ + g.gxy * py / ihy_), r.dy += (g.gyx * px / ihx_ + g.gyy * py / ihy_);
        return r;
      }
      mx += px;
      my += py;
    }
    return plain_.central(x);
  }

  /// Whether the grid is large enough for the shape at all; its coefficients; whether a cell's stencil is all valid.
  bool smooth() const { return !complete_.empty(); }
  const std::vector<std::array<double, 2>>& coefficients() const { return coefficients_; }
  bool measured(std::size_t element) const { return complete_[element] == 0; }

 private:
  using Weights = typename Basis::Weights;
  // Spacings. The step that remains is taken along the gradient: what that leaves is of the order of its square.
  static constexpr double last_step = 1e-7;

  bool covered(double sx, double sy) const {
    if (complete_.empty() || !(sx >= 0 && sy >= 0 && sx <= nx_ - 1 && sy <= ny_ - 1)) return false;
    return complete_[cell(sx, sy)] < 2;
  }
  std::size_t cell(double sx, double sy) const {
    return nodes_.grid.element(std::min(int(sx), nx_ - 2), std::min(int(sy), ny_ - 2));
  }

  // The worst class of the stencil's nodes, a cell: 0 valid, 1 replaced among them, 2 incomplete.
  void find_complete_stencils() {
    complete_.resize(nodes_.grid.element_count());
    for (int j = 0; j + 1 < ny_; ++j)
      for (int i = 0; i + 1 < nx_; ++i) {
        int i0 = i - 1, j0 = j - 1, i1 = i + 2, j1 = j + 2;
        if constexpr (Basis::ghosts == 0) {
          i0 = Basis::first(i, nx_), j0 = Basis::first(j, ny_);
          i1 = i0 + Basis::count - 1, j1 = j0 + Basis::count - 1;
        }
        std::uint8_t worst = 0;
        for (int b = std::max(j0, 0); b <= std::min(j1, ny_ - 1); ++b)
          for (int a = std::max(i0, 0); a <= std::min(i1, nx_ - 1); ++a)
            worst = std::max(worst, support_.node_class(nodes_.grid.node(a, b)));
        complete_[nodes_.grid.element(i, j)] = worst;
      }
  }

  void sum(const Weights& wx, const Weights& wy, int fx, int fy, double& u, double& v) const {
    u = v = 0;
    const std::array<double, 2>* row =
        coefficients_.data() + std::ptrdiff_t(fy + Basis::ghosts) * wide_ + fx + Basis::ghosts;
    for (std::size_t b = 0; b < wy.size(); ++b, row += wide_) {
      double ru = 0, rv = 0;
      for (std::size_t a = 0; a < wx.size(); ++a) ru += wx[a] * row[a][0], rv += wx[a] * row[a][1];
      u += wy[b] * ru;
      v += wy[b] * rv;
    }
  }

  void slopes(double sx, double sy, Reading& r) const {
    Weights wx, wy, dx, dy;
    const int fx = Basis::weigh(sx, nx_, wx, dx), fy = Basis::weigh(sy, ny_, wy, dy);
    sum(dx, wy, fx, fy, r.gxx, r.gyx);
    sum(wx, dy, fx, fy, r.gxy, r.gyy);
    r.gxx *= ihx_, r.gyx *= ihx_, r.gxy *= ihy_, r.gyy *= ihy_;
  }

  Reading read(double sx, double sy) const {
    Reading r;
    Weights wx, wy, dx, dy;
    const int fx = Basis::weigh(sx, nx_, wx, dx), fy = Basis::weigh(sy, ny_, wy, dy);
    sum(wx, wy, fx, fy, r.dx, r.dy);
    if (centre_gradient_) {
      slopes(Basis::centre(sx, nx_), Basis::centre(sy, ny_), r);
    } else {
      sum(dx, wy, fx, fy, r.gxx, r.gyx);
      sum(wx, dy, fx, fy, r.gxy, r.gyy);
      r.gxx *= ihx_, r.gyx *= ihx_, r.gxy *= ihy_, r.gyy *= ihy_;
    }
    r.support = complete_[cell(sx, sy)] == 0 ? Support::measured : Support::replaced;
    if (nodes_.errors != nullptr) covariance(sx, sy, wx, wy, r);
    return r;
  }

  // Errors that neighbours share are read as they are, since the weights sum to 1; independent ones are averaged. (By
  // Cauchy and Schwarz only (sum |w|)^2 C holds whatever the correlation, but for errors whose sign alternates from node
  // to node, as no overlapping windows make them.)
  void covariance(double sx, double sy, const Weights& wx, const Weights& wy, Reading& r) const {
    WeightSums x, y;
    if constexpr (Basis::ghosts > 0) {
      if (correlation_ < 1) {
        x = cardinal_sums(Basis::count - 1, wx.data());
        y = cardinal_sums(Basis::count - 1, wy.data());
      }
    } else {
      for (const double w : wx) x.square += w * w;
      for (const double w : wy) y.square += w * w;
    }
    read_errors(nodes_, std::min(int(sx), nx_ - 2), std::min(int(sy), ny_ - 2), correlation_, x.square * y.square, r);
  }

  Gather<Real> plain_;
  Nodes<Real> nodes_;
  const SupportMap& support_;
  double ihx_, ihy_;
  int nx_, ny_, wide_;
  bool centre_gradient_;
  double correlation_;
  std::vector<std::array<double, 2>> coefficients_;  // [ny + 2 ghosts][nx + 2 ghosts], length
  std::vector<std::uint8_t> complete_;               // per cell; empty: the grid is too small
};

}  // namespace pivnp::np
