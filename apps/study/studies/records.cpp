#include "apps/study/studies/records.hpp"

#include <algorithm>
#include <cmath>

#include "apps/study/pipeline/record/opened_motion.hpp"
#include "apps/study/pipeline/record/outcome.hpp"
#include "apps/study/pipeline/record/remarks.hpp"
#include "apps/study/pipeline/record/report_input.hpp"
#include "apps/study/studies/histories.hpp"
#include "compare/metrics/limits.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::app {

namespace {

namespace fs = std::filesystem;

bool same_names(const std::vector<Frame>& a, const std::vector<Frame>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Frame& x, const Frame& y) { return x.name == y.name; });
}

void copy_motion(const MotionSource& motion, const std::string& name, io::RecordWriter& writer) {
  const std::string stage = "motion/" + name;
  writer.begin_motion(name, motion.particles());
  for (std::size_t k = 0; k < motion.times().size(); ++k) {
    writer.add_frame(name, motion.frame(k));
    if (writer.segment_full(stage)) writer.close_segment(stage, {});
  }
  writer.end_stage(stage, &motion.particles());
}

}  // namespace

RunOutcome compare_records(const CompareSources& sources, const compare::CompareOptions& given,
                           const compare::LimitOptions& limits, const RunSettings& settings, Progress& progress) {
  if (is_history(sources.first) || is_history(sources.second))
    return compare_histories(sources, given, limits, settings);
  const io::ImportOptions foreign{.step = sources.step_s, .length_unit = sources.length_unit};
  const OpenedMotion one = open_motion(sources.first, foreign), two = open_motion(sources.second, foreign);
  std::vector<OpenedMotion> coarser;
  compare::Refinement refinement{{}, sources.refinement_ratio};
  for (const std::string& text : sources.coarser) {
    coarser.push_back(open_motion(text, foreign));
    refinement.coarser.push_back(coarser.back().motion.get());
  }
  if (sources.coarser.empty() && !two.coarser.empty()) {
    refinement.ratio = mesh_study_ratio;
    for (const auto& motion : two.coarser) refinement.coarser.push_back(motion.get());
  }
  compare::CompareOptions options = given;
  add_camera(std::hypot(one.residual(), two.residual()), options);
  Comparison comparison =
      compare::compare(*one.motion, *two.motion, options, limits, progress, refinement, {one.note, two.note});

  const Case c = comparison_case(sources, options, limits);
  const std::string first_name = one.motion->name();
  const std::string second_name = two.motion->name() == first_name ? first_name + "_2" : two.motion->name();
  io::RecordHead head = one.head;
  head.length_unit = one.motion->length_unit();
  head.time_unit = one.motion->time_unit();
  head.command = settings.command;
  head.case_text = write_case(c);
  io::RecordWriter writer(settings.out, head, false, settings.threads);
  copy_motion(*one.motion, first_name, writer);
  copy_motion(*two.motion, second_name, writer);
  if (one.note) writer.set_strain_note(first_name, *one.note);
  if (two.note) writer.set_strain_note(second_name, *two.note);
  comparison.names = {first_name, second_name};
  return finish_comparison(c, std::move(comparison), writer, settings);
}

RunOutcome report_record(const fs::path& given, const RunSettings& settings, Progress& progress,
                         const std::function<void(report::ReportOptions&)>& change) {
  const fs::path file = fs::is_directory(given) ? given / "record.h5" : given;
  RunOutcome outcome;
  outcome.record = file;
  Case c;
  std::unique_ptr<image::FrameSource> source;
  std::optional<Comparison> comparison;
  {
    const io::RecordReader record(file);
    if (record.pair_count() > 0 && record.frames().empty())
      throw InputError(file.string() + ": /frames: is missing, but /piv holds " + std::to_string(record.pair_count()) +
                       " pairs of frames");
    c = parse_recorded_case(record.head().case_text, file.string() + " (its case)", file.parent_path());
    if (change) change(c.report);
    // A reader of the report need not know how keys were called when it was run: one line for all.
    if (c.notes.size() == 1) append({"Of the record's case: " + c.notes[0] + "."}, outcome.remarks);
    else if (!c.notes.empty())
      append({"The record's case has " + std::to_string(c.notes.size()) +
              " keys under former names, which were read as the keys that replace them."},
             outcome.remarks);
    if (settings.frames) {
      if (!c.frames) c.frames = image::FrameOptions{};
      c.frames->path = fs::absolute(*settings.frames).string();
    }
    if (c.frames && !c.frames->path.empty() && record.pair_count() > 0) {
      try {
        source = image::open_frames(*c.frames, c.folder);
        if (!same_names(source->frames(), record.frames())) {
          source.reset();
          append({"The frames at " + c.frames->path +
                  " are not those that were measured: vectors are drawn without a picture; --frames names their place."},
                 outcome.remarks);
        }
      } catch (const InputError&) {
        append({"The frames are not where the record says (" + c.frames->path +
                "): vectors are drawn without a picture; --frames names their new place."},
               outcome.remarks);
      }
    }
    if (auto held = record.comparison()) {
      const auto& [first, second] = held->names;
      if (is_history(first)) {
        comparison = std::move(held);
      } else {
        compare::CompareOptions options = c.compare;
        if (record.pair_count() > 0) add_camera(record.head().camera_residual, options);  // else it is in the case
        comparison = compare::compare(*record.motion(first), *record.motion(second), options, c.limits, progress, {},
                                      {record.strain_note(first), record.strain_note(second)});
        // Outlines, fields and curves are found again; the numbers are the record's: coarser grids and frames, which
        // some of them need, are not in it.
        comparison->metrics = std::move(held->metrics);
      }
      comparison->limits = compare::apply_limits(c.limits, comparison->metrics);
      outcome.limits = comparison->limits;
    }
  }
  const fs::path directory = settings.out.empty() ? file.parent_path() : settings.out;
  tell_record(c, outcome, std::move(comparison), source.get(), directory, true);
  return outcome;
}

std::vector<fs::path> export_record(const fs::path& given, const fs::path& out, io::ExportFormat format, const io::ExportOptions& options) {
  const fs::path file = fs::is_directory(given) ? given / "record.h5" : given;
  const io::RecordReader record(file);
  const fs::path directory = out.empty() ? file.parent_path() / "export" : out;
  fs::create_directories(directory);
  switch (format) {
    case io::ExportFormat::vtu: return io::export_vtu(record, options, directory);
    case io::ExportFormat::vtkhdf: return io::export_vtkhdf(record, options, directory);
    case io::ExportFormat::csv: break;
  }
  return io::export_csv(record, options, directory);
}

}  // namespace pivnp::app
