#include "compare/measures/numerics.hpp"

#include <algorithm>
#include <cmath>

#include "pivnp/core/error.hpp"

namespace pivnp::compare {

GridConvergence grid_convergence(double change_fine, double change_coarse, double ratio) {
  GridConvergence g;
  double safety = 3;
  if (std::isfinite(change_coarse)) {
    const double order = std::log(change_coarse / change_fine) / std::log(ratio);
    g.asymptotic = order >= 0.5 && order <= 2.1;  // a tenth for what is not quite the limit
    g.order = std::isfinite(order) ? std::clamp(order, 0.5, 2.0) : change_fine == 0 ? 2.0 : 0.5;
    if (g.asymptotic) safety = 1.25;
  }
  g.factor = safety / (std::pow(ratio, g.order) - 1) / 1.15;
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

Numerics::Numerics(const Refinement& refinement, const DataSet& first, const DataSet& second, const CommonTimes& common) {
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
  double fine = 0, coarse = 0;
  for (std::size_t p = 0; p < first.size(); ++p) {
    const Vec2 f21 = u[0][p] - u[1][p], f32 = three ? Vec2(u[1][p] - u[2][p]) : Vec2(Vec2::Zero());
    if (!f21.allFinite() || !f32.allFinite()) continue;
    fine += f21.squaredNorm();
    coarse += f32.squaredNorm();
  }
  convergence_ = grid_convergence(std::sqrt(fine), three ? std::sqrt(coarse) : std::nan(""), refinement.ratio);
}

const std::vector<Vec2>& Numerics::at(double time, const DataSetState& second, const std::vector<Partner>& partners) {
  if (sets_.empty()) return variance_;
  const DataSetState& coarse = sets_[0].set->at(time);
  sets_[0].alignment->update(coarse.followed);
  variance_.assign(partners.size(), Vec2::Constant(std::nan("")));
  Vec2 mean = Vec2::Zero();
  std::size_t known = 0;
  for (std::size_t p = 0; p < partners.size(); ++p) {
    const Partner& other = sets_[0].alignment->partners()[p];
    if (!has_partner(partners[p]) || !has_partner(other)) continue;
    const Vec2 change = partner_state(partners[p], second).u - partner_state(other, coarse).u;
    variance_[p] = (convergence_.factor * change).cwiseAbs2();
    mean += variance_[p];
    ++known;
  }
  // Where the coarser grid has no material: the mean of the rest.
  for (Vec2& v : variance_)
    if (std::isnan(v.x())) v = known > 0 ? Vec2(mean / double(known)) : Vec2(Vec2::Zero());
  return variance_;
}

}  // namespace pivnp::compare
