#include "pivnp/piv/sequence.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "pivnp/piv/dense/lattice_filter.hpp"
#include "pivnp/piv/dense/lost.hpp"
#include "pivnp/piv/dense/restored.hpp"
#include "pivnp/piv/dense/shrink.hpp"
#include "pivnp/piv/method.hpp"

namespace pivnp::piv {

namespace {

constexpr int branches = 4;  // parts that a group of pairs is divided into, and these again
// Of the whole group's mean less is asked than of a pair: what it loses, every pair loses, while its noise partly
// cancels along the sum, consecutive pairs sharing a frame. Measured on bands of .05 to .5 px a step.
constexpr float group_caution = 0.45f;

// Two components at the points of a lattice.
struct Components {
  std::vector<float> u, v;
  void resize(std::size_t count) { u.resize(count), v.resize(count); }
};

// A field of a group of pairs, what it adds to the variance of each of them, and the square of the bias that it leaves.
struct GroupField {
  Components value, variance, lost;
  // Of the errors that pairs share, summed over the groups within groups: their variance, and that times the number of the
  // group's first pair. The sum of k such errors has k^2 times their variance, to which the k-th adds 2 k - 1.
  Components shared, shared_from;
};

// What is known of a place of the material in a pair.
enum class Source : std::uint8_t { lost, smooth, measured };

struct HeldPair {
  PixelVectors vectors;
  Components measured, smooth, variance;
  std::vector<std::uint8_t> trusted;
  Components on_paths;               // `measured` where the material of the reference lattice is, `smooth` where it is not trusted
  Components about;                  // `smooth` there, about which it was measured
  std::vector<Source> known;         // of these
  Components path;                   // place of that material at the vectors' instant, pixels of the level
  std::optional<CameraStep> camera;
};

bool same(const CellLattice& a, const CellLattice& b) {
  return a.nx == b.nx && a.ny == b.ny && a.x0 == b.x0 && a.y0 == b.y0 && a.step == b.step;
}

std::size_t valid(const PixelVectors& vectors) {
  return std::size_t(std::count(vectors.status.begin(), vectors.status.end(), VectorStatus::valid));
}

float column(const CellLattice& lattice, int i) { return static_cast<float>(lattice.x0 + i * lattice.step); }
float row(const CellLattice& lattice, int j) { return static_cast<float>(lattice.y0 + j * lattice.step); }

}  // namespace

struct SequenceCorrelator::Impl {
  PairCorrelator pairs;
  NodeLattice nodes;
  Anchor anchor;
  double window_px;
  int threads;
  std::vector<HeldPair> held;
  CellLattice lattice;
  int decimation = 1;
  std::array<int, 2> origin{0, 0};
  std::vector<std::uint8_t> wanted;
  bool together = true;  // all pairs held have fields on one lattice
  std::unique_ptr<Shrinker> shrinker;

  Impl(const PivOptions& options, NodeLattice given, int width, int height, int thread_count)
      : pairs(options, given, width, height, thread_count),
        nodes(std::move(given)),
        anchor(options.anchor),
        window_px(options.window_px),
        threads(std::max(1, thread_count)) {}

  void take_field(HeldPair& pair) {
    const DenseField* field = pairs.field();
    if (field == nullptr) {
      together = false;
      return;
    }
    if (held.empty()) {
      if (shrinker == nullptr || !same(lattice, field->lattice)) shrinker = std::make_unique<Shrinker>(field->lattice);
      lattice = field->lattice, decimation = field->decimation, origin = pairs.field_origin(), wanted = *field->wanted;
    }
    together = together && same(lattice, field->lattice) && origin == pairs.field_origin() && wanted == *field->wanted;
    pair.measured = {field->u, field->v}, pair.smooth = {field->smooth_u, field->smooth_v};
    pair.variance = {field->variance_u, field->variance_v};
    pair.trusted = field->trusted;
    pair.vectors.path_factor.assign(pair.vectors.displacement.size(), 1.0f);
  }

  // Vectors of the pair before that this one has not found.
  static std::size_t lost(const PixelVectors& before, const PixelVectors& now) {
    std::size_t count = 0;
    for (std::size_t k = 0; k < now.status.size(); ++k)
      count += before.status[k] == VectorStatus::valid && (now.status[k] == VectorStatus::rejected || now.status[k] == VectorStatus::replaced);
    return count;
  }
  std::size_t nodes_in_window() const {
    const double across = window_px / std::max(1.0, double(node_spacing(nodes)));
    return std::max<std::size_t>(4, std::size_t(across * across));
  }

  template <class Function>
  void each_point(Function function) const {
#pragma omp parallel for num_threads(threads) schedule(static)
    for (int j = 0; j < lattice.ny; ++j)
      for (int i = 0; i < lattice.nx; ++i) function(i, j, lattice.index(i, j));
  }

  SplineField spline(const Components& values) const {
    SplineField field;
    field.interpolate(lattice, values.u, values.v, threads);
    return field;
  }

  // How what is at rest moves in that pair, pixels of the level.
  std::array<float, 2> at_rest(const HeldPair& pair, float x, float y) const {
    if (!pair.camera) return {0.0f, 0.0f};
    const std::array<double, 6>& a = pair.camera->rest;
    const double d = decimation, X = origin[0] + 0.5 * (d - 1) + d * double(x), Y = origin[1] + 0.5 * (d - 1) + d * double(y);
    return {static_cast<float>((a[0] + a[1] * X + a[2] * Y) / d), static_cast<float>((a[3] + a[4] * X + a[5] * Y) / d)};
  }

  // Places of the reference lattice's material in every pair, from the middle of the group outward.
  void find_paths() {
    const int middle = static_cast<int>(held.size()) / 2;
    for (const int direction : {1, -1}) {
      Components place;
      place.resize(lattice.size());
      each_point([&](int i, int j, std::size_t k) { place.u[k] = column(lattice, i), place.v[k] = row(lattice, j); });
      for (int n = direction > 0 ? middle : middle - 1; n >= 0 && n < static_cast<int>(held.size()); n += direction)
        follow(held[std::size_t(n)], static_cast<float>(direction), place);
    }
  }

  // One pair from its first frame to its second (sign 1) or back (-1).
  void follow(HeldPair& pair, float sign, Components& place) const {
    constexpr int iterations = 3;
    const SplineField smooth = spline(pair.smooth), measured = spline(pair.measured);
    const float to_anchor = anchor == Anchor::central ? 0.5f * sign : sign > 0 ? 0.0f : -1.0f;
    pair.path.resize(lattice.size()), pair.on_paths.resize(lattice.size()), pair.known.resize(lattice.size());
    pair.about.resize(lattice.size());
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
        pair.path.u[k] = column(lattice, int(k % std::size_t(lattice.nx))), pair.path.v[k] = row(lattice, int(k / std::size_t(lattice.nx)));
        pair.on_paths.u[k] = pair.on_paths.v[k] = pair.about.u[k] = pair.about.v[k] = 0, pair.known[k] = Source::lost;
        return;
      }
      const auto i = std::lround((x - column(lattice, 0)) / static_cast<float>(lattice.step)),
                 j = std::lround((y - row(lattice, 0)) / static_cast<float>(lattice.step));
      const bool trusted = i >= 0 && j >= 0 && i < lattice.nx && j < lattice.ny &&
                           pair.trusted[lattice.index(static_cast<int>(i), static_cast<int>(j))] != 0;
      pair.known[k] = trusted ? Source::measured : Source::smooth;
      const auto& from = trusted ? value : d;
      pair.on_paths.u[k] = from[0] - rest[0], pair.on_paths.v[k] = from[1] - rest[1];
      pair.about.u[k] = d[0] - rest[0], pair.about.v[k] = d[1] - rest[1];
      place.u[k] += sign * d[0], place.v[k] += sign * d[1];
    });
  }

  // The base, and what is left of value - base after shrinkage.
  void smooth_departure(const Components& value, const GroupField& base, float caution, Components& out) const {
    SmoothedField smooth;
    std::vector<float> off(lattice.size());
    out = base.value;
    for (const auto part : {&Components::u, &Components::v}) {
      for (std::size_t k = 0; k < off.size(); ++k) off[k] = (value.*part)[k] - (base.value.*part)[k];
      shrinker->run(off, wanted, threads, smooth, caution);
      for (std::size_t k = 0; k < off.size(); ++k) (out.*part)[k] += smooth.value[k];
    }
  }

  // Adds what is left of value - base after shrinkage to the base, and `pairs_sharing` times its variance to the variance: an
  // error that as many pairs share adds up along paths, and their errors are summed as if independent. Of what smoothing has
  // lost, only what larger groups have not shown already. `first`: of these pairs.
  GroupField shrunk(const Components& value, const GroupField& base, float caution, float pairs_sharing,
                    float first) const {
    GroupField out = base;
    SmoothedField smooth;
    std::vector<float> off(lattice.size()), lost;
    for (const auto part : {&Components::u, &Components::v}) {
      for (std::size_t k = 0; k < off.size(); ++k) off[k] = (value.*part)[k] - (base.value.*part)[k];
      shrinker->run(off, wanted, threads, smooth, caution);
      for (std::size_t k = 0; k < off.size(); ++k) {
        (out.value.*part)[k] += smooth.value[k];
        (out.variance.*part)[k] += pairs_sharing * smooth.variance[k];
        (out.shared.*part)[k] += smooth.variance[k];
        (out.shared_from.*part)[k] += first * smooth.variance[k];
        off[k] -= smooth.value[k];
      }
      lost_variance(lattice, off, wanted, threads, lost);
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

  // Beside the material nothing is known: a jump there would be taken for structure, and for noise. What the material departs from
  // the base by goes on there.
  void depart_smoothly(const GroupField& base, const std::vector<std::uint8_t>& known, Components& values) const {
    for (const auto part : {&Components::u, &Components::v}) {
      std::vector<float>& value = values.*part;
      for (std::size_t k = 0; k < value.size(); ++k) value[k] = known[k] ? value[k] - (base.value.*part)[k] : 0.0f;
      continue_field(lattice, known, value);
      for (std::size_t k = 0; k < value.size(); ++k) value[k] += (base.value.*part)[k];
    }
  }

  // Pairs begin ... end - 1, of which `base` is known on the reference lattice.
  void divide(std::size_t begin, std::size_t end, const GroupField& base) {
    if (end - begin == 1) {
      finish_pair(held[begin], base);
      return;
    }
    Components mean, about;
    mean.resize(lattice.size()), about.resize(lattice.size());
    std::vector<std::uint8_t> most(lattice.size());
    // A pair that is not trusted at a place counts there by its smooth field, as long as most are: means of neighbours over
    // different pairs would differ by how the motion changes, which would be taken for noise.
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
      if (most[k]) mean.u[k] = u / count, mean.v[k] = v / count, about.u[k] = about_u / count, about.v[k] = about_v / count;
    });
    // What this tells of the group, no pair knew; its cells would have shown more of it.
    const bool whole = end - begin == held.size();
    const float caution = whole ? group_caution : 1.0f;
    Components restored = mean, better;
    depart_smoothly(base, most, restored);
    for (int n = 0; n < (whole ? 2 : 1); ++n) {
      smooth_departure(restored, base, caution, better);
      restored = mean;
      for (const auto part : {&Components::u, &Components::v})
        restore_measured(lattice, better.*part, about.*part, most, threads, restored.*part);
      depart_smoothly(base, most, restored);
    }
    const GroupField field = shrunk(restored, base, caution, static_cast<float>(end - begin), static_cast<float>(begin));
    const std::size_t parts = std::min<std::size_t>(branches, end - begin);
    for (std::size_t part = 0; part < parts; ++part)
      divide(begin + (end - begin) * part / parts, begin + (end - begin) * (part + 1) / parts, field);
  }

  // How far a pair is to be believed to move as its group does, 0 ... 1: where it departs by more than the noise of its
  // own cells, it knows better by itself (onset and arrest, flow that is not steady, paths that are wrong).
  std::vector<float> steady_share(const HeldPair& pair, const GroupField& base, const GroupField& own) const {
    constexpr int reach = 2;
    std::vector<float> departure(lattice.size()), noise(lattice.size()), departures, noises;
    const auto square = [](float x) { return x * x; };
    // In air a field may be anything: one sum without bound would be no number in the whole lattice's running sums.
    constexpr float most = 1e6f;
    const auto bounded = [](float x) { return x < most ? x : most; };
    for (std::size_t k = 0; k < lattice.size(); ++k) {
      departure[k] = bounded(square(own.value.u[k] - base.value.u[k]) + square(own.value.v[k] - base.value.v[k]));
      noise[k] = bounded(square(pair.measured.u[k] - pair.smooth.u[k]) + square(pair.measured.v[k] - pair.smooth.v[k]));
    }
    box_mean(lattice, departure, reach, departures);
    box_mean(lattice, noise, reach, noises);
    for (std::size_t k = 0; k < lattice.size(); ++k)
      departures[k] = 1 / (1 + square(departures[k] / std::max(noises[k], 1e-8f)));
    return departures;
  }

  // What a vector at the material's rim may be off by: its window holds texture on one side only, whose middle is beside it by
  // some pixels, times the field's gradient. Zero inside. Pixels of the level.
  Components rim_bias(const HeldPair& pair) const {
    constexpr int reach = 2;
    constexpr float weights[] = {1, 4, 6, 4, 1};
    Components out;
    out.resize(lattice.size());
    const auto inside = [&](int i, int j) { return i >= 0 && j >= 0 && i < lattice.nx && j < lattice.ny; };
    const auto trusted = [&](int i, int j) { return inside(i, j) && pair.trusted[lattice.index(i, j)] != 0; };
    each_point([&](int i, int j, std::size_t k) {
      out.u[k] = out.v[k] = 0;
      if (!pair.trusted[k]) return;
      float sum = 0, x = 0, y = 0;
      for (int b = -reach; b <= reach; ++b)
        for (int a = -reach; a <= reach; ++a) {
          if (!trusted(i + a, j + b)) continue;
          const float w = weights[a + reach] * weights[b + reach];
          sum += w;
          if (inside(i - a, j - b) && !trusted(i - a, j - b)) x += w * static_cast<float>(a), y += w * static_cast<float>(b);
        }
      if (x == 0 && y == 0) return;
      const auto slope = [&](const std::vector<float>& f, int a, int b) {  // to the trusted neighbours
        const bool on = trusted(i + a, j + b), back = trusted(i - a, j - b);
        if (!on && !back) return 0.0f;
        return (f[on ? lattice.index(i + a, j + b) : k] - f[back ? lattice.index(i - a, j - b) : k]) / static_cast<float>(on + back);
      };
      out.u[k] = (x * slope(pair.smooth.u, 1, 0) + y * slope(pair.smooth.u, 0, 1)) / sum;
      out.v[k] = (x * slope(pair.smooth.v, 1, 0) + y * slope(pair.smooth.v, 0, 1)) / sum;
    });
    return out;
  }

  // The pair's own departure from what its group says, on its own lattice.
  void finish_pair(HeldPair& pair, const GroupField& group_field) {
    const auto doubled = static_cast<float>(2 * (&pair - held.data()) + 1);
    Components along;  // what the pair adds to the variance of a path from the first pair on
    along.resize(lattice.size());
    for (const auto part : {&Components::u, &Components::v})
      for (std::size_t k = 0; k < lattice.size(); ++k)
        (along.*part)[k] = doubled * (group_field.shared.*part)[k] - 2 * (group_field.shared_from.*part)[k];
    constexpr int iterations = 6;
    constexpr float farthest = 1e3f;  // pixels of the level; a group's field that is read so far off was read beyond its end
    Components carried;
    carried.resize(lattice.size());
    each_point([&](int i, int j, std::size_t k) {
      carried.u[k] = pair.path.u[k] - column(lattice, i), carried.v[k] = pair.path.v[k] - row(lattice, j);
    });
    const SplineField way = spline(carried), known = spline(group_field.value), spread = spline(group_field.variance),
                      given_up = spline(group_field.lost), adding = spline(along);
    GroupField base;
    base.shared.resize(lattice.size()), base.shared_from.resize(lattice.size());
    base.value.resize(lattice.size()), base.variance.resize(lattice.size()), base.lost.resize(lattice.size());
    each_point([&](int i, int j, std::size_t k) {
      float x = column(lattice, i), y = row(lattice, j);
      for (int n = 0; n < iterations; ++n) {
        const auto d = way.at(x, y);
        x = column(lattice, i) - d[0], y = row(lattice, j) - d[1];
      }
      const auto value = known.at(x, y), variance = spread.at(x, y), lost = given_up.at(x, y);
      const auto rest = at_rest(pair, column(lattice, i), row(lattice, j));
      const float apart = std::max(std::abs(value[0] + rest[0] - pair.smooth.u[k]), std::abs(value[1] + rest[1] - pair.smooth.v[k]));
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
    GroupField change = shrunk(own, base, 1, 1, 0);
    const std::vector<float> share = steady_share(pair, base, change);
    for (std::size_t k = 0; k < lattice.size(); ++k) {
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
    const auto all = static_cast<float>(held.size());
    const auto d = static_cast<float>(decimation);
    const auto& pixel = pair.camera ? pair.camera->pixel : nodes.pixel;
    for (std::size_t n = 0; n < pixel.size(); ++n) {
      auto& displacement = pair.vectors.displacement[n];
      if (!std::isfinite(displacement[0])) continue;
      const auto on_level = [&](std::size_t c) {
        return (pixel[n][c] - static_cast<float>(origin[c]) - 0.5f * (d - 1)) / d;
      };
      const float x = on_level(0), y = on_level(1);
      const auto more = by.at(x, y);
      displacement[0] += d * more[0], displacement[1] += d * more[1];
      const auto nearest = [&](float at, float first, int points) {
        return std::clamp(static_cast<int>(std::lround((at - first) / static_cast<float>(lattice.step))), 0, points - 1);
      };
      const std::size_t k = lattice.index(nearest(x, column(lattice, 0), lattice.nx), nearest(y, row(lattice, 0), lattice.ny));
      auto& cov = pair.vectors.cov[n];
      const std::array<float, 2> before{cov[0], cov[1]};
      const float path = std::max(0.0f, cov[0] + d * d * along.u[k]) + std::max(0.0f, cov[1] + d * d * along.v[k]) +
                         doubled * d * d * (rim.u[k] * rim.u[k] + rim.v[k] * rim.v[k]);
      // What else the covariance holds (truncation, interpolation) stays.
      cov[0] += d * d * change.variance.u[k], cov[1] += d * d * change.variance.v[k];
      cov[2] *= std::sqrt(cov[0] / before[0] * (cov[1] / before[1]));
      cov[0] += all * d * d * rim.u[k] * rim.u[k], cov[1] += all * d * d * rim.v[k] * rim.v[k], cov[2] += all * d * d * rim.u[k] * rim.v[k];
      if (const float factor = path / (cov[0] + cov[1]); std::isfinite(factor)) pair.vectors.path_factor[n] = factor;
    }
  }
};

int SequenceCorrelator::group_for(const PivOptions& options, std::size_t nodes, int width, int height) {
  constexpr double memory = 800e6, bytes_a_cell = 44, bytes_a_node = 26;  // measured
  const double cell = options.window_px / 4.0;
  const double pair = bytes_a_cell * double(width) * double(height) / (cell * cell) + bytes_a_node * double(nodes);
  return std::clamp(int(memory / pair), 8, group);
}

SequenceCorrelator::SequenceCorrelator(const PivOptions& options, NodeLattice lattice, int width, int height,
                                       int threads)
    : impl_(std::make_unique<Impl>(options, std::move(lattice), width, height, threads)) {}

SequenceCorrelator::~SequenceCorrelator() = default;

void SequenceCorrelator::add(const ImageView& first, const ImageView& second, const MaskView& mask,
                             const CameraStep* camera, const MaskView& material) {
  HeldPair pair;
  if (camera != nullptr) {
    impl_->pairs.place(camera->pixel, impl_->held.empty());
    pair.camera = *camera;
  }
  pair.vectors = impl_->pairs.correlate(first, second, mask, material);
  impl_->take_field(pair);
  // A pair that lost a window's worth of the vectors of the pair before, where windows were drawn to a false peak, is searched again
  // from there; the better of both counts.
  if (const PixelVectors* before = impl_->held.empty() ? nullptr : &impl_->held.back().vectors;
      before != nullptr && impl_->lost(*before, pair.vectors) >= impl_->nodes_in_window()) {
    HeldPair again;
    again.camera = pair.camera;
    again.vectors = impl_->pairs.correlate(first, second, mask, material, before);
    impl_->take_field(again);
    if (valid(again.vectors) >= valid(pair.vectors) + impl_->nodes_in_window()) pair = std::move(again);
  }
  impl_->held.push_back(std::move(pair));
}

const PixelVectors& SequenceCorrelator::last() const { return impl_->held.back().vectors; }

void SequenceCorrelator::drop_last() {
  impl_->held.pop_back();
  if (impl_->held.empty()) impl_->together = true;
}

int SequenceCorrelator::held() const { return static_cast<int>(impl_->held.size()); }

std::vector<PixelVectors> SequenceCorrelator::finish() {
  if (impl_->together && impl_->held.size() > 1) {
    impl_->find_paths();
    const std::vector<float> zero(impl_->lattice.size(), 0.0f);
    impl_->divide(0, impl_->held.size(), {{zero, zero}, {zero, zero}, {zero, zero}, {zero, zero}, {zero, zero}});
  }
  std::vector<PixelVectors> out;
  for (HeldPair& pair : impl_->held) out.push_back(std::move(pair.vectors));
  impl_->held.clear();
  impl_->together = true;
  return out;
}

}  // namespace pivnp::piv
