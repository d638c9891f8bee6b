// Which folder may include which. An arrow that is not in this list is a fault, and so is a circle.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
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
    {"apps/cli", with(engines, {"apps/case", "apps/study", "apps/report"})},
};

// Floors of a folder, from the lowest: each may include those before it, and the folder's own files all of them.
const std::map<std::string, std::vector<std::string>> floors = {
    {"mpm", {"state", "simd", "grid", "material", "transfer", "constraint", "step"}},
    {"apps/report", {"content", "words", "figures", "document"}},
    {"apps/study", {"pipeline", "synth", "methods", "studies"}},
};

// Of another folder, one header only.
const std::map<std::pair<std::string, std::string>, std::string> only = {
    {{"apps/case", "apps/report"}, "apps/report/content/options.hpp"},
};

// Vendor headers, and the folders that may see them.
const std::map<std::string, Folders> vendors = {
    {"opencv2/", {"pivnp/image", "pivnp/piv"}}, {"CGAL/", {"pivnp/core", "pivnp/np", "compare"}}, {"hdf5", {"pivnp/io"}},
    {"H5", {"pivnp/io"}},          {"Q", {"apps/plot", "apps/report"}},  {"qcustomplot", {"apps/plot", "apps/report"}},
    {"CLI/", {"apps/cli"}},        {"toml++", {"apps/case"}},            {"fftw3", {"pivnp/piv"}},
    {"hwy/", {"pivnp/np", "pivnp/piv", "mpm"}},
};

std::string folder_of(const std::string& path) {
  for (const auto& [folder, targets] : allowed)
    if (path.starts_with(folder + "/")) return folder;
  return "";
}

// Place of a file's floor in its folder's list; above all floors for the folder's own files, -1 for an unknown floor.
int floor_of(const std::string& path, const std::string& folder) {
  const std::string rest = path.substr(folder.size() + 1);
  const std::vector<std::string>& list = floors.at(folder);
  if (rest.find('/') == std::string::npos) return int(list.size());
  const auto at = std::find(list.begin(), list.end(), rest.substr(0, rest.find('/')));
  return at == list.end() ? -1 : int(at - list.begin());
}

struct Include {
  std::string file, folder, target;
  bool quoted;
};

std::vector<Include> includes() {
  std::vector<Include> found;
  const fs::path root = PIVNP_SOURCE_DIR;
  for (const char* top : {"pivnp", "mpm", "compare", "apps"})
    for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
      const std::string suffix = entry.path().extension().string();
      if (suffix != ".cpp" && suffix != ".hpp") continue;
      const std::string file = fs::relative(entry.path(), root).string();
      std::ifstream in(entry.path());
      std::string text;
      while (std::getline(in, text)) {
        const std::size_t open = text.find_first_of("<\"");
        if (!text.starts_with("#include") || open == std::string::npos) continue;
        const std::size_t close = text.find_first_of(">\"", open + 1);
        found.push_back({file, folder_of(file), text.substr(open + 1, close - open - 1), text[open] == '"'});
      }
    }
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
  }
  EXPECT_GT(arrows, 50);  // the scan found something
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

// Within a folder that has floors nothing looks upward: so there is no circle between them.
TEST(Architecture, FloorsLookDown) {
  int steps = 0;
  for (const Include& i : includes()) {
    if (!floors.contains(i.folder)) continue;
    const int from = floor_of(i.file, i.folder);
    EXPECT_GE(from, 0) << i.file << " lies on no known floor of " << i.folder;
    if (!i.quoted || folder_of(i.target) != i.folder) continue;
    const int to = floor_of(i.target, i.folder);
    EXPECT_LE(to, from) << i.file << " includes " << i.target;
    steps += to < from;
  }
  EXPECT_GT(steps, 50);
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

TEST(Architecture, HeadersShowVendorsToTheirFoldersOnly) {
  std::map<std::string, Folders> readers;  // of a header: other folders that include it
  for (const Include& i : includes())
    if (i.quoted && folder_of(i.target) != i.folder) readers[i.target].insert(i.folder);
  for (const Include& i : includes()) {
    if (i.quoted || !readers.contains(i.file)) continue;
    for (const auto& [prefix, folders] : vendors)
      if (i.target.starts_with(prefix))
        for (const std::string& reader : readers.at(i.file))
          EXPECT_TRUE(folders.contains(reader)) << i.file << " shows <" << i.target << "> to " << reader;
  }
}

}  // namespace
