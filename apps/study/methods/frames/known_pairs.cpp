#include "apps/study/methods/frames/known_pairs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "apps/study/methods/frames/frame_noise.hpp"
#include "apps/study/pipeline/measure/measure.hpp"
#include "apps/study/pipeline/measure/statistics.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

constexpr int wavelengths[] = {256, 128, 64, 32};  // px
constexpr double band_half_width = 8;              // px
constexpr double carried_blur = 0.7;               // px
constexpr int most_px = 1200;                      // side of the part of a frame that is carried

struct Field {
  std::string name;
  image::Motion motion;  // displacement by the place
  double wavelength = 0;
  double noise = 0, loss = 0;  // of drawn texture
};

// Fields of a greatest displacement `shift` px and gradient `slope` about the image's middle.
std::vector<Field> fields(double shift, double slope, double cx, double cy) {
  const double whole = std::floor(shift);
  std::vector<Field> all = {{"shift", image::uniform(whole + 0.3, -0.6 * whole - 0.4)}};
  for (const int length : wavelengths)
    all.push_back(
        {"wave " + std::to_string(length) + " px", image::sine(slope * length / (2 * M_PI), length), double(length)});
  all.push_back({"shear " + number(100 * slope, 2) + " %", image::triangle_shear(slope)});
  all.push_back({"band " + number(2 * band_half_width, 2) + " px",
                 image::band(slope * band_half_width, band_half_width, cx, cy)});
  return all;
}

double percentile(std::vector<double> values, double share) {
  const auto at = values.begin() + std::ptrdiff_t(share * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// What the frames show: 95th percentiles over valid nodes.
struct Shown {
  double shift = 0, slope = 0;  // px, px/px
  std::size_t valid = 0;
};

Shown shown(const piv::PixelVectors& found, const piv::NodeLattice& nodes) {
  const auto ok = [&](std::size_t k) { return found.status[k] == VectorStatus::valid; };
  const auto at = [&](const std::array<float, 2>& a) { return Vec2(double(a[0]), double(a[1])); };
  std::vector<double> shifts, slopes;
  for (int j = 0; j < nodes.ny; ++j)
    for (int i = 0; i < nodes.nx; ++i) {
      const std::size_t k = std::size_t(j) * std::size_t(nodes.nx) + std::size_t(i);
      if (!ok(k)) continue;
      shifts.push_back(at(found.displacement[k]).norm());
      for (const std::size_t next :
           {i + 2 < nodes.nx ? k + 2 : k, j + 2 < nodes.ny ? k + 2 * std::size_t(nodes.nx) : k})
        if (next != k && ok(next))
          slopes.push_back((at(found.displacement[next]) - at(found.displacement[k])).norm() /
                           (at(nodes.pixel[next]) - at(nodes.pixel[k])).norm());
    }
  Shown out;
  out.valid = shifts.size();
  if (!shifts.empty()) out.shift = percentile(std::move(shifts), 0.95);
  if (!slopes.empty()) out.slope = percentile(std::move(slopes), 0.95);
  return out;
}

// Of a large frame the part about what is scored: the pairs, their nodes and their mask are of that part from here on.
Image cropped(KnownPairs& known, const Image& frame) {
  const int width = std::min(frame.width(), most_px), height = std::min(frame.height(), most_px);
  if (width == frame.width() && height == frame.height()) {
    Image copy(width, height, frame.depth(), frame.white());
    std::copy_n(frame.view().data, frame.stride() * height, reinterpret_cast<std::byte*>(copy.row<std::uint8_t>(0)));
    return copy;
  }
  double cx = 0, cy = 0, n = 0;
  for (std::size_t k = 0; k < known.scored.size(); ++k)
    if (known.scored[k]) cx += double(known.nodes.pixel[k][0]), cy += double(known.nodes.pixel[k][1]), ++n;
  const int left = std::clamp(int(cx / n) - width / 2, 0, frame.width() - width),
            top = std::clamp(int(cy / n) - height / 2, 0, frame.height() - height);
  Image part(width, height, frame.depth(), frame.white());
  const std::size_t pixel = bytes_per_pixel(frame.depth());
  for (int r = 0; r < height; ++r)
    std::copy_n(frame.view().data + (top + r) * frame.stride() + std::ptrdiff_t(pixel) * left,
                pixel * std::size_t(width), reinterpret_cast<std::byte*>(part.row<std::uint8_t>(r)));
  if (!known.mask.empty()) {
    image::Mask mask(width, height);
    for (int r = 0; r < height; ++r) std::copy_n(known.mask.row(top + r) + left, width, mask.row(r));
    known.mask = std::move(mask);
  }
  constexpr float rim = 32;
  if (known.nodes.on.empty()) known.nodes.on.assign(known.nodes.pixel.size(), 1);
  for (std::size_t k = 0; k < known.nodes.pixel.size(); ++k) {
    float &x = known.nodes.pixel[k][0], &y = known.nodes.pixel[k][1];
    x -= float(left), y -= float(top);
    if (x >= rim && y >= rim && x <= float(width) - 1 - rim && y <= float(height) - 1 - rim) continue;
    known.nodes.on[k] = known.scored[k] = 0;
  }
  known.width = width;
  known.height = height;
  return part;
}

// Median over the valid nodes of what does not correlate.
double unlike_share(const KnownPairs& known, const std::vector<float>& score, const std::vector<VectorStatus>& status) {
  std::vector<double> all;
  for (std::size_t k = 0; k < score.size(); ++k)
    if (known.scored[k] && status[k] == VectorStatus::valid) all.push_back(1 - double(score[k]));
  return median(std::move(all), 0);
}

}  // namespace

Vec2 middle_of(const image::Motion& motion, const Vec2& px, int side) {
  Vec2 x = px;
  for (int k = 0; k < 30; ++k) x = px - 0.5 * side * motion(x);  // slopes are far below 2: it converges
  return x;
}

piv::NodeLattice even_nodes(int side, double spacing, double rim) {
  piv::NodeLattice nodes;
  nodes.nx = nodes.ny = int((side - 1 - 2 * rim) / spacing) + 1;
  for (int j = 0; j < nodes.ny; ++j)
    for (int i = 0; i < nodes.nx; ++i)
      nodes.pixel.push_back({float(rim + i * spacing), float(side - 1 - rim - j * spacing)});
  return nodes;
}

KnownPairs drawn_pairs(int side, int seed) {
  constexpr double spacing = 8, margin = 48;
  KnownPairs known;
  known.made_of = "Drawn texture: blobs of 3 px, 0.05 a pixel, frames of " + std::to_string(side) + " x " +
                  std::to_string(side) +
                  " px, nodes 8 px apart; noise is in percent of white, loss the share of blobs without a partner.";
  known.width = known.height = side;
  known.nodes = even_nodes(side, spacing, margin);
  known.scored.assign(known.nodes.pixel.size(), 1);
  const double middle = 0.5 * (side - 1);
  std::vector<Field> all = fields(2, 0.1, middle, middle);
  for (const int length : wavelengths)
    all.push_back({"wave " + std::to_string(length) + " px, noise 5 %", image::sine(0.1 * length / (2 * M_PI), length),
                   0, 0.05, 0});
  all.push_back({"shift, noise 5 %", image::uniform(2.3, -1.4), 0, 0.05, 0});
  all.push_back({"shift, loss 20 %", image::uniform(2.3, -1.4), 0, 0, 0.2});
  image::TextureOptions texture;
  for (Field& field : all) {
    texture.seed = seed++;
    texture.noise = field.noise;
    texture.loss = field.loss;
    auto scene = std::make_shared<image::SyntheticPair>(image::synthetic_pair(field.motion, side, side, texture));
    known.pairs.push_back({field.name,
                           std::move(scene->first),
                           std::move(scene->second),
                           [scene](const Vec2& place, Anchor anchor) { return scene->truth(place, anchor); },
                           field.wavelength,
                           {}});
  }
  return known;
}

KnownPair CarriedFrame::pair(const std::string& name, const image::Motion& motion, std::uint64_t number) const {
  const auto draw = [&](int side) {
    return texture.draw(
        [&](int column, int row) {
          return texture.at(middle_of(motion, {double(column), double(row)}, side));
        },
        1, 2 * number + (side > 0 ? 1 : 0));
  };
  return {name,
          draw(-1),
          draw(1),
          [motion](const Vec2& place, Anchor anchor) {
            return motion(anchor == Anchor::central ? place : middle_of(motion, place, -1));
          },
          0,
          {}};
}

CarriedFrame carried_frame(const Case& c, const Setting& setting, image::FrameSource& source, int threads,
                           Progress& progress) {
  const std::size_t frames = source.frames().size();
  if (frames < 2)
    throw InputError(of_file(c) + (of_file(c).empty() ? "" : ": ") +
                     "frames: found one, expected two or more to show how the material moves");
  KnownPairs known;
  known.width = setting.width;
  known.height = setting.height;
  known.mask = setting.mask;
  known.nodes = node_lattice(setting);
  // Of three pairs the one that moves most says what is to be measured.
  Shown most;
  piv::PixelVectors best;
  VectorField field;
  int from = 0;
  std::vector<double> moved(known.nodes.pixel.size(), 0), looks(moved);
  piv::PairCorrelator correlator(*c.piv, known.nodes, known.width, known.height, threads);
  for (const std::size_t at : {std::size_t(0), (frames - 1) / 2, frames - 2}) {
    progress.update("looking at the frames", std::int64_t(at), std::int64_t(frames));
    if (progress.stop_requested()) throw Interrupted();
    const Image first = source.read(int(at)), second = source.read(int(at) + 1);
    const piv::PixelVectors found = correlator.correlate(first.view(), second.view(), known.mask.view());
    const Shown here = shown(found, known.nodes);
    for (std::size_t k = 0; k < moved.size(); ++k)
      if (found.status[k] == VectorStatus::valid)
        moved[k] += std::hypot(double(found.displacement[k][0]), double(found.displacement[k][1])), ++looks[k];
    if (at > 0 && here.shift <= most.shift) continue;
    most = here;
    from = int(at);
    best = found;
    field.score = found.score;
    field.status = found.status;
    std::vector<double> sigmas;
    for (std::size_t k = 0; k < found.cov.size(); ++k)
      if (found.status[k] == VectorStatus::valid)
        sigmas.push_back(std::sqrt(0.5 * double(found.cov[k][0] + found.cov[k][1])));
    known.shift = most.shift, known.slope = most.slope, known.sigma = median(std::move(sigmas), 0);
  }
  if (most.valid < 20)
    throw InputError(of_file(c) + ": found " + std::to_string(most.valid) + " valid vectors between frames " +
                     std::to_string(from) + " and " + std::to_string(from + 1) +
                     ", expected 20 or more; 'pivnp check' shows grid and masks");
  for (const VectorStatus s : field.status) known.scored.push_back(s == VectorStatus::valid);
  const std::array<float, 2> corner = known.nodes.pixel.front();
  const NoiseShape shape = noise_shape(source.read(from), source.read(from + 1), known.nodes, best, known.scored);
  const Image frame = cropped(known, source.read(from));
  std::vector<Vec2> places;
  for (const auto& p : known.nodes.pixel) places.emplace_back(double(p[0]), double(p[1]));
  const double scored = double(std::count(known.scored.begin(), known.scored.end(), 1));
  for (std::size_t k = 0; k < known.scored.size(); ++k)
    if (!known.scored[k]) field.status[k] = VectorStatus::masked;
  // The noise that lowers correlation as much as the frames' does. (Methods that smooth frames see less of it than
  // windows of raw frames would, so it is found by trial.)
  double noise = noise_variance(frame.view(), places, c.piv->window_px, {field});
  const double unlike = unlike_share(known, field.score, field.status);
  piv::PairCorrelator on_part(*c.piv, known.nodes, known.width, known.height, threads);
  for (int round = 0; round < 3 && noise > 0; ++round) {
    const KnownPair trial =
        CarriedFrame{{}, {}, CarriedTexture(frame, noise, carried_blur, shape)}.pair("", image::uniform(0.3, -0.4), 0);
    const piv::PixelVectors found = on_part.correlate(trial.first.view(), trial.second.view(), known.mask.view());
    const double share = unlike_share(known, found.score, found.status);
    if (!(share > 0)) break;
    noise *= std::clamp(unlike / share, 0.25, 4.0);
  }
  CarriedFrame out{{},
                   "Frame " + std::to_string(from) + " of " + std::to_string(frames),
                   CarriedTexture(frame, noise, carried_blur, shape),
                   noise,
                   shape,
                   most.shift,
                   most.slope};
  out.frame = from;
  out.left = int(std::lround(corner[0] - known.nodes.pixel.front()[0]));
  out.top = int(std::lround(corner[1] - known.nodes.pixel.front()[1]));
  for (std::size_t k = 0; k < moved.size(); ++k) out.step_px.push_back(moved[k] / looks[k]);
  for (std::size_t k = 0; k < places.size(); ++k)
    if (known.scored[k]) out.middle += places[k] / scored;
  out.known = std::move(known);
  return out;
}

KnownPairs carried_pairs(const Case& c, const Setting& setting, image::FrameSource& source, int threads,
                         Progress& progress) {
  CarriedFrame carried = carried_frame(c, setting, source, threads, progress);
  KnownPairs known = std::move(carried.known);
  const double shift = std::clamp(carried.shift, 0.5, 20.0), slope = std::clamp(carried.slope, 0.01, 0.2);
  known.made_of = carried.from + ", carried by known fields of up to " + number(shift, 2) + " px and " +
                  number(100 * slope, 2) + " % (the frames' own: " + number(carried.shift, 2) + " px and " +
                  number(100 * carried.slope, 2) + " % from one to the next), with noise of " +
                  number(std::sqrt(carried.noise), 2) + " grey values in both images (" +
                  (carried.noise_shape.white() ? std::string("independent from pixel to pixel")
                                               : "neighbours correlate by " + number(carried.noise_shape.correlation(1, 0), 2) + " along rows, by " +
                                                     number(carried.noise_shape.correlation(0, 1), 2) + " along columns") +
                  ").";
  const std::vector<Field> all = fields(shift, slope, carried.middle.x(), carried.middle.y());
  for (std::size_t f = 0; f < all.size(); ++f) {
    progress.update("drawing pairs", std::int64_t(f), std::int64_t(all.size()));
    if (progress.stop_requested()) throw Interrupted();
    known.pairs.push_back(carried.pair(all[f].name, all[f].motion, f + 1));
    known.pairs.back().wavelength = all[f].wavelength;
  }
  return known;
}

}  // namespace pivnp::app
