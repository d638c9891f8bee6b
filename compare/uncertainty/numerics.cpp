#include "compare/uncertainty/numerics.hpp"

#include <algorithm>
#include <cmath>

#include "pivnp/core/error.hpp"

namespace pivnp::compare {

GridConvergence grid_convergence(double change_fine, double change_coarse, double ratio, double range) {
  GridConvergence g;
  if (std::isfinite(change_coarse)) {
    const double order = std::log(change_coarse / change_fine) / std::log(ratio);
    g.asymptotic = order >= 0.5 && order <= 2.1;  // a tenth for what is not quite the limit
    g.order = std::isfinite(order) ? std::clamp(order, 0.5, 2.0) : change_fine == 0 ? 2.0 : 0.5;
  }
  g.factor = g.asymptotic      ? 1.25 / (std::pow(ratio, g.order) - 1) / 1.15
             : change_fine > 0 ? std::max(range, change_fine) / change_fine
                               : 1;
  return g;
}

GridConvergence grid_convergence(const std::vector<double>& values, double ratio) {
  const double fine = values[0] - values[1];
  if (values.size() < 3) return grid_convergence(std::abs(fine), std::nan(""), ratio);
  const double coarse = values[1] - values[2];
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  GridConvergence g = grid_convergence(std::abs(fine), std::abs(coarse), ratio, *high - *low);
  if (fine * coarse > 0 || !g.asymptotic) return g;
  g.asymptotic = false;
  g.factor = (*high - *low) / std::abs(fine);
  return g;
}

namespace {

// The displacements of `motion` at the particles of the first, at `end`; NaN without a partner.
std::vector<Vec2> displacements_at(const DataSet& first, const MotionSource& motion, const CommonTimes& common,
                                   double end) {
  DataSet set(motion, common);
  Alignment alignment(first, set);
  const DataSetState& state = set.at(end);
  alignment.update(state.followed);
  std::vector<Vec2> u(first.size(), Vec2::Constant(std::nan("")));
  for (std::size_t p = 0; p < first.size(); ++p)
    if (has_partner(alignment.partners()[p])) u[p] = partner_state(alignment.partners()[p], state).u;
  return u;
}

}  // namespace

Numerics::Numerics(const Refinement& refinement, const DataSet& first, const DataSet& second,
                   const CommonTimes& common) {
  if (refinement.coarser.empty()) return;
  if (refinement.coarser.size() > 2)
    throw InputError("compare: found " + std::to_string(refinement.coarser.size()) +
                     " coarser simulations, expected one or two");
  if (!(refinement.ratio > 1)) throw InputError("compare: the ratio of grid spacings must be more than 1");
  const double end = common.times.back();
  std::vector<std::vector<Vec2>> u{displacements_at(first, second.motion(), common, end)};
  for (const MotionSource* motion : refinement.coarser) {
    if (motion->times().empty() || motion->times().back() < end - common.tolerance ||
        motion->times().front() > common.start + common.tolerance)
      throw InputError("compare: the coarser simulation '" + motion->name() + "' does not cover the times compared");
    u.push_back(displacements_at(first, *motion, common, end));
    sets_.push_back({std::make_unique<DataSet>(*motion, common), nullptr});
    sets_.back().alignment = std::make_unique<Alignment>(first, *sets_.back().set);
    if (sets_.back().alignment->coverage_first() == 0)
      throw InputError("compare: the coarser simulation '" + motion->name() + "' covers no particle of '" +
                       first.motion().name() + "'");
  }
  const bool three = u.size() > 2;
  double fine = 0, coarse = 0, whole = 0;
  for (std::size_t p = 0; p < first.size(); ++p) {
    const Vec2 f21 = u[0][p] - u[1][p], f32 = three ? Vec2(u[1][p] - u[2][p]) : Vec2(Vec2::Zero());
    if (!f21.allFinite() || !f32.allFinite()) continue;
    fine += f21.squaredNorm();
    coarse += f32.squaredNorm();
    whole += (f21 + f32).squaredNorm();
  }
  convergence_ = grid_convergence(std::sqrt(fine), three ? std::sqrt(coarse) : std::nan(""), refinement.ratio,
                                  std::sqrt(std::max(coarse, whole)));
}

const std::vector<Vec2>& Numerics::at(double time, const DataSetState& second, const std::vector<Partner>& partners) {
  if (sets_.empty()) return error_;
  const DataSetState& coarse = sets_[0].set->at(time);
  sets_[0].alignment->update(coarse.followed);
  error_.assign(partners.size(), Vec2::Constant(std::nan("")));
  Vec2 square = Vec2::Zero();
  std::size_t known = 0;
  for (std::size_t p = 0; p < partners.size(); ++p) {
    const Partner& other = sets_[0].alignment->partners()[p];
    if (!has_partner(partners[p]) || !has_partner(other)) continue;
    error_[p] = convergence_.factor * (partner_state(partners[p], second).u - partner_state(other, coarse).u);
    square += error_[p].cwiseAbs2();
    ++known;
  }
  // Where the coarser grid has no material: as large as the rest.
  const Vec2 rest = known > 0 ? Vec2((square / double(known)).cwiseSqrt()) : Vec2(Vec2::Zero());
  for (Vec2& e : error_)
    if (std::isnan(e.x())) e = rest;
  return error_;
}

}  // namespace pivnp::compare
