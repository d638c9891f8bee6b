#include "apps/study/studies/check.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <utility>

#include "apps/report/figures/check_figure.hpp"
#include "apps/study/methods/frames/camera_motion.hpp"
#include "apps/study/methods/frames/exposure.hpp"
#include "apps/study/methods/frames/filters.hpp"
#include "apps/study/methods/frames/peak_locking.hpp"
#include "apps/study/methods/frames/stride.hpp"
#include "apps/study/methods/paths/strain_floor.hpp"
#include "apps/study/methods/simulation/doubts.hpp"
#include "apps/study/pipeline/measure/imported_vectors.hpp"
#include "apps/study/pipeline/measure/measure.hpp"
#include "apps/study/pipeline/measure/shutter.hpp"
#include "apps/study/pipeline/scene/placed.hpp"
#include "apps/study/pipeline/scene/scene.hpp"
#include "apps/study/pipeline/scene/simulation_scene.hpp"
#include "apps/study/pipeline/scene/sizes.hpp"
#include "apps/study/pipeline/scene/zones.hpp"
#include "apps/study/studies/check_regions.hpp"
#include "apps/study/synth/case_frames.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/region.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/image/files/write.hpp"
#include "pivnp/image/rectify.hpp"

namespace pivnp::app {

namespace {

std::vector<Vec2> circle(const std::vector<double>& c) {
  std::vector<Vec2> out;
  for (int k = 0; k < 72; ++k) {
    const double a = 2 * std::numbers::pi * k / 72;
    out.emplace_back(c[0] + c[2] * std::cos(a), c[1] + c[2] * std::sin(a));
  }
  return out;
}

// Frames that are drawn for the check alone, and the folders above them that were not there before: gone with it,
// unless something else has come into them.
class DrawnFrames {
 public:
  explicit DrawnFrames(const std::filesystem::path& out) : folder_(out / "check_frames") {
    std::error_code ignored;
    for (std::filesystem::path p = std::filesystem::absolute(out, ignored);
         !p.empty() && !std::filesystem::exists(p, ignored); p = p.parent_path())
      made_.push_back(p);
  }
  ~DrawnFrames() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
    for (const auto& p : made_)
      if (std::filesystem::is_empty(p, ignored)) std::filesystem::remove(p, ignored);
  }
  DrawnFrames(const DrawnFrames&) = delete;
  DrawnFrames& operator=(const DrawnFrames&) = delete;
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
  std::vector<std::filesystem::path> made_;  // innermost first
};

// Measured on a few steps and one pair: what a run takes beside reading frames, following particles and drawing.
double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double simulation_seconds(mpm::Solver& solver, const CaseSize& size, double end_s) {
  if (!(size.steps > 0) || !(end_s > 0)) return 0;
  SilentProgress silent;
  const auto start = std::chrono::steady_clock::now();
  double spent = 0;
  try {
    for (double steps = 2; spent < 0.1 && double(solver.steps()) < size.steps; steps *= 2) {
      solver.advance_to(std::min(end_s, solver.time() + steps * end_s / size.steps), silent);
      spent = seconds_since(start);
    }
  } catch (const RunError&) {
    return 0;  // a run that blows up at once says so itself
  }
  return solver.steps() > 0 ? spent / double(solver.steps()) * size.steps : 0;
}

// The first pair, one in the middle and the last.
std::vector<VectorField> three_pairs(const Case& c, const Setting& setting, image::FrameSource& source, int threads, double& seconds) {
  const int last = int(pairs_among(c, source.frames().size())) - 1, apart = in_twos(c) ? 2 : 1;
  std::vector<VectorField> out;
  for (const int k : {0, last / 2, last}) {
    const int first = k * apart;
    if (!out.empty() && first <= out.back().pair[0]) continue;
    const auto start = std::chrono::steady_clock::now();
    out.push_back(measure_pair(c, setting, source, {first, first + 1}, threads));
    if (out.size() == 1) seconds = seconds_since(start);
  }
  return out;
}

// How far the texture moves in a step, and what that says of the frame rate.
std::vector<std::string> rate_remarks(const Case& c, const Setting& setting, const std::vector<VectorField>& pairs, double rate_hz) {
  double most = 0, middle = 0;
  std::size_t valid = 0, asked = 0;
  const double pixel = setting.grid.spacing.x() / node_spacing_px(setting);
  for (const VectorField& field : pairs) {
    std::vector<double> moved;
    for (std::size_t n = 0; n < field.status.size(); ++n) {
      const Vec2 x = setting.grid.position(int(n) % setting.grid.nx, int(n) / setting.grid.nx);
      const bool material = std::any_of(setting.regions.begin(), setting.regions.end(), [&](const Region& r) { return r.polygon.contains(x); });
      if (field.status[n] == VectorStatus::masked || !material) continue;
      ++asked;
      if (field.status[n] != VectorStatus::valid) continue;
      ++valid;
      moved.push_back(std::hypot(double(field.displacement[n][0]), double(field.displacement[n][1])) / pixel);
    }
    if (moved.empty()) continue;
    std::sort(moved.begin(), moved.end());
    most = std::max(most, moved[moved.size() * 95 / 100]);
    middle = std::max(middle, moved[moved.size() / 2]);
  }
  const piv::PivOptions given = c.piv.value_or(piv::PivOptions{});
  const int first_window = given.first_window_px > 0 ? given.first_window_px : std::min({4 * given.window_px, setting.width, setting.height});
  if (double(valid) < 0.01 * double(asked) || valid == 0)
    return {"Hardly a vector could be measured in the material between the frames that were tried: is there texture, does the region lie on it, and does the "
            "material move by less than " + number(first_window / 4.0, 3) + " px a step, a quarter of the first window (piv.first_window_px)?"};
  const double window = given.window_px, quarter = window / 4;
  std::string text = "Motion in a step, in " + std::to_string(pairs.size()) + (pairs.size() == 1 ? " pair" : " pairs") + " tried: " +
                     number(middle, 2) + " px in the median, " + number(most, 2) + " px at the 95th percentile; " +
                     number(100 * double(valid) / double(asked), 3) + " % of the vectors in the material are valid. ";
  if (in_twos(c)) return {text};
  const auto at = [&](double factor) { return rate_hz > 0 ? " (" + number(rate_hz * factor, 3) + " frames a second)" : std::string(); };
  if (most > window)
    text += "That is more than a window: " + number(most / quarter, 2) + " times as many frames" + at(most / quarter) + " would hold it to a quarter of one.";
  else if (most < 0.1)
    text += "That is little against an error of some hundredths of a pixel a step: frames.stride = " + number(std::ceil(0.5 / std::max(most, 0.01))) +
            " would make it half a pixel, if the whole test is so slow.";
  else
    text += "A quarter of the window, " + number(quarter, 3) + " px, is a good greatest step: " + number(std::max(most, 1e-3) / quarter, 2) +
            " times as many frames" + at(std::max(most, 1e-3) / quarter) + " would do.";
  return {text};
}

std::string duration_words(double seconds) {
  const std::string about = seconds < 90     ? number(seconds, 2) + " s"
                            : seconds < 5400 ? number(seconds / 60, 2) + " minutes"
                                             : number(seconds / 3600, 2) + " hours";
  return "Expected time: about " + about + " on this machine (steps and a pair were timed; an initial equilibrium comes on top).";
}

std::string view_of(const Setting& setting) {
  const Vec2 across = setting.camera.to_world({double(setting.width), 0}) - setting.camera.to_world({0, 0});
  const Vec2 up = setting.camera.to_world({0, 0}) - setting.camera.to_world({0, double(setting.height)});
  const std::string unit = setting.camera.length_unit();
  std::string text = "View: " + std::to_string(setting.width) + " x " + std::to_string(setting.height) + " px";
  if (unit != "px") text += ", " + number(across.norm(), 3) + " x " + number(up.norm(), 3) + " " + unit;
  return text + "; nodes " + number(setting.grid.spacing.x(), 3) + " " + unit + " apart.";
}

// The middle of the first frame as it is and through each filter, and what the filters do to the error.
std::vector<std::string> check_filters(const Case& c, Setting& setting, image::FrameSource& source,
                                       const RunSettings& settings, Progress& progress) {
  if (!c.preprocess) return {};
  constexpr int side = 600;
  const FilterTrials trials = try_filters(c, setting, source, settings.threads, progress);
  const std::filesystem::path folder = settings.out / "check_filters";
  std::filesystem::create_directories(folder);
  const auto show = [&](const image::FilterOptions& options, const std::string& name) {
    const Image frame = filter_of(options, source)(source.read(0));
    const int width = std::min(side, frame.width()), height = std::min(side, frame.height());
    const Image part =
        image::part_of(frame.view(), (frame.width() - width) / 2, (frame.height() - height) / 2, width, height);
    if (part.depth() != PixelDepth::f32) image::write_image(part.view(), folder / (name + ".png"));
  };
  show({}, "unfiltered");
  for (const FilterTrial& trial : trials.trials) show(trial.options, trial.name);
  std::vector<std::string> words = words_of(trials);
  words.push_back("What each filter makes of the middle of the first frame: check_filters/.");
  image::FilterOptions own = *c.preprocess;
  if (own.choose) own = trials.best;
  setting.filter.reset();
  if (own.any()) setting.filter = std::make_shared<const image::FrameFilter>(filter_of(own, source));
  return words;
}

// The regions where they have gone, and everything else of `outlines`.
std::vector<report::Outline> moved_outlines(std::vector<report::Outline> outlines, const RegionsInFrame& seen) {
  std::erase_if(outlines, [](const report::Outline& o) { return o.kind == report::Outline::Kind::region; });
  for (const MovingOutline& moved : seen.outlines) {
    report::Outline& outline = outlines.emplace_back(report::Outline{report::Outline::Kind::region, moved.name, {}, true});
    for (const OutlinePoint& p : moved.points) outline.points.push_back(p.place);
  }
  return outlines;
}

CheckOutcome checked(const Case& given, const RunSettings& settings, Progress& progress) {
  Case c = given;
  // Of frames that are to be drawn two are enough, in a folder of their own: a run to be resumed must not find them.
  RunSettings own = settings;
  const DrawnFrames drawn(settings.out);
  int frames_drawn = 0;
  if (c.synth) {
    require_drawable(*c.synth, c.texture);
    own.out = drawn.folder();
    own.resume = false;
    frames_drawn = c.synth->frames;
    c.synth->frames = std::min(c.synth->frames, c.preprocess ? 8 : 2);  // a background takes more
  }
  const bool draws = c.synth && !settings.frames && (!c.frames || c.frames->path.empty());
  if (draws && c.frames) {  // which of them are used is known without them
    const image::FrameOptions& used = *c.frames;
    const int last = used.last.value_or(frames_drawn - 1);
    if (last >= frames_drawn || used.first >= frames_drawn)
      throw InputError(std::string(last >= frames_drawn ? "frames.last" : "frames.first") + ": found " +
                       std::to_string(last >= frames_drawn ? last : used.first) + ", but synth.frames is " +
                       std::to_string(frames_drawn));
    frames_drawn = (last - used.first) / used.stride + 1;
    c.frames->first = 0;
    c.frames->last.reset();
    c.frames->stride = 1;
  }
  std::unique_ptr<image::FrameSource> source = case_frames(c, own, progress);
  const std::size_t frames_there = source ? source->frames().size() : 0;
  if (!c.vectors) source = strided_by_motion(c, std::move(source), settings.threads, progress);
  const std::unique_ptr<io::VectorFiles> vectors = case_vectors(c, source.get());
  Setting setting =
      make_setting(c, source ? source->width() : 0, source ? source->height() : 0, vectors.get());
  const std::vector<Frame> listed = source ? source->frames() : vectors ? frames_of(*vectors, c) : std::vector<Frame>{};
  const std::size_t frames = draws ? std::size_t(frames_drawn) : listed.size();
  const double rate = c.frames ? c.frames->rate_hz.value_or(1.0) : 1.0;
  const double end_s = draws ? double(frames_drawn - 1) / rate : listed.empty() ? 0.0 : listed.back().time;
  const bool measures = source || vectors;
  const CaseSize size = size_of(c, setting, frames, end_s);
  if (measures) {
    seed_particles(c, setting);  // throws where a region holds none
    check_strain_floor(c, setting, frames);
  }
  if (measures && c.mpm) require_time_and_scale(c, setting, source.get());
  double seconds = 0;
  if (c.mpm) {
    mpm::Solver solver = make_solver(c, setting, settings.threads);  // likewise
    if (c.mpm->initial_equilibrium) solver.require_held();
    seconds += simulation_seconds(solver, size, c.mpm->end_s.value_or(end_s));
  }
  std::vector<VectorField> tried;
  std::vector<std::string> filters;
  RegionsAlongFrames regions;
  if (source && !vectors && source->frames().size() > 1) {
    follow_masks(c, setting, *source, settings.threads, progress);
    filters = check_filters(c, setting, *source, settings, progress);
    double one = 0;
    tried = three_pairs(c, setting, *source, settings.threads, one);
    if (!draws && !in_twos(c)) regions = regions_along_frames(c, setting, *source, settings.threads, progress);
    seconds += one * double(pairs_among(c, frames));
  }
  if (measures && c.mpm) check_compared_zones(c, setting);
  CheckOutcome outcome{{}, {text_of(size)}};
  if (setting.width > 0) outcome.remarks.insert(outcome.remarks.begin(), view_of(setting));
  if (seconds > 0) outcome.remarks.push_back(duration_words(seconds));
  for (std::string& doubt : doubts_of_scale(c)) outcome.remarks.push_back(std::move(doubt));
  if (c.mpm)
    for (std::string& doubt : doubts(c, setting)) outcome.remarks.push_back(std::move(doubt));
  if (!measures) return outcome;

  report::CheckInput input;
  Image first;
  image::DrawnFrame drawn_first;
  image::Mask drawn_mask = image::drawn_mask(setting.mask, setting.camera);
  input.world_from_pixel = setting.camera.world_from_pixel();
  if (source) {
    first = source->read(0);
    image::Mask mask = mask_of(setting, 0, first.view());
    drawn_mask = image::drawn_mask(mask, setting.camera);
    drawn_first = image::drawn_frame(source->read(0), setting.camera);
    input.image = drawn_first.image.view();
    input.world_from_pixel = drawn_first.world_from_pixel;
    if (!setting.camera.lens().straight()) {
      input.to_world = [&setting](const Vec2& p) { return setting.camera.to_world(p); };
      input.columns = setting.width, input.rows = setting.height;
    }
  }
  input.mask = drawn_mask.view();
  input.length_unit = setting.camera.length_unit();
  input.grid = setting.grid;
  using Kind = report::Outline::Kind;
  for (const Region& region : setting.regions)
    input.outlines.push_back({Kind::region, region.name, region.polygon.vertices(), true});
  for (const auto& [name, b] : c.boundaries)
    input.outlines.push_back({Kind::boundary, name, positions_of(b.line_m.empty() ? b.polygon_m : b.line_m), b.line_m.empty()});
  for (const auto& [name, b] : c.bodies)
    input.outlines.push_back({Kind::body, name, b.circle_m.empty() ? positions_of(b.polygon_m) : circle(b.circle_m), true});
  outcome.picture = settings.out / "check.png";
  report::write_check(input, outcome.picture);
  // Masks and regions at two more times.
  const bool followed = regions.seen.size() == 3;
  if (source && (!c.masks.empty() || followed) && source->frames().size() > 2) {
    const int last = int(source->frames().size()) - 1;
    for (const auto& [k, name] : {std::pair{followed ? regions.seen[1].frame : last / 2, "check_middle.png"},
                                  std::pair{followed ? regions.seen[2].frame : last, "check_last.png"}}) {
      Image frame = source->read(k);
      image::Mask mask = mask_of(setting, k, frame.view());
      const RegionsInFrame* seen = followed ? &regions.seen[k == regions.seen[1].frame ? 1 : 2] : nullptr;
      const image::Mask there = image::drawn_mask(mask, setting.camera);
      const image::DrawnFrame drawn_then = image::drawn_frame(std::move(frame), setting.camera);
      report::CheckInput then = input;
      then.image = drawn_then.image.view();
      then.mask = there.view();
      if (seen != nullptr) then.outlines = moved_outlines(input.outlines, *seen);
      report::write_check(then, settings.out / name);
    }
    outcome.remarks.push_back(std::string(!followed          ? "The masks are"
                                          : c.masks.empty() ? "The regions, moved with their material, are"
                                                            : "The masks and the regions, moved with their material, are") +
                              " also drawn on the frame in the middle and on the last one: check_middle.png, check_last.png.");
  }
  for (Remark& remark : regions.remarks) outcome.remarks.push_back(std::move(remark.text));
  if (!tried.empty())
    for (Remark& remark : shutter_remarks(c, setting, listed, tried.size(), [&](std::size_t k) { return tried[k]; }))
      outcome.remarks.push_back(std::move(remark.text));
  if (!tried.empty())
    for (std::string& remark : rate_remarks(c, setting, tried, c.frames && c.frames->rate_hz ? *c.frames->rate_hz : 0)) outcome.remarks.push_back(std::move(remark));
  for (std::string& remark : filters) outcome.remarks.push_back(std::move(remark));
  if (source && !vectors && !draws)
    for (std::string& remark : stride_remarks(c, frames_there, source->frames().size()))
      outcome.remarks.push_back(std::move(remark));
  if (!tried.empty()) {
    const VectorField& some = tried[tried.size() / 2];
    for (std::string& remark : interlace_remarks(setting, source->read(some.pair[0]), some))
      outcome.remarks.push_back(std::move(remark));
  }
  const auto tell = [&](std::vector<std::string> texts) {
    for (std::string& text : texts) outcome.remarks.push_back(std::move(text));
  };
  if (source && !draws)
    for (const Remark& remark : source->remarks()) tell({remark.text});
  if (source && !vectors) {
    tell(exposure_remarks(setting, first));
    tell(texture_remarks(setting, first, file_of_first(*source)));
  }
  return outcome;
}

}  // namespace

CheckOutcome check_case(const Case& given, const RunSettings& settings, Progress& progress) {
  return placed(given, settings, [&] { return checked(given, settings, progress); });
}

}  // namespace pivnp::app
