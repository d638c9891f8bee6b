// Frames that the tests of the window work on: grains under a uniform motion, drawn once a process.
#pragma once

#include <filesystem>

#include "apps/case/case.hpp"
#include "apps/study/pipeline/scene/settings.hpp"
#include "apps/study/studies/run.hpp"
#include "apps/study/synth/synthesize.hpp"
#include "pivnp/core/progress.hpp"
#include "tests/support/scratch.hpp"

namespace pivnp::test {

constexpr int drawn_width = 240, drawn_height = 176, drawn_frames = 5;

/// A folder with frames/frame_*.png: 0.8 px to the right and 0.3 px up a frame, and a little shear.
inline const std::filesystem::path& drawn_shear() {
  static const Scratch scratch;
  static const std::filesystem::path folder = [] {
    const app::Case c = app::parse_case(
        "[synth]\nmotion = \"affine\"\nwidth_px = 240\nheight_px = 176\nframes = 5\nshift_px_per_frame = [0.8, 0.3]\n"
        "gradient_per_frame = [0.0, 0.004, 0.0, 0.0]\n[synth.texture]\nseed = 7\n",
        "drawn", scratch.path);
    SilentProgress silent;
    app::RunSettings settings;
    settings.out = scratch.path;
    settings.threads = 1;
    app::synthesize(c, settings, silent);
    return scratch.path / "frames";
  }();
  return folder;
}

/// A finished record of them, without a simulation; `frames` may lie elsewhere by the time it is read.
inline std::filesystem::path measured_record(const std::filesystem::path& frames, const std::filesystem::path& out) {
  const app::Case c = app::parse_case("[frames]\npath = \"" + (frames / "*.png").string() +
                                          "\"\nrate_hz = 10.0\n[camera]\nmetres_per_pixel = 2e-4\n[piv]\nmethod = \"fft\"\nwindow_px = 32\n",
                                      "measured", ".");
  SilentProgress silent;
  app::RunSettings settings;
  settings.out = out;
  settings.threads = 1;
  settings.report = false;
  return app::run_case(c, settings, app::Stages::track, silent).record;
}

}  // namespace pivnp::test
