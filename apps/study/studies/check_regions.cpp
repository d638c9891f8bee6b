#include "apps/study/studies/check_regions.hpp"

#include <algorithm>
#include <utility>

#include "apps/study/pipeline/measure/moving_regions.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/piv/piv.hpp"

namespace pivnp::app {

namespace {

constexpr double most_pixels = 4e8;  // some fifteen seconds of one core

}  // namespace

RegionsAlongFrames regions_along_frames(const Case& c, const Setting& setting, image::FrameSource& source, int threads, Progress& progress) {
  RegionsAlongFrames out;
  piv::PivOptions options = c.piv.value_or(piv::PivOptions{});
  const int frames = int(source.frames().size());
  MovingRegions regions(setting, options.window_px, options.follow_regions && !c.regions.empty());
  if (!regions.any() || frames < 2) return out;
  options.method = "fast", options.ensemble = 1;
  const piv::NodeLattice lattice = node_lattice(setting);
  piv::PairCorrelator correlator(options, lattice, setting.width, setting.height, threads);
  const int last = int(std::min(double(frames - 1), std::max(2.0, most_pixels / (double(setting.width) * double(setting.height)))));
  Image before = source.read(0);
  image::Mask mask_before = mask_of(setting, 0, before.view());
  before = prepared(setting, std::move(before));
  for (int k = 0; k < last; ++k) {
    if (progress.stop_requested()) throw Interrupted();
    Image after = source.read(k + 1);
    image::Mask mask_after = mask_of(setting, k + 1, after.view());
    after = prepared(setting, std::move(after));
    const bool masked = !mask_before.empty() && !mask_after.empty();
    const image::Mask mask = masked ? image::both(mask_before, mask_after) : image::Mask();
    const auto measured = [&] {
      return world_vectors(correlator.correlate(before.view(), after.view(), mask.view(), regions.mask()), lattice, setting, {k, k + 1});
    };
    regions.look(k, before.view(), after.view());
    VectorField field = measured();
    if (regions.revise(field, before.view(), after.view())) field = measured();
    if (k == 0) out.seen.push_back({0, regions.outlines()});
    regions.carry(field);
    if (!regions.any()) break;
    if (k + 1 == std::max(1, last / 2) || k + 1 == last)
      out.seen.push_back({k + 1, regions.outlines()});
    mask_before = std::move(mask_after);
    before = std::move(after);
    progress.update("regions", k + 1, last);
  }
  out.remarks = regions.remarks();
  if (last < frames - 1)
    out.remarks.push_back({"The regions were followed as far as " + source.frames()[std::size_t(last)].name + ", by `fast`; a run follows them to the end."});
  return out;
}

}  // namespace pivnp::app
