#include "compare/measures/pressures.hpp"

#include <algorithm>
#include <cmath>

namespace pivnp::compare {

namespace {

constexpr std::size_t most_values = std::size_t(1) << 24;  // of a field that is kept

bool knows_pressure(const MotionSource& motion) {
  if (motion.times().empty()) return false;
  const MotionFrame frame = motion.frame(0);
  const FieldValues* values = frame.find("pressure");
  return values != nullptr && values->values.size() == motion.particles().size();
}

}  // namespace

Pressures::Pressures(const DataSet& first, const DataSet& second, const std::vector<std::size_t>& paired, const CommonTimes& common)
    : motion_{&first.motion(), &second.motion()},
      tolerance_(common.tolerance),
      known_(knows_pressure(first.motion()) && knows_pressure(second.motion())),
      paired_(paired),
      most_times_(common.times.size()),
      kept_(std::clamp<std::size_t>(most_values / std::max<std::size_t>(1, paired.size()), 2, std::max<std::size_t>(2, most_times_))) {
  if (!known_) return;
  for (const std::size_t p : paired_) id_.push_back(first.motion().particles().id[p]);
}

const std::vector<float>& Pressures::frame(std::size_t set, std::size_t index) {
  Held& held = held_[set][index % 2];  // neighbours never share a place
  if (held.index != index) {
    const MotionFrame read = motion_[set]->frame(index);
    const FieldValues* values = read.find("pressure");
    held.values = values ? values->values : std::vector<float>();
    held.values.resize(motion_[set]->particles().size(), float(not_known));
    held.index = index;
  }
  return held.values;
}

std::vector<double> Pressures::at(std::size_t set, double time) {
  const std::vector<double>& t = motion_[set]->times();
  const auto after = std::upper_bound(t.begin(), t.end(), time + tolerance_);
  const std::size_t lower = std::size_t(std::max<std::ptrdiff_t>(0, after - t.begin() - 1));
  const bool between = time - t[lower] > tolerance_ && lower + 1 < t.size();
  const double w = between ? (time - t[lower]) / (t[lower + 1] - t[lower]) : 0;
  const std::vector<float>& a = frame(set, lower);
  std::vector<double> out(a.begin(), a.end());
  if (!between) return out;
  const std::vector<float>& b = frame(set, lower + 1);
  for (std::size_t p = 0; p < out.size(); ++p) out[p] += w * (double(b[p]) - out[p]);
  return out;
}

void Pressures::add(const DataSetState& first, const DataSetState& second, const std::vector<Partner>& partners) {
  if (!known_) return;
  const std::vector<double> a = at(0, first.time), b = at(1, second.time);
  const std::size_t k = added_++, n = most_times_ - 1, m = kept_ - 1;
  const bool keep = kept_ >= most_times_ || k == 0 || k * m / n != (k - 1) * m / n;
  if (keep) time_.push_back(first.time);
  last_ = {};
  for (const std::size_t p : paired_) {
    double difference = not_known;
    if (first.followed[p] && has_partner(partners[p])) {
      double other = 0;
      for (const Natural::Share& share : partners[p].shares) other += share.weight * b[std::size_t(share.point)];
      difference = other - a[p];
      if (std::isfinite(difference)) {
        total_.add(difference);
        last_.add(difference);
        greatest_[0] = std::max(greatest_[0], std::abs(a[p]));
        greatest_[1] = std::max(greatest_[1], std::abs(other));
      }
    }
    if (keep) values_.push_back(float(difference));
  }
}

std::optional<ComparisonField> Pressures::field() const {
  if (total_.count() == 0) return std::nullopt;
  return ComparisonField{"difference_pressure", "Pa", "pressure in the pores of the second minus that of the first", time_, id_, values_};
}

}  // namespace pivnp::compare
