#include "mpm/transfer.hpp"

#include <algorithm>
#include <cmath>

namespace pivnp::mpm {

namespace {

// A point that sits on an edge would give a node no mass but a gradient. Weights are taken this far inside, which
// changes them by as little and leaves every active node with a velocity.
constexpr double edge = 1e-9;

double inside(double s) { return std::min(std::max(s, edge), 1 - edge); }

struct Corners {
  std::size_t n[4];
};
Corners corners_of(const GridState& g, std::size_t slot) {
  const std::size_t n = g.corner(slot), nx = std::size_t(g.grid.nx);
  return {{n, n + 1, n + nx, n + nx + 1}};
}

struct Weights {
  double v[4];
};
Weights weights(double xi, double eta) {
  return {{(1 - xi) * (1 - eta), xi * (1 - eta), (1 - xi) * eta, xi * eta}};
}

bool locate_anew(Particles& p, const Grid& grid, std::size_t k) {
  ElementPoint at;
  if (!locate(grid, {p.x[k], p.y[k]}, at)) {
    p.cell[k] = Particles::ended;
    return false;
  }
  p.cell[k] = std::int32_t(grid.element(at.i, at.j));
  p.xi[k] = inside(at.xi);
  p.eta[k] = inside(at.eta);
  return true;
}

void add_point(const Particles& p, std::size_t k, double per_hx, double per_hy, CellSums& sum, double& mean_volume) {
  const double xi = p.xi[k], eta = p.eta[k];
  const Weights w = weights(xi, eta);
  const double mass = p.mass[k], volume = p.volume0[k];
  const double mean = (p.tau_xx[k] + p.tau_yy[k] + p.tau_zz[k]) / 3;
  mean_volume += volume * mean;
  const double sxx = volume * (p.tau_xx[k] - mean) * per_hx, sxy_x = volume * p.tau_xy[k] * per_hx;
  const double syy = volume * (p.tau_yy[k] - mean) * per_hy, sxy_y = volume * p.tau_xy[k] * per_hy;
  const double gx[4] = {-(1 - eta), 1 - eta, -eta, eta}, gy[4] = {-(1 - xi), -xi, 1 - xi, xi};
  for (int c = 0; c < 4; ++c) {
    const double m = mass * w.v[c];
    sum.mass[c] += m;
    sum.px[c] += m * p.vx[k];
    sum.py[c] += m * p.vy[k];
    sum.fx[c] -= sxx * gx[c] + sxy_y * gy[c];
    sum.fy[c] -= sxy_x * gx[c] + syy * gy[c];
  }
}

}  // namespace

void locate_all(Particles& p, GridState& g) {
  for (std::size_t k = 0; k < p.size(); ++k)
    if (p.cell[k] != Particles::ended) locate_anew(p, g.grid, k);
  g.rebuild(p);
}

bool locate_points(Particles& p, GridState& g, std::vector<std::uint32_t>& left, int threads) {
  bool changed = false;
  const auto across = std::int32_t(g.grid.nx - 1);
  const auto n_slots = std::ptrdiff_t(g.slots());
#pragma omp parallel for num_threads(threads) schedule(static) reduction(|| : changed) if (threads > 1)
  for (std::ptrdiff_t s = 0; s < n_slots; ++s) {
    const std::int32_t cell = g.slot_cell[std::size_t(s)];
    const double i = cell % across, j = cell / across;
    for (std::uint32_t q = g.slot_begin[std::size_t(s)]; q < g.slot_begin[std::size_t(s) + 1]; ++q) {
      const std::size_t k = g.order[q];
      const double a = (p.x[k] - g.grid.origin.x()) * g.per_hx - i, b = (p.y[k] - g.grid.origin.y()) * g.per_hy - j;
      if (a >= 0 && a < 1 && b >= 0 && b < 1) {
        p.xi[k] = inside(a);
        p.eta[k] = inside(b);
      } else {
        locate_anew(p, g.grid, k);
        changed = changed || p.cell[k] != cell;
      }
    }
  }
  if (changed)
    for (const std::uint32_t k : g.order)
      if (p.cell[k] == Particles::ended) left.push_back(k);
  return changed;
}

void particles_to_grid(const Particles& p, GridState& g, int threads) {
  const auto n_slots = std::ptrdiff_t(g.slots()), n_nodes = std::ptrdiff_t(g.nodes.size());
#pragma omp parallel num_threads(threads) if (threads > 1)
  {
#pragma omp for schedule(static)
    for (std::ptrdiff_t s = 0; s < n_slots; ++s) {
      CellSums sum{};
      double mean_volume = 0;
      for (std::uint32_t q = g.slot_begin[std::size_t(s)]; q < g.slot_begin[std::size_t(s) + 1]; ++q)
        add_point(p, g.order[q], g.per_hx, g.per_hy, sum, mean_volume);
      const double fx = 0.5 * mean_volume * g.per_hx, fy = 0.5 * mean_volume * g.per_hy;  // gradient at the centre
      for (int c = 0; c < 4; ++c) {
        sum.fx[c] += c % 2 == 0 ? fx : -fx;
        sum.fy[c] += c < 2 ? fy : -fy;
      }
      g.sums[std::size_t(s)] = sum;
    }
#pragma omp for schedule(static)
    for (std::ptrdiff_t a = 0; a < n_nodes; ++a) {
      Node node;
      for (int c = 0; c < 4; ++c) {
        const CellSums& sum = g.sums[g.node_slots[std::size_t(a)][std::size_t(c)]];
        node.mass += sum.mass[c];
        node.vx += sum.px[c];
        node.vy += sum.py[c];
        node.fx += sum.fx[c];
        node.fy += sum.fy[c];
      }
      const double per_mass = node.mass > 0 ? 1 / node.mass : 0;
      node.vx *= per_mass;
      node.vy *= per_mass;
      g.node[g.nodes[std::size_t(a)]] = node;
    }
  }
}

GatherSums grid_to_particles(Particles& p, GridState& g, double dt, double pic, int threads) {
  const auto n_slots = std::ptrdiff_t(g.slots()), n_nodes = std::ptrdiff_t(g.nodes.size());
  const double reach2 = std::pow(std::min(g.grid.spacing.x(), g.grid.spacing.y()) / dt, 2);
  double fastest2 = 0;
  bool good = true;
  std::vector<double> loss(pic > 0 ? g.slots() : 0, 0.0);
#pragma omp parallel num_threads(threads) if (threads > 1)
  {
#pragma omp for schedule(static) reduction(max : fastest2) reduction(&& : good)
    for (std::ptrdiff_t s = 0; s < n_slots; ++s) {
      double nx[4], ny[4], ax[4], ay[4];
      const Corners at = corners_of(g, std::size_t(s));
      for (int c = 0; c < 4; ++c) {
        const Node& node = g.node[at.n[c]];
        nx[c] = node.nx;
        ny[c] = node.ny;
        ax[c] = node.nx - node.vx;
        ay[c] = node.ny - node.vy;
      }
      double px[4] = {}, py[4] = {};
      for (std::uint32_t q = g.slot_begin[std::size_t(s)]; q < g.slot_begin[std::size_t(s) + 1]; ++q) {
        const std::size_t k = g.order[q];
        const Weights w = weights(p.xi[k], p.eta[k]);
        double vx = 0, vy = 0, dvx = 0, dvy = 0;
        for (int c = 0; c < 4; ++c) {
          vx += w.v[c] * nx[c];
          vy += w.v[c] * ny[c];
          dvx += w.v[c] * ax[c];
          dvy += w.v[c] * ay[c];
        }
        p.x[k] += dt * vx;
        p.y[k] += dt * vy;
        double flip_x = p.vx[k] + dvx, flip_y = p.vy[k] + dvy;
        if (pic > 0) {
          const double before = flip_x * flip_x + flip_y * flip_y;
          flip_x += pic * (vx - flip_x);
          flip_y += pic * (vy - flip_y);
          loss[std::size_t(s)] += 0.5 * p.mass[k] * (before - flip_x * flip_x - flip_y * flip_y);
        }
        p.vx[k] = flip_x;
        p.vy[k] = flip_y;
        const double speed2 = flip_x * flip_x + flip_y * flip_y;
        good = good && speed2 <= reach2 && vx * vx + vy * vy <= reach2;  // false for NaN too
        fastest2 = std::max(fastest2, speed2);
        for (int c = 0; c < 4; ++c) {
          px[c] += p.mass[k] * w.v[c] * flip_x;
          py[c] += p.mass[k] * w.v[c] * flip_y;
        }
      }
      CellSums& sum = g.sums[std::size_t(s)];
      std::copy(px, px + 4, sum.px);
      std::copy(py, py + 4, sum.py);
    }
#pragma omp for schedule(static)
    for (std::ptrdiff_t a = 0; a < n_nodes; ++a) {
      Node& node = g.node[g.nodes[std::size_t(a)]];
      double px = 0, py = 0;
      for (int c = 0; c < 4; ++c) {
        const CellSums& sum = g.sums[g.node_slots[std::size_t(a)][std::size_t(c)]];
        px += sum.px[c];
        py += sum.py[c];
      }
      const double per_mass = node.mass > 0 ? 1 / node.mass : 0;
      node.ux = px * per_mass;
      node.uy = py * per_mass;
    }
  }
  double total = 0;
  for (const double l : loss) total += l;
  return {fastest2, total, good};
}

void strain_increments(Particles& p, const GridState& g, double dt, int threads) {
  const auto n_slots = std::ptrdiff_t(g.slots());
  const double sx = dt * g.per_hx, sy = dt * g.per_hy;
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
  for (std::ptrdiff_t s = 0; s < n_slots; ++s) {
    // Velocity in the cell is v = v00 + b xi + c eta + d xi eta.
    const Corners at = corners_of(g, std::size_t(s));
    const Node &n0 = g.node[at.n[0]], &n1 = g.node[at.n[1]], &n2 = g.node[at.n[2]], &n3 = g.node[at.n[3]];
    const double bx = n1.ux - n0.ux, cx = n2.ux - n0.ux, dx = n3.ux - n2.ux - bx;
    const double by = n1.uy - n0.uy, cy = n2.uy - n0.uy, dy = n3.uy - n2.uy - by;
    const double centre = (bx + 0.5 * dx) * sx + (cy + 0.5 * dy) * sy;
    for (std::uint32_t q = g.slot_begin[std::size_t(s)]; q < g.slot_begin[std::size_t(s) + 1]; ++q) {
      const std::size_t k = g.order[q];
      const double xx = (bx + dx * p.eta[k]) * sx, xy = (cx + dx * p.xi[k]) * sy;
      const double yx = (by + dy * p.eta[k]) * sx, yy = (cy + dy * p.xi[k]) * sy;
      const double shift = (centre - xx - yy) / 3;
      p.de_xx[k] = xx + shift;
      p.de_yy[k] = yy + shift;
      p.de_zz[k] = shift;
      p.de_xy[k] = 0.5 * (xy + yx);
      p.spin[k] = 0.5 * (yx - xy);
    }
  }
}

void update_deformation(Particles& p, int threads) {
  const auto n = std::ptrdiff_t(p.size());
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
  for (std::ptrdiff_t q = 0; q < n; ++q) {
    const auto k = std::size_t(q);
    // The point's own gradient: the averaging moved the three normal increments by de_zz.
    const double xx = p.de_xx[k] - p.de_zz[k], yy = p.de_yy[k] - p.de_zz[k];
    const double xy = p.de_xy[k] - p.spin[k], yx = p.de_xy[k] + p.spin[k];
    const double a = p.F_xx[k], b = p.F_xy[k], c = p.F_yx[k], d = p.F_yy[k];
    p.F_xx[k] = a + xx * a + xy * c;
    p.F_xy[k] = b + xx * b + xy * d;
    p.F_yx[k] = c + yx * a + yy * c;
    p.F_yy[k] = d + yx * b + yy * d;
    p.J[k] *= 1 + p.de_xx[k] + p.de_yy[k] + p.de_zz[k];
  }
}

}  // namespace pivnp::mpm
