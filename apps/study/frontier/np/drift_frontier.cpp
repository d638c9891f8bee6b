#include "apps/study/frontier/np/drift_frontier.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/study/frontier/work.hpp"
#include "apps/study/methods/paths/tracking.hpp"
#include "apps/study/synth/truth.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/image/synthetic/synthetic.hpp"
#include "pivnp/np/tracker.hpp"

namespace pivnp::app {

namespace {

constexpr int side_px = 320, block_px = 128, drift_frames = 25;

// A motion that stays in the frame, the blobs that it carries, and their vectors.
struct DriftScene {
  Case c;
  Setting setting;
  AffineMotion motion;
  std::vector<Frame> frames;
  std::vector<Image> images;
  std::vector<VectorField> vectors;
};

AffineMotion motion_of(const Followed& followed) {
  AffineMotion m;
  const double room = 0.25 * side_px / (drift_frames - 1);  // to either side of the block
  m.A(0, 1) = std::min(followed.slope, 0.5 / (drift_frames - 1));
  m.shift = Vec2(std::min(followed.shift, room), 0.1 * std::min(followed.shift, room));
  m.centre = Vec2(0.3 * side_px, 0.5 * side_px);
  return m;
}

DriftScene draw(const np::NpOptions& base, const piv::PivOptions& piv, const Followed& followed) {
  const int spacing = std::max(4, int(std::lround(followed.spacing)));
  const double left = 0.3 * side_px - block_px / 2.0, low = 0.5 * side_px - block_px / 2.0;
  const auto at = [](double x, double y) { return "[" + number(x) + ", " + number(y) + "]"; };
  DriftScene s;
  s.c = parse_case("[frames]\npath = \"\"\n[grid]\nspacing_px = " + std::to_string(spacing) + "\n[region.block]\npolygon_px = [" + at(left, low) + ", " +
                       at(left + block_px, low) + ", " + at(left + block_px, low + block_px) + ", " + at(left, low + block_px) + "]\n",
                   "the frames of np.drift", ".");
  s.c.piv = piv;
  s.c.np = base;
  s.c.np->reseed = false;
  s.setting = make_setting(s.c, side_px, side_px);
  s.motion = motion_of(followed);
  // Blobs far beyond the frame too: what enters it must be there from the first.
  constexpr double beyond = side_px;
  image::TextureOptions texture;
  texture.noise = 0.02;
  texture.seed = 977;
  const image::BlobRenderer renderer(texture, side_px, side_px);
  std::vector<Vec2> blobs;
  const double wide = side_px + 2 * beyond;
  for (std::uint64_t n = 0; n < std::uint64_t(wide * wide * texture.density_per_px); ++n)
    blobs.push_back(Vec2(wide * uniform(31, 2 * n), wide * uniform(31, 2 * n + 1)) - Vec2(beyond, beyond));
  for (int k = 0; k < drift_frames; ++k) {
    std::vector<Vec2> px;
    for (Vec2& x : blobs) {
      if (k > 0) x = s.motion.next(x);
      px.push_back(s.setting.camera.to_pixel(x));
    }
    s.images.push_back(renderer.draw(px, k, drift_frames));
    s.frames.push_back({.name = "", .time = double(k)});
  }
  return s;
}

Image copy_of(const Image& from) {
  Image copy(from.width(), from.height(), from.depth(), from.white());
  std::copy_n(from.view().data, from.stride() * from.height(), reinterpret_cast<std::byte*>(copy.row<std::uint8_t>(0)));
  return copy;
}

struct DriftChoice {
  std::string name, keys;
  np::DriftScheme scheme;
  int interval;
};

std::vector<DriftChoice> drift_choices(const np::NpOptions& base) {
  using enum np::DriftScheme;
  std::vector<DriftChoice> all = {{"summed increments", "np.drift=none", none, base.drift_interval}};
  std::vector<int> intervals = {5, 10, 20};
  if (base.drift == corrected && std::find(intervals.begin(), intervals.end(), base.drift_interval) == intervals.end()) intervals.push_back(base.drift_interval);
  for (const int n : intervals)
    all.push_back({"corrected every " + std::to_string(n) + " frames", "np.drift=corrected np.drift_interval=" + std::to_string(n), corrected, n});
  all.push_back({"leapfrog", "np.drift=leapfrog", leapfrog, base.drift_interval});
  all.push_back({"reference update", "np.drift=reference_update", reference_update, base.drift_interval});
  return all;
}

}  // namespace

FrontierStage drift_frontier(const np::NpOptions& base, const piv::PivOptions& piv, const Followed& followed, int repeats, int threads, Progress& progress) {
  DriftScene s = draw(base, piv, followed);
  const piv::NodeLattice nodes = node_lattice(s.setting);
  piv::PairCorrelator correlator(piv, nodes, side_px, side_px, threads);
  for (int k = 0; k + 1 < drift_frames; ++k) {
    progress.update("frames of np.drift", k, drift_frames - 1);
    if (progress.stop_requested()) throw Interrupted();
    s.vectors.push_back(world_vectors(correlator.correlate(s.images[std::size_t(k)].view(), s.images[std::size_t(k) + 1].view(), {}), nodes, s.setting, {k, k + 1}));
  }
  const Measured vectors{plan_steps(s.frames), [&](const TrackStep& step) { return s.vectors[std::size_t(step.from)]; },
                         [&](int k) { return copy_of(s.images[std::size_t(k)]); }};
  FrontierStage stage;
  stage.name = "drift";
  stage.title = "Numerical particles: drift";
  stage.made_of = std::to_string(drift_frames) + " drawn frames (3 px blobs, noise of 2 %), carried by a shear of " + number(100 * s.motion.A(0, 1), 2) + " % and a shift of " +
                  number(s.motion.shift.norm(), 2) + " px from frame to frame; all schemes follow the same vectors.";
  stage.error_label = "error of the path at the end, rms (px)";
  stage.time_label = "time of following per frame (ms)";
  stage.time_unit = 1e-3;
  stage.columns = {{"greatest_px", "greatest (px)", "greatest error of any particle"}, {"followed", "followed", "share of the particles followed to the end"}};
  const np::NpOptions plain;
  const std::vector<DriftChoice> all_choices = drift_choices(base);
  const std::int64_t total = std::int64_t(all_choices.size()) * repeats;
  std::int64_t done = 0;
  for (const DriftChoice& choice : all_choices) {
    Case c = s.c;
    c.np->drift = choice.scheme;
    c.np->drift_interval = choice.interval;
    FrontierPoint p;
    p.name = choice.name, p.keys = choice.keys;
    p.standard = choice.scheme == plain.drift;
    p.own = followed.of_case && choice.scheme == base.drift && (choice.scheme != np::DriftScheme::corrected || choice.interval == base.drift_interval);
    double square = 0, greatest = 0, n = 0, all = 0;
    SilentProgress unseen;
    const auto follow_it = [&](bool score) {
      follow(c, s.setting, s.frames, vectors, threads, unseen, [&](std::size_t step, const np::Tracker& tracker) {
        if (!score || step + 1 != std::size_t(drift_frames)) return;
        const auto state = tracker.state();
        for (std::size_t q = 0; q < state.size(); ++q, ++all) {
          if (!alive(state[q].status)) continue;
          const double miss = (state[q].x - s.motion.at(tracker.particles().x0[q], drift_frames - 1)).norm();
          square += miss * miss, ++n;
          greatest = std::max(greatest, miss);
        }
      });
    };
    const Effort work = measured(threads, [&] { follow_it(true); });
    std::vector<double> seconds;
    for (int again = 0; again < repeats; ++again) {
      progress.update("schemes of np.drift", done++, total);
      if (progress.stop_requested()) throw Interrupted();
      seconds.push_back(seconds_of(threads, [&] { follow_it(false); }) / (drift_frames - 1));
    }
    set_times(seconds, p);
    p.bytes = work.bytes, p.instructions = work.instructions;
    p.error = std::sqrt(square / n);
    p.columns = {greatest, n / all};
    stage.points.push_back(std::move(p));
  }
  find_front(stage.points);
  return stage;
}

}  // namespace pivnp::app
