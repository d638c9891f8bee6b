// What the settings of [piv] do, each on one telling scene: docs/pictures/piv_*.png. Usage: piv_pictures FOLDER
#include <cmath>
#include <cstdio>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "apps/plot/files.hpp"
#include "apps/plot/marks.hpp"
#include "tests/support/piv_score.hpp"

namespace {

using namespace pivnp;
using namespace pivnp::plot;
using piv::NodeLattice, piv::PivOptions, piv::PixelVectors;

constexpr int side = 512;
constexpr double dots_per_inch = 110;

struct Line {
  std::string name;
  Rgb colour;
  PivOptions options;
};

PivOptions with(const std::function<void(PivOptions&)>& change) {
  PivOptions options;
  change(options);
  return options;
}

PixelVectors measure(const image::SyntheticPair& pair, const NodeLattice& nodes, const PivOptions& options) {
  return piv::PairCorrelator(options, nodes, pair.width, pair.height, 1)
      .correlate(pair.first.view(), pair.second.view(), {});
}

void write(const Canvas& canvas, const std::string& file) {
  write_file(file, canvas.png(dots_per_inch));
  std::printf("%s\n", file.c_str());
}

void title(Canvas& canvas, double x_mm, const char* words) {
  canvas.text(x_mm, 2, words, Align::top_left, {.bold = true});
}

// Names of lines below the panels, `across` of them in a row.
void keys(Canvas& canvas, const std::vector<Line>& lines, double y_mm) {
  double x = legend(canvas, 14, y_mm, Key::dashed, ink, "truth");
  for (const Line& line : lines) x = legend(canvas, x, y_mm, Key::line, line.colour, line.name);
}

// One column of nodes through the middle, 2 px apart: u against y.
NodeLattice column_of_nodes(double x, double half_length) {
  NodeLattice nodes;
  const double middle = 0.5 * (side - 1);
  for (double y = -half_length; y <= half_length; y += 2) nodes.pixel.push_back({float(x), float(middle + y)});
  nodes.nx = 1, nodes.ny = static_cast<int>(nodes.pixel.size());
  return nodes;
}

// u of every setting along a column of nodes, beside the truth; values that are not trusted are left out.
void profiles(Canvas& canvas, double x_mm, const image::SyntheticPair& pair, double half_length, double largest,
              const std::vector<Line>& lines, std::size_t component = 0) {
  Panel panel = canvas.panel(x_mm, 8, 62, 46);
  panel.axis(Axis::x, -half_length, half_length, "across (px)");
  panel.axis(Axis::y, -largest, largest, component == 0 ? "u (px)" : "v (px)").pale_grid();
  const NodeLattice nodes = column_of_nodes(0.5 * (side - 1), half_length);
  std::vector<double> at, truth;
  for (const auto& [x, y] : nodes.pixel) {
    at.push_back(y - 0.5 * (side - 1));
    truth.push_back(pair.truth({x, y}, Anchor::central)[static_cast<Eigen::Index>(component)]);
  }
  for (const Line& line : lines) {
    const PixelVectors found = measure(pair, nodes, line.options);
    std::vector<double> u;
    for (std::size_t k = 0; k < at.size(); ++k)
      u.push_back(found.status[k] == VectorStatus::valid ? double(found.displacement[k][component]) : NAN);
    canvas.curve(panel, at, u, {line.colour, 1.1});
  }
  canvas.curve(panel, at, truth, {ink, 0.7, Dash::dashed});
}

image::SyntheticPair pair_of(image::Motion motion, double noise, double loss = 0) {
  image::TextureOptions texture;
  texture.noise = noise, texture.loss = loss, texture.seed = 5;
  return image::synthetic_pair(std::move(motion), side, side, texture);
}

constexpr double middle = 0.5 * (side - 1);

void window_picture(const std::string& folder) {
  Canvas canvas(164, 74);
  std::vector<Line> lines;
  const std::pair<int, Rgb> windows[] = {{16, blue}, {32, vermilion}, {64, green}};
  for (const auto& [window, rgb] : windows)
    lines.push_back({std::to_string(window) + " px", rgb, with([w = window](PivOptions& o) { o.window_px = w; })});
  title(canvas, 14, "shear band, half-width 5 px, clean frames");
  profiles(canvas, 14, pair_of(image::band(2, 5, middle, middle), 0), 40, 2.6, lines);
  title(canvas, 94, "the same, 10 % of noise");
  profiles(canvas, 94, pair_of(image::band(2, 5, middle, middle), 0.1), 40, 2.6, lines);
  keys(canvas, lines, 69);
  write(canvas, folder + "/piv_window.png");
}

void smoothing_picture(const std::string& folder) {
  Canvas canvas(164, 74);
  const std::vector<Line> lines = {{"adaptive", vermilion, {}},
                                   {"window, order 1", blue, with([](PivOptions& o) { o.smoothing = piv::Smoothing::window; })}};
  title(canvas, 14, "wave of 128 px and .2 px, 5 % of noise");
  profiles(canvas, 14, pair_of(image::sine(0.2, 128), 0.05), 128, 0.32, lines);
  title(canvas, 94, "wave of 64 px and .06 px, 10 % of noise");
  profiles(canvas, 94, pair_of(image::sine(0.06, 64), 0.1), 128, 0.32, lines);
  keys(canvas, lines, 69);
  write(canvas, folder + "/piv_smoothing.png");
}

void method_picture(const std::string& folder) {
  Canvas canvas(164, 80);
  const auto method = [](const char* name) { return with([=](PivOptions& o) { o.method = name; }); };
  const std::vector<Line> lines = {{"gn", vermilion, method("gn")},
                                   {"fast", green, method("fast")},
                                   {"fft", blue, method("fft")}};
  title(canvas, 14, "wave of 48 px and 1 px, clean frames");
  profiles(canvas, 14, pair_of(image::sine(1, 48), 0), 72, 1.5, lines);
  title(canvas, 94, "wave of 96 px, 20 % of grains lost");
  profiles(canvas, 94, pair_of(image::sine(1, 96), 0, 0.2), 72, 1.5, lines);
  keys(canvas, lines, 69);
  write(canvas, folder + "/piv_method.png");
}

void order_picture(const std::string& folder) {
  Canvas canvas(164, 74);
  std::vector<Line> lines;
  const Rgb colours[] = {blue, green, vermilion};
  for (const int order : {0, 1, 2})
    lines.push_back({"order " + std::to_string(order), colours[order],
                     with([=](PivOptions& o) { o.smoothing = piv::Smoothing::window, o.order = order; })});
  title(canvas, 14, "wave of 48 px and 1 px, clean frames");
  profiles(canvas, 14, pair_of(image::sine(1, 48), 0), 72, 1.5, lines);
  title(canvas, 94, "no motion, 10 % of noise");
  profiles(canvas, 94, pair_of(image::uniform(0, 0), 0.1), 72, 0.5, lines);
  keys(canvas, lines, 69);
  write(canvas, folder + "/piv_order.png");
}

// Turned by 6 degrees about the middle: what belongs to the middle of the path and what to its start.
void anchor_picture(const std::string& folder) {
  Canvas canvas(164, 74);
  const image::SyntheticPair pair = pair_of(image::rotation(6, middle, middle), 0);
  const NodeLattice nodes = column_of_nodes(middle, 100);
  const char* titles[] = {"turned by 6 degrees: u", "and v, where only the anchors differ"};
  for (const int component : {0, 1}) {
    const double x = component == 0 ? 14 : 94, largest = component == 0 ? 13 : 1;
    title(canvas, x, titles[component]);
    Panel panel = canvas.panel(x, 8, 62, 46);
    panel.axis(Axis::x, -100, 100, "y, down from the centre (px)");
    panel.axis(Axis::y, -largest, largest, component == 0 ? "u (px)" : "v (px)").pale_grid();
    for (const Anchor anchor : {Anchor::central, Anchor::forward}) {
      const PixelVectors found = measure(
          pair, nodes, with([=](PivOptions& o) { o.anchor = anchor; }));
      std::vector<double> at, value, truth;
      for (std::size_t k = 0; k < nodes.pixel.size(); ++k) {
        const auto [px, py] = nodes.pixel[k];
        at.push_back(py - middle);
        const bool valid = found.status[k] == VectorStatus::valid;
        value.push_back(valid ? double(found.displacement[k][std::size_t(component)]) : NAN);
        truth.push_back(pair.truth({px, py}, anchor)[component]);
      }
      canvas.curve(panel, at, value, {anchor == Anchor::central ? vermilion : blue, 1.4});
      canvas.curve(panel, at, truth, {ink, 0.7, Dash::dashed});
    }
  }
  keys(canvas, {{"central", vermilion, {}}, {"forward", blue, {}}}, 69);
  write(canvas, folder + "/piv_anchor.png");
}

// A patch whose texture is another one in the second frame, amid 30 % of loss: what is valid, rebuilt, not trusted.
void rejection_picture(const std::string& folder) {
  Canvas canvas(164, 74);
  image::SyntheticPair pair = pair_of(image::sine(1, 128), 0, 0.3);
  image::TextureOptions texture;
  texture.seed = 77;
  const image::SyntheticPair strange = image::synthetic_pair(image::uniform(0, 0), side, side, texture);
  constexpr int first = 190, end = 300;
  for (int r = first; r < end; ++r)
    std::copy_n(strange.second.view().row<std::uint8_t>(r) + first, end - first,
                pair.second.row<std::uint8_t>(r) + first);
  const NodeLattice nodes = piv::even_nodes(side, side, 8, 100);
  const std::pair<const char*, PivOptions> settings[] = {
      {"default", {}},
      {"max_sigma_px = .3", with([](PivOptions& o) { o.max_sigma_px = 0.3; })},
      {"min_score = .5", with([](PivOptions& o) { o.min_score = 0.5; })}};
  const auto colour_of = [](VectorStatus s) {
    return s == VectorStatus::valid      ? Rgb(0xd9e6ef)
           : s == VectorStatus::replaced ? orange
           : s == VectorStatus::rejected ? red
                                         : no_value;
  };
  double x = 8;
  for (const auto& [name, options] : settings) {
    const PixelVectors found = measure(pair, nodes, options);
    title(canvas, x, name);
    Panel panel = canvas.panel(x, 8, 46, 46);
    panel.axis(Axis::x, 0, nodes.nx, "").axis(Axis::y, 0, nodes.ny, "");
    for (const Axis axis : {Axis::x, Axis::y}) panel.ticks(axis, false).numbers(axis, false);
    canvas.paint(panel, [=](Painter& p) {
      p.no_pen();
      for (int j = 0; j < nodes.ny; ++j)
        for (int i = 0; i < nodes.nx; ++i) {
          Rectangle tile = between(panel.at({double(i), double(j)}), panel.at({i + 1.0, j + 1.0}));
          tile = {tile.left + 0.4, tile.top + 0.4, tile.width - 0.8, tile.height - 0.8};
          p.fill({colour_of(found.status[std::size_t(j * nodes.nx + i)])});
          p.rectangle(tile);
        }
      const double x0 = (first - 100) / 8.0, x1 = (end - 100) / 8.0, y0 = (side - 101 - end) / 8.0,
                   y1 = (side - 101 - first) / 8.0;
      p.pen({ink, 0.9, Dash::dashed});
      p.no_fill();
      p.rectangle(between(panel.at({x0, y0}), panel.at({x1, y1})));
    });
    x += 52;
  }
  double at = legend(canvas, 8, 63, Key::tile, 0xd9e6ef, "valid");
  at = legend(canvas, at, 63, Key::tile, orange, "replaced (rebuilt from neighbours)");
  at = legend(canvas, at, 63, Key::tile, red, "rejected");
  legend(canvas, at, 63, Key::dashed, ink, "texture exchanged here");
  canvas.text(8, 68, "A shear wave with 30 % of its grains lost.", Align::top_left,
              {.points = small_text, .rgb = faint});
  write(canvas, folder + "/piv_rejection.png");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: piv_pictures FOLDER\n");
    return 2;
  }
  try {
    for (const auto picture :
         {method_picture, window_picture, smoothing_picture, order_picture, anchor_picture, rejection_picture})
      picture(argv[1]);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "piv_pictures: %s\n", e.what());
    return 2;
  }
  return 0;
}
