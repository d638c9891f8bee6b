#include "compare/alignment/partners.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <unordered_map>
#include <utility>

namespace pivnp::compare {

namespace {

std::string label_name(const ParticleSet& set, std::size_t p) {
  const std::int32_t label = p < set.label.size() ? set.label[p] : -1;
  const bool named = label >= 0 && std::size_t(label) < set.label_names.size();
  return named ? set.label_names[std::size_t(label)] : std::string();
}

// Group of each label name that particles of both data sets carry; every other name shares group 0.
std::unordered_map<std::string, int> shared_names(const ParticleSet& a, const ParticleSet& b) {
  std::unordered_map<std::string, int> names, shared;
  for (std::size_t p = 0; p < b.size(); ++p) names.emplace(label_name(b, p), 0);
  for (std::size_t p = 0; p < a.size(); ++p) {
    const std::string name = label_name(a, p);
    if (!name.empty() && names.contains(name)) shared.emplace(name, int(shared.size()) + 1);
  }
  return shared;
}

std::vector<int> groups_of(const ParticleSet& set, const std::unordered_map<std::string, int>& shared) {
  std::vector<int> group(set.size(), 0);
  for (std::size_t p = 0; p < set.size(); ++p) {
    const auto it = shared.find(label_name(set, p));
    if (it != shared.end()) group[p] = it->second;
  }
  return group;
}

// Places every wanted particle of `set` among the followed particles of `other`, group by group.
std::vector<Partner> interpolate(const DataSet& set, const std::vector<int>& group,
                                 const std::vector<std::uint8_t>& wanted, const DataSet& other,
                                 const std::vector<int>& other_group,
                                 const std::vector<std::uint8_t>& other_followed, int groups) {
  std::vector<Partner> partners(set.size());
  for (int g = 0; g < groups; ++g) {
    const auto asked = [&](std::size_t p) { return group[p] == g && wanted[p]; };
    bool any = false;
    for (std::size_t p = 0; p < set.size() && !any; ++p) any = asked(p);
    if (!any) continue;
    std::vector<int> index;
    std::vector<Vec2> points;
    std::vector<double> spacing;
    for (std::size_t q = 0; q < other.size(); ++q) {
      if (other_group[q] != g || !other_followed[q]) continue;
      index.push_back(int(q));
      points.push_back(other.material_position()[q]);
      spacing.push_back(other.spacing()[q]);
    }
    if (index.empty()) continue;
    const MaterialMesh mesh(std::move(points), std::move(spacing));
    for (std::size_t p = 0; p < set.size(); ++p) {
      if (!asked(p)) continue;
      auto found = mesh.find_natural(set.material_position()[p]);
      if (!found) continue;
      partners[p] = std::move(*found);
      partners[p].renumber(index);
    }
  }
  return partners;
}

double share(const std::vector<Partner>& partners) {
  return double(std::count_if(partners.begin(), partners.end(), has_partner)) / double(partners.size());
}

}  // namespace

PartnerState partner_state(const Partner& partner, const DataSetState& state) {
  PartnerState out{Vec2::Zero(), Mat2::Zero(), {0, 0, 0}, {0, 0, 0}};
  Vec2 curved = Vec2::Zero();  // half of what each particle's own gradient makes of its distance
  for (const Natural::Share& share : partner.shares) {
    const std::size_t q = std::size_t(share.point);
    const double w = share.weight;
    out.u += w * state.u[q];
    out.F += w * state.F[q];
    curved += 0.5 * w * ((state.F[q] - Mat2::Identity()) * share.from);
    if (!state.cov.empty())
      for (std::size_t c = 0; c < 3; ++c) out.cov[c] += w * state.cov[q][c];
    if (!state.cov_F.empty())
      for (std::size_t c = 0; c < 3; ++c) out.cov_F[c] += w * state.cov_F[q][c];
  }
  // F's own curvature; not where it would leave no material (beside a jump that the particles do not resolve).
  Mat2 F = out.F;
  for (const Natural::Term& term : partner.curving) F += term.weight * state.F[std::size_t(term.point)];
  if (F.determinant() > 0) out.F = F;
  // A data set that knows no gradient there (too few neighbours) gives its displacements as they are.
  if (curved.allFinite()) out.u += curved;
  if (partner.beyond != Vec2::Zero() && out.F.allFinite()) out.u += (out.F - Mat2::Identity()) * partner.beyond;
  return out;
}

Alignment::Alignment(const DataSet& first, const DataSet& second)
    : first_(first), second_(second), same_id_(first.size(), -1), second_followed_(second.state().followed) {
  const ParticleSet &a = first.motion().particles(), &b = second.motion().particles();
  const auto shared = shared_names(a, b);
  group_first_ = groups_of(a, shared);
  group_second_ = groups_of(b, shared);
  groups_ = int(shared.size()) + 1;
  decide();
  const std::vector<std::uint8_t>& wanted = first.state().followed;
  partners_ = find_partners(wanted);
  measure_coverage();
}

void Alignment::decide() {
  const ParticleSet &a = first_.motion().particles(), &b = second_.motion().particles();
  std::unordered_map<std::int64_t, int> place;
  for (std::size_t q = 0; q < b.size(); ++q) place.emplace(b.id[q], int(q));
  const double tolerance = 1e-6 * std::min(first_.median_spacing(), second_.median_spacing());
  std::size_t agree = 0, differ = 0;
  for (std::size_t p = 0; p < a.size(); ++p) {
    const auto it = place.find(a.id[p]);
    if (it == place.end()) continue;
    const Vec2 apart = first_.material_position()[p] - second_.material_position()[std::size_t(it->second)];
    same_id_[p] = it->second;
    ++(apart.norm() <= tolerance ? agree : differ);
  }
  by_identity_ = differ == 0 && 2 * agree >= std::min(a.size(), b.size());
}

std::vector<Partner> Alignment::find_partners(const std::vector<std::uint8_t>& wanted) const {
  if (!by_identity_)
    return interpolate(first_, group_first_, wanted, second_, group_second_, second_followed_, groups_);
  std::vector<Partner> partners(first_.size());
  for (std::size_t p = 0; p < first_.size(); ++p) {
    const int q = same_id_[p];
    if (wanted[p] && q >= 0 && second_followed_[std::size_t(q)] && group_first_[p] == group_second_[std::size_t(q)])
      partners[p] = Partner{{{q, 1.0, Vec2::Zero()}}, {}, Vec2::Zero()};
  }
  return partners;
}

void Alignment::measure_coverage() {
  coverage_first_ = share(partners_);
  if (!by_identity_) {
    coverage_second_ = share(interpolate(second_, group_second_, second_followed_, first_, group_first_,
                                         first_.state().followed, groups_));
    return;
  }
  const auto paired = std::count_if(partners_.begin(), partners_.end(), has_partner);
  coverage_second_ = double(paired) / double(second_.size());
}

void Alignment::update(const std::vector<std::uint8_t>& second_followed) {
  if (second_followed == second_followed_) return;
  second_followed_ = second_followed;
  std::vector<std::uint8_t> broken(first_.size());
  for (std::size_t p = 0; p < first_.size(); ++p) broken[p] = !partners_[p].rests_on(second_followed_);
  std::vector<Partner> renewed = find_partners(broken);
  for (std::size_t p = 0; p < first_.size(); ++p)
    if (broken[p]) partners_[p] = std::move(renewed[p]);
}

}  // namespace pivnp::compare
