#include "apps/study/frontier/chain/chain_frontier.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "apps/study/frontier/chain/whole_settings.hpp"
#include "apps/study/frontier/work.hpp"
#include "apps/study/methods/frames/camera_motion.hpp"
#include "apps/study/methods/frames/filters.hpp"
#include "apps/study/methods/paths/closure.hpp"
#include "apps/study/methods/paths/tracking.hpp"
#include "apps/study/methods/simulation/simulation.hpp"
#include "apps/study/pipeline/measure/measure.hpp"
#include "apps/study/pipeline/record/record_head.hpp"
#include "apps/study/synth/case_frames.hpp"
#include "compare/compare.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/particles/strain.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

namespace fs = std::filesystem;

// A motion with the file that it is read from, and what it took.
struct Part {
  std::unique_ptr<io::RecordWriter> writer;
  std::unique_ptr<MotionSource> motion;
  Effort work;
};

RunSettings in(const RunSettings& settings, const std::string& folder, int threads) {
  RunSettings part = settings;
  part.out = settings.out / "chain" / folder;
  part.threads = threads;
  part.resume = false;
  return part;
}

Part measured_motion(const Case& c, image::FrameSource& source, const RunSettings& settings, Progress& progress) {
  Part part;
  part.work = measured(settings.threads, [&] {
    Setting setting = make_setting(c, source.width(), source.height());
    follow_masks(c, setting, source, settings.threads, progress);
    set_camera_motion(find_camera_motion(c, setting, source, settings.threads, progress), setting);
    fs::create_directories(settings.out);
    part.writer = std::make_unique<io::RecordWriter>(settings.out, record_head(c, setting, settings), false, settings.threads);
    set_filter(c, source, settings.threads, progress, setting);
    measure(c, setting, source, *part.writer, settings.threads, progress);
    const std::vector<Frame> frames = flagged_frames(source.frames(), *part.writer);
    part.writer->set_frames(frames);
    const ClosureNote closure = check_closure(
        c, setting, source, [&](int k) { return part.writer->pair(std::size_t(k)); }, settings.threads, progress);
    part.writer->set_closure(closure);
    track(c, setting, frames, &source, closure, *part.writer, settings.threads, progress);
    part.writer->pack();
  });
  part.motion = part.writer->motion("np");
  return part;
}

Part simulated_motion(const Case& c, const Setting& setting, const std::vector<double>& times, const RunSettings& settings, Progress& progress) {
  Part part;
  part.work = measured(settings.threads, [&] {
    fs::create_directories(settings.out);
    part.writer = std::make_unique<io::RecordWriter>(settings.out, record_head(c, setting, settings), false, settings.threads);
    simulate(c, setting, times, *part.writer, settings.threads, progress);
    part.writer->pack();
  });
  part.motion = part.writer->motion("mpm");
  return part;
}

// Final rms displacement, rms deviatoric strain and greatest displacement of a motion.
struct Size {
  double displacement = 0, strain = 0, greatest = 0;
};

Size size_of_motion(const MotionSource& motion) {
  const MotionFrame last = motion.frame(motion.times().size() - 1);
  Size size;
  double n = 0;
  for (std::size_t p = 0; p < last.u.size(); ++p) {
    if (!alive(last.status[p])) continue;
    const double u = std::hypot(double(last.u[p][0]), double(last.u[p][1])), e = deviatoric(log_strain(matrix(last.F[p])));
    size.displacement += u * u, size.strain += e * e, ++n;
    size.greatest = std::max(size.greatest, u);
  }
  size.displacement = std::sqrt(size.displacement / n);
  size.strain = std::sqrt(size.strain / n);
  return size;
}

// The numbers of a verdict, and what each is measured against.
struct Verdicts {
  std::vector<std::string> names, units;
  std::vector<double> sizes;
  explicit Verdicts(const Case& c, const Size& size, const std::string& unit)
      : names{"displacement_rms_final", "strain_dev_rms_final"}, units{unit, ""}, sizes{size.displacement, size.strain} {
    if (!c.compare.slope_base_m) return;
    names.push_back("run_out_x_difference");
    units.push_back(unit);
    sizes.push_back(size.greatest);
  }
  std::vector<double> of(const MotionSource& first, const MotionSource& second, const Case& c, Progress& progress) const {
    compare::CompareOptions options = c.compare;
    options.levelling = false;
    const Comparison found = compare::compare(first, second, options, {}, progress);
    std::vector<double> values;
    for (const std::string& name : names) {
      const Metric* metric = find(found.metrics, name);
      values.push_back(metric ? std::abs(metric->value) : std::nan(""));
    }
    return values;
  }
};

void add_times(const FrontierPoint& part, FrontierPoint& whole) {
  whole.seconds += part.seconds, whole.quickest += part.quickest, whole.slowest += part.slowest;
}

}  // namespace

FrontierStage chain_frontier(const Case& given, bool own, const RunSettings& settings, int repeats, int threads, Progress& progress) {
  if (!given.synth) throw InputError(of_file(given) + ": the whole chain needs a motion that is known; expected [synth]");
  Case c = given;
  WithinProgress quiet(progress);
  const RunSettings drawing = in(settings, "drawn", threads);
  progress.update("drawing frames", 0, 1);
  const std::unique_ptr<image::FrameSource> source = case_frames(c, drawing, quiet);
  const io::RecordReader drawn(drawing.out / "truth" / "record.h5");
  const std::unique_ptr<MotionSource> truth = drawn.motion("truth");
  const Setting setting = make_setting(c, source->width(), source->height());
  std::vector<double> times;
  for (const Frame& frame : source->frames())
    if (!c.mpm || !c.mpm->end_s || frame.time <= *c.mpm->end_s * (1 + 1e-12)) times.push_back(frame.time);

  const std::vector<WholeSetting> measurements = measurement_settings(c, own), simulations = c.mpm ? simulation_settings(c, own) : std::vector<WholeSetting>{};
  const std::int64_t total = std::int64_t(measurements.size() + simulations.size()) + (c.mpm ? 1 : 0);
  std::int64_t done = 0;
  const auto next = [&] {
    progress.update("whole settings", done++, total);
    if (progress.stop_requested()) throw Interrupted();
  };
  FrontierStage stage;
  stage.name = "chain";
  stage.title = "The whole chain";
  stage.error_label = "error of what the verdict compares (% of the motion)";
  stage.time_label = "total time (s)";
  std::vector<Part> measured_parts, simulated_parts;
  std::vector<Timed> timed;  // the measured parts, then the simulated ones
  std::vector<const WholeSetting*> measured_by, simulated_by;
  for (std::size_t k = 0; k < measurements.size(); ++k) try {
      next();
      measured_parts.push_back(measured_motion(measurements[k].applied(c), *source, in(settings, "measured_" + std::to_string(k), threads), quiet));
      measured_by.push_back(&measurements[k]);
      timed.push_back({{measured_parts.back().work.seconds}, [&, k] {
                         return measured_motion(measurements[k].applied(c), *source, in(settings, "again", threads), quiet).work.seconds;
                       }});
    } catch (const InputError& error) {
      stage.left_out.push_back(measurements[k].name + ": " + error.what());
    }
  for (std::size_t k = 0; k < simulations.size(); ++k) try {
      next();
      const Case changed = simulations[k].applied(c);
      Setting cells = setting;
      cells.grid = coarsened(setting.grid, simulations[k].cells);
      simulated_parts.push_back(simulated_motion(changed, cells, times, in(settings, "simulated_" + std::to_string(k), threads), quiet));
      simulated_by.push_back(&simulations[k]);
      timed.push_back({{simulated_parts.back().work.seconds}, [&, changed, cells] {
                         return simulated_motion(changed, cells, times, in(settings, "again", threads), quiet).work.seconds;
                       }});
    } catch (const InputError& error) {
      stage.left_out.push_back(simulations[k].name + ": " + error.what());
    } catch (const RunError& error) {
      stage.left_out.push_back(simulations[k].name + ": " + error.what());
    }
  repeat_in_turn(timed, repeats, progress);
  fs::remove_all(settings.out / "chain" / "again");
  std::vector<FrontierPoint> times_of(timed.size());  // median, least, most
  for (std::size_t k = 0; k < timed.size(); ++k) set_times(timed[k].seconds, times_of[k]);
  std::optional<Part> finest;
  if (c.mpm) {
    next();
    Setting cells = setting;
    cells.grid = coarsened(setting.grid, 0.5);
    finest = simulated_motion(c, cells, times, in(settings, "finest", threads), quiet);
  }

  const Verdicts verdicts(c, size_of_motion(*truth), setting.camera.length_unit());
  const std::vector<double> real = finest ? verdicts.of(*truth, *finest->motion, c, quiet) : std::vector<double>(verdicts.names.size(), 0.0);
  for (std::size_t n = 0; n < real.size(); ++n)
    if (!std::isfinite(real[n])) throw InputError(of_file(given) + ": the whole chain: found no " + verdicts.names[n] + " between the drawn motion and the simulation");
  // What each side is off by: the measured motion from the drawn one, the simulated from that on finer cells.
  std::vector<std::vector<double>> off_measured, off_simulated;
  for (const Part& part : measured_parts) off_measured.push_back(verdicts.of(*truth, *part.motion, c, quiet));
  for (const Part& part : simulated_parts) off_simulated.push_back(verdicts.of(*finest->motion, *part.motion, c, quiet));
  std::string numbers;
  for (std::size_t n = 0; n < verdicts.names.size(); ++n) {
    const std::string unit = verdicts.units[n].empty() ? "" : " (" + verdicts.units[n] + ")";
    stage.columns.push_back({verdicts.names[n], verdicts.names[n] + unit, "the verdict's number; true: " + number(real[n], 3)});
    numbers += (n ? ", " : "") + verdicts.names[n];
  }
  stage.made_of = "Frames drawn from a known motion (" + std::to_string(source->frames().size()) + " of " + std::to_string(source->width()) + " x " +
                  std::to_string(source->height()) + " px), measured" + (c.mpm ? ", simulated and compared" : " and compared with that motion") + "; the verdict's numbers are " + numbers +
                  ". The error is what the measured motion is off from the drawn one" + (c.mpm ? " and the simulated one from the case's simulation on cells half as large" : "") + " in these numbers, each in percent of the motion's own size, as a root mean square: a verdict cannot be "
                  "righter by design, though its single numbers (in the table, beside the true ones) may be by chance.";
  for (std::size_t m = 0; m < measured_parts.size(); ++m)
    for (std::size_t s = 0; s < std::max<std::size_t>(1, simulated_parts.size()); ++s) {
      if (c.mpm && simulated_parts.empty()) break;
      const Part& np = measured_parts[m];
      FrontierPoint p;
      p.name = measured_by[m]->name, p.keys = measured_by[m]->keys;
      p.own = measured_by[m]->own, p.standard = measured_by[m]->standard;
      p.seconds = p.quickest = p.slowest = 0;
      std::vector<double> found;
      try {
        const double comparing = seconds_of(threads, [&] {
          found = c.mpm ? verdicts.of(*np.motion, *simulated_parts[s].motion, c, quiet) : verdicts.of(*truth, *np.motion, c, quiet);
        });
        add_times(times_of[m], p);
        p.seconds += comparing, p.quickest += comparing, p.slowest += comparing;
      } catch (const InputError& error) {
        stage.left_out.push_back(p.name + ": " + error.what());
        continue;
      }
      p.bytes = np.work.bytes, p.instructions = np.work.instructions;
      if (c.mpm) {
        const WholeSetting& by = *simulated_by[s];
        p.name += " + " + by.name;
        p.keys = p.keys == "as it is" ? by.keys : by.keys == "as it is" ? p.keys : p.keys + " " + by.keys;
        p.own = p.own && by.own, p.standard = p.standard && by.standard;
        add_times(times_of[measured_parts.size() + s], p);
        p.bytes = std::max(p.bytes, simulated_parts[s].work.bytes);
        p.instructions += simulated_parts[s].work.instructions;
      }
      double square = 0;
      for (std::size_t n = 0; n < found.size(); ++n) {
        const double away = 100 * std::hypot(off_measured[m][n], c.mpm ? off_simulated[s][n] : 0.0) / verdicts.sizes[n];
        square += away * away / double(found.size());
        p.worst = std::isnan(p.worst) ? away : std::max(p.worst, away);
      }
      p.error = std::sqrt(square);
      p.columns = found;
      stage.points.push_back(std::move(p));
    }
  find_front(stage.points);
  measured_parts.clear();
  simulated_parts.clear();
  return stage;
}

}  // namespace pivnp::app
