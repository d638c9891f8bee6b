#include "apps/study/pipeline/record/report_input.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "apps/report/animation.hpp"
#include "apps/report/report.hpp"
#include "apps/study/pipeline/record/remarks.hpp"
#include "apps/study/pipeline/record/simulation_setup.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/image/camera/camera.hpp"
#include "pivnp/image/files/video_writer.hpp"
#include "pivnp/image/rectify.hpp"
#include "pivnp/io/records/record.hpp"
#include "pivnp/piv/methods.hpp"

namespace pivnp::app {

namespace {

namespace fs = std::filesystem;

// Frame `index` as it is drawn: where its camera was, without the bends of its lens.
report::Picture picture(const Case& c, const io::RecordReader& record, image::FrameSource& source, int index) {
  Image frame = source.read(index);
  const CameraMotion motion = record.camera_motion();
  if (c.vectors || (c.camera.lens == image::LensModel::none && c.camera.window_thickness_m == 0 && motion.empty()))
    return {index, std::move(frame), {}};
  image::Camera camera = image::make_camera(c.camera, frame.width(), frame.height());
  if (!motion.empty()) camera = camera.after(motion.matrix(std::size_t(index)));
  image::DrawnFrame drawn = image::drawn_frame(std::move(frame), camera);
  return {index, std::move(drawn.image), drawn.world_from_pixel};
}

// The pictures under vectors: the frames nearest to the first and the last of the report's times, never one twice; without
// images where there is no source of them.
std::vector<report::Picture> pictures(const Case& c, const io::RecordReader& record, image::FrameSource* source) {
  const std::vector<Frame>& frames = record.frames();
  std::vector<double> times = c.report.times_s;
  if (times.empty())
    for (const double share : {1.0 / 3, 2.0 / 3}) times.push_back(share * frames.back().time);
  std::vector<int> chosen;
  for (const double t : times) {
    const auto nearest = std::min_element(frames.begin(), frames.end(), [&](const Frame& a, const Frame& b) {
      return std::abs(a.time - t) < std::abs(b.time - t);
    });
    const int index = std::min(int(nearest - frames.begin()), int(frames.size()) - 2);  // the first of a pair
    if (std::find(chosen.begin(), chosen.end(), index) == chosen.end()) chosen.push_back(index);
  }
  std::sort(chosen.begin(), chosen.end());
  if (chosen.size() > 2) chosen = {chosen.front(), chosen.back()};
  std::vector<report::Picture> out;
  for (const int index : chosen)
    out.push_back(source ? picture(c, record, *source, index) : report::Picture{index, Image(), {}});
  return out;
}

struct Matching {
  std::string subset, shape, criterion, interpolant;
};

// How a method matches images, in the guide's words (docs/theory/piv.md).
Matching matching_of(const piv::PivOptions& o, const std::string& overlap) {
  const std::string least = "squared differences of grey values, robustly weighted, gain and offset of the light removed";
  const std::string side = std::to_string(o.window_px) + " px" + overlap;
  const piv::PivMethod* method = piv::piv_methods().find(o.method);
  switch (method == nullptr ? piv::MethodFamily::other : method->family) {
    case piv::MethodFamily::gauss_newton:
      if (o.smoothing == piv::Smoothing::window)
        return {side, o.order == 0 ? "constant" : o.order == 1 ? "affine" : "quadratic", least, "quintic B-spline"};
      return {side + " (noise of such a window; cells of a quarter of it, smoothed as far as the field\u2019s own noise asks)", "cubic B-spline over the cells", least,
              "quintic B-spline"};
    case piv::MethodFamily::window_search:
    case piv::MethodFamily::window_refinement:
      return {side, "gradient and curvature of the field about it", "cross-correlation, zero mean, normalised", "quintic B-spline"};
    case piv::MethodFamily::other: break;
  }
  return {side, "not stated", "not stated", "not stated"};
}

// Rows of the report's table on how the measurement was made: what the case says.
std::vector<std::pair<std::string, std::string>> setup_of(const Case& c, const io::RecordReader& record) {
  std::vector<std::pair<std::string, std::string>> rows;
  if (record.pair_count() == 0) return rows;
  const std::vector<Frame>& frames = record.frames();
  std::string text = std::to_string(frames.size());
  const bool twos = c.frames && c.frames->pairs == image::FramePairs::twos;
  if (twos) text += ", two exposures a pair";
  if (twos && c.frames->rate_hz)
    text += " " + number(*c.frames->pair_time_s, 4) + " s apart, " + number(*c.frames->rate_hz, 4) + " pairs a second";
  else if (!twos && record.head().time_unit == "s" && frames.size() > 1)
    text += ", " + number(double(frames.size() - 1) / (frames.back().time - frames.front().time), 4) + " a second";
  rows.emplace_back("Frames", text);
  if (const std::size_t targets = c.camera.points_px.size(); targets > 0)
    rows.emplace_back("Targets of the camera", std::to_string(targets) + (targets == 4 ? ", no degree of freedom: their residual is not known"
                                                                                       : ", " + std::to_string(2 * targets - 8) + " degrees of freedom"));
  if (!c.vectors && c.camera.lens != image::LensModel::none) {
    std::string lens(name_of(c.camera.lens));
    for (const double k : c.camera.distortion) lens += (lens.find(',') == std::string::npos ? ", distortion " : " ") + number(k, 4);
    if (c.camera.lens_rms_px > 0) lens += ", residual " + number(c.camera.lens_rms_px, 2) + " px";
    rows.emplace_back("Distortion of the lens, corrected", lens);
  }
  if (!c.vectors && c.camera.window_thickness_m > 0)
    rows.emplace_back("Refraction by a window, corrected", number(c.camera.window_thickness_m, 4) + " m, index " + number(c.camera.window_index, 4));
  if (c.vectors) {
    rows.emplace_back("Correlation", "another program's vectors (" + c.vectors->format + ")");
  } else {
    const piv::PivOptions piv = c.piv.value_or(piv::PivOptions{});
    rows.emplace_back("Correlation", piv.method + ", " + std::string(name_of(piv.smoothing)) + " smoothing, " + std::string(name_of(piv.anchor)) +
                                         " vectors, frame to frame");
    const double h_px = c.grid.spacing_px.value_or(piv.window_px / 4.0);
    const Matching matching = matching_of(
        piv, c.grid.spacing_m ? std::string() : ", overlap " + number(100 * std::max(0.0, 1 - h_px / piv.window_px), 3) + " %");
    rows.emplace_back("Filtering of the images", "none");
    rows.emplace_back("Subset or window", matching.subset);
    rows.emplace_back("Shape function of a subset", matching.shape);
    rows.emplace_back("Matching criterion", matching.criterion);
    rows.emplace_back("Interpolant of the images", matching.interpolant);
    rows.emplace_back("Validation", "normalised median " + number(piv.median_threshold) + ", score above " + number(piv.min_score) +
                                        ", stated error below " + number(piv.max_sigma_px) + " px");
  }
  const np::NpOptions np = c.np.value_or(np::NpOptions{});
  rows.emplace_back("Particles", std::to_string(np.per_element) + " an element, shape functions " + std::string(name_of(np.shape)) + ", drift " +
                                     std::string(name_of(np.drift)));
  return rows;
}

// The displacement that 95 % of a motion's particles do not exceed, against time.
report::Run run_of(const std::string& name, const MotionSource& motion, bool measured) {
  report::Run run{name, measured, motion.times(), {}, {}};
  for (std::size_t k = 0; k < motion.times().size(); ++k) {
    const MotionFrame frame = motion.frame(k);
    std::vector<double> u;
    for (std::size_t p = 0; p < frame.u.size(); ++p)
      if (alive(frame.status[p])) u.push_back(std::hypot(double(frame.u[p][0]), double(frame.u[p][1])));
    std::erase_if(u, [](double v) { return !std::isfinite(v); });
    if (!u.empty()) std::nth_element(u.begin(), u.begin() + std::ptrdiff_t(u.size() * 95 / 100), u.end());
    run.displacement.push_back(u.empty() ? nan_value : u[u.size() * 95 / 100]);
  }
  return run;
}

// Of a record: its measurement if `with_measured`, and its last motion, which is the simulation where there is one.
void add_runs(const std::string& name, const io::RecordReader& record, bool with_measured, std::vector<report::Run>& runs) {
  const std::vector<std::string> motions = record.motion_names();
  if (motions.empty()) throw InputError("report.compare_runs: " + name + " holds no motion");
  const auto comparison = record.comparison();
  const std::string second = comparison && std::find(motions.begin(), motions.end(), comparison->names[1]) != motions.end() ? comparison->names[1]
                             : std::find(motions.begin(), motions.end(), "mpm") != motions.end()                             ? "mpm"
                                                                                                                             : motions.back();
  if (with_measured && record.pair_count() > 0 && second != "np") runs.push_back(run_of("measured", *record.motion("np"), true));
  runs.push_back(run_of(name, *record.motion(second), false));
  if (comparison) runs.back().metrics = comparison->metrics;
}

std::vector<report::Run> runs_of(const Case& c, const io::RecordReader& own) {
  std::vector<report::Run> runs;
  if (c.report.compare_runs.empty()) return runs;
  add_runs("this run", own, true, runs);
  for (const std::string& text : c.report.compare_runs) {
    const fs::path given(text), file = fs::is_directory(given) ? given / "record.h5" : given;
    const io::RecordReader other(file);
    if (other.head().length_unit != own.head().length_unit || other.head().time_unit != own.head().time_unit)
      throw InputError("report.compare_runs: " + text + " is in " + other.head().length_unit + " and " + other.head().time_unit + ", expected " +
                       own.head().length_unit + " and " + own.head().time_unit);
    const fs::path folder = fs::absolute(file).parent_path();
    add_runs(fs::is_directory(given) || given.filename() == "record.h5" ? folder.filename().string() : given.stem().string(), other, false, runs);
  }
  return runs;
}

void write_animation(const Case& c, const io::RecordReader& record, const report::Content& content, image::FrameSource* source,
                     const fs::path& file) {
  const report::Animation animation(content);
  if (animation.size() < 2) return;
  constexpr double least = 2, most = 25, length_s = 8;  // frames a second; about so long
  image::VideoWriter video(file, std::clamp(double(animation.size()) / length_s, least, most));
  for (std::size_t k = 0; k < animation.size(); ++k) {
    const int frame = source != nullptr ? animation.frame_of(k) : -1;
    video.add_png(animation.png(k, frame >= 0 ? picture(c, record, *source, frame) : report::Picture{}));
  }
  video.finish();
}

void draw_report(const Case& c, const io::RecordReader& record, RunOutcome& outcome, std::optional<Comparison> comparison,
                 image::FrameSource* source, const fs::path& directory) {
  report::ReportInput input;
  input.name = c.name;
  input.record = &record;
  input.remarks = outcome.remarks;
  if (comparison) input.notes = comparison->remarks;
  input.comparison = std::move(comparison);
  input.compared = c.compare;
  input.setup = setup_of(c, record);
  const std::vector<std::string> motions = record.motion_names();
  if (std::find(motions.begin(), motions.end(), "mpm") != motions.end())
    input.simulated = simulation_setup(c, record.head().grid.spacing.x(), record.motion("mpm")->particles().size());
  input.runs = runs_of(c, record);
  if (record.pair_count() > 0) {
    input.pictures = pictures(c, record, source);
    const std::vector<double> times = input.comparison ? input.comparison->times() : std::vector<double>{};
    if (source && !times.empty()) {
      const std::vector<Frame>& frames = record.frames();
      const auto nearest = std::min_element(frames.begin(), frames.end(), [&](const Frame& a, const Frame& b) {
        return std::abs(a.time - times.back()) < std::abs(b.time - times.back());
      });
      const int index = int(nearest - frames.begin());
      input.last_picture = std::make_shared<report::Picture>(picture(c, record, *source, index));
    }
  }
  report::write_report(c.report, input, directory);
  if (c.report.animation) write_animation(c, record, report::content_of(c.report, input), source, directory / "animation.mp4");
  outcome.report_html = directory / "report.html";
  outcome.report_pdf = directory / "report.pdf";
}

}  // namespace

void tell_record(const Case& c, RunOutcome& outcome, std::optional<Comparison> comparison, image::FrameSource* source,
                 const fs::path& directory, bool draw) {
  const io::RecordReader record(outcome.record, io::Trust::known);  // just written, or read before
  for (Remark& remark : remarks_of(record)) outcome.remarks.push_back(std::move(remark));
  if (comparison) append(comparison->doubts, outcome.remarks, RemarkWeight::doubt);
  std::vector<std::string> notes = comparison ? comparison->remarks : std::vector<std::string>{};
  if (draw) draw_report(c, record, outcome, std::move(comparison), source, directory);
  append(std::move(notes), outcome.remarks);
}

}  // namespace pivnp::app
