// Which folder may include which. An arrow that is not in this list is a fault, and so is a circle. Within a folder
// that is built in floors, a floor may use itself and those before it.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace {

namespace fs = std::filesystem;

using Folders = std::set<std::string>;

const Folders engines = {"compare", "mpm", "pivnp/np", "pivnp/piv", "pivnp/image", "pivnp/io", "pivnp/core"};

Folders with(Folders base, const Folders& more) {
  base.insert(more.begin(), more.end());
  return base;
}

const std::map<std::string, Folders> allowed = {
    {"pivnp/core", {}},
    {"pivnp/image", {"pivnp/core"}},
    {"pivnp/piv", {"pivnp/core"}},
    {"pivnp/np", {"pivnp/core"}},
    {"pivnp/io", {"pivnp/core"}},
    {"mpm", {"pivnp/core"}},
    {"compare", {"pivnp/core"}},
    {"apps/plot", {"pivnp/core"}},
    {"apps/report", {"compare", "pivnp/io", "pivnp/core", "apps/plot"}},
    {"apps/case", with(engines, {"apps/report"})},  // the report's options alone: see `only`
    {"apps/study", with(engines, {"apps/case", "apps/plot", "apps/report"})},
    {"python/src", with(engines, {"apps/case", "apps/study"})},  // without charts and reports: see `below`
    {"apps/cli", with(engines, {"apps/case", "apps/study", "apps/report"})},
    {"apps/view", with(engines, {"apps/case", "apps/plot", "apps/study", "apps/report"})},
};

// Floors from the lowest to the highest. What lies in the folder itself stands on all of them.
const std::map<std::string, std::vector<std::string>> floors = {
    {"pivnp/image", {"files", "camera", "masks", "frames", "calibration", "synthetic"}},
    {"pivnp/piv", {"sampling", "window", "dense", "validation"}},
    {"pivnp/io", {"files", "hdf5", "records", "imports", "exports"}},
    {"mpm", {"state", "simd", "grid", "material", "transfer", "constraint", "water", "heat", "scene", "step", "solver"}},
    {"compare", {"data", "shapes", "alignment", "uncertainty", "measures", "metrics"}},
    {"apps/report", {"content", "words", "figures", "document"}},
    {"apps/study/pipeline", {"scene", "measure", "record"}},
    {"apps/study/methods", {"frames", "simulation", "paths"}},
    {"apps/study", {"pipeline", "synth", "methods", "frontier", "element", "stress", "sweep", "studies"}},
    {"apps/view", {"model", "window"}},
};

// Of another folder, one floor only.
const std::map<std::pair<std::string, std::string>, std::string> below = {
    {{"python/src", "apps/study"}, "apps/study/pipeline/"},
};

// Of another folder, one header only.
const std::map<std::pair<std::string, std::string>, std::string> only = {
    {{"apps/case", "apps/report"}, "apps/report/content/options.hpp"},
};

// Vendor headers, and the folders that may see them.
const std::map<std::string, Folders> vendors = {
    {"opencv2/", {"pivnp/image", "pivnp/piv"}},
    {"CGAL/", {"pivnp/core", "pivnp/np", "compare"}},
    {"hdf5", {"pivnp/io"}},
    {"H5", {"pivnp/io"}},
    {"Q", {"apps/plot", "apps/report", "apps/view"}},
    {"qcustomplot", {"apps/plot", "apps/view"}},
    {"CLI/", {"apps/cli"}},
    {"toml++", {"apps/case"}},
    {"fftw3", {"pivnp/piv"}},
    {"hwy/", {"pivnp/core", "pivnp/np", "pivnp/piv", "mpm"}},
    {"pybind11/", {"python/src"}},
};

std::string folder_of(const std::string& path) {
  for (const auto& [folder, targets] : allowed)
    if (path.starts_with(folder + "/")) return folder;
  return "";
}

struct Include {
  std::string file, folder, target;
  bool quoted;
};

// Calls `see(file, line)` for all lines of the project's C++.
void for_each_line(const auto& see) {
  const fs::path root = PIVNP_SOURCE_DIR;
  for (const char* top : {"pivnp", "mpm", "compare", "apps", "python"})
    for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
      const std::string suffix = entry.path().extension().string();
      if (suffix != ".cpp" && suffix != ".hpp") continue;
      const std::string file = fs::relative(entry.path(), root).string();
      std::ifstream in(entry.path());
      std::string text;
      while (std::getline(in, text)) see(file, text);
    }
}

std::vector<Include> includes() {
  std::vector<Include> found;
  for_each_line([&](const std::string& file, const std::string& text) {
    const std::size_t open = text.find_first_of("<\"");
    if (!text.starts_with("#include") || open == std::string::npos) return;
    const std::size_t close = text.find_first_of(">\"", open + 1);
    found.push_back({file, folder_of(file), text.substr(open + 1, close - open - 1), text[open] == '"'});
  });
  return found;
}

TEST(Architecture, IncludesFollowTheArrows) {
  int arrows = 0;
  for (const Include& i : includes()) {
    EXPECT_NE(i.folder, "") << i.file << " lies outside the known folders";
    if (!i.quoted || i.folder.empty()) continue;
    const std::string target = folder_of(i.target);
    EXPECT_NE(target, "") << i.file << " includes \"" << i.target << "\": write paths from the project's top";
    if (target.empty() || target == i.folder) continue;
    ++arrows;
    EXPECT_TRUE(allowed.at(i.folder).contains(target)) << i.file << " includes " << i.target;
    if (const auto one = only.find({i.folder, target}); one != only.end()) {
      EXPECT_EQ(i.target, one->second) << i.file;
    }
    if (const auto floor = below.find({i.folder, target}); floor != below.end()) {
      EXPECT_TRUE(i.target.starts_with(floor->second)) << i.file << " includes " << i.target;
    }
  }
  EXPECT_GT(arrows, 50);  // the scan found something
}

// 0 the lowest floor, their number for the folder itself; -1: an unknown floor.
int height(const std::string& folder, const std::string& path) {
  const std::vector<std::string>& names = floors.at(folder);
  const std::string inside = path.substr(folder.size() + 1);
  const std::size_t slash = inside.find('/');
  if (slash == std::string::npos) return static_cast<int>(names.size());
  const auto at = std::find(names.begin(), names.end(), inside.substr(0, slash));
  return at == names.end() ? -1 : static_cast<int>(at - names.begin());
}

TEST(Architecture, FloorsStandOnThoseBelow) {
  std::map<std::string, int> arrows;
  for (const Include& i : includes())
    for (const auto& [folder, names] : floors) {
      if (!i.file.starts_with(folder + "/")) continue;
      const int own = height(folder, i.file);
      EXPECT_GE(own, 0) << i.file << " lies on an unknown floor of " << folder;
      if (!i.quoted || !i.target.starts_with(folder + "/")) continue;
      const int used = height(folder, i.target);
      EXPECT_LE(used, own) << i.file << " includes " << i.target << " of a floor above";
      arrows[folder] += used < own;
    }
  for (const auto& [folder, names] : floors) EXPECT_GE(arrows[folder], int(names.size()) - 1) << folder;
}

TEST(Architecture, NoCircle) {
  for (const auto& [start, first] : allowed) {
    Folders seen;
    std::vector<std::string> todo(first.begin(), first.end());
    while (!todo.empty()) {
      const std::string here = todo.back();
      todo.pop_back();
      EXPECT_NE(here, start) << "circle through " << start;
      if (seen.insert(here).second) todo.insert(todo.end(), allowed.at(here).begin(), allowed.at(here).end());
    }
  }
}

TEST(Architecture, VendorsStayInTheirFolders) {
  for (const Include& i : includes()) {
    if (i.quoted) continue;
    for (const auto& [prefix, folders] : vendors)
      if (i.target.starts_with(prefix)) {
        EXPECT_TRUE(folders.contains(i.folder)) << i.file << " includes <" << i.target << ">";
      }
  }
}

// A session in the window can be driven without a screen: what it holds knows no Qt.
TEST(Architecture, TheWindowsModelKnowsNoQt) {
  int seen = 0;
  for (const Include& i : includes()) {
    if (!i.file.starts_with("apps/view/model/")) continue;
    ++seen;
    EXPECT_FALSE(!i.quoted && (i.target.starts_with("Q") || i.target.starts_with("qcustomplot"))) << i.file << " includes <" << i.target << ">";
  }
  EXPECT_GT(seen, 20);
}

// A pipe or a device that is opened to read holds the program up for ever: pivnp/core/regular_file.hpp.
TEST(Architecture, FilesAreOpenedToReadByOneFunction) {
  const std::regex opens(R"re(ifstream( \w+)?[({]\s*[^"& ]|\bfopen\([^)]*"rb?"|\bimread\(|\bi?fstream \w+;)re");
  int seen = 0;
  for_each_line([&](const std::string& file, const std::string& line) {
    seen += line.find("open_regular_file(") != line.npos;
    if (file.starts_with("pivnp/core/regular_file.")) return;
    EXPECT_FALSE(std::regex_search(line, opens)) << file << ": " << line;
  });
  EXPECT_GT(seen, 9);
}

TEST(Architecture, HeadersShowVendorsToTheirFoldersOnly) {
  std::map<std::string, Folders> readers;  // of a header: other folders that include it
  for (const Include& i : includes())
    if (i.quoted && folder_of(i.target) != i.folder) readers[i.target].insert(i.folder);
  for (const Include& i : includes()) {
    if (i.quoted || !readers.contains(i.file)) continue;
    for (const auto& [prefix, folders] : vendors) {
      if (!i.target.starts_with(prefix)) continue;
      for (const std::string& reader : readers.at(i.file))
        EXPECT_TRUE(folders.contains(reader)) << i.file << " shows <" << i.target << "> to " << reader;
    }
  }
}

}  // namespace
