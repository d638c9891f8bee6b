// `pivnp verify`: every case with thresholds under the paths given, run and held against its thresholds; records, read and
// held against their checksums.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <memory>
#include <ostream>

#include "apps/cli/arguments.hpp"
#include "apps/cli/commands.hpp"
#include "apps/cli/junit.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/io/records/record_check.hpp"

namespace pivnp::app {

namespace fs = std::filesystem;

namespace {

struct Found {
  Case c;
  fs::path folder;  // under the output folder: unique among the cases found
};

std::vector<fs::path> case_files(const fs::path& path) {
  if (!fs::exists(path)) throw InputError(path.string() + ": no such file or folder");
  if (!fs::is_directory(path)) return {path};
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(path))
    if (entry.path().filename() == "case.toml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

// All are read before the first is run: a mistake in the last shows at once.
std::vector<Found> cases_with_thresholds(const std::vector<std::string>& paths, const std::vector<std::string>& given,
                                         const Session& session) {
  std::vector<Found> cases;
  for (const std::string& path : paths)
    for (const fs::path& file : case_files(path)) {
      Case c = read_case(file, given);
      print_notes(c, session);
      if (!demands_anything(c.verify)) continue;
      const std::string name = short_name(c);
      const auto same =
          std::count_if(cases.begin(), cases.end(), [&](const Found& f) { return short_name(f.c) == name; });
      cases.push_back({std::move(c), same == 0 ? name : name + "_" + std::to_string(same + 1)});
    }
  if (!cases.empty()) return cases;
  std::string where;
  for (const std::string& path : paths) where.append(where.empty() ? "" : ", ").append(path);
  throw InputError("nothing to verify: no case with a threshold in [verify] under " + where);
}

void check_record(const std::string& path, std::ostream& out) {
  const io::RecordCheck found = io::check_record(path);
  out << path << ": " << (found.has_checksum ? "intact, as it was written" : "can be read, but holds no checksum")
      << (found.written_by.empty() ? "" : " by pivnp " + found.written_by) << ": " << found.bytes << " bytes, "
      << found.frames << " frames, " << found.pairs << " pairs";
  for (const io::RecordCheck::Motion& motion : found.motions)
    out << ", " << motion.name << " with " << motion.particles << " particles at " << motion.times << " times";
  out << std::endl;
}

// Each says its own: 2 if one is not as it was written, else 1 if one could not be read, else 0.
int check_records(const std::vector<std::string>& paths, Session& session) {
  int code = 0;
  for (const std::string& path : paths) try {
      check_record(path, session.out);
    } catch (const InputError& error) {
      print_error(session.err, error.what());
      code = 2;
    } catch (const RunError& error) {
      print_error(session.err, error.what());
      if (code == 0) code = 1;
    }
  return code;
}

void write_file(const fs::path& file, const std::string& text) {
  if (file.has_parent_path()) fs::create_directories(file.parent_path());
  std::ofstream stream(file, std::ios::binary);
  stream << text << std::flush;
  if (!stream) throw RunError(file.string() + ": cannot be written");
}

int verdict(const std::vector<VerifyResult>& results) {
  int code = 0;
  for (const VerifyResult& result : results) {
    if (!result.failure.empty()) return 1;
    if (!result.passed) code = 3;
  }
  return code;
}

}  // namespace

Action declare_verify(CLI::App& app, Session& session) {
  struct Verify {
    Arguments arguments;
    std::vector<std::string> paths;
    std::string junit;
  };
  const auto v = std::make_shared<Verify>();
  app.add_option("PATH", v->paths, "cases, or folders that hold them; or records (record.h5, or an output folder)")->required();
  add_given(app, v->arguments);
  add_out(app, v->arguments, "out/verify");
  app.add_option("--junit", v->junit, "the results as JUnit XML (default: verify.xml in the output folder)")
      ->type_name("FILE");
  add_session(app, session);
  return [v, &session] {
    const auto records = std::stable_partition(v->paths.begin(), v->paths.end(),
                                               [](const std::string& path) { return !io::is_record(path); });
    const int code = check_records({records, v->paths.end()}, session);
    v->paths.erase(records, v->paths.end());
    if (v->paths.empty() || code != 0) return code;
    const std::vector<Found> cases = cases_with_thresholds(v->paths, v->arguments.given, session);
    std::vector<VerifyResult> results;
    RunSettings settings = settings_for(v->arguments, session, {}, "out/verify");
    const fs::path out = settings.out;
    for (const Found& found : cases) {
      settings.out = out / found.folder;
      VerifyResult result;
      {
        TerminalProgress progress = progress_for(session);
        result = verify_case(found.c, settings, progress);
      }
      session.out << verify_table({result}) << std::flush;
      results.push_back(std::move(result));
    }
    write_file(v->junit.empty() ? out / "verify.xml" : fs::path(v->junit), junit_xml(results));
    const auto passed = std::count_if(results.begin(), results.end(), [](const VerifyResult& r) { return r.passed; });
    session.out << passed << " of " << results.size() << " cases passed\n";
    return verdict(results);
  };
}

}  // namespace pivnp::app
