#include "apps/study/frontier/piv/peers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <sstream>
#include <utility>
#include <vector>

#include "apps/study/frontier/piv/piv_frontier.hpp"
#include "apps/study/methods/frames/known_pairs.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/image/synthetic/synthetic_pair.hpp"

namespace pivnp::app {

namespace {

constexpr double peer_spacing = 8, peer_margin = 48;
constexpr double ours_there = 220000;  // vectors a second of our default, one thread of their machine

struct PeerRow {
  std::string name;  // of peers.csv
  image::Motion motion;
  double loss = 0, wavelength = 0;
  bool on_slopes = false;  // scored within 24 px of the steepest places of the triangle wave alone
};

std::vector<PeerRow> peer_rows(int side) {
  const double middle = 0.5 * (side - 1);
  return {{"shift 20.3 -5.7", image::uniform(20.3, -5.7)},
          {"rotation 1 deg", image::rotation(1, middle, middle)},
          {"shear 10 %", image::triangle_shear(0.1), 0, 0, true},
          {"shear 20 %", image::triangle_shear(0.2), 0, 0, true},
          {"band w=16 A=4", image::band(4, 16, middle, middle)},
          {"band w=8 A=2", image::band(2, 8, middle, middle)},
          {"band w=4 A=2", image::band(2, 4, middle, middle)},
          {"sine 128", image::sine(1, 128), 0, 128},
          {"sine 64", image::sine(1, 64), 0, 64},
          {"sine 32", image::sine(1, 32), 0, 32},
          {"loss 20 %", image::uniform(2.3, -1.4), 0.2}};
}
// The first is there for the noise of even motion; some programs return nothing at its 20 px.
constexpr std::size_t first_compared = 1;

KnownPairs pairs(int side) {
  KnownPairs known;
  known.width = known.height = side;
  known.nodes = even_nodes(side, peer_spacing, peer_margin);
  known.scored.assign(known.nodes.pixel.size(), 1);
  int seed = 1301;
  for (const PeerRow& row : peer_rows(side)) {
    image::TextureOptions texture;
    texture.seed = seed++;
    texture.loss = row.loss;
    auto scene = std::make_shared<image::SyntheticPair>(image::synthetic_pair(row.motion, side, side, texture));
    KnownPair pair{row.name, std::move(scene->first), std::move(scene->second),
                   [scene](const Vec2& place, Anchor anchor) { return scene->truth(place, anchor); }, row.wavelength, {}};
    if (row.on_slopes)
      for (const auto& p : known.nodes.pixel) pair.scored.push_back(std::abs(double(p[1]) - 64 - 128 * std::round((double(p[1]) - 64) / 128)) < 24);
    known.pairs.push_back(std::move(pair));
  }
  return known;
}

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> parts;
  std::stringstream text(line);
  for (std::string part; std::getline(text, part, ',');) parts.push_back(part);
  return parts;
}

}  // namespace

FrontierStage peers_frontier(int side, int repeats, Progress& progress) {
  const KnownPairs known = pairs(side);
  std::vector<PivChoice> chosen;
  constexpr std::array names = {"default, 16 px", "default, 32 px", "default, 64 px", "default, 32 px, subsets", "fast, 32 px", "fft, 16 px", "fft, 32 px"};
  for (PivChoice& choice : piv_choices({}))
    if (std::find(names.begin(), names.end(), choice.name) != names.end()) chosen.push_back(std::move(choice));
  // The rms over all rows but the first is made from those of the rows: the first counts for noise alone.
  FrontierStage stage = piv_frontier(known, {}, false, repeats, 1, progress, chosen, first_compared);
  stage.name = "peers";
  stage.title = "Image correlation beside other programs";
  stage.time_label = "time per vector, one thread (µs)";
  stage.time_unit = 1e-6;
  const double vectors = double(known.nodes.pixel.size());
  for (FrontierPoint& p : stage.points)
    for (double* t : {&p.seconds, &p.quickest, &p.slowest}) *t /= vectors;
  const auto standard = std::find_if(stage.points.begin(), stage.points.end(), [](const FrontierPoint& p) { return p.standard; });
  const double slower = standard->seconds * ours_there;  // this machine than theirs
  std::stringstream table(peers_table());
  std::string line;
  std::getline(table, line);
  const std::vector<std::string> head = cells(line);
  std::string incomplete;
  while (std::getline(table, line)) {
    const std::vector<std::string> parts = cells(line);
    if (parts.empty()) continue;
    FrontierPoint p;
    p.name = parts[0];
    p.keys = "another program";
    p.elsewhere = true;
    p.seconds = slower / std::stod(parts[1]);
    double square = 0, n = 0;
    const std::vector<PeerRow> compared = peer_rows(side);
    for (std::size_t k = first_compared; k < compared.size(); ++k) {
      const auto column = std::size_t(std::find(head.begin(), head.end(), compared[k].name) - head.begin());
      if (column >= parts.size() || parts[column].empty()) continue;
      const double rms = std::stod(parts[column]);
      square += rms * rms, ++n;
      p.worst = std::isnan(p.worst) ? rms : std::max(p.worst, rms);
    }
    if (n < double(compared.size() - first_compared)) {
      incomplete += (incomplete.empty() ? "" : ", ") + p.name;
      continue;
    }
    p.error = std::sqrt(square / n);
    p.columns.assign(stage.columns.size(), std::nan(""));
    stage.points.push_back(std::move(p));
  }
  stage.made_of = "Drawn frames of " + std::to_string(side) + " x " + std::to_string(side) + " px (3 px blobs, 0.05 a pixel), nodes 8 px apart: a rotation, shears, bands, waves, and a fifth of the blobs lost. Other "
                  "programs were measured on frames of 1024 x 1024 px of the same recipe on another machine (two cores of an AMD EPYC), one thread, all vectors that they returned; their "
                  "times are those, times " + number(slower, 2) + ": what our default takes here over what it took there (1/220000 s a vector).";
  if (!incomplete.empty()) stage.left_out.push_back(incomplete + ": not measured on all of these rows.");
  return stage;
}

}  // namespace pivnp::app
