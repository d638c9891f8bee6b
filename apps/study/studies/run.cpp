#include "apps/study/studies/run.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <new>
#include <utility>

#include "apps/study/methods/frames/camera_motion.hpp"
#include "apps/study/methods/frames/exposure.hpp"
#include "apps/study/methods/frames/filters.hpp"
#include "apps/study/methods/frames/fixed_pattern.hpp"
#include "apps/study/methods/frames/peak_locking.hpp"
#include "apps/study/methods/frames/stride.hpp"
#include "apps/study/methods/paths/levelling.hpp"
#include "apps/study/methods/paths/strain_floor.hpp"
#include "apps/study/methods/paths/tracking.hpp"
#include "apps/study/methods/simulation/doubts.hpp"
#include "apps/study/methods/simulation/simulation.hpp"
#include "apps/study/pipeline/measure/imported_vectors.hpp"
#include "apps/study/pipeline/measure/measure.hpp"
#include "apps/study/pipeline/measure/shutter.hpp"
#include "apps/study/pipeline/record/outcome.hpp"
#include "apps/study/pipeline/record/record_head.hpp"
#include "apps/study/pipeline/record/remarks.hpp"
#include "apps/study/pipeline/record/report_input.hpp"
#include "apps/study/pipeline/record/sources.hpp"
#include "apps/study/pipeline/record/stage_clock.hpp"
#include "apps/study/pipeline/scene/placed.hpp"
#include "apps/study/pipeline/scene/sizes.hpp"
#include "apps/study/pipeline/scene/zones.hpp"
#include "apps/study/synth/case_frames.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

namespace fs = std::filesystem;

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
    throw InputError(of_file(c) + ": mpm: there is nothing to simulate; give end_s and output_rate_hz, or frames");
  return times;
}

// One run of a case: what its stages share, and the stages in their order.
class Run {
 public:
  Run(const Case& given, const RunSettings& settings, Stages stages, Progress& progress)
      : settings_(settings), progress_(progress), c_(given) {
    progress_.begin("frames");
    measures = stages != Stages::simulate && (c_.frames || c_.vectors || c_.synth || settings.frames);
    tracks = measures && stages != Stages::piv && !in_twos(c_);
    if (in_twos(c_)) require_alone(stages);
    simulates = c_.mpm && (stages == Stages::all || stages == Stages::simulate);
    if (!measures && !simulates)
      throw InputError(of_file(c_) + ": there is nothing to do, as there are neither frames nor [mpm]");
    fs::create_directories(settings.out);
    lock_ = std::make_shared<io::DirectoryLock>(settings.out);
    if (measures || c_.frames || c_.vectors) open_frames();
    setting_ = make_setting(c_, source_ ? source_->width() : 0, source_ ? source_->height() : 0, vectors_.get());
    size_ = size_of(c_, setting_, frames_.size(), frames_.empty() ? 0.0 : frames_.back().time);
    if (!settings.resume) require_room(c_, size_, settings.out);
    progress_.expect_bytes(size_.memory_bytes);
    if (tracks) check_strain_floor(c_, setting_, frames_.size());
    if (simulates && (measures || !c_.mpm->end_s || !c_.mpm->output_rate_hz) && !frames_.empty())
      require_time_and_scale(c_, setting_, source_.get());
    if (tracks && simulates) check_compared_zones(c_, setting_);
    setting_.sources = sources_of(c_, source_.get(), vectors_.get(), progress_);
    for (const fs::path& file : setting_.moving_masks.files())
      setting_.sources.push_back(io::identity_of(file, file.filename().string(), progress_));
    writer_ = std::make_unique<io::RecordWriter>(settings.out, head(), settings.resume, settings.threads, lock_, keys_of_stage);
  }

  bool measures = false, tracks = false, simulates = false;

  void measure_vectors() {
    progress_.begin("vectors");
    progress_.expect("PIV", double(pairs_among(c_, frames_.size())));
    FrameLooks looks(frames_.size());
    std::vector<std::string> filters;
    std::vector<Remark> regions;
    if (!vectors_) {
      follow_camera();
      filters = set_filter(c_, *source_, settings_.threads, progress_, setting_);
    }
    if (vectors_)
      import_vectors(*vectors_, setting_, *writer_, progress_);
    else
      regions = measure(c_, setting_, *source_, *writer_, settings_.threads, progress_, &looks);
    central_ = writer_->pair(0).anchor == Anchor::central;
    frames_ = flagged_frames(std::move(frames_), *writer_,
                             vectors_ ? std::vector<FrameLook>{} : all_looks(*source_, looks));
    writer_->set_frames(frames_);
    const auto pair = [&](std::size_t k) { return writer_->pair(k); };
    const std::size_t pairs = pairs_among(c_, frames_.size()), middle = (pairs - 1) / 2;
    const bool follow_each_other = !in_twos(c_);
    if (vectors_) note(remarks_on_import(*vectors_, c_));
    if (!vectors_) {
      const Image first = source_->read(0);
      add(source_->remarks());
      doubt(exposure_remarks(setting_, first));
      doubt(texture_remarks(setting_, first, file_of_first(*source_)));
      const VectorField some = pair(middle);
      doubt(interlace_remarks(setting_, source_->read(some.pair[0]), some));
    }
    doubt(doubts_of_scale(c_));
    if (setting_.width > 0) doubt(fraction_remarks(setting_, pairs, pair));
    note(std::move(filters));
    add(std::move(regions));
    if (!vectors_ && follow_each_other) doubt(pattern_remarks(setting_, *source_, pair));
    note(strided_);
    add(camera_motion_remarks(c_, setting_.camera_motion, frames_));
    if (follow_each_other) doubt(still_zone_remarks(c_, setting_, pairs, pair));
    if (!vectors_) add(shutter_remarks(c_, setting_, frames_, pairs, pair));
    progress_.begin("closure");
    if (vectors_)
      closure_.verdict = "not checked: the vectors are another program's";
    else if (!follow_each_other)
      closure_.verdict = "not checked: the pairs do not follow each other";
    else
      closure_ = check_closure(
          c_, setting_, *source_, [&](int k) { return writer_->pair(std::size_t(k)); }, settings_.threads, progress_);
    writer_->set_closure(closure_);
    doubt(closure_remarks(closure_, setting_));
  }

  void follow_particles() {
    progress_.begin("particles");
    tracked_ = track(c_, setting_, frames_, source_.get(), closure_, *writer_, settings_.threads, progress_);
    if (!c_.regions.empty()) writer_->set_material("np");  // without any, all is material
  }

  void simulate_motion() {
    progress_.begin("simulation");
    progress_.expect("simulation", size_.steps);
    add(simulate(c_, setting_, output_times(c_, frames_), *writer_, settings_.threads, progress_));
    if (tracks && c_.compare.mesh_study > 0) progress_.begin("mesh_study");
    for (int level = 1; tracks && level <= c_.compare.mesh_study; ++level) try {
        simulate_coarser(c_, setting_, level, output_times(c_, frames_), *writer_, settings_.threads, progress_);
        coarser_grids_ = level;
      } catch (const Interrupted&) {
        throw;
      } catch (const std::exception& error) {
        doubt({"The mesh study ended at grid " + std::to_string(level) + ": " + error.what() + "."});
        break;
      }
    for (int level = coarser_grids_ + 1; level <= 2; ++level)  // the most that compare.mesh_study takes
      writer_->leave_out(coarser_motion(level));
  }

  // A stage that needs what those before it have found. Where it fails, their results stand, and the error is told at the end.
  template <class Work>
  void attempt(const std::string& motion, const std::string& what, Work&& work) {
    try {
      work();
    } catch (const Interrupted&) {
      throw;
    } catch (const std::exception& error) {
      failure_ = std::current_exception();
      writer_->leave_out(motion);
      tracks = tracks && motion != "np";
      doubt({what + " failed: " + error.what() + "."});
    }
  }
  bool failed() const { return failure_ != nullptr; }

  // The record and the report of what has been finished; then the failure, with its exit code.
  [[noreturn]] void finish_failed() {
    std::string kept;
    try {
      pack();
      if (tracks) note_strains();
      finish();
      kept = " (what was finished before is in " + (settings_.out / "record.h5").string() + (settings_.report ? " and its report" : "") +
             "; --resume goes on from there)";
    } catch (const std::exception&) {  // a full disk, as a rule: what failed first is to be told
    }
    try {
      std::rethrow_exception(failure_);
    } catch (const InputError& error) {
      throw InputError(error.what() + kept);
    } catch (const std::bad_alloc&) {
      throw RunError("out of memory" + kept);
    } catch (const std::exception& error) {
      throw RunError(error.what() + kept);
    }
  }

  void pack() {
    progress_.begin("record");
    writer_->set_output_fields(c_.output.fields_stored);
    writer_->pack();
  }

  void note_strains() {
    note_ = strain_note(c_, setting_, *writer_->motion("np"), central_);
    writer_->set_strain_note("np", note_);
  }

  // Particles against material points, as the case asks. What cannot be compared is kept and reported all the same.
  void compare_motions() {
    progress_.begin("comparison");
    compare::CompareOptions options = c_.compare;
    add_camera(setting_.camera.residual(), options);
    try {
      const auto np = writer_->motion("np"), mpm = writer_->motion("mpm");
      std::vector<std::unique_ptr<MotionSource>> coarser;
      compare::Refinement refinement{{}, mesh_study_ratio};
      for (int level = 1; level <= coarser_grids_; ++level) {
        coarser.push_back(writer_->motion(coarser_motion(level)));
        refinement.coarser.push_back(coarser.back().get());
      }
      Comparison found = compare::compare(*np, *mpm, options, c_.limits, progress_, refinement, {note_, {}});
      if (c_.compare.levelling)
        add_levelled(c_, setting_, settings_, *source_, frames_, *writer_, *np, *mpm, note_, options, found, progress_);
      comparison_ = std::move(found);
      writer_->set_comparison(*comparison_);
      outcome_.limits = comparison_->limits;
    } catch (const InputError& error) {
      not_compared_ = error.what();
      doubt({"Measurement and simulation were not compared: " + not_compared_ + "."});
    }
  }

  RunOutcome finish() {
    progress_.end();
    writer_->set_cost(progress_.cost());
    note(remarks_on_tracking(tracked_, frames_));
    writer_->set_remarks(outcome_.remarks);
    writer_->finish(failed());
    progress_.begin("report");
    outcome_.record = settings_.out / "record.h5";
    outcome_.remarks.clear();  // the record has them
    if (comparison_) outcome_.metrics = comparison_->metrics;
    tell_record(c_, outcome_, std::move(comparison_), source_.get(), settings_.out, settings_.report);
    progress_.end();
    outcome_.cost = progress_.cost();
    if (!not_compared_.empty())
      throw InputError(not_compared_ + " (" + outcome_.record.string() +
                       " and its report are written without a comparison)");
    return std::move(outcome_);
  }

 private:
  // Pairs of exposures: from one to the next no motion is known.
  void require_alone(Stages stages) {
    const std::string twos = "frames.pairs: found \"double\", ";
    if (stages == Stages::track)
      throw InputError(twos + "but from one pair to the next no motion is known that particles could follow; expected the command piv");
    if (c_.piv && c_.piv->ensemble > 1) throw InputError(twos + "expected \"sequence\" for piv.ensemble");
    if (c_.vectors) throw InputError(twos + "expected \"sequence\" for imported vectors");
    if (stages == Stages::all && measures)
      note({"The frames are pairs of exposures (frames.pairs): no particles were followed, as from one pair to the next no motion is known."});
  }

  void add(std::vector<Remark> remarks) {
    for (Remark& remark : remarks) outcome_.remarks.push_back(std::move(remark));
  }
  void note(std::vector<std::string> texts) { append(std::move(texts), outcome_.remarks); }
  void doubt(std::vector<std::string> texts) { append(std::move(texts), outcome_.remarks, RemarkWeight::doubt); }

  void follow_camera() {
    follow_masks(c_, setting_, *source_, settings_.threads, progress_);
    if (c_.camera_motion.from == image::RestSource::none) return;
    set_camera_motion(find_camera_motion(c_, setting_, *source_, settings_.threads, progress_), setting_);
    writer_->set_camera_motion(setting_.camera_motion);
  }

  void open_frames() {
    if (auto frames = case_frames(c_, settings_, progress_, lock_.get())) {
      const std::size_t all = frames->frames().size();
      source_ = image::prefetched(std::move(frames));
      if (c_.frames->least_motion_px > 0 && !c_.vectors) {
        source_ = image::prefetched(strided_by_motion(c_, std::move(source_), settings_.threads, progress_));
        strided_ = stride_remarks(c_, all, source_->frames().size());
      }
    }
    vectors_ = case_vectors(c_, source_.get());
    frames_ = source_ ? source_->frames() : frames_of(*vectors_, c_);
    if (measures && frames_.size() < 2)
      throw InputError(c_.frames->path + ": found 1 frame, expected at least 2 to measure motion");
  }

  io::RecordHead head() const {
    io::RecordHead head = record_head(c_, setting_, settings_);
    head.time_unit = (!source_ && !vectors_) || has_rate(c_, source_.get()) ? "s" : "frame";
    head.camera_residual = setting_.camera.residual();
    if (c_.camera.metres_per_pixel) head.metres_per_pixel = c_.camera.metres_per_pixel;
    return head;
  }

  const RunSettings& settings_;
  StageClock progress_;
  Case c_;
  CaseSize size_;
  std::shared_ptr<const io::DirectoryLock> lock_;  // of the output folder, drawn frames included
  std::unique_ptr<image::FrameSource> source_;
  std::unique_ptr<io::VectorFiles> vectors_;
  std::vector<Frame> frames_;
  std::vector<std::string> strided_;  // what frames.least_motion_px left out
  Setting setting_;
  std::unique_ptr<io::RecordWriter> writer_;
  bool central_ = true;  // the vectors' anchor
  ClosureNote closure_;
  TrackOutcome tracked_;
  int coarser_grids_ = 0;  // of the mesh study
  StrainNote note_;
  std::optional<Comparison> comparison_;
  std::string not_compared_;  // why
  std::exception_ptr failure_;  // of the stage that ended the run
  RunOutcome outcome_;
};

}  // namespace

RunOutcome run_case(const Case& c, const RunSettings& settings, Stages stages, Progress& progress) {
  return placed(c, settings, [&] {
    Run run(c, settings, stages, progress);
    if (run.measures) run.measure_vectors();
    if (run.tracks) run.attempt("np", "Tracking", [&] { run.follow_particles(); });
    if (run.simulates && !run.measures)
      run.simulate_motion();
    else if (run.simulates && !run.failed())
      run.attempt("mpm", "The simulation", [&] { run.simulate_motion(); });
    if (run.failed()) run.finish_failed();
    run.pack();
    if (run.tracks) run.note_strains();
    if (run.tracks && run.simulates) run.compare_motions();
    return run.finish();
  });
}

}  // namespace pivnp::app
