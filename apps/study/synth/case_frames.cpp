#include "apps/study/synth/case_frames.hpp"

#include "apps/study/synth/drawn_frames.hpp"
#include "apps/study/synth/synthesize.hpp"

namespace pivnp::app {

namespace fs = std::filesystem;

std::unique_ptr<image::FrameSource> case_frames(Case& c, const RunSettings& settings, Progress& progress,
                                                const io::DirectoryLock* held) {
  const bool drawn = c.synth && !settings.frames && (!c.frames || c.frames->path.empty());
  if (!c.frames && !drawn && !settings.frames) return nullptr;
  if (!c.frames) c.frames = image::FrameOptions{};
  if (drawn) {
    const bool there = settings.resume && DrawnFrames(c, settings.out / "frames").complete();
    if (!there) synthesize(c, settings, progress, held);
    c.frames->path = fs::absolute(settings.out / "frames" / "frame_*.png").string();
    if (!c.frames->rate_hz) c.frames->rate_hz = 1.0;
  } else if (settings.frames && fs::is_directory(*settings.frames) && !c.frames->path.empty()) {
    // A folder: the case's own pattern is looked for in it.
    c.frames->path = (fs::absolute(*settings.frames) / fs::path(c.frames->path).filename()).string();
  } else {
    c.frames->path = fs::absolute(settings.frames ? fs::path(*settings.frames) : c.folder / c.frames->path).string();
  }
  return image::open_frames(*c.frames, c.folder);
}

}  // namespace pivnp::app
