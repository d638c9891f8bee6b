// Commands on finished records: compare two of them, report one again.
#include <algorithm>

#include "apps/study/outcome.hpp"
#include "apps/study/report_input.hpp"
#include "apps/study/study.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/io/record.hpp"

namespace pivnp::app {

namespace {

namespace fs = std::filesystem;

struct Side {
  fs::path file;
  std::string motion;
};

// "FILE" or "FILE:motion"; a colon inside a path that exists belongs to the path.
Side side_of(const std::string& text) {
  Side side{text, ""};
  const std::size_t colon = text.rfind(':');
  if (!fs::exists(side.file) && colon != std::string::npos) side = {text.substr(0, colon), text.substr(colon + 1)};
  if (fs::is_directory(side.file)) side.file /= "record.h5";
  return side;
}

std::unique_ptr<MotionSource> motion_of(const io::RecordReader& record, const Side& side) {
  const std::vector<std::string> names = record.motion_names();
  std::string known;
  for (const std::string& name : names) known += (known.empty() ? "" : ", ") + name;
  if (side.motion.empty() && names.size() != 1)
    throw InputError(side.file.string() + ": holds " + std::to_string(names.size()) + " motions (" + known +
                     "); name one as FILE:motion");
  const std::string name = side.motion.empty() ? names.front() : side.motion;
  if (std::find(names.begin(), names.end(), name) == names.end())
    throw InputError(side.file.string() + ": no motion '" + name + "'; it holds: " + known);
  return record.motion(name);
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

RunOutcome compare_records(const std::string& first, const std::string& second,
                           const compare::CompareOptions& options, const compare::LimitOptions& limits,
                           const RunSettings& settings, Progress& progress) {
  const Side sides[2] = {side_of(first), side_of(second)};
  const io::RecordReader a(sides[0].file), b(sides[1].file);
  const std::unique_ptr<MotionSource> one = motion_of(a, sides[0]), two = motion_of(b, sides[1]);
  compare::Comparison comparison = compare::compare(*one, *two, options, limits, progress);

  Case c;
  c.name = first + " against " + second;
  c.compare = options;
  c.limits = limits;
  const std::string first_name = one->name(), second_name = two->name() == one->name() ? two->name() + "_2" : two->name();
  io::RecordHead head = a.head();
  head.command = settings.command;
  head.case_text = write_case(c);
  io::RecordWriter writer(settings.out, head, false);
  copy_motion(*one, first_name, writer);
  copy_motion(*two, second_name, writer);
  writer.set_comparison(comparison_data(comparison, first_name, second_name));
  writer.finish();

  RunOutcome outcome;
  outcome.over_limit = comparison.over_limit;
  outcome.record = settings.out / "record.h5";
  write_report_of(c, outcome, std::move(comparison), nullptr, settings.out);
  return outcome;
}

RunOutcome report_record(const fs::path& given, const RunSettings& settings, Progress& progress) {
  const fs::path file = fs::is_directory(given) ? given / "record.h5" : given;
  RunOutcome outcome;
  outcome.record = file;
  Case c;
  std::unique_ptr<image::FrameSource> source;
  std::optional<compare::Comparison> comparison;
  {
    const io::RecordReader record(file);
    c = parse_case(record.head().case_text, file.string() + " (its case)", file.parent_path());
    if (settings.frames) {
      if (!c.frames) c.frames = image::FrameOptions{};
      c.frames->path = fs::absolute(*settings.frames).string();
    }
    if (c.frames && record.pair_count() > 0) {
      try {
        source = image::open_frames(*c.frames, c.folder);
      } catch (const InputError&) {
        outcome.remarks.push_back("The frames are not where the record says (" + c.frames->path +
                                  "): vectors are drawn without a picture; --frames names their new place.");
      }
    }
    if (const auto held = record.comparison())
      comparison = compare::compare(*record.motion(held->measured), *record.motion(held->simulated), c.compare,
                                    c.limits, progress);
  }
  const fs::path directory = settings.out.empty() ? file.parent_path() : settings.out;
  write_report_of(c, outcome, std::move(comparison), source.get(), directory);
  return outcome;
}

}  // namespace pivnp::app
