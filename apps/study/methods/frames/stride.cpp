#include "apps/study/methods/frames/stride.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/image/frames/forwarded.hpp"

namespace pivnp::app {

namespace {

// Some of another source's frames.
class SomeFrames final : public image::ForwardedFrames {
 public:
  SomeFrames(std::unique_ptr<image::FrameSource> source, std::vector<int> used)
      : ForwardedFrames(std::move(source)), used_(std::move(used)) {
    for (const int k : used_) frames_.push_back(source_->frames()[std::size_t(k)]);
    const auto files = source_->files();
    const bool one_each = files.size() == source_->frames().size();
    if (!one_each)
      files_ = files;
    else
      for (const int k : used_) files_.push_back(files[std::size_t(k)]);
  }

  const std::vector<Frame>& frames() const override { return frames_; }
  std::vector<std::filesystem::path> files() const override { return files_; }
  Image read(int index) override { return source_->read(used_.at(std::size_t(index))); }

 private:
  std::vector<int> used_;
  std::vector<Frame> frames_;
  std::vector<std::filesystem::path> files_;
};

// Of the case's nodes those in the material, some 48 px apart.
piv::NodeLattice coarse_nodes(const Setting& setting) {
  constexpr double apart_px = 48;
  const int step = std::max(1, int(std::lround(apart_px / node_spacing_px(setting))));
  const piv::NodeLattice all = node_lattice(setting);
  piv::NodeLattice some;
  some.nx = (all.nx - 1) / step + 1;
  some.ny = (all.ny - 1) / step + 1;
  for (int j = 0; j < some.ny; ++j)
    for (int i = 0; i < some.nx; ++i) {
      some.pixel.push_back(all.pixel[setting.grid.node(i * step, j * step)]);
      const Vec2 x = setting.grid.position(i * step, j * step);
      some.on.push_back(std::any_of(setting.regions.begin(), setting.regions.end(),
                                    [&](const Region& r) { return r.polygon.contains(x); }));
    }
  return some;
}

struct CoarseMotion {
  double px = 0, valid = 0;
};

CoarseMotion coarse_motion(const piv::PixelVectors& found) {
  std::vector<double> moved;
  double asked = 0;
  for (std::size_t k = 0; k < found.status.size(); ++k) {
    if (found.status[k] == VectorStatus::masked) continue;
    ++asked;
    if (found.status[k] == VectorStatus::valid)
      moved.push_back(std::hypot(double(found.displacement[k][0]), double(found.displacement[k][1])));
  }
  if (moved.empty()) return {};
  const auto at = moved.begin() + std::ptrdiff_t(moved.size() * 9 / 10);
  std::nth_element(moved.begin(), at, moved.end());
  return {*at, double(moved.size()) / asked};
}

}  // namespace

std::vector<int> frames_by_motion(const Case& c, const Setting& setting, image::FrameSource& source, int threads,
                                  Progress& progress) {
  const double least = c.frames->least_motion_px;
  piv::PivOptions options;
  options.method = "fast";
  options.window_px = std::min(64, std::min(setting.width, setting.height));
  piv::PairCorrelator correlator(options, coarse_nodes(setting), setting.width, setting.height, threads);
  const int frames = int(source.frames().size());
  std::vector<int> used = {0};
  Image from = source.read(0), before;
  double usual = 0;  // share of vectors that are valid one frame on
  const auto moved = [&](const Image& to) {
    return coarse_motion(correlator.correlate(from.view(), to.view(), setting.mask.view()));
  };
  for (int k = 1; k < frames; ++k) {
    if (progress.stop_requested()) throw Interrupted();
    Image next = source.read(k);
    CoarseMotion motion = moved(next);
    if (k - used.back() > 1 && motion.valid < 0.5 * usual) {
      used.push_back(k - 1);
      from = std::move(before);
      motion = moved(next);
    }
    if (k - used.back() == 1) usual = std::max(motion.valid, 0.9 * usual);
    if (motion.px >= least || k + 1 == frames) {
      used.push_back(k);
      from = std::move(next);
      before = {};
    } else {
      before = std::move(next);
    }
    progress.update("motion of the frames", k, frames - 1);
  }
  return used;
}

std::unique_ptr<image::FrameSource> strided_by_motion(const Case& c, std::unique_ptr<image::FrameSource> source,
                                                      int threads, Progress& progress) {
  if (!source || !c.frames || !(c.frames->least_motion_px > 0) || source->frames().size() < 3) return source;
  std::vector<int> used =
      frames_by_motion(c, make_setting(c, source->width(), source->height()), *source, threads, progress);
  return std::make_unique<SomeFrames>(std::move(source), std::move(used));
}

std::vector<std::string> stride_remarks(const Case& c, std::size_t all, std::size_t used) {
  if (!c.frames || !(c.frames->least_motion_px > 0)) return {};
  return {"Of " + std::to_string(all) + " frames " + std::to_string(used) + " are used, so that steps move by " +
          number(c.frames->least_motion_px) + " px or more (frames.least_motion_px); the frames keep their times."};
}

}  // namespace pivnp::app
