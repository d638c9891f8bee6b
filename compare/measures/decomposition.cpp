#include "compare/measures/decomposition.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <unordered_map>

#include "compare/data/statistics.hpp"
#include "pivnp/core/particles/fields.hpp"

namespace pivnp::compare {

namespace {

constexpr std::size_t most_points = 20000;  // of more, an even choice stands for all

double mean_product(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0) / double(a.size());
}

double rms(const std::vector<double>& v) { return std::sqrt(mean_product(v, v)); }

double residual_rms(const std::vector<double>& field, const std::vector<double>& fit) {
  double sum = 0;
  for (std::size_t k = 0; k < field.size(); ++k) sum += (field[k] - fit[k]) * (field[k] - fit[k]);
  return std::sqrt(sum / double(field.size()));
}

// Share of the points in the largest group of neighbouring cells whose points are missed by more than `missed_by`.
double largest_cluster(const std::vector<Vec2>& x, const std::vector<double>& field, const std::vector<double>& fit,
                       double missed_by) {
  Vec2 lower = x[0], upper = x[0];
  for (const Vec2& p : x) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  const Vec2 size = upper - lower;
  const double cell = 1.5 * std::sqrt(std::max(size.prod(), 1e-12 * size.squaredNorm()) / double(x.size()));
  if (!(cell > 0)) return 0;
  std::unordered_map<std::int64_t, std::size_t> missed;  // points a cell
  const auto key = [](std::int64_t i, std::int64_t j) { return i * 4'000'000 + j; };
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (std::abs(field[k] - fit[k]) <= missed_by) continue;
    const Vec2 at = (x[k] - lower) / cell;
    ++missed[key(std::int64_t(at.x()), std::int64_t(at.y()))];
  }
  std::size_t most = 0;
  while (!missed.empty()) {
    std::vector<std::int64_t> todo{missed.begin()->first};
    std::size_t points = missed.begin()->second;
    missed.erase(missed.begin());
    while (!todo.empty()) {
      const std::int64_t here = todo.back();
      todo.pop_back();
      for (int dj = -1; dj <= 1; ++dj)
        for (int di = -1; di <= 1; ++di) {
          const auto it = missed.find(here + key(di, dj));
          if (it == missed.end()) continue;
          points += it->second;
          todo.push_back(it->first);
          missed.erase(it);
        }
    }
    most = std::max(most, points);
  }
  return double(most) / double(x.size());
}

}  // namespace

OrthonormalBasis::OrthonormalBasis(const std::vector<Vec2>& x) {
  if (x.empty()) return;
  Vec2 lower = x[0], upper = x[0];
  for (const Vec2& p : x) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  const Vec2 middle = (lower + upper) / 2;
  const Vec2 half = ((upper - lower) / 2).cwiseMax(1e-300);
  // Chebyshev polynomials of each coordinate: bounded, and far from parallel to each other.
  const auto chebyshev = [](int n, double t) { return std::cos(n * std::acos(std::clamp(t, -1.0, 1.0))); };
  const std::size_t most = std::min(most_terms, std::max<std::size_t>(1, x.size() / 4));
  for (int degree = 0; terms_.size() < most && degree <= 12; ++degree)
    for (int j = 0; j <= degree && terms_.size() < most; ++j) {
      std::vector<double> p;
      p.reserve(x.size());
      for (const Vec2& at : x) {
        const Vec2 t = (at - middle).cwiseQuotient(half);
        p.push_back(chebyshev(degree - j, t.x()) * chebyshev(j, t.y()));
      }
      const double before = rms(p);
      for (int pass = 0; pass < 2; ++pass)
        for (const std::vector<double>& q : terms_) {
          const double share = mean_product(p, q);
          for (std::size_t k = 0; k < p.size(); ++k) p[k] -= share * q[k];
        }
      const double after = rms(p);
      if (!(after > 1e-8 * before)) continue;
      for (double& v : p) v /= after;
      terms_.push_back(std::move(p));
      degree_.push_back(degree);
    }
}

std::vector<double> OrthonormalBasis::coefficients(const std::vector<double>& field) const {
  std::vector<double> s;
  for (const std::vector<double>& term : terms_) s.push_back(mean_product(field, term));
  return s;
}

std::vector<double> OrthonormalBasis::reconstruction(const std::vector<double>& s, std::size_t terms) const {
  std::vector<double> field(terms_.empty() ? 0 : terms_[0].size(), 0.0);
  for (std::size_t t = 0; t < terms; ++t)
    for (std::size_t k = 0; k < field.size(); ++k) field[k] += s[t] * terms_[t][k];
  return field;
}

double Decomposition::outside(double k) const {
  std::size_t count = 0;
  for (std::size_t c = 0; c < first.size(); ++c) count += std::abs(second[c] - first[c]) > k * uncertainty;
  return first.empty() ? not_known : double(count) / double(first.size());
}

Decomposition decompose(const OrthonormalBasis& basis, const std::vector<Vec2>& x, const std::vector<double>& first,
                        const std::vector<double>& second, double u, double accepted) {
  Decomposition d;
  d.first = basis.coefficients(first);
  d.second = basis.coefficients(second);
  // |field|^2 = sum of squares of all coefficients + residual^2: the terms needed follow without reconstructing.
  double left_first = mean_product(first, first), left_second = mean_product(second, second);
  std::size_t terms = 0;
  while (terms < basis.size()) {
    left_first -= d.first[terms] * d.first[terms];
    left_second -= d.second[terms] * d.second[terms];
    ++terms;
    const bool whole = terms == basis.size() || basis.degree(terms) != basis.degree(terms - 1);
    if (whole && left_first <= accepted * accepted && left_second <= accepted * accepted) break;
  }
  d.first.resize(terms);
  d.second.resize(terms);
  const std::vector<double> fit_first = basis.reconstruction(d.first, terms),
                            fit_second = basis.reconstruction(d.second, terms);
  d.residual_first = residual_rms(first, fit_first);
  d.residual_second = residual_rms(second, fit_second);
  d.cluster_first = largest_cluster(x, first, fit_first, std::max(3 * d.residual_first, accepted));
  d.cluster_second = largest_cluster(x, second, fit_second, std::max(3 * d.residual_second, accepted));
  d.adequate = d.cluster_first < 0.003 && d.cluster_second < 0.003;
  d.uncertainty = std::hypot(std::isfinite(u) ? u : 0, d.residual_first);
  return d;
}

std::string definition_of(const DecomposedField& field) {
  return " of " + std::string(field.symbol) +
         " at the last common time, by polynomials orthonormal on the compared particles (CEN CWA 16799)";
}

ComparisonTable table_of(const FieldDecomposition& f, const std::string& length_unit) {
  const std::string unit = unit_in(f.field.unit, length_unit, "");
  return {"decomposition_" + std::string(f.field.name),
          "coefficients" + definition_of(f.field) + "; band: 2 u(s)",
          {{std::string(name_of(DataSetRole::first)), unit, f.of.first},
           {std::string(name_of(DataSetRole::second)), unit, f.of.second},
           {"uncertainty", unit, std::vector<double>(f.of.first.size(), f.of.uncertainty)}}};
}

std::vector<FieldDecomposition> decompose_fields(const ComparedParticles& last, double u_dev) {
  struct Values {
    double u = 0;
    std::vector<double> first, second;
  };
  std::vector<Vec2> x;
  std::array<Values, decomposed_fields.size()> fields;
  auto& [ux, uy, dev] = fields;  // in the order of decomposed_fields
  dev.u = u_dev;
  const std::size_t stride = last.X.size() / most_points + 1;
  Vec2 variance = Vec2::Zero();
  for (std::size_t k = 0; k < last.X.size(); k += stride) {
    if (!std::isfinite(last.dev_first[k]) || !std::isfinite(last.dev_second[k])) continue;
    x.push_back(last.X[k]);
    ux.first.push_back(last.u_first[k].x());
    ux.second.push_back(last.u_second[k].x());
    uy.first.push_back(last.u_first[k].y());
    uy.second.push_back(last.u_second[k].y());
    dev.first.push_back(last.dev_first[k]);
    dev.second.push_back(last.dev_second[k]);
    variance += last.variance[k];
  }
  std::vector<FieldDecomposition> out;
  if (x.size() < 16) return out;
  ux.u = std::sqrt(variance.x() / double(x.size()));
  uy.u = std::sqrt(variance.y() / double(x.size()));
  const OrthonormalBasis basis(x);
  for (std::size_t f = 0; f < fields.size(); ++f) {
    const Values& v = fields[f];
    const double size = rms(v.first);
    if (size > 0)
      out.push_back({decomposed_fields[f], v.u, decompose(basis, x, v.first, v.second, v.u, 0.02 * size)});
  }
  return out;
}

}  // namespace pivnp::compare
