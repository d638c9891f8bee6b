#include "pivnp/piv/dense/normal_sums.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pivnp/piv/dense/normal_sums.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>

#include "pivnp/piv/sampling/sample_row-inl.hpp"

#ifndef PIVNP_PIV_NORMAL_SUMS_ONCE
#define PIVNP_PIV_NORMAL_SUMS_ONCE
namespace pivnp::piv {

constexpr int derivative_reach = 2;
constexpr float derivative_1 = 0.74f, derivative_2 = -0.12f;  // 2 d1 + 4 d2 = 1: exact for slopes
constexpr int cell_rows_per_band = 8;
constexpr int most_step = 64;    // pixels of a cell
constexpr int row_padding = 32;  // floats before and behind a row buffer, at least a vector and the derivative's reach

// Rows of pixels kept while a band of cells is summed; column k of a buffer is the lattice's first column + k.
struct RowStore {
  int width = 0, slots = 0;
  std::ptrdiff_t stride = 0;
  std::vector<float> mean, difference, use, f, g;
  std::vector<float> du, dv, ux, uy, noise, tolerance, gain, offset;
  std::vector<float> upper, lower;  // [planes][stride]: sums for the lattice row above and below
  std::vector<float> coefficients_u, coefficients_v;
  std::vector<std::pair<int, int>> runs;  // columns of cells [first, end) that the band needs

  void prepare(int pixel_columns, int cell_step, int lattice_columns, int planes) {
    width = pixel_columns;
    stride = (pixel_columns + 2 * row_padding + 15) / 16 * 16;
    slots = cell_step + 2 * derivative_reach;
    const auto rows = static_cast<std::size_t>(stride) * static_cast<std::size_t>(slots);
    for (auto* v : {&mean, &difference, &use}) v->assign(rows, 0.0f);
    for (auto* v : {&du, &dv, &ux, &uy, &noise, &tolerance, &gain, &offset, &f, &g})
      v->assign(static_cast<std::size_t>(stride), 0.0f);
    for (auto* v : {&upper, &lower})
      v->assign(static_cast<std::size_t>(stride) * static_cast<std::size_t>(planes), 0.0f);
    for (auto* v : {&coefficients_u, &coefficients_v}) v->assign(static_cast<std::size_t>(lattice_columns) + 2, 0.0f);
  }
  float* row(std::vector<float>& buffer, int slot) { return buffer.data() + slot * stride + row_padding; }
  float* line(std::vector<float>& buffer) { return buffer.data() + row_padding; }
};

}  // namespace pivnp::piv
#endif

HWY_BEFORE_NAMESPACE();
namespace pivnp::piv::HWY_NAMESPACE {

using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;
// The displacement along one row of pixels, from the spline's coefficients along it. weight[o][a]: of coefficient a at
// offset o in a cell.
void expand_row(const float* coefficients, int cells, int step, const float (*weight)[4], float* out) {
  for (int i = 0; i < cells; ++i) {
    const float* c = coefficients + i;
    for (int o = 0; o < step; ++o)
      out[i * step + o] = weight[o][0] * c[0] + weight[o][1] * c[1] + weight[o][2] * c[2] + weight[o][3] * c[3];
  }
}

void scale_row(const float* in, float factor, int count, float* out) {
  const D d;
  const V s = hn::Set(d, factor);
  for (int k = 0; k < count; k += static_cast<int>(hn::Lanes(d)))
    hn::StoreU(hn::Mul(s, hn::LoadU(d, in + k)), d, out + k);
}

// One row of both warped frames over the band's runs: mean, difference (corrected for illumination) and use.
void warp_row(const SumsInput& input, int row, const float (*weight)[4], int slot, RowStore& store) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const CellLattice& lattice = input.field->lattice();
  float* mean = store.row(store.mean, slot);
  float* difference = store.row(store.difference, slot);
  float* use = store.row(store.use, slot);
  const int height = input.first->height(), width = input.first->width();
  for (float* line : {mean, difference, use}) std::fill(line - row_padding, line - row_padding + store.stride, 0.0f);
  if (row < 0 || row >= height) return;
  input.field->row_coefficients(static_cast<float>(row), store.coefficients_u.data(), store.coefficients_v.data());
  const bool framed = row >= derivative_reach && row < height - derivative_reach;
  float* f = store.line(store.f);
  float* g = store.line(store.g);
  float* ux = store.line(store.ux);
  float* uy = store.line(store.uy);
  const V half = hn::Set(d, 0.5f);
  for (const auto& [cell, cell_end] : store.runs) {
    // Only columns that the image has; the derivative is not taken at its edge.
    const int begin = std::max(cell * lattice.step, -lattice.x0);
    const int end = std::min(cell_end * lattice.step, width - lattice.x0);
    if (begin >= end) continue;
    const int count = (end - begin + lanes - 1) / lanes * lanes;
    const int from = std::max(begin, derivative_reach - lattice.x0),
              to = std::min(end, width - derivative_reach - lattice.x0);
    if (framed && from < to) std::fill(use + from, use + to, 1.0f);
    const int start = cell * lattice.step;
    expand_row(store.coefficients_u.data() + cell, cell_end - cell, lattice.step, weight, store.line(store.du) + start);
    expand_row(store.coefficients_v.data() + cell, cell_end - cell, lattice.step, weight, store.line(store.dv) + start);
    for (const bool second : {false, true}) {
      const float share = second ? input.shares.second : input.shares.first;
      scale_row(store.line(store.du) + begin, share, count, ux + begin);
      scale_row(store.line(store.dv) + begin, share, count, uy + begin);
      sample_row(second ? *input.second : *input.first, second ? input.second_flags : input.first_flags,
                 lattice.x0 + begin, row, ux + begin, uy + begin, count, (second ? g : f) + begin, use + begin);
    }
    const float* gain = store.line(store.gain);
    const float* offset = store.line(store.offset);
    for (int k = begin; k < begin + count; k += lanes) {
      const V a = hn::LoadU(d, f + k);
      V b = hn::LoadU(d, g + k);
      if (input.gain != nullptr) b = hn::MulAdd(hn::LoadU(d, gain + k), b, hn::LoadU(d, offset + k));
      hn::StoreU(hn::Mul(half, hn::Add(a, b)), d, mean + k);
      hn::StoreU(hn::Sub(a, b), d, difference + k);
    }
    for (float* line : {mean, difference, use}) std::fill(line + end, line + begin + count, 0.0f);
  }
}

// The products of `rows` rows of pixels in a strip of columns from c on, one vector wide, added to the sums of the
// lattice rows above and below.
template <bool robust, bool scores>
HWY_INLINE void add_strip(int c, int first_slot, int rows, RowStore& store) {
  const D d;
  constexpr int planes = scores ? int(CellSums::planes) : int(CellSums::basic);
  const V d1 = hn::Set(d, derivative_1), d2 = hn::Set(d, derivative_2), one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f);
  const auto slot = [&](int k) { return (first_slot + k) % store.slots; };
  V up[planes], down[planes];
  for (int p = 0; p < planes; ++p) {
    up[p] = hn::LoadU(d, store.upper.data() + p * store.stride + row_padding + c);
    down[p] = hn::LoadU(d, store.lower.data() + p * store.stride + row_padding + c);
  }
  const V noise = robust ? hn::LoadU(d, store.line(store.noise) + c) : one;
  const V tolerance = robust ? hn::LoadU(d, store.line(store.tolerance) + c) : one;
  for (int k = 0; k < rows; ++k) {
    const V use = hn::LoadU(d, store.row(store.use, slot(k)) + c);
    const float* m = store.row(store.mean, slot(k)) + c;
    const V e = hn::LoadU(d, store.row(store.difference, slot(k)) + c);
    const V gx = hn::MulAdd(d1, hn::Sub(hn::LoadU(d, m + 1), hn::LoadU(d, m - 1)),
                            hn::Mul(d2, hn::Sub(hn::LoadU(d, m + 2), hn::LoadU(d, m - 2))));
    const auto at = [&](int dy) { return hn::LoadU(d, store.row(store.mean, slot(k + store.slots + dy)) + c); };
    const V gy = hn::MulAdd(d1, hn::Sub(at(1), at(-1)), hn::Mul(d2, hn::Sub(at(2), at(-2))));
    V w = use;
    const V ee = hn::Mul(e, e);
    if (robust) {
      const V bound = hn::MulAdd(tolerance, hn::MulAdd(gx, gx, hn::Mul(gy, gy)), noise);
      const V q = hn::Div(bound, hn::Add(bound, ee));
      w = hn::Mul(w, hn::Mul(q, q));
    }
    const V wgx = hn::Mul(w, gx), wgy = hn::Mul(w, gy);
    V product[planes];
    product[CellSums::gxx] = hn::Mul(wgx, gx);
    product[CellSums::gxy] = hn::Mul(wgx, gy);
    product[CellSums::gyy] = hn::Mul(wgy, gy);
    product[CellSums::gxe] = hn::Mul(wgx, e);
    product[CellSums::gye] = hn::Mul(wgy, e);
    product[CellSums::wee] = hn::Mul(w, ee);
    product[CellSums::weight] = w;
    product[CellSums::usable] = use;
    if constexpr (scores) {
      const V mean = hn::LoadU(d, m), f = hn::MulAdd(half, e, mean), g = hn::NegMulAdd(half, e, mean);
      product[CellSums::f] = hn::Mul(use, f);
      product[CellSums::g] = hn::Mul(use, g);
      product[CellSums::ff] = hn::Mul(product[CellSums::f], f);
      product[CellSums::gg] = hn::Mul(product[CellSums::g], g);
      product[CellSums::fg] = hn::Mul(product[CellSums::f], g);
      const float* d0 = store.row(store.difference, slot(k)) + c;
      const auto off = [&](int dy) { return hn::LoadU(d, store.row(store.difference, slot(k + store.slots + dy)) + c); };
      const V ex = hn::MulAdd(d1, hn::Sub(hn::LoadU(d, d0 + 1), hn::LoadU(d, d0 - 1)),
                              hn::Mul(d2, hn::Sub(hn::LoadU(d, d0 + 2), hn::LoadU(d, d0 - 2))));
      const V ey = hn::MulAdd(d1, hn::Sub(off(1), off(-1)), hn::Mul(d2, hn::Sub(off(2), off(-2))));
      const V wex = hn::Mul(w, ex);
      product[CellSums::exx] = hn::Mul(wex, ex);
      product[CellSums::exy] = hn::Mul(wex, ey);
      product[CellSums::eyy] = hn::Mul(hn::Mul(w, ey), ey);
    }
    const float share = static_cast<float>(k) / static_cast<float>(rows);
    const V below = hn::Set(d, share), above = hn::Set(d, 1 - share);
    for (int p = 0; p < planes; ++p) {
      up[p] = hn::MulAdd(above, product[p], up[p]);
      down[p] = hn::MulAdd(below, product[p], down[p]);
    }
  }
  for (int p = 0; p < planes; ++p) {
    hn::StoreU(up[p], d, store.upper.data() + p * store.stride + row_padding + c);
    hn::StoreU(down[p], d, store.lower.data() + p * store.stride + row_padding + c);
  }
}

template <bool robust, bool scores>
HWY_NOINLINE void add_products(int first_slot, int rows, RowStore& store) {
  const int lanes = static_cast<int>(hn::Lanes(D()));
  for (const auto& [cell, cell_end] : store.runs)
    for (int c = cell * rows; c < cell_end * rows; c += lanes) add_strip<robust, scores>(c, first_slot, rows, store);
}

// Values at lattice points along row j and j + 1, as a row of pixels (mean of both lattice rows, linear along x).
void expand_points(const std::vector<float>& values, const CellLattice& lattice, int j, float* out) {
  const float* a = values.data() + lattice.index(0, j);
  const float* b = values.data() + lattice.index(0, std::min(j + 1, lattice.ny - 1));
  for (int i = 0; i + 1 < lattice.nx; ++i) {
    const float left = 0.5f * (a[i] + b[i]), slope = (0.5f * (a[i + 1] + b[i + 1]) - left) / float(lattice.step);
    for (int o = 0; o < lattice.step; ++o) out[i * lattice.step + o] = left + slope * static_cast<float>(o);
  }
}

// Sums of one lattice row, from the rows of pixels already weighted along y.
void reduce_row(const float* pixels, std::ptrdiff_t stride, int planes, const CellLattice& lattice, float* const* out) {
  float share[most_step];
  for (int o = 0; o < lattice.step; ++o) share[o] = static_cast<float>(o) / static_cast<float>(lattice.step);
  for (int p = 0; p < planes; ++p) {
    const float* in = pixels + p * stride;
    float carried = 0;
    for (int i = 0; i + 1 < lattice.nx; ++i) {
      float here = 0, all = 0;
      for (int o = 0; o < lattice.step; ++o) {
        const float value = in[i * lattice.step + o];
        all += value;
        here += value * share[o];
      }
      out[p][i] = carried + (all - here);
      carried = here;
    }
    out[p][lattice.nx - 1] = carried;
  }
}

// Runs of cells that the rows first ... end - 1 need, with one more cell all round for the hats' and derivatives'
// reach.
void find_runs(const SumsInput& input, const CellLattice& lattice, int first, int end,
               std::vector<std::pair<int, int>>& runs) {
  runs.clear();
  const int cells = lattice.nx - 1;
  if (input.active == nullptr) {
    runs.emplace_back(0, cells);
    return;
  }
  constexpr int least_gap = 4;  // cells; shorter gaps are not worth a new run
  for (int i = 0; i < cells; ++i) {
    bool wanted = false;
    for (int j = std::max(0, first - 1); j <= std::min(end, lattice.ny - 2) && !wanted; ++j)
      for (int a = std::max(0, i - 1); a <= std::min(cells - 1, i + 1) && !wanted; ++a)
        wanted = (*input.active)[lattice.index(a, j)] != 0;
    if (!wanted) continue;
    if (!runs.empty() && i - runs.back().second < least_gap)
      runs.back().second = i + 1;
    else
      runs.emplace_back(i, i + 1);
  }
}

void sum_band(const SumsInput& input, int band, CellSums& sums, std::vector<float>& tail, RowStore& store) {
  const CellLattice& lattice = input.field->lattice();
  const int planes = input.scores ? int(CellSums::planes) : int(CellSums::basic), step = lattice.step;
  const int first = band * cell_rows_per_band, end = std::min(first + cell_rows_per_band, lattice.ny - 1);
  find_runs(input, lattice, first, end, store.runs);
  float weight[most_step][4];
  for (int o = 0; o < step; ++o) {
    const auto w = cubic_weights(static_cast<float>(o) / static_cast<float>(step));
    std::copy(w.begin(), w.end(), weight[o]);
  }
  std::fill(store.upper.begin(), store.upper.end(), 0.0f);
  const int top = lattice.y0 + first * step;
  if (store.runs.empty()) {
    for (int p = 0; p < planes; ++p) {
      std::fill_n(sums.plane[p].data() + lattice.index(0, first), (end - first) * lattice.nx, 0.0f);
      std::fill_n(tail.data() + p * lattice.nx, lattice.nx, 0.0f);
    }
    return;
  }
  const auto expand_illumination = [&](int j) {
    if (input.gain == nullptr) return;
    expand_points(*input.gain, lattice, j, store.line(store.gain));
    expand_points(*input.offset, lattice, j, store.line(store.offset));
  };
  expand_illumination(first);
  for (int k = -derivative_reach; k < derivative_reach; ++k)  // row top + k lies in slot k + reach
    warp_row(input, top + k, weight, (k + derivative_reach) % store.slots, store);
  for (int j = first; j < end; ++j) {
    expand_illumination(j);
    const int start = (j - first) * step;  // first row of pixels, counted from the band's top
    for (int k = 0; k < step; ++k) {
      const int ahead = start + k + derivative_reach;
      warp_row(input, top + ahead, weight, (ahead + derivative_reach) % store.slots, store);
    }
    std::fill(store.lower.begin(), store.lower.end(), 0.0f);
    const int slot = (start + derivative_reach) % store.slots;
    if (input.noise != nullptr) {
      expand_points(*input.noise, lattice, j, store.line(store.noise));
      expand_points(*input.tolerance, lattice, j, store.line(store.tolerance));
      input.scores ? add_products<true, true>(slot, step, store) : add_products<true, false>(slot, step, store);
    } else {
      input.scores ? add_products<false, true>(slot, step, store) : add_products<false, false>(slot, step, store);
    }
    float* out[CellSums::planes];
    for (int p = 0; p < planes; ++p) out[p] = sums.plane[p].data() + lattice.index(0, j);
    reduce_row(store.upper.data() + row_padding, store.stride, planes, lattice, out);
    std::swap(store.upper, store.lower);
  }
  float* out[CellSums::planes];
  for (int p = 0; p < planes; ++p) out[p] = tail.data() + p * lattice.nx;
  reduce_row(store.upper.data() + row_padding, store.stride, planes, lattice, out);
}

const char* target_name() { return lanes_name(); }

}  // namespace pivnp::piv::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::piv {

HWY_EXPORT(sum_band);
HWY_EXPORT(target_name);

void accumulate_sums(const SumsInput& input, int threads, CellSums& sums) {
  const CellLattice& lattice = input.field->lattice();
  const int planes = input.scores ? int(CellSums::planes) : int(CellSums::basic);
  sums.lattice = lattice;
  for (int p = 0; p < planes; ++p) sums.plane[p].resize(lattice.size());
  const int bands = (lattice.ny - 1 + cell_rows_per_band - 1) / cell_rows_per_band;
  std::vector<std::vector<float>> tails(static_cast<std::size_t>(bands));
#pragma omp parallel num_threads(threads)
  {
    RowStore store;
    store.prepare((lattice.nx - 1) * lattice.step, lattice.step, lattice.nx, planes);
#pragma omp for schedule(dynamic, 1)
    for (int band = 0; band < bands; ++band) {
      tails[std::size_t(band)].resize(std::size_t(planes) * std::size_t(lattice.nx));
      HWY_DYNAMIC_DISPATCH(sum_band)(input, band, sums, tails[std::size_t(band)], store);
    }
  }
  for (int band = 0; band < bands; ++band) {
    const int j = std::min((band + 1) * cell_rows_per_band, lattice.ny - 1);
    const bool last = j == lattice.ny - 1;  // no band starts there
    for (int p = 0; p < planes; ++p)
      for (int i = 0; i < lattice.nx; ++i) {
        float& sum = sums.plane[p][lattice.index(i, j)];
        const float more = tails[std::size_t(band)][std::size_t(p) * std::size_t(lattice.nx) + std::size_t(i)];
        sum = last ? more : sum + more;
      }
  }
}

const char* simd_target() { return HWY_DYNAMIC_DISPATCH(target_name)(); }

}  // namespace pivnp::piv
#endif
