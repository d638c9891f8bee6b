#include "mpm/heat/zone_width.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mpm/water/pore_elements.hpp"

namespace pivnp::mpm {

namespace {

constexpr double cells = 4;       // l
constexpr double least_width = 0.5;  // cells

// The weights exp(-r^2/l^2) between nodes with what the hats at both ends spread (a third of a cell's square) taken off, of sum 1.
std::vector<double> taps_of(double variance) {
  const auto far = std::ptrdiff_t(std::ceil(4.5 * std::sqrt(variance)));
  std::vector<double> f;
  double sum = 0;
  for (std::ptrdiff_t t = 0; t <= far; ++t) {
    f.push_back(std::exp(-0.5 * double(t * t) / variance));
    sum += (t > 0 ? 2 : 1) * f.back();
  }
  for (double& tap : f) tap /= sum;
  return f;
}

// sum f[t] (in(i + t) + sign in(i - t)); beyond the line nothing, or what is so many periods away: in(place, periods).
template <class In>
double filtered(const std::vector<double>& f, double sign, std::ptrdiff_t i, std::ptrdiff_t n, std::ptrdiff_t period, In&& in) {
  double sum = sign > 0 ? f[0] * in(i, 0) : 0;
  for (std::ptrdiff_t t = 1; t < std::ptrdiff_t(f.size()); ++t)
    for (const int side : {1, -1}) {
      std::ptrdiff_t at = i + side * t, away = 0;
      if (period > 0) away = at >= 0 ? at / period : -((period - 1 - at) / period), at -= away * period;
      else if (at < 0 || at >= n) continue;
      sum += (side > 0 ? 1 : sign) * f[std::size_t(t)] * in(at, away);
    }
  return sum;
}

}  // namespace

ZoneWidth::ZoneWidth(const GridState& g, const TiedSides& ties) : ties_(&ties), length_(cells * std::sqrt(g.grid.spacing.prod())) {
  for (const auto& [of, per_h] : {std::pair{of_x_, g.per_hx}, {of_y_, g.per_hy}}) {
    of[0] = taps_of(0.5 * length_ * length_ * per_h * per_h - 1.0 / 3);
    for (int power : {1, 2}) {
      of[power] = of[0];
      for (std::size_t t = 0; t < of[0].size(); ++t) of[power][t] *= std::pow(double(t) / per_h, power);
    }
  }
}

void ZoneWidth::look(Particles& p, const GridState& g, const std::vector<double>& shear, const std::vector<double>& sense, double time) {
  const auto row = std::ptrdiff_t(g.grid.nx);
  struct Sheared {
    std::uint32_t k;
    std::ptrdiff_t i, j;
    double s, t;
  };
  std::vector<Sheared> points;
  std::ptrdiff_t left = row, right = -1, low = std::ptrdiff_t(g.grid.ny), high = -1;
  for (const std::uint32_t k : g.cells.order) {
    if (!(shear[k] > 0)) continue;
    const InElement in = element_of(p, g, k);
    const std::ptrdiff_t i = std::ptrdiff_t(in.node) % row, j = std::ptrdiff_t(in.node) / row;
    points.push_back({k, i, j, in.s, in.t});
    left = std::min(left, i), right = std::max(right, i + 1), low = std::min(low, j), high = std::max(high, j + 1);
  }
  if (points.empty()) return;
  period_x_ = period_y_ = shift_x_ = shift_y_ = 0;
  for (const TiedSides::Tie& tie : ties_->ties()) {
    if (time >= tie.until) continue;
    const bool in_order = tie.along_y ? tie.node[0] % row < tie.node[1] % row : tie.node[0] < tie.node[1];
    const std::ptrdiff_t a = tie.node[in_order ? 0 : 1], b = tie.node[in_order ? 1 : 0];
    if (tie.along_y) left = std::min(a % row, left), right = std::max(b % row, right), period_x_ = b % row - a % row, shift_y_ = b / row - a / row;
    else low = std::min(a / row, low), high = std::max(b / row, high), period_y_ = b / row - a / row, shift_x_ = b % row - a % row;
  }
  if (period_x_ > 0) low -= std::abs(shift_y_), high += std::abs(shift_y_);  // what a column sees through the opposite side
  if (period_y_ > 0) left -= std::abs(shift_x_), right += std::abs(shift_x_);
  box_ = {left, low, right - left + 1, high - low + 1};
  const auto at = [&](std::ptrdiff_t i, std::ptrdiff_t j) {
    if (period_x_ > 0) j -= i / period_x_ * shift_y_, i %= period_x_;
    if (period_y_ > 0) i -= j / period_y_ * shift_x_, j %= period_y_;
    return std::size_t(j * box_.nx + i);
  };
  const auto size = std::size_t(box_.nx * box_.ny);
  Moments all, turning[2];  // those that turn to the right, and to the left
  for (Moments* of : {&all, &turning[0], &turning[1]}) of->sum.assign(size, 0.0), of->square.assign(size, 0.0);
  const double per_cell = g.per_hx * g.per_hy;
  const auto for_hats = [&](const Sheared& of, auto&& each) {
    for (int b = 0; b < 2; ++b)
      for (int a = 0; a < 2; ++a) each(at(of.i - box_.i + a, of.j - box_.j + b), (a ? of.s : 1 - of.s) * (b ? of.t : 1 - of.t), a, b);
  };
  for (const Sheared& of : points) {
    const double v = per_cell * p.volume0[of.k] * p.J[of.k], gamma = shear[of.k];
    Moments& same = turning[sense[of.k] > 0];
    all.any = true;
    same.any = same.any || sense[of.k] != 0;
    for_hats(of, [&](std::size_t n, double w, int, int) {
      const double first = w * v * gamma, second = first * gamma, share = std::abs(sense[of.k]);
      all.sum[n] += first;
      all.square[n] += second;
      same.sum[n] += share * first;
      same.square[n] += share * second;
    });
  }
  const bool both = turning[0].any && turning[1].any;
  filter_moments(all);
  if (both)
    for (Moments& of : turning) filter_moments(of);
  const double l2 = length_ * length_, hx = g.grid.spacing.x(), hy = g.grid.spacing.y();
  for (const Sheared& of : points) {
    double m[5] = {};
    const auto add = [&](const Moments& from, double share) {
      const auto& moment = from.moment;
      for_hats(of, [&](std::size_t n, double hat, int a, int b) {
        const double x = (a - of.s) * hx, y = (b - of.t) * hy, w = share * hat;  // from the point to the node
        m[0] += w * moment[0][n];
        m[1] += w * (moment[1][n] + x * moment[0][n]);
        m[2] += w * (moment[2][n] + y * moment[0][n]);
        m[3] += w * (moment[3][n] + 2 * (x * moment[1][n] + y * moment[2][n]) + (x * x + y * y) * moment[0][n]);
        m[4] += w * moment[4][n];
      });
    };
    add(all, 1);
    if (both && sense[of.k] != 0) add(turning[sense[of.k] < 0], -std::abs(sense[of.k]));
    if (!(m[0] > 0 && m[4] > 0)) continue;
    const double c2 = (m[1] * m[1] + m[2] * m[2]) / (m[0] * m[0]);
    const double across2 = std::max(0.0, m[3] / m[0] - c2 - 0.5 * l2);
    // (The weights per area are the taps over l sqrt(pi) along the zone: so the quotient is a length.)
    const double width = std::sqrt(std::numbers::pi) * length_ * m[0] * m[0] / m[4] * std::exp(std::min(1.0, c2 / l2)) * (1 + std::min(1.0, across2 / l2));
    p.band_width[of.k] = std::max(width, least_width * std::sqrt(hx * hy));
  }
}

void ZoneWidth::filter_moments(Moments& of) {
  std::vector<double> part;
  filter(of_x_[0], of_y_[0], of.square, of.moment[4]);
  filter(of_x_[0], of_y_[0], of.sum, of.moment[0]);
  filter(of_x_[1], of_y_[0], of.sum, of.moment[1]);
  filter(of_x_[0], of_y_[1], of.sum, of.moment[2]);
  filter(of_x_[2], of_y_[0], of.sum, of.moment[3]);
  filter(of_x_[0], of_y_[2], of.sum, part);
  for (std::size_t n = 0; n < part.size(); ++n) of.moment[3][n] += part[n];
}

void ZoneWidth::filter(const std::vector<double>& x_taps, const std::vector<double>& y_taps, const std::vector<double>& in,
                       std::vector<double>& out) {
  const auto odd = [](const std::vector<double>& f, const std::vector<double>& first) { return &f == &first ? -1.0 : 1.0; };
  const double sign_x = odd(x_taps, of_x_[1]), sign_y = odd(y_taps, of_y_[1]);
  std::vector<double> rows(in.size(), 0.0);
  out.assign(in.size(), 0.0);
  if (period_x_ == 0 && period_y_ == 0) {  // the same sums, row by row
    const auto size = [](const std::vector<double>& f) { return std::ptrdiff_t(f.size()); };
    const std::ptrdiff_t columns = box_.nx, height = box_.ny;
    const auto add = [](double* to, const double* from, double f, std::ptrdiff_t n) {
      for (std::ptrdiff_t i = 0; i < n; ++i) to[i] += f * from[i];
    };
    for (std::ptrdiff_t j = 0; j < height; ++j) {
      const double* from = in.data() + j * columns;
      double* to = rows.data() + j * columns;
      if (sign_x > 0) add(to, from, x_taps[0], columns);
      for (std::ptrdiff_t t = 1; t < std::min(size(x_taps), columns); ++t) {
        add(to, from + t, x_taps[std::size_t(t)], columns - t);
        add(to + t, from, sign_x * x_taps[std::size_t(t)], columns - t);
      }
    }
    for (std::ptrdiff_t j = 0; j < height; ++j) {
      double* to = out.data() + j * columns;
      if (sign_y > 0) add(to, rows.data() + j * columns, y_taps[0], columns);
      for (std::ptrdiff_t t = 1; t < size(y_taps); ++t) {
        if (j + t < height) add(to, rows.data() + (j + t) * columns, y_taps[std::size_t(t)], columns);
        if (j >= t) add(to, rows.data() + (j - t) * columns, sign_y * y_taps[std::size_t(t)], columns);
      }
    }
    return;
  }
  const std::ptrdiff_t nx = period_x_ > 0 ? period_x_ : box_.nx, ny = period_y_ > 0 ? period_y_ : box_.ny;
  const auto value = [&](const std::vector<double>& of, std::ptrdiff_t i, std::ptrdiff_t j) {
    return i >= 0 && i < nx && j >= 0 && j < ny ? of[std::size_t(j * box_.nx + i)] : 0.0;
  };
  for (std::ptrdiff_t j = 0; j < ny; ++j)
    for (std::ptrdiff_t i = 0; i < nx; ++i)
      rows[std::size_t(j * box_.nx + i)] =
          filtered(x_taps, sign_x, i, nx, period_x_, [&](std::ptrdiff_t k, std::ptrdiff_t away) { return value(in, k, j - away * shift_y_); });
  for (std::ptrdiff_t j = 0; j < ny; ++j)
    for (std::ptrdiff_t i = 0; i < nx; ++i)
      out[std::size_t(j * box_.nx + i)] =
          filtered(y_taps, sign_y, j, ny, period_y_, [&](std::ptrdiff_t k, std::ptrdiff_t away) { return value(rows, i - away * shift_x_, k); });
}

}  // namespace pivnp::mpm
