#include "apps/study/frontier/frontier.hpp"

#include <algorithm>
#include <memory>
#include <thread>
#include <utility>

#include "apps/plot/files.hpp"
#include "apps/study/frontier/chain/chain_frontier.hpp"
#include "apps/study/frontier/mpm/mpm_frontier.hpp"
#include "apps/study/frontier/mpm/vortex_frontier.hpp"
#include "apps/study/frontier/np/drift_frontier.hpp"
#include "apps/study/frontier/np/np_frontier.hpp"
#include "apps/study/frontier/pages.hpp"
#include "apps/study/frontier/piv/peers.hpp"
#include "apps/study/frontier/piv/piv_frontier.hpp"
#include "apps/study/frontier/piv/spacing_frontier.hpp"
#include "apps/study/frontier/tables.hpp"
#include "apps/study/frontier/written_pages.hpp"
#include "apps/study/methods/frames/known_pairs.hpp"
#include "apps/study/pipeline/scene/scene.hpp"
#include "apps/study/synth/case_frames.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

constexpr int drawn_seed = 901, drawn_frames = 15;

// A column of sand that collapses, drawn by a simulation of another scheme: what is measured, simulated and compared without a case.
Case column_case(double cell_px) {
  return parse_case(R"(name = "column collapse"
[frames]
rate_hz = 50.0
[camera]
metres_per_pixel = 1.0e-3
origin_px = [16.0, 175.0]
[grid]
area_m = [[0.0, 0.0], [0.32, 0.16]]
[region.sand]
polygon_m = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.12], [0.0, 0.12]]
[piv]
window_px = 20
[material.sand]
model = "mohr_coulomb"
density_kg_m3 = 1600.0
young_pa = 1e6
poisson = 0.3
friction_deg = 30.0
[mpm]
initial_equilibrium = false
[boundary.base]
line_m = [[0.0, 0.0], [0.32, 0.0]]
type = "fixed"
[boundary.left]
line_m = [[0.0, 0.0], [0.0, 0.16]]
type = "roller"
[compare]
slope_base_m = 0.0
[synth]
motion = "mpm"
width_px = 352
height_px = 192
[synth.texture]
noise = 0.02
[synth.material.sand]
model = "mohr_coulomb"
density_kg_m3 = 1600.0
young_pa = 1e6
poisson = 0.3
friction_deg = 33.0
[synth.mpm]
initial_equilibrium = false
refine = 2
)",
                    "the column of pivnp frontier", ".",
                    {"grid.spacing_m=" + number(1e-3 * cell_px), "synth.frames=" + std::to_string(drawn_frames)});
}

// The case's nodes, and its own words for others.
SpacingKey spacing_of(const Case& c, const Setting& setting) {
  SpacingKey given{.px = node_spacing_px(setting)};
  if (!c.grid.spacing_m) return given;
  const double m = *c.grid.spacing_m / given.px;
  given.key = [m](double px) { return "grid.spacing_m=" + number(m * px, 4); };
  return given;
}

// The stages in their order.
class Frontier {
 public:
  Frontier(const FrontierOptions& options, const RunSettings& settings, Progress& progress)
      : options_(options), settings_(settings), progress_(progress),
        threads_(settings.threads > 0 ? settings.threads : int(std::max(1u, std::thread::hardware_concurrency()))) {}

  void on_drawn_scenes() {
    const int repeats = options_.repeats;
    if (options_.piv) {
      const KnownPairs known = drawn_pairs(options_.drawn_px, drawn_seed);
      stages.push_back(piv_frontier(known, {}, false, repeats, threads_, progress_));
      stages.push_back(spacing_frontier(known, {}, {}, {}, false, repeats, threads_, progress_));
      stages.push_back(peers_frontier(2 * options_.drawn_px, repeats, progress_));
    }
    if (options_.np) {
      Followed followed;  // what the default's nodes and windows give
      followed.alike = 0.5 * piv::PivOptions{}.window_px;
      followed.spacing = 0.5 * followed.alike;
      particles({}, {}, followed, {});
    }
    const Case column = column_case(options_.column_cell_px);
    if (options_.mpm) {
      stages.push_back(vortex_frontier(repeats, threads_, progress_));
      Case simulated = column;
      simulated.frames.reset();
      simulated.synth.reset();
      simulated.camera = {};
      stages.push_back(mpm_frontier(simulated, make_setting(simulated, 0, 0), double(drawn_frames - 1) / *column.frames->rate_hz, repeats, threads_, progress_));
      for (FrontierPoint& p : stages.back().points) p.own = false;  // nobody's
    }
    if (options_.chain) stages.push_back(chain_frontier(column, false, settings_, repeats, threads_, progress_));
  }

  void on_case(const Case& given) {
    Case c = given;
    const bool wants_frames = options_.piv || options_.np || options_.chain || (c.mpm && !c.mpm->end_s);
    const std::unique_ptr<image::FrameSource> source = wants_frames ? case_frames(c, settings_, progress_) : nullptr;
    const bool frames = source && c.piv, simulates = options_.mpm && c.mpm;
    if (!(frames && (options_.piv || options_.np)) && !simulates && !(options_.chain && c.synth))
      throw InputError((of_file(c).empty() ? "" : of_file(c) + ": ") + "there is nothing to measure; expected frames ([frames], [synth] or --frames) or [mpm]");
    const Setting setting = make_setting(c, source ? source->width() : 0, source ? source->height() : 0);
    if (frames && (options_.piv || options_.np)) {
      const KnownPairs known = carried_pairs(c, setting, *source, threads_, progress_);
      if (options_.piv) {
        stages.push_back(piv_frontier(known, *c.piv, true, options_.repeats, threads_, progress_));
        stages.push_back(spacing_frontier(known, *c.piv, c.np.value_or(np::NpOptions{}), spacing_of(c, setting), true, options_.repeats, threads_, progress_));
      }
      if (options_.np) {
        Followed followed;
        followed.spacing = node_spacing_px(setting);
        followed.alike = 0.5 * c.piv->window_px;
        followed.shift = known.shift;
        followed.slope = known.slope;
        if (known.sigma > 0) followed.noise = known.sigma;
        followed.steps = std::clamp(int(source->frames().size()) - 1, 5, 30);
        followed.central = c.piv->anchor == Anchor::central;
        followed.of_case = true;
        particles(c.np.value_or(np::NpOptions{}), *c.piv, followed, followed);
      }
    }
    if (simulates) {
      const double end = c.mpm->end_s ? *c.mpm->end_s : source ? source->frames().back().time : 0;
      if (!(end > 0)) throw InputError(of_file(c) + ": mpm.end_s: missing; expected the simulation's end");
      stages.push_back(mpm_frontier(c, setting, end, options_.repeats, threads_, progress_));
    }
    if (!options_.chain) return;
    if (given.synth && !settings_.frames) stages.push_back(chain_frontier(given, true, settings_, options_.repeats, threads_, progress_));
    else if (source) left_out.push_back("The whole chain: the motion in the frames is not known; expected frames drawn from a known one ([synth]).");
  }

  int threads() const { return threads_; }
  std::vector<FrontierStage> stages;
  std::vector<std::string> left_out;

 private:
  // `drawn`: of the frames on which the schemes of drift are compared.
  void particles(const np::NpOptions& base, const piv::PivOptions& piv, const Followed& followed, const Followed& drawn) {
    for (FrontierStage& stage : np_frontier(base, followed, options_.repeats, threads_, progress_)) stages.push_back(std::move(stage));
    stages.push_back(drift_frontier(base, piv, drawn, options_.repeats, threads_, progress_));
  }

  const FrontierOptions& options_;
  const RunSettings& settings_;
  Progress& progress_;
  const int threads_;
};

}  // namespace

FrontierOutcome frontier(const Case* given, const FrontierOptions& options, const RunSettings& settings, Progress& progress) {
  FrontierOutcome outcome;
  plot::make_folder(settings.out);  // before the work
  Frontier work(options, settings, progress);
  std::string subject = "drawn scenes";
  if (given) {
    subject = given->name.empty() ? of_file(*given) : given->name;
    work.on_case(*given);
  } else {
    work.on_drawn_scenes();
  }
  std::vector<std::pair<std::string, std::string>> texts;
  std::vector<io::NamedTable> tables;
  for (const FrontierStage& stage : work.stages) {
    texts.push_back({stage.name + ".csv", csv(stage)});
    tables.push_back(table_of(stage, processor(), work.threads()));
    for (const std::string& sentence : what_to_change(stage)) outcome.sentences.push_back(stage.title + ": " + sentence);
    outcome.remarks.insert(outcome.remarks.end(), stage.remarks.begin(), stage.remarks.end());
    for (const std::string& left : stage.left_out) outcome.remarks.push_back("Not measured: " + left);
  }
  for (const std::string& left : work.left_out) outcome.remarks.push_back("Not measured: " + left);
  outcome.files = write_pages(frontier_document(work.stages, subject, work.threads()), "frontier", texts, tables, settings.out);
  outcome.stages = std::move(work.stages);
  return outcome;
}

}  // namespace pivnp::app
