// Where the material of a group of pairs is in each of them.
#include <cmath>

#include "pivnp/piv/joint_smoothing.hpp"

namespace pivnp::piv {

SplineField JointSmoothing::spline(const Components& values) const {
  SplineField field;
  field.interpolate(lattice_, values.u, values.v, threads_);
  return field;
}

// How what is at rest moves in that pair, pixels of the level.
std::array<float, 2> JointSmoothing::at_rest(const HeldPair& pair, float x, float y) const {
  if (!pair.camera) return {0.0f, 0.0f};
  const std::array<double, 6>& a = pair.camera->rest;
  const double d = decimation_, X = origin_[0] + 0.5 * (d - 1) + d * double(x),
               Y = origin_[1] + 0.5 * (d - 1) + d * double(y);
  return {static_cast<float>((a[0] + a[1] * X + a[2] * Y) / d), static_cast<float>((a[3] + a[4] * X + a[5] * Y) / d)};
}

// Places of the reference lattice's material in every pair, from the middle of the group outward.
void JointSmoothing::find_paths(std::vector<HeldPair>& held) const {
  const int middle = static_cast<int>(held.size()) / 2;
  for (const int direction : {1, -1}) {
    Components place;
    place.resize(lattice_.size());
    each_point([&](int i, int j, std::size_t k) { place.u[k] = column(i), place.v[k] = row(j); });
    for (int n = direction > 0 ? middle : middle - 1; n >= 0 && n < static_cast<int>(held.size()); n += direction)
      follow(held[std::size_t(n)], static_cast<float>(direction), place);
  }
}

// One pair from its first frame to its second (sign 1) or back (-1).
void JointSmoothing::follow(HeldPair& pair, float sign, Components& place) const {
  constexpr int iterations = 3;
  const SplineField smooth = spline(pair.smooth), measured = spline(pair.measured);
  const float to_anchor = anchor_ == Anchor::central ? 0.5f * sign : sign > 0 ? 0.0f : -1.0f;
  pair.path.resize(lattice_.size()), pair.on_paths.resize(lattice_.size()), pair.known.resize(lattice_.size());
  pair.about.resize(lattice_.size());
  each_point([&](int, int, std::size_t k) {
    float x = place.u[k], y = place.v[k];
    std::array<float, 2> d = smooth.at(x, y);
    for (int n = 0; n < iterations && to_anchor != 0; ++n)
      x = place.u[k] + to_anchor * d[0], y = place.v[k] + to_anchor * d[1], d = smooth.at(x, y);
    pair.path.u[k] = x, pair.path.v[k] = y;
    const auto value = measured.at(x, y), rest = at_rest(pair, x, y);
    // A path that is lost (air, where a field may be anything) ends: one value that is no number would spread over
    // the lattice by the splines' recursion and the running sums.
    if (!std::isfinite(x + y + d[0] + d[1] + value[0] + value[1])) {
      pair.path.u[k] = column(int(k % std::size_t(lattice_.nx))),
      pair.path.v[k] = row(int(k / std::size_t(lattice_.nx)));
      pair.on_paths.u[k] = pair.on_paths.v[k] = pair.about.u[k] = pair.about.v[k] = 0, pair.known[k] = Source::lost;
      return;
    }
    const auto i = std::lround((x - column(0)) / static_cast<float>(lattice_.step)),
               j = std::lround((y - row(0)) / static_cast<float>(lattice_.step));
    const bool trusted = i >= 0 && j >= 0 && i < lattice_.nx && j < lattice_.ny &&
                         pair.trusted[lattice_.index(static_cast<int>(i), static_cast<int>(j))] != 0;
    pair.known[k] = trusted ? Source::measured : Source::smooth;
    const auto& from = trusted ? value : d;
    pair.on_paths.u[k] = from[0] - rest[0], pair.on_paths.v[k] = from[1] - rest[1];
    pair.about.u[k] = d[0] - rest[0], pair.about.v[k] = d[1] - rest[1];
    place.u[k] += sign * d[0], place.v[k] += sign * d[1];
  });
}

}  // namespace pivnp::piv
