// Speed against accuracy, where methods fail, and what a simulation depends on: frontier, stress, sweep.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "apps/case/values.hpp"
#include "apps/cli/arguments.hpp"
#include "apps/cli/commands.hpp"
#include "apps/study/element/element.hpp"
#include "apps/study/frontier/frontier.hpp"
#include "apps/study/stress/stress.hpp"
#include "apps/study/sweep/sweep.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::app {

namespace {

// The case, or one of nothing but frames; none: drawn texture.
std::optional<Case> scene(const Arguments& arguments, const Session& session) {
  if (!arguments.case_path.empty()) return load_case(arguments, session);
  if (!arguments.frames.empty())
    return parse_case("[frames]\npath = " + toml_text(arguments.frames) + "\n", "--frames", std::filesystem::current_path(), arguments.given);
  if (!arguments.given.empty()) throw InputError("--set: given without a case, expected CASE or --frames");
  return std::nullopt;
}

// Where the charts go: beside the case's other results, or in out/NAME.
RunSettings charts_in(const Arguments& arguments, const Session& session, const std::optional<Case>& c, const std::string& name) {
  const std::filesystem::path fallback = (arguments.case_path.empty() ? std::filesystem::path("out") : default_out(*c)) / name;
  return settings_for(arguments, session, c ? *c : Case{}, fallback);
}

int print_charts(const std::vector<std::filesystem::path>& files, const std::vector<std::string>& sentences, const Session& session) {
  for (const std::filesystem::path& file : files) session.out << file.string() << "\n";
  for (const std::string& sentence : sentences) session.out << sentence << "\n";
  return 0;
}

// What stages are measured.
class StageNames {
 public:
  void add(CLI::App& app, const std::vector<std::string>& all) {
    std::string names;
    for (const std::string& name : all) names += (names.empty() ? "" : ", ") + name;
    app.add_option("--stages", names_, "stages to measure: " + names + " (default: all)")
        ->type_name("STAGE,...")
        ->delimiter(',')
        ->check(CLI::IsMember(all));
  }
  const std::vector<std::string>& given() const { return names_; }
  bool asked(const char* stage) const { return names_.empty() || std::find(names_.begin(), names_.end(), stage) != names_.end(); }

 private:
  std::vector<std::string> names_;
};

}  // namespace

Action declare_frontier(CLI::App& app, Session& session) {
  struct Frontier {
    Arguments arguments;
    FrontierOptions options;
    StageNames stages;
  };
  const auto f = std::make_shared<Frontier>();
  add_case(app, f->arguments, "drawn scenes, or --frames");
  add_out(app, f->arguments, "out/frontier, or out/<name of the case's folder>/frontier");
  add_frames(app, f->arguments);
  f->stages.add(app, {"piv", "np", "mpm", "chain"});
  app.add_option("--repeats", f->options.repeats, "times that what takes less than a second is measured (3)")
      ->type_name("N")
      ->check(CLI::Range(1, 100));
  add_session(app, session);
  return [f, &session] {
    f->options.piv = f->stages.asked("piv");
    f->options.np = f->stages.asked("np");
    f->options.mpm = f->stages.asked("mpm");
    f->options.chain = f->stages.asked("chain");
    const std::optional<Case> c = scene(f->arguments, session);
    FrontierOutcome outcome;
    {
      TerminalProgress progress = progress_for(session);
      outcome = frontier(c ? &*c : nullptr, f->options, charts_in(f->arguments, session, c, "frontier"), progress);
    }
    const int code = print_charts(outcome.files, outcome.sentences, session);
    if (!session.quiet)
      for (const std::string& remark : outcome.remarks) session.out << "note: " << remark << "\n";
    return code;
  };
}

Action declare_stress(CLI::App& app, Session& session) {
  struct Stress {
    Arguments arguments;
    StressOptions options;
    StageNames stages;
  };
  const auto s = std::make_shared<Stress>();
  add_case(app, s->arguments, "the default settings");
  add_out(app, s->arguments, "out/stress, or out/<name of the case's folder>/stress");
  add_frames(app, s->arguments);
  s->stages.add(app, {stress_stages.begin(), stress_stages.end()});
  app.add_option("--seeds", s->options.seeds, "number of pairs of frames drawn for each combination (1)")->type_name("N")->check(CLI::Range(1, 100));
  app.add_option("--maps", s->options.maps, "maps to make, by name, for example mpm_step,piv_jpeg_window (default: all of the stages)")->type_name("NAME,...")->delimiter(',');
  app.add_flag("--short", s->options.in_short, "every second level and smaller frames: under a minute");
  add_session(app, session);
  return [s, &session] {
    s->options.stages = s->stages.given();
    std::optional<Case> c;
    if (!s->arguments.case_path.empty() || !s->arguments.frames.empty()) c = scene(s->arguments, session);
    else if (!s->arguments.given.empty()) c = parse_case("[frames]\npath = \"\"\n", "--set", std::filesystem::current_path(), s->arguments.given);
    StressOutcome outcome;
    try {
      TerminalProgress progress = progress_for(session);
      outcome = stress(c ? &*c : nullptr, s->options, charts_in(s->arguments, session, c, "stress"), progress);
    } catch (const Interrupted&) {
      session.err << "pivnp: the combinations that were finished are kept; the same command continues\n";
      throw;
    }
    const int code = print_charts(outcome.files, outcome.sentences, session);
    if (!session.quiet && outcome.kept > 0)
      session.out << "note: " << outcome.kept << " of " << outcome.combinations << " combinations are those of a run that was stopped\n";
    return code;
  };
}

Action declare_sweep(CLI::App& app, Session& session) {
  struct Sweep {
    Arguments arguments;
    SweepOptions options;
  };
  const auto s = std::make_shared<Sweep>();
  add_case(app, s->arguments);
  add_out(app, s->arguments, "out/<name of the case's folder>/sweep");
  app.add_option("--vary", s->options.vary, "a key and the values that it takes, as in --vary material.clay.friction_deg=10,11,12 (may be repeated; KEY+KEY=... sets several alike)")
      ->type_name("KEY=VALUE,...")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->required();
  app.add_flag("--grid", s->options.grid, "all combinations of the values (default: one key at a time, the others as in the case)");
  std::string names;
  for (const SweepResponse& r : sweep_responses()) names += (names.empty() ? "" : ", ") + r.name;
  app.add_option("--response", s->options.responses, "what is read off each run: " + names + ", or difference.METRIC, a metric of the comparison with --against (default: top_speed,run_out)")
      ->type_name("NAME,...")
      ->delimiter(',');
  app.add_option("--against", s->options.against, "the measurement that difference.METRIC compares each run with")->type_name("RECORD[:MOTION]");
  app.add_option("--zone", s->options.zone_m, "the particles that start in this box give displacement and speed (default: those that move at least half as far as the one that moves most)")
      ->type_name("X0,Y0,X1,Y1")
      ->delimiter(',')
      ->expected(4);
  app.add_option("--fields", s->options.fields, "fields drawn of each run's end (default: displacement_magnitude)")->type_name("NAME,...")->delimiter(',');
  app.add_option("--jobs", s->options.jobs, "runs at a time (default: as many as threads)")->type_name("N")->check(CLI::Range(1, 4096));
  add_session(app, session);
  return [s, &session] {
    const Case c = load_case(s->arguments, session);
    s->options.given = s->arguments.given;
    std::error_code failed;
    s->options.program = std::filesystem::read_symlink("/proc/self/exe", failed);
    SweepOutcome outcome;
    try {
      TerminalProgress progress = progress_for(session);
      outcome = sweep(c, s->options, settings_for(s->arguments, session, c, default_out(c) / "sweep"), progress);
    } catch (const Interrupted&) {
      session.err << "pivnp: the runs that were finished are kept; the same command continues\n";
      throw;
    }
    const int code = print_charts(outcome.files, outcome.sentences, session);
    const auto kept = std::count_if(outcome.runs.begin(), outcome.runs.end(), [](const SweepRun& run) { return run.kept; });
    if (!session.quiet && kept > 0) session.out << "note: " << kept << " of " << outcome.runs.size() << " runs are those of an earlier call\n";
    return code;
  };
}

Action declare_element(CLI::App& app, Session& session) {
  struct Element {
    Arguments arguments;
    ElementStudy study;
    std::string test = "triaxial";
  };
  const auto e = std::make_shared<Element>();
  add_case(app, e->arguments);
  add_out(app, e->arguments, "out/<name of the case's folder>/element");
  app.add_option("--test", e->test, "triaxial, biaxial (plane strain), oedometer, isotropic, simple_shear or direct_shear (triaxial)")
      ->type_name("TEST")
      ->check(CLI::IsMember(choice_names<mpm::ElementTest>()));
  app.add_option("--material", e->study.material, "the case's material to test (default: its only one)")->type_name("NAME");
  app.add_option("--pressure", e->study.pressures_pa,
                 "a test each: cell pressure, or vertical stress in shear, or the greatest stress of an oedometer or isotropic test, in Pa (50e3,100e3,200e3)")
      ->type_name("PA,...")
      ->delimiter(',');
  app.add_flag("--undrained", e->study.test.undrained, "constant volume, with the pore pressure that follows (default: drained)");
  app.add_option("--strain", e->study.test.strain, "axial or shear strain at the end (0.2)")->type_name("1");
  app.add_option("--k0", e->study.test.k0, "horizontal over vertical stress at the start of a shear test (1)")->type_name("1");
  app.add_option("--rate", e->study.test.rate_1_s, "strain rate, for laws that depend on it (1e-4)")->type_name("1/S");
  app.add_option("--band", e->study.band_m, "thickness of a shear box's band: the displacement is it times the shear strain (default: the strain is drawn)")->type_name("M");
  app.add_option("--lab", e->study.laboratory, "the laboratory's test, CSV: axial_strain_percent, deviator_stress_kpa, volumetric_strain_percent and the like")->type_name("FILE");
  add_session(app, session);
  return [e, &session] {
    const Case c = load_case(e->arguments, session);
    e->study.test.test = *value_named<mpm::ElementTest>(e->test);
    const ElementOutcome outcome = element(c, e->study, settings_for(e->arguments, session, c, default_out(c) / "element"));
    return print_charts(outcome.files, outcome.sentences, session);
  };
}

}  // namespace pivnp::app
