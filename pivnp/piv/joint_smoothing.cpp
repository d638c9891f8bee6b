#include "pivnp/piv/joint_smoothing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "pivnp/core/grid/bends.hpp"
#include "pivnp/piv/dense/lattice_filter.hpp"
#include "pivnp/piv/dense/lost.hpp"
#include "pivnp/piv/dense/quality.hpp"
#include "pivnp/piv/dense/restored.hpp"

namespace pivnp::piv {

namespace {

constexpr int branches = 4;  // parts that a group of pairs is divided into, and these again
// Of the whole group's mean less is asked than of a pair: what it loses, every pair loses, while its noise partly
// cancels along the sum, consecutive pairs sharing a frame. Measured on bands of .05 to .5 px a step.
constexpr float group_caution = 0.45f;
// Pairs of a group from which what cells did not show is restored: bias adds up as their number, the noise of that as its root.
constexpr std::size_t restored_from = 16;

// In air a field may be anything: one sum without bound would be no number in the whole lattice's running sums.
float within_frames(float x) {
  constexpr float most = 1e3f;
  return x > -most ? std::min(x, most) : -most;
}

bool same(const CellLattice& a, const CellLattice& b) {
  return a.nx == b.nx && a.ny == b.ny && a.x0 == b.x0 && a.y0 == b.y0 && a.step == b.step;
}

}  // namespace

// A field of a group of pairs, what it adds to the variance of each of them, and the square of the bias that it leaves.
struct JointSmoothing::Field {
  Components value, variance, lost;
  // Of the errors that pairs share, summed over the groups within groups: their variance, and that times the number of
  // the group's first pair. The sum of k such errors has k^2 times their variance, to which the k-th adds 2 k - 1.
  Components shared, shared_from;
};

JointSmoothing::JointSmoothing(NodeLattice nodes, Anchor anchor, int threads)
    : nodes_(std::move(nodes)), anchor_(anchor), threads_(std::max(1, threads)) {}

void JointSmoothing::take(const PairCorrelator& pairs, bool first, HeldPair& pair) {
  const DenseField* field = pairs.field();
  if (field == nullptr) {
    together_ = false;
    return;
  }
  if (first) {
    if (shrinker_ == nullptr || !same(lattice_, field->lattice)) shrinker_ = std::make_unique<Shrinker>(field->lattice);
    lattice_ = field->lattice, decimation_ = field->decimation, origin_ = pairs.field_origin(),
    wanted_ = *field->wanted;
  }
  together_ =
      together_ && same(lattice_, field->lattice) && origin_ == pairs.field_origin() && wanted_ == *field->wanted;
  pair.measured = {field->u, field->v}, pair.smooth = {field->smooth_u, field->smooth_v};
  pair.variance = {field->variance_u, field->variance_v};
  pair.trusted = field->trusted;
  pair.vectors.path_factor.assign(pair.vectors.displacement.size(), 1.0f);
}

// The base, and what is left of value - base after shrinkage.
void JointSmoothing::smooth_departure(const Components& value, const Field& base, float caution,
                                      Components& out) const {
  SmoothedField smooth;
  std::vector<float> off(lattice_.size());
  out = base.value;
  for (const auto part : {&Components::u, &Components::v}) {
    for (std::size_t k = 0; k < off.size(); ++k) off[k] = (value.*part)[k] - (base.value.*part)[k];
    shrinker_->run(off, wanted_, threads_, smooth, caution);
    for (std::size_t k = 0; k < off.size(); ++k) (out.*part)[k] += smooth.value[k];
  }
}

// Adds what is left of value - base after shrinkage to the base, and `pairs_sharing` times its variance to the
// variance: an error that as many pairs share adds up along paths, and their errors are summed as if independent. Of
// what smoothing has lost, only what larger groups have not shown already. `first`: of these pairs. `restored`: what
// was shrunk holds what cells did not show, so that the risk of shrinkage is all that it is off by; else more is
// stated.
JointSmoothing::Field JointSmoothing::shrunk(const Components& value, const Field& base, float caution,
                                             float pairs_sharing, float first, bool restored) const {
  Field out = base;
  SmoothedField smooth;
  std::vector<float> off(lattice_.size()), lost;
  for (const auto part : {&Components::u, &Components::v}) {
    for (std::size_t k = 0; k < off.size(); ++k) off[k] = (value.*part)[k] - (base.value.*part)[k];
    shrinker_->run(off, wanted_, threads_, smooth, caution, restored);
    for (std::size_t k = 0; k < off.size(); ++k) {
      (out.value.*part)[k] += smooth.value[k];
      (out.variance.*part)[k] += pairs_sharing * smooth.variance[k];
      (out.shared.*part)[k] += smooth.variance[k];
      (out.shared_from.*part)[k] += first * smooth.variance[k];
      off[k] -= smooth.value[k];
    }
    lost_variance(lattice_, off, wanted_, threads_, lost);
    for (std::size_t k = 0; k < off.size(); ++k) {
      const float more = std::max(0.0f, lost[k] - (base.lost.*part)[k]);
      (out.variance.*part)[k] += pairs_sharing * more;
      (out.shared.*part)[k] += more;
      (out.shared_from.*part)[k] += first * more;
      (out.lost.*part)[k] += more;
    }
  }
  return out;
}

// Beside the material nothing is known: a jump there would be taken for structure, and for noise. What the material
// departs from the base by goes on there.
void JointSmoothing::depart_smoothly(const Field& base, const std::vector<std::uint8_t>& known,
                                     Components& values) const {
  for (const auto part : {&Components::u, &Components::v}) {
    std::vector<float>& value = values.*part;
    for (std::size_t k = 0; k < value.size(); ++k) value[k] = known[k] ? value[k] - (base.value.*part)[k] : 0.0f;
    continue_field(lattice_, known, value);
    for (std::size_t k = 0; k < value.size(); ++k) value[k] += (base.value.*part)[k];
  }
}

// What is still missing where the field of a group of so many pairs bends more sharply than cells show, to second order
// (a smoother takes off its width squared times the Laplacian, and restoration does not bring back all). All share it.
void JointSmoothing::state_bend(float pairs, Field& field) const {
  constexpr float share = 1.0f / 16;  // of the Laplacian, cells squared: measured on bands of tanh
  std::vector<std::array<float, 2>> missing(lattice_.size(), {0, 0});
  each_point([&](int i, int j, std::size_t k) {
    if (i == 0 || j == 0 || i == lattice_.nx - 1 || j == lattice_.ny - 1) return;
    const std::size_t above = lattice_.index(i, j - 1), below = lattice_.index(i, j + 1);
    const auto bent = [&](const std::vector<float>& f) {
      return share * (f[k - 1] + f[k + 1] + f[above] + f[below] - 4 * f[k]);
    };
    missing[k] = {bent(field.value.u), bent(field.value.v)};
  });
  sharpen_bends(lattice_.nx, lattice_.ny, missing);
  each_point([&](int, int, std::size_t k) {
    const float u = missing[k][0] * missing[k][0], v = missing[k][1] * missing[k][1];
    field.variance.u[k] += pairs * u, field.variance.v[k] += pairs * v;
    field.shared.u[k] += u, field.shared.v[k] += v;
  });
}

// What a part's motion is expected to be. Motion that begins, grows or stops keeps its shape and changes its size: of the group's
// field f, the structure g = f - mean(f) counts by 1 + a,
//   a = sum g . (y - Y) / sum g . Y   about each place,
// as far as that exceeds three of its standard deviations; Y, y: what cells show of the group and of the part. A base of the
// group's own size would leave motion of other times in the part, by what shrinkage takes off the difference.
JointSmoothing::Field JointSmoothing::grown(const Components& part, const Components& group, const Field& base) const {
  constexpr int reach = 3, sums_reach = 6;  // of mean(f), and of the sums
  constexpr float of_one_sum = float((2 * sums_reach + 1) * (2 * sums_reach + 1)) / 2.25f;  // independent of each other
  constexpr float squared_deviations = 9;
  const std::size_t size = lattice_.size();
  const auto structure = [&](std::vector<float>& values) {
    std::vector<float> means;
    for (float& value : values) value = within_frames(value);
    box_mean(lattice_, values, reach, means);
    for (std::size_t k = 0; k < size; ++k) values[k] -= means[k];
  };
  std::vector<float> gg(size), gd(size), gY(size), dd(size);
  Components g = base.value;
  for (const auto c : {&Components::u, &Components::v}) {
    std::vector<float> d(size), Y = group.*c;
    for (std::size_t k = 0; k < size; ++k) d[k] = (part.*c)[k] - Y[k];
    structure(g.*c), structure(d), structure(Y);
    for (std::size_t k = 0; k < size; ++k) {
      const float of_g = (g.*c)[k];
      gg[k] += of_g * of_g, gd[k] += of_g * d[k], gY[k] += of_g * Y[k], dd[k] += d[k] * d[k];
    }
  }
  for (std::vector<float>* sums : {&gg, &gd, &gY, &dd}) {
    const std::vector<float> at = *sums;
    box_mean(lattice_, at, sums_reach, *sums);
  }
  Field out = base;
  for (std::size_t k = 0; k < size; ++k) {
    if (!(gg[k] > 1e-12f && gY[k] > 0)) continue;
    const float left = std::max(dd[k] - gd[k] * gd[k] / gg[k], 1e-12f);
    const float clear = gd[k] * gd[k] * of_one_sum / (squared_deviations * left * gg[k]);
    const float by = gd[k] / gY[k] * clear * clear / (1 + clear * clear);
    for (const auto c : {&Components::u, &Components::v}) (out.value.*c)[k] += by * (g.*c)[k];
  }
  return out;
}

// Pairs begin ... end - 1, of which `of_group` is known on the reference lattice.
void JointSmoothing::divide(std::vector<HeldPair>& held, std::size_t begin, std::size_t end,
                            const Field& of_group, const Components& group_shown) const {
  if (end - begin == 1) {
    finish_pair(held[begin], begin, held.size(), of_group);
    return;
  }
  Components mean, about;
  mean.resize(lattice_.size()), about.resize(lattice_.size());
  std::vector<std::uint8_t> most(lattice_.size());
  // A pair that is not trusted at a place counts there by its smooth field, as long as most are: means of neighbours
  // over different pairs would differ by how the motion changes, which would be taken for noise.
  each_point([&](int, int, std::size_t k) {
    float u = 0, v = 0, about_u = 0, about_v = 0, count = 0;
    std::size_t measured = 0;
    for (std::size_t n = begin; n < end; ++n) {
      if (held[n].known[k] == Source::lost) continue;
      u += held[n].on_paths.u[k], v += held[n].on_paths.v[k], ++count;
      about_u += held[n].about.u[k], about_v += held[n].about.v[k];
      measured += held[n].known[k] == Source::measured;
    }
    most[k] = 2 * measured >= end - begin;
    if (most[k])
      mean.u[k] = u / count, mean.v[k] = v / count, about.u[k] = about_u / count, about.v[k] = about_v / count;
  });
  // What this tells of the group, no pair knew; its cells would have shown more of it.
  const bool whole = end - begin == held.size();
  const float caution = whole ? group_caution : 1.0f;
  const bool enough = held.size() >= restored_from;
  Components shown = mean;
  if (enough)
    for (const auto part : {&Components::u, &Components::v})
      restore_measured(lattice_, std::vector<float>(lattice_.size()), about.*part, most, threads_, shown.*part);
  depart_smoothly(of_group, most, shown);
  const Field base = whole || !enough ? of_group : grown(shown, group_shown, of_group);
  Components restored = mean, better;
  depart_smoothly(base, most, restored);
  for (int n = 0; n < (!enough ? 0 : whole ? 2 : 1); ++n) {
    smooth_departure(restored, base, caution, better);
    restored = mean;
    for (const auto part : {&Components::u, &Components::v})
      restore_measured(lattice_, better.*part, about.*part, most, threads_, restored.*part);
    depart_smoothly(base, most, restored);
  }
  Field field = shrunk(restored, base, caution, static_cast<float>(end - begin), static_cast<float>(begin), enough);
  if (whole && enough) state_bend(static_cast<float>(end - begin), field);
  const std::size_t parts = std::min<std::size_t>(branches, end - begin);
  for (std::size_t part = 0; part < parts; ++part)
    divide(held, begin + (end - begin) * part / parts, begin + (end - begin) * (part + 1) / parts, field, shown);
}

// How far a pair is to be believed to move as its group does, 0 ... 1: where it departs by more than the noise of its
// own cells, it knows better by itself (onset and arrest, flow that is not steady, paths that are wrong).
std::vector<float> JointSmoothing::steady_share(const HeldPair& pair, const Field& base, const Field& own) const {
  constexpr int reach = 2;
  std::vector<float> departure(lattice_.size()), noise(lattice_.size()), departures, noises;
  const auto square = [](float x) { return x * x; };
  for (std::size_t k = 0; k < lattice_.size(); ++k) {
    departure[k] = square(within_frames(own.value.u[k] - base.value.u[k])) + square(within_frames(own.value.v[k] - base.value.v[k]));
    noise[k] = square(within_frames(pair.measured.u[k] - pair.smooth.u[k])) +
               square(within_frames(pair.measured.v[k] - pair.smooth.v[k]));
  }
  box_mean(lattice_, departure, reach, departures);
  box_mean(lattice_, noise, reach, noises);
  for (std::size_t k = 0; k < lattice_.size(); ++k)
    departures[k] = 1 / (1 + square(departures[k] / std::max(noises[k], 1e-8f)));
  return departures;
}

// What a vector at the material's rim may be off by: its window holds texture on one side only, whose middle is beside
// it by some pixels, times the field's gradient. Zero inside. Pixels of the level.
Components JointSmoothing::rim_bias(const HeldPair& pair) const {
  constexpr int reach = 2;
  constexpr float weights[] = {1, 4, 6, 4, 1};
  Components out;
  out.resize(lattice_.size());
  const auto inside = [&](int i, int j) { return i >= 0 && j >= 0 && i < lattice_.nx && j < lattice_.ny; };
  const auto trusted = [&](int i, int j) { return inside(i, j) && pair.trusted[lattice_.index(i, j)] != 0; };
  each_point([&](int i, int j, std::size_t k) {
    out.u[k] = out.v[k] = 0;
    if (!pair.trusted[k]) return;
    float sum = 0, x = 0, y = 0;
    for (int b = -reach; b <= reach; ++b)
      for (int a = -reach; a <= reach; ++a) {
        if (!trusted(i + a, j + b)) continue;
        const float w = weights[a + reach] * weights[b + reach];
        sum += w;
        if (inside(i - a, j - b) && !trusted(i - a, j - b))
          x += w * static_cast<float>(a), y += w * static_cast<float>(b);
      }
    if (x == 0 && y == 0) return;
    const auto slope = [&](const std::vector<float>& f, int a, int b) {  // to the trusted neighbours
      const bool on = trusted(i + a, j + b), back = trusted(i - a, j - b);
      if (!on && !back) return 0.0f;
      return (f[on ? lattice_.index(i + a, j + b) : k] - f[back ? lattice_.index(i - a, j - b) : k]) /
             static_cast<float>(on + back);
    };
    out.u[k] = (x * slope(pair.smooth.u, 1, 0) + y * slope(pair.smooth.u, 0, 1)) / sum;
    out.v[k] = (x * slope(pair.smooth.v, 1, 0) + y * slope(pair.smooth.v, 0, 1)) / sum;
  });
  return out;
}

// The pair's own departure from what its group says, on its own lattice.
void JointSmoothing::finish_pair(HeldPair& pair, std::size_t place, std::size_t pairs, const Field& group_field) const {
  const auto doubled = static_cast<float>(2 * place + 1);
  Components along;  // what the pair adds to the variance of a path from the first pair on
  along.resize(lattice_.size());
  for (const auto part : {&Components::u, &Components::v})
    for (std::size_t k = 0; k < lattice_.size(); ++k)
      (along.*part)[k] = doubled * (group_field.shared.*part)[k] - 2 * (group_field.shared_from.*part)[k];
  constexpr int iterations = 6;
  constexpr float farthest =
      1e3f;  // pixels of the level; a group's field that is read so far off was read beyond its end
  Components carried;
  carried.resize(lattice_.size());
  each_point([&](int i, int j, std::size_t k) {
    carried.u[k] = pair.path.u[k] - column(i), carried.v[k] = pair.path.v[k] - row(j);
  });
  const SplineField way = spline(carried), known = spline(group_field.value), spread = spline(group_field.variance),
                    given_up = spline(group_field.lost), adding = spline(along);
  Field base;
  base.shared.resize(lattice_.size()), base.shared_from.resize(lattice_.size());
  base.value.resize(lattice_.size()), base.variance.resize(lattice_.size()), base.lost.resize(lattice_.size());
  each_point([&](int i, int j, std::size_t k) {
    float x = column(i), y = row(j);
    for (int n = 0; n < iterations; ++n) {
      const auto d = way.at(x, y);
      x = column(i) - d[0], y = row(j) - d[1];
    }
    const auto value = known.at(x, y), variance = spread.at(x, y), lost = given_up.at(x, y);
    const auto rest = at_rest(pair, column(i), row(j));
    const float apart =
        std::max(std::abs(value[0] + rest[0] - pair.smooth.u[k]), std::abs(value[1] + rest[1] - pair.smooth.v[k]));
    if (!std::isfinite(value[0] + value[1] + variance[0] + variance[1]) || !(apart < farthest)) {
      base.value.u[k] = pair.smooth.u[k], base.value.v[k] = pair.smooth.v[k];
      base.variance.u[k] = pair.variance.u[k], base.variance.v[k] = pair.variance.v[k];
      base.lost.u[k] = base.lost.v[k] = 0;
      along.u[k] = pair.variance.u[k], along.v[k] = pair.variance.v[k];
      return;
    }
    base.value.u[k] = value[0] + rest[0], base.value.v[k] = value[1] + rest[1];
    base.variance.u[k] = std::max(variance[0], 0.0f), base.variance.v[k] = std::max(variance[1], 0.0f);
    base.lost.u[k] = std::max(lost[0], 0.0f), base.lost.v[k] = std::max(lost[1], 0.0f);
    const auto path = adding.at(x, y);
    along.u[k] = std::max(path[0], 0.0f), along.v[k] = std::max(path[1], 0.0f);
  });
  Components own = pair.measured;
  depart_smoothly(base, pair.trusted, own);
  Field change = shrunk(own, base, 1, 1, 0, pairs >= restored_from);
  const std::vector<float> share = steady_share(pair, base, change);
  for (std::size_t k = 0; k < lattice_.size(); ++k) {
    along.u[k] = share[k] * (along.u[k] + change.variance.u[k] - base.variance.u[k] - pair.variance.u[k]);
    along.v[k] = share[k] * (along.v[k] + change.variance.v[k] - base.variance.v[k] - pair.variance.v[k]);
    change.value.u[k] = share[k] * (change.value.u[k] - pair.smooth.u[k]);
    change.value.v[k] = share[k] * (change.value.v[k] - pair.smooth.v[k]);
    change.variance.u[k] = share[k] * (change.variance.u[k] - pair.variance.u[k]);
    change.variance.v[k] = share[k] * (change.variance.v[k] - pair.variance.v[k]);
    if (std::isfinite(change.value.u[k] + change.value.v[k] + change.variance.u[k] + change.variance.v[k])) continue;
    change.value.u[k] = change.value.v[k] = change.variance.u[k] = change.variance.v[k] = 0;
  }
  const SplineField by = spline(change.value);
  const Components rim = rim_bias(pair);
  // It is the same in all pairs of the group that see the material's rim there.
  const auto all = static_cast<float>(pairs);
  const auto d = static_cast<float>(decimation_);
  const auto& pixel = pair.camera ? pair.camera->pixel : nodes_.pixel;
  // Pairs that move alike err alike by interpolation.
  const auto interpolation = [&](float moved) {
    const float off = interpolation_bias(decimation_) * std::sin(static_cast<float>(M_PI) * moved / d);
    return off * off;
  };
  for (std::size_t n = 0; n < pixel.size(); ++n) {
    auto& displacement = pair.vectors.displacement[n];
    if (!std::isfinite(displacement[0])) continue;
    const auto on_level = [&](std::size_t c) {
      return (pixel[n][c] - static_cast<float>(origin_[c]) - 0.5f * (d - 1)) / d;
    };
    const float x = on_level(0), y = on_level(1);
    const auto more = by.at(x, y);
    displacement[0] += d * more[0], displacement[1] += d * more[1];
    const auto nearest = [&](float at, float first, int points) {
      return std::clamp(static_cast<int>(std::lround((at - first) / static_cast<float>(lattice_.step))), 0, points - 1);
    };
    const std::size_t k = lattice_.index(nearest(x, column(0), lattice_.nx), nearest(y, row(0), lattice_.ny));
    auto& cov = pair.vectors.cov[n];
    const std::array<float, 2> before{cov[0], cov[1]},
        alike{interpolation(displacement[0]), interpolation(displacement[1])};
    const float path = std::max(0.0f, cov[0] + d * d * along.u[k]) + std::max(0.0f, cov[1] + d * d * along.v[k]) +
                       doubled * d * d * (rim.u[k] * rim.u[k] + rim.v[k] * rim.v[k]) +
                       (doubled - 1) * (alike[0] + alike[1]);
    // What else the covariance holds (truncation, interpolation) stays.
    cov[0] = changed_variance(cov[0], d * d * pair.variance.u[k], d * d * change.variance.u[k]);
    cov[1] = changed_variance(cov[1], d * d * pair.variance.v[k], d * d * change.variance.v[k]);
    cov[2] *= std::sqrt(cov[0] / before[0] * (cov[1] / before[1]));
    cov[0] += all * d * d * rim.u[k] * rim.u[k], cov[1] += all * d * d * rim.v[k] * rim.v[k],
        cov[2] += all * d * d * rim.u[k] * rim.v[k];
    cov[0] += (all - 1) * alike[0], cov[1] += (all - 1) * alike[1];
    if (const float factor = path / (cov[0] + cov[1]); std::isfinite(factor)) pair.vectors.path_factor[n] = factor;
  }
}

void JointSmoothing::run(std::vector<HeldPair>& held) {
  find_paths(held);
  const std::vector<float> zero(lattice_.size(), 0.0f);
  divide(held, 0, held.size(), {{zero, zero}, {zero, zero}, {zero, zero}, {zero, zero}, {zero, zero}}, {});
}

}  // namespace pivnp::piv
