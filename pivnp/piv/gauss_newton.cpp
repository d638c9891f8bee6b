#include "pivnp/piv/gauss_newton.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstdio>
#include <limits>
#include <chrono>

#include "pivnp/piv/multipass.hpp"
#include "pivnp/piv/normal_sums.hpp"
#include "pivnp/piv/shrink.hpp"
#include "pivnp/piv/window_passes.hpp"

namespace pivnp::piv {

namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
float knob(const char* name, float otherwise) {
  const char* s = std::getenv(name);
  return s ? std::strtof(s, nullptr) : otherwise;
}
struct Timer {
  bool on = std::getenv("GNTIME");
  std::chrono::steady_clock::time_point t = std::chrono::steady_clock::now();
  void lap(const char* what) {
    const auto n = std::chrono::steady_clock::now();
    if (on) std::fprintf(stderr, "%-14s %7.2f ms\n", what, 1e3 * std::chrono::duration<double>(n - t).count());
    t = std::chrono::steady_clock::now();
  }
};

struct GnLevel {
  int decimation = 1;
  SplineImage first, second;
  PixelFlags first_flags, second_flags;
  CellLattice lattice;
  int passes = 0;
  float from_full(float x) const { return (x - 0.5f * float(decimation - 1)) / float(decimation); }
  float to_full(float x) const { return x * float(decimation) + 0.5f * float(decimation - 1); }
};

void smooth3(const CellLattice& l, const std::vector<float>& in, std::vector<float>& out) {
  std::vector<float> half(in.size());
  out.resize(in.size());
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i)
      half[l.index(i, j)] = 0.25f * (in[l.index(std::max(i - 1, 0), j)] + 2 * in[l.index(i, j)] + in[l.index(std::min(i + 1, l.nx - 1), j)]);
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i)
      out[l.index(i, j)] = 0.25f * (half[l.index(i, std::max(j - 1, 0))] + 2 * half[l.index(i, j)] + half[l.index(i, std::min(j + 1, l.ny - 1))]);
}

void box(const CellLattice& l, const std::vector<float>& in, int reach, std::vector<float>& out) {
  std::vector<float> half(in.size());
  out.resize(in.size());
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) {
      float s = 0; int n = 0;
      for (int a = std::max(0, i - reach); a <= std::min(l.nx - 1, i + reach); ++a) s += in[l.index(a, j)], ++n;
      half[l.index(i, j)] = s / float(n);
    }
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) {
      float s = 0; int n = 0;
      for (int b = std::max(0, j - reach); b <= std::min(l.ny - 1, j + reach); ++b) s += half[l.index(i, b)], ++n;
      out[l.index(i, j)] = s / float(n);
    }
}

class GaussNewton final : public Method {
 public:
  GaussNewton(const PivOptions& options, const NodeLattice& nodes, int width, int height, int threads)
      : options_(options), nodes_(nodes), width_(width), height_(height), threads_(std::max(1, threads)),
        anchor_(options.anchor == "central" ? Anchor::central : Anchor::forward),
        windows_(options, nodes, width, height, threads) {
    cell_ = std::max(2, options.window_px / 4);
    const std::vector<int> sides = window_sides(options, width, height);
    if (bounding_box(nodes_, static_cast<float>(sides.front()) / 2, width, height).empty()) return;
    const int side = sides.front();
    windows_.add(side, decimation_of(side, sides.back()), static_cast<float>(side) / 2, int(knob("S1P", 2)), true);
    if (knob("S2", 1) > 0 && side / 2 > options.window_px) windows_.add(side / 2, std::min(decimation_of(side, sides.back()), std::max(1, side / 2 / int(knob("S2W", 16)))), static_cast<float>(side) / 4, int(knob("S2P", 1)), true);
    const int passes[3] = {int(knob("P1", 3)), int(knob("P2", 3)), int(knob("P4", 4))};
    for (int k = 2; k >= 0; --k) {
      if (passes[k] == 0) continue;
      GnLevel l;
      l.decimation = 1 << k;
      l.passes = passes[k];
      const Box b = bounding_box(nodes_, 2.0f * float(cell_ * l.decimation), width, height);
      l.lattice.step = cell_;
      l.lattice.x0 = int(std::floor(l.from_full(float(b.x0))));
      l.lattice.y0 = int(std::floor(l.from_full(float(b.y0))));
      l.lattice.nx = std::max(3, int(std::ceil((l.from_full(float(b.x1)) - float(l.lattice.x0)) / float(cell_))) + 1);
      l.lattice.ny = std::max(3, int(std::ceil((l.from_full(float(b.y1)) - float(l.lattice.y0)) / float(cell_))) + 1);
      levels_.push_back(std::move(l));
    }
  }

  void correlate(const ImageView& first, const ImageView& second, const MaskView& mask, PixelVectors& vectors) override {
    vectors.anchor = anchor_;
    for (std::size_t k = 0; k < nodes_.pixel.size(); ++k) {
      vectors.displacement[k] = {nan, nan};
      vectors.cov[k] = {nan, nan, nan};
      vectors.score[k] = nan;
      vectors.status[k] = switched_on(nodes_, k) ? VectorStatus::failed : VectorStatus::masked;
    }
    if (windows_.empty()) return;
    Timer timer;
    light_ = {};
    const PredictorField& start = windows_.find(first, second, mask);
    timer.lap("search");
    std::vector<float> u, v;
    SplineField field;
    const GnLevel* before = nullptr;
    CellSums sums;
    Shrunk su, sv;
    for (GnLevel& l : levels_) {
      const float smoothing = l.decimation == 1 ? knob("SMOOTH", 0.13f) : 0.0f;
      l.first.assign(first, mask, l.decimation, threads_, smoothing);
      l.second.assign(second, mask, l.decimation, threads_, smoothing);
      const bool flags = l.decimation == 1 && (find_flags(first, mask, l.first_flags) | find_flags(second, mask, l.second_flags));
      timer.lap("prefilter");
      // Field of the level before, at this level's points.
      const float d = float(l.decimation);
      std::vector<float> nu(l.lattice.size()), nv(l.lattice.size());
      for (int j = 0; j < l.lattice.ny; ++j)
        for (int i = 0; i < l.lattice.nx; ++i) {
          const float x = l.to_full(float(l.lattice.x0 + i * cell_)), y = l.to_full(float(l.lattice.y0 + j * cell_));
          std::array<float, 2> p;
          if (before == nullptr) p = start.at(x, y);
          else {
            p = field.at(before->from_full(x), before->from_full(y));
            p[0] *= float(before->decimation), p[1] *= float(before->decimation);
          }
          nu[l.lattice.index(i, j)] = p[0] / d, nv[l.lattice.index(i, j)] = p[1] / d;
        }
      u = nu, v = nv;
      std::vector<float> noise, tolerance, removed_u(u.size(), 1.0f), removed_v(u.size(), 1.0f);
      const Shrinker shrinker(l.lattice);
      for (int pass = 0; pass < l.passes; ++pass) {
        field.interpolate(l.lattice, u, v);
        SumsInput in;
        in.first = &l.first, in.second = &l.second;
        if (flags) in.first_flags = &l.first_flags, in.second_flags = &l.second_flags;
        in.field = &field;
        in.share_first = anchor_ == Anchor::central ? -0.5f : 0.0f;
        in.share_second = anchor_ == Anchor::central ? 0.5f : 1.0f;
        if (!noise.empty()) in.noise = &noise, in.tolerance = &tolerance;
        in.scores = (l.decimation == 1 || before == nullptr) && pass + 1 == l.passes;
        std::vector<float> gain, offset;
        if (light_.lattice.nx > 0) {
          light_at(l, gain, offset);
          in.gain = &gain, in.offset = &offset;
        }
        accumulate_sums(in, threads_, sums);
        timer.lap("sums");
        step(l, sums, shrinker, u, v, removed_u, removed_v, su, sv, noise, tolerance);
        timer.lap("field");
      }
      if (before == nullptr && &l != &levels_.back() && knob("LIGHT", 1) > 0) find_light(l, sums);
      field.interpolate(l.lattice, u, v);
      before = &l;
    }
    read_nodes(levels_.back(), field, sums, su, sv, vectors);
    timer.lap("nodes");
  }

 private:
  bool find_flags(const ImageView& image, const MaskView& mask, PixelFlags& flags) {
    flags.resize(image.width, image.height);
    bool any = false;
    for (int r = 0; r < image.height; ++r)
      for (int c = 0; c < image.width; ++c) {
        const float v = image.depth == PixelDepth::u8 ? float(image.row<std::uint8_t>(r)[c]) : image.depth == PixelDepth::u16 ? float(image.row<std::uint16_t>(r)[c]) : image.row<float>(r)[c];
        if (v >= image.white && knob("SAT", 1) > 0) flags.mark(c, r, 1), any = true;
        if (!mask.usable(c, r)) flags.mark(c, r, 0), any = true;
      }
    return any;
  }

  struct Light {
    CellLattice lattice;  // of the level
    int decimation = 1;
    std::vector<float> gain, offset;
  };

  void find_light(const GnLevel& l, const CellSums& s) {
    std::vector<float> sum[6];
    const CellSums::Plane planes[6] = {CellSums::usable, CellSums::f, CellSums::g, CellSums::ff, CellSums::gg, CellSums::fg};
    for (int p = 0; p < 6; ++p) box(l.lattice, s[planes[p]], 2, sum[p]);
    light_.lattice = l.lattice, light_.decimation = l.decimation;
    light_.gain.resize(l.lattice.size()), light_.offset.resize(l.lattice.size());
    float most = 0;
    for (std::size_t k = 0; k < l.lattice.size(); ++k) {
      const float n = std::max(sum[0][k], 1e-3f), f = sum[1][k] / n, g = sum[2][k] / n;
      const float vf = sum[3][k] / n - f * f, vg = sum[4][k] / n - g * g;
      const float gain = vf > 0.1f && vg > 0.1f ? std::clamp(std::sqrt(vf / vg), 0.5f, 2.0f) : 1.0f;
      light_.gain[k] = gain, light_.offset[k] = f - gain * g;
      most = std::max(most, std::max(std::abs(gain - 1), std::abs(light_.offset[k]) / 50));
    }
    if (std::getenv("GNLIGHT")) std::fprintf(stderr, "light most %.4f\n", most);
    if (most < knob("LMIN", 0.01f)) light_ = {};
  }

  void light_at(const GnLevel& l, std::vector<float>& gain, std::vector<float>& offset) const {
    gain.resize(l.lattice.size()), offset.resize(l.lattice.size());
    const CellLattice& c = light_.lattice;
    for (int j = 0; j < l.lattice.ny; ++j)
      for (int i = 0; i < l.lattice.nx; ++i) {
        const float d = float(light_.decimation);
        const float x = ((l.to_full(float(l.lattice.x0 + i * cell_)) - 0.5f * (d - 1)) / d - float(c.x0)) / float(c.step);
        const float y = ((l.to_full(float(l.lattice.y0 + j * cell_)) - 0.5f * (d - 1)) / d - float(c.y0)) / float(c.step);
        const int a = std::clamp(int(std::floor(x)), 0, c.nx - 2), b = std::clamp(int(std::floor(y)), 0, c.ny - 2);
        const float s = std::clamp(x - float(a), 0.0f, 1.0f), t = std::clamp(y - float(b), 0.0f, 1.0f);
        const auto mix = [&](const std::vector<float>& v) {
          return (1 - t) * ((1 - s) * v[c.index(a, b)] + s * v[c.index(a + 1, b)]) + t * ((1 - s) * v[c.index(a, b + 1)] + s * v[c.index(a + 1, b + 1)]);
        };
        gain[l.lattice.index(i, j)] = mix(light_.gain), offset[l.lattice.index(i, j)] = mix(light_.offset);
      }
  }

  void step(const GnLevel& l, const CellSums& s, const Shrinker& shrinker, std::vector<float>& u, std::vector<float>& v,
            std::vector<float>& removed_u, std::vector<float>& removed_v, Shrunk& su, Shrunk& sv, std::vector<float>& noise, std::vector<float>& tolerance) {
    const std::size_t n = l.lattice.size();
    static const float mu_share = knob("MU", 0.05f), strength = knob("STRENGTH", 2.5f), c1 = knob("C1", 3.0f), kappa0 = knob("K0", 0.1f),
                       kappa1 = knob("K1", 0.1f), cap = knob("CAP", 1.5f), widen = knob("WIDEN", 0);
    CellSums w;
    const CellSums* h = &s;
    if (widen > 0) {
      w.lattice = s.lattice;
      for (int p = 0; p < CellSums::basic; ++p) smooth3(l.lattice, s.plane[p], w.plane[p]);
      h = &w;
    }
    // typical texture
    std::vector<float> trace(n), around;
    for (std::size_t k = 0; k < n; ++k) trace[k] = 0.5f * ((*h)[CellSums::gxx][k] + (*h)[CellSums::gyy][k]);
    box(l.lattice, trace, 4, around);
    NoisyField fu, fv;
    fu.value.resize(n), fv.value.resize(n), fu.variance.resize(n), fv.variance.resize(n);
    std::vector<float> bxx(n), byy(n), bxy(n), hxx(n), hyy(n), hxy(n);
    for (std::size_t k = 0; k < n; ++k) {
      const float mu = mu_share * around[k] + 1e-3f;
      const float a = (*h)[CellSums::gxx][k] + mu, b = (*h)[CellSums::gxy][k], c = (*h)[CellSums::gyy][k] + mu;
      const float x = (*h)[CellSums::gxe][k], y = (*h)[CellSums::gye][k];
      const float det = 1 / (a * c - b * b);
      float du = (c * x - b * y) * det, dv = (a * y - b * x) * det;
      const float size = std::sqrt(du * du + dv * dv);
      if (size > cap) du *= cap / size, dv *= cap / size;
      bxx[k] = du * du, byy[k] = dv * dv;
      fu.value[k] = u[k] + du, fv.value[k] = v[k] + dv;
    }
    // noise from residual displacement, pooled
    box(l.lattice, bxx, int(knob("POOL", 2)), hxx);
    box(l.lattice, byy, int(knob("POOL", 2)), hyy);
    for (std::size_t k = 0; k < n; ++k) {
      fu.variance[k] = hxx[k] / std::max(0.3f, removed_u[k]) + 1e-9f;
      fv.variance[k] = hyy[k] / std::max(0.3f, removed_v[k]) + 1e-9f;
    }
    if (strength > 0) {
      shrinker.run(fu, strength, threads_, su);
      shrinker.run(fv, strength, threads_, sv);
      u = su.value, v = sv.value;
      removed_u = su.removed, removed_v = sv.removed;
    } else {
      u = fu.value, v = fv.value;
      su.variance = fu.variance, sv.variance = fv.variance;
    }
    // robust scale
    if (c1 > 0 && l.decimation <= int(knob("RL", 2))) {
      std::vector<float> ee, ww;
      smooth3(l.lattice, s[CellSums::wee], ee);
      smooth3(l.lattice, s[CellSums::weight], ww);
      noise.resize(n), tolerance.resize(n);
      for (int j = 0; j < l.lattice.ny; ++j)
        for (int i = 0; i < l.lattice.nx; ++i) {
          const std::size_t k = l.lattice.index(i, j);
          noise[k] = c1 * c1 * ee[k] / std::max(ww[k], 1e-3f) / 0.72f + 0.1f;
          const auto diff = [&](const std::vector<float>& f, int i0, int j0, int i1, int j1) {
            const float q = f[l.lattice.index(i1, j1)] - f[l.lattice.index(i0, j0)];
            return q * q;
          };
          const int i0 = std::max(i - 1, 0), i1 = std::min(i + 1, l.lattice.nx - 1), j0 = std::max(j - 1, 0), j1 = std::min(j + 1, l.lattice.ny - 1);
          const float strain = std::sqrt(0.25f * (diff(u, i0, j, i1, j) + diff(u, i, j0, i, j1) + diff(v, i0, j, i1, j) + diff(v, i, j0, i, j1)));
          const float kappa = kappa0 + kappa1 * strain;
          tolerance[k] = kappa * kappa;
        }
    }
  }

  void read_nodes(const GnLevel& l, const SplineField& field, const CellSums& s, const Shrunk& su, const Shrunk& sv, PixelVectors& vectors) {
    std::vector<float> score(l.lattice.size());
    std::vector<float> f, g, ff, gg, fg, n;
    smooth3(l.lattice, s[CellSums::f], f), smooth3(l.lattice, s[CellSums::g], g), smooth3(l.lattice, s[CellSums::ff], ff);
    smooth3(l.lattice, s[CellSums::gg], gg), smooth3(l.lattice, s[CellSums::fg], fg), smooth3(l.lattice, s[CellSums::usable], n);
    for (std::size_t k = 0; k < score.size(); ++k) {
      const float m = std::max(n[k], 1.0f);
      const float vf = ff[k] - f[k] * f[k] / m, vg = gg[k] - g[k] * g[k] / m, c = fg[k] - f[k] * g[k] / m;
      score[k] = c / std::sqrt(std::max(vf * vg, 1e-6f));
    }
    for (std::size_t k = 0; k < nodes_.pixel.size(); ++k) {
      if (vectors.status[k] == VectorStatus::masked) continue;
      const auto [x, y] = nodes_.pixel[k];
      if (!(x >= 0 && y >= 0 && x <= float(width_ - 1) && y <= float(height_ - 1))) continue;
      vectors.displacement[k] = field.at(x, y);
      const int i = std::clamp(int(std::lround((x - float(l.lattice.x0)) / float(cell_))), 0, l.lattice.nx - 1);
      const int j = std::clamp(int(std::lround((y - float(l.lattice.y0)) / float(cell_))), 0, l.lattice.ny - 1);
      const std::size_t q = l.lattice.index(i, j);
      vectors.cov[k] = {su.variance[q] + knob("FLOOR", 1e-6f), sv.variance[q] + knob("FLOOR", 1e-6f), 0};
      vectors.score[k] = score[q];
      vectors.status[k] = score[q] > float(options_.min_score) ? VectorStatus::valid : VectorStatus::rejected;
    }
  }

  PivOptions options_;
  NodeLattice nodes_;
  int width_, height_, threads_;
  Anchor anchor_;
  WindowPasses windows_;
  int cell_ = 8;
  Light light_;
  std::vector<GnLevel> levels_;
};

}  // namespace

std::unique_ptr<Method> make_gauss_newton(const PivOptions& options, const NodeLattice& nodes, int width, int height,
                                          int threads) {
  return std::make_unique<GaussNewton>(options, nodes, width, height, threads);
}

}  // namespace pivnp::piv
