#include "apps/study/studies/run.hpp"

#include <algorithm>
#include <cmath>

#include "apps/study/methods/levelling.hpp"
#include "apps/study/methods/peak_locking.hpp"
#include "apps/study/methods/stages.hpp"
#include "apps/study/methods/strain_floor.hpp"
#include "apps/study/pipeline/measure.hpp"
#include "apps/study/pipeline/outcome.hpp"
#include "apps/study/pipeline/report_input.hpp"
#include "apps/study/synth/case_frames.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::app {

namespace {

namespace fs = std::filesystem;

io::RecordHead head_of(const Case& c, const RunSettings& settings, const Setting& setting, bool seconds) {
  io::RecordHead head;
  head.command = settings.command;
  head.case_text = write_case(c);
  head.length_unit = setting.camera.length_unit();
  head.time_unit = seconds ? "s" : "frame";
  head.grid = setting.grid;
  head.world_from_pixel = setting.camera.world_from_pixel();
  head.camera_residual = setting.camera.residual();
  if (c.camera.metres_per_pixel) head.metres_per_pixel = c.camera.metres_per_pixel;
  return head;
}

std::vector<double> output_times(const Case& c, const std::vector<Frame>& frames) {
  std::vector<double> times;
  const double end = c.mpm->end_s.value_or(frames.empty() ? 0.0 : frames.back().time);
  if (c.mpm->output_rate_hz) {
    const auto count = std::int64_t(std::floor(end * *c.mpm->output_rate_hz + 1e-9));
    for (std::int64_t k = 0; k <= count; ++k) times.push_back(double(k) / *c.mpm->output_rate_hz);
  } else {
    for (const Frame& frame : frames)
      if (frame.time <= end * (1 + 1e-12)) times.push_back(frame.time);
  }
  if (times.size() < 2)
    throw InputError((c.file.empty() ? c.name : c.file.string()) +
                     ": mpm: nothing to simulate; give end_s and output_rate_hz, or frames");
  return times;
}

// Particles against material points, as the case asks.
Comparison compare_motions(const Case& c, const Setting& setting, const RunSettings& settings,
                           image::FrameSource& source, const std::vector<Frame>& frames,
                           const io::RecordWriter& writer, const StrainNote& note, Progress& progress) {
  compare::CompareOptions options = c.compare;
  add_camera(setting.camera.residual(), options);
  const auto np = writer.motion("np"), mpm = writer.motion("mpm");
  Comparison comparison = compare::compare(*np, *mpm, options, c.limits, progress, {}, {note, {}});
  if (c.compare.levelling)
    add_levelled(c, setting, settings, source, frames, writer, *np, *mpm, note, options, comparison, progress);
  return comparison;
}

}  // namespace

RunOutcome run_case(const Case& given, const RunSettings& settings, Stages stages, Progress& progress) {
  Case c = given;
  const bool measures = stages != Stages::simulate && (c.frames || c.synth || settings.frames);
  const bool tracks = measures && stages != Stages::piv;
  const bool simulates = c.mpm && (stages == Stages::all || stages == Stages::simulate);
  if (!measures && !simulates)
    throw InputError((c.file.empty() ? c.name : c.file.string()) + ": nothing to do: neither frames nor [mpm]");

  std::error_code failed;
  fs::create_directories(settings.out, failed);
  if (failed) throw RunError(settings.out.string() + ": " + failed.message());

  std::unique_ptr<image::FrameSource> source;
  std::vector<Frame> frames;
  if (measures || c.frames) {
    source = image::prefetched(case_frames(c, settings, progress));
    frames = source->frames();
    if (measures && frames.size() < 2)
      throw InputError(c.frames->path + ": found 1 frame, expected at least 2 to measure motion");
  }
  const Setting setting = make_setting(c, source ? source->width() : 0, source ? source->height() : 0);
  io::RecordWriter writer(settings.out, head_of(c, settings, setting, !source || source->has_rate()),
                          settings.resume, settings.threads);

  if (tracks) check_strain_floor(c, setting, frames.size());

  RunOutcome outcome;
  TrackOutcome tracked;
  if (measures) {
    measure(c, setting, *source, writer, settings.threads, progress);
    frames = flagged_frames(std::move(frames), writer);
    writer.set_frames(frames);
    outcome.remarks = texture_remarks(setting, source->read(0));
    for (std::string& remark :
         fraction_remarks(setting, frames.size() - 1, [&](std::size_t k) { return writer.pair(k); }))
      outcome.remarks.push_back(std::move(remark));
    const ClosureNote closure = check_closure(
        c, setting, *source, [&](int k) { return writer.pair(std::size_t(k)); }, settings.threads, progress);
    writer.set_closure(closure);
    for (std::string& remark : closure_remarks(closure, setting)) outcome.remarks.push_back(std::move(remark));
    if (tracks) tracked = track(c, setting, frames, *source, closure, writer, settings.threads, progress);
  }
  if (simulates)
    for (std::string& remark : simulate(c, setting, output_times(c, frames), writer, settings.threads, progress))
      outcome.remarks.push_back(std::move(remark));
  writer.set_output_fields(c.output.fields_stored);

  std::optional<Comparison> comparison;
  StrainNote note;
  writer.pack();
  if (tracks) {
    const auto motion = writer.motion("np");
    const bool central = !c.piv || c.piv->anchor == Anchor::central;
    note = strain_note(c, setting, *motion, central);
    writer.set_strain_note("np", note);
  }
  std::string not_compared;  // why; what was measured and simulated is kept and reported all the same
  if (tracks && simulates) {
    try {
      comparison = compare_motions(c, setting, settings, *source, frames, writer, note, progress);
      writer.set_comparison(*comparison);
      outcome.limits = comparison->limits;
    } catch (const InputError& error) {
      not_compared = error.what();
      outcome.remarks.push_back("Not compared: " + not_compared + ".");
    }
  }
  writer.finish();

  outcome.record = settings.out / "record.h5";
  for (std::string& remark : remarks_on_tracking(tracked, frames)) outcome.remarks.push_back(std::move(remark));
  write_report_of(c, outcome, std::move(comparison), source.get(), settings.out);
  if (!not_compared.empty())
    throw InputError(not_compared + " (" + outcome.record.string() + " and its report are written without a comparison)");
  return outcome;
}

}  // namespace pivnp::app
