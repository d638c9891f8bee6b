#include "tests/bench/mpm/plain_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <vector>

namespace pivnp::bench {

namespace {

struct Point {
  double x, y, vx = 0, vy = 0, cxx = 0, cxy = 0, cyx = 0, cyy = 0;
  double fxx = 1, fxy = 0, fyx = 0, fyy = 1, sxx = 0, syy = 0, szz = 0, sxy = 0;
};
struct Node {
  double m = 0, px = 0, py = 0;
};

struct Plain {
  int nx, ny;
  double h, dt, mass, volume, lambda, shear;
  std::vector<Point> points;
  std::vector<Node> nodes;

  static void weights(double s, int& first, double* w) {
    first = int(s - 0.5);
    const double d = s - first;
    w[0] = 0.5 * (1.5 - d) * (1.5 - d);
    w[1] = 0.75 - (d - 1) * (d - 1);
    w[2] = 0.5 * (d - 0.5) * (d - 0.5);
  }

  void step() {
    std::fill(nodes.begin(), nodes.end(), Node{});
    for (const Point& p : points) {
      int i, j;
      double wx[3], wy[3];
      weights(p.x / h, i, wx);
      weights(p.y / h, j, wy);
      const double J = p.fxx * p.fyy - p.fxy * p.fyx, k = -4 * dt * volume * J / (h * h);
      const double axx = k * p.sxx + mass * p.cxx, axy = k * p.sxy + mass * p.cxy;
      const double ayx = k * p.sxy + mass * p.cyx, ayy = k * p.syy + mass * p.cyy;
      for (int b = 0; b < 3; ++b)
        for (int a = 0; a < 3; ++a) {
          const double w = wx[a] * wy[b], dx = (i + a) * h - p.x, dy = (j + b) * h - p.y;
          Node& n = nodes[std::size_t((j + b) * nx + i + a)];
          n.m += w * mass;
          n.px += w * (mass * p.vx + axx * dx + axy * dy);
          n.py += w * (mass * p.vy + ayx * dx + ayy * dy);
        }
    }
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        Node& n = nodes[std::size_t(j * nx + i)];
        if (!(n.m > 0)) continue;
        n.px /= n.m;
        n.py = n.py / n.m - 9.81 * dt;
        if (j < 3) n.px = n.py = 0;
        if (i < 3 || i > nx - 4) n.px = 0;
      }
    for (Point& p : points) {
      int i, j;
      double wx[3], wy[3];
      weights(p.x / h, i, wx);
      weights(p.y / h, j, wy);
      double vx = 0, vy = 0, bxx = 0, bxy = 0, byx = 0, byy = 0;
      for (int b = 0; b < 3; ++b)
        for (int a = 0; a < 3; ++a) {
          const Node& n = nodes[std::size_t((j + b) * nx + i + a)];
          const double w = wx[a] * wy[b], dx = (i + a) * h - p.x, dy = (j + b) * h - p.y;
          vx += w * n.px;
          vy += w * n.py;
          bxx += w * n.px * dx;
          bxy += w * n.px * dy;
          byx += w * n.py * dx;
          byy += w * n.py * dy;
        }
      const double k = 4 / (h * h);
      p.vx = vx, p.vy = vy, p.cxx = k * bxx, p.cxy = k * bxy, p.cyx = k * byx, p.cyy = k * byy;
      p.x += dt * vx;
      p.y += dt * vy;
      const double exx = dt * p.cxx, eyy = dt * p.cyy, exy = 0.5 * dt * (p.cxy + p.cyx), spin = 0.5 * dt * (p.cxy - p.cyx);
      const double fxx = p.fxx, fxy = p.fxy;
      p.fxx += dt * (p.cxx * fxx + p.cxy * p.fyx);
      p.fxy += dt * (p.cxx * fxy + p.cxy * p.fyy);
      p.fyx += dt * (p.cyx * fxx + p.cyy * p.fyx);
      p.fyy += dt * (p.cyx * fxy + p.cyy * p.fyy);
      const double mean = lambda * (exx + eyy), turned = 2 * spin * p.sxy, difference = spin * (p.syy - p.sxx);
      p.sxx += mean + 2 * shear * exx + turned;
      p.syy += mean + 2 * shear * eyy - turned;
      p.szz += mean;
      p.sxy += 2 * shear * exy + difference;
    }
  }
};

}  // namespace

double plain_rate(int cells, double steps) {
  const double h = 1.0 / cells, young = 1e6, nu = 0.3, density = 2000;
  Plain s{2 * cells + 7, int(1.2 * cells) + 7, h, 0, density * h * h / 4, h * h / 4, young * nu / ((1 + nu) * (1 - 2 * nu)),
          young / (2 * (1 + nu)), {}, {}};
  s.dt = 0.2 * h / std::sqrt((s.lambda + 2 * s.shear) / density);
  for (int j = 0; j < 2 * cells; ++j)
    for (int i = 0; i < 2 * cells; ++i) s.points.push_back({.x = (3 + 0.25 + 0.5 * i) * h, .y = (3 + 0.25 + 0.5 * j) * h});
  s.nodes.resize(std::size_t(s.nx * s.ny));
  for (int k = 0; k < 5; ++k) s.step();
  const auto cpu = std::clock();
  for (int k = 0; k < int(steps); ++k) s.step();
  const double seconds = double(std::clock() - cpu) / CLOCKS_PER_SEC;
  return std::isfinite(s.points.back().x) ? steps * double(s.points.size()) / seconds / 1e6 : 0;
}

}  // namespace pivnp::bench
