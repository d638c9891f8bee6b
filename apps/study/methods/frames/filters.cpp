#include "apps/study/methods/frames/filters.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "apps/study/methods/frames/fixed_pattern.hpp"
#include "apps/study/methods/frames/known_pairs.hpp"
#include "apps/study/methods/frames/texture.hpp"
#include "pivnp/core/choice.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

using image::Background;
using image::FilterOptions;

constexpr double light_px = 32;          // standard deviation of what counts as light
constexpr double pattern_px = 16;        // and of the window in which two backgrounds are compared
constexpr double carried_blur_px = 0.7;  // of what is carried
constexpr double helps_by = 0.05, more_valid = 0.02, fewer_valid = 0.01;

float& grey(Image& image, int c, int r) { return image.row<float>(r)[c]; }
float grey(const Image& image, int c, int r) { return image.view().row<float>(r)[c]; }

template <class Grey>
Image drawn_grey(int width, int height, float white, const Grey& value) {
  Image out(width, height, PixelDepth::f32, white);
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) grey(out, c, r) = static_cast<float>(value(c, r));
  return out;
}

Image floating(const Image& frame) {
  const ImageView v = frame.view();
  return drawn_grey(v.width, v.height, v.white, [&](int c, int r) {
    return v.depth == PixelDepth::u8    ? float(v.row<std::uint8_t>(r)[c])
           : v.depth == PixelDepth::u16 ? float(v.row<std::uint16_t>(r)[c])
                                        : v.row<float>(r)[c];
  });
}

Image background_between(image::FrameSource& source, Background kind, int most, int from, int to) {
  const std::vector<int> frames = image::background_frames(to - from, most);
  return image::background_of(
      int(frames.size()), [&](int k) { return source.read(from + frames[std::size_t(k)]); }, kind);
}

// What does not move with the material: what two halves of a sequence have in common beside their light.
Image fixed_pattern(const Image& first, const Image& second) {
  const auto fine = [](const Image& background) {
    const Image real = floating(background), light = image::blurred_image(real.view(), light_px);
    return drawn_grey(real.width(), real.height(), real.white(),
                      [&](int c, int r) { return grey(real, c, r) - grey(light, c, r); });
  };
  const Image a = fine(first), b = fine(second);
  const auto windowed = [&](const auto& value) {
    return image::blurred_image(drawn_grey(a.width(), a.height(), a.white(), value).view(), pattern_px);
  };
  const Image common = windowed([&](int c, int r) { return grey(a, c, r) * grey(b, c, r); });
  const Image own = windowed([&](int c, int r) { return grey(b, c, r) * grey(b, c, r); });
  return drawn_grey(a.width(), a.height(), a.white(), [&](int c, int r) {
    const float power = grey(own, c, r);
    return power > 0 ? grey(b, c, r) * std::clamp(grey(common, c, r) / power, 0.0f, 1.0f) : 0.0f;
  });
}

// What of a frame is finer than any texture, at most: variance by differences of differences (Immerkaer 1996, Comput.
// Vis. Image Underst. 64:300), the median over pixels. What stays or goes between frames lowers their correlation too,
// and is no noise.
double fine_variance(const Image& real) {
  std::vector<double> off;
  for (int r = 1; r + 1 < real.height(); r += 2)
    for (int c = 1; c + 1 < real.width(); c += 2) {
      const auto at = [&](int dc, int dr) { return double(grey(real, c + dc, r + dr)); };
      off.push_back(std::abs(at(-1, -1) + at(1, -1) + at(-1, 1) + at(1, 1) -
                             2 * (at(0, -1) + at(-1, 0) + at(1, 0) + at(0, 1)) + 4 * at(0, 0)));
    }
  const auto middle = off.begin() + std::ptrdiff_t(off.size() / 2);
  std::nth_element(off.begin(), middle, off.end());
  const double deviation = 1.48 * *middle / 6;  // 6: of the weights, root of their squares' sum
  return deviation * deviation;
}

struct FootageTruth {
  KnownPairs known;
  std::string from;
  double shift = 0, slope = 0;
  int frame = 0, left = 0, top = 0;
};

// Pairs of a case's frame: texture that moves, under light and behind a pattern that do not.
FootageTruth footage_truth(CarriedFrame carried, image::FrameSource& source, const Image* pattern) {
  const int left = carried.left, top = carried.top, width = carried.known.width, height = carried.known.height;
  const Image a = image::part_of(source.read(carried.frame).view(), left, top, width, height);
  const Image b = image::part_of(source.read(carried.frame + 1).view(), left, top, width, height);
  const Image real = floating(a), light_a = image::blurred_image(real.view(), light_px),
              light_b = image::blurred_image(floating(b).view(), light_px);
  const auto still = [&](int c, int r) { return pattern ? grey(*pattern, left + c, top + r) : 0.0f; };
  const Image moving = drawn_grey(width, height, real.white(),
                                  [&](int c, int r) { return grey(real, c, r) - grey(light_a, c, r) - still(c, r); });
  const double noise = std::min(carried.noise, fine_variance(real));
  const CarriedTexture texture(moving, noise, carried_blur_px), camera(a, noise, 0, carried.noise_shape);
  FootageTruth out{std::move(carried.known),
                   std::move(carried.from),
                   std::clamp(carried.shift, 0.5, 20.0),
                   std::clamp(carried.slope, 0.01, 0.2),
                   carried.frame,
                   left,
                   top};
  const double whole = std::floor(out.shift), length = 64;
  const std::vector<std::pair<std::string, image::Motion>> fields = {
      {"shift", image::uniform(whole + 0.3, -0.6 * whole - 0.4)},
      {"wave", image::sine(out.slope * length / (2 * M_PI), length)},
      {"shear", image::triangle_shear(out.slope)}};
  std::uint64_t number = 0;
  for (const auto& [name, motion] : fields) {
    const auto draw = [&, move = motion](int side) {
      const Image& light = side < 0 ? light_a : light_b;
      return camera.draw(
          [&](int column, int row) {
            const double contrast =
                double(grey(light, column, row)) / std::max(1.0, double(grey(light_a, column, row)));
            return contrast * texture.at(middle_of(move, {double(column), double(row)}, side)) +
                   double(grey(light, column, row)) + double(still(column, row));
          },
          1, number++);
    };
    Image first = draw(-1), second = draw(1);
    out.known.pairs.push_back({name,
                               std::move(first),
                               std::move(second),
                               [move = motion](const Vec2& place, Anchor anchor) {
                                 return move(anchor == Anchor::central ? place : middle_of(move, place, -1));
                               },
                               0,
                               {}});
  }
  return out;
}

// Errors of all vectors of all pairs; NaN where a vector is not valid.
struct VectorErrors {
  std::vector<double> error2;  // of both components
  double valid = 0;
};

VectorErrors errors_in(const FootageTruth& truth, const piv::PivOptions& options, const image::FrameFilter& filter,
                       int threads) {
  const KnownPairs& known = truth.known;
  piv::PairCorrelator correlator(options, known.nodes, known.width, known.height, threads);
  VectorErrors out;
  double asked = 0;
  for (const KnownPair& pair : known.pairs) {
    const auto copy = [&](const Image& image) {
      return filter(image::part_of(image.view(), 0, 0, known.width, known.height));
    };
    const Image first = copy(pair.first), second = copy(pair.second);
    const piv::PixelVectors found = correlator.correlate(first.view(), second.view(), known.mask.view());
    for (std::size_t k = 0; k < known.nodes.pixel.size(); ++k) {
      if (!known.scored[k]) continue;
      ++asked;
      const bool valid = found.status[k] == VectorStatus::valid;
      const Vec2 got(double(found.displacement[k][0]), double(found.displacement[k][1]));
      const Vec2 there = pair.truth({double(known.nodes.pixel[k][0]), double(known.nodes.pixel[k][1])}, found.anchor);
      out.valid += valid;
      out.error2.push_back(valid ? (got - there).squaredNorm() : NAN);
    }
  }
  out.valid /= std::max(1.0, asked);
  return out;
}

// Nodes far off count as half a pixel: one wild vector is to be seen, not to decide.
FilterTrial judged_filter(const VectorErrors& with, const VectorErrors& without) {
  constexpr double most2 = 0.5;
  FilterTrial trial;
  double a = 0, b = 0, both = 0;
  for (std::size_t k = 0; k < with.error2.size(); ++k) {
    if (!std::isfinite(with.error2[k]) || !std::isfinite(without.error2[k])) continue;
    a += std::min(with.error2[k], most2), b += std::min(without.error2[k], most2), both += 2;
  }
  trial.rms_px = std::sqrt(a / both);
  trial.plain_px = std::sqrt(b / both);
  trial.valid = with.valid;
  const double gain = 1 - trial.rms_px / trial.plain_px;
  trial.helps = (gain > helps_by && with.valid > without.valid - fewer_valid) ||
                (with.valid > without.valid + more_valid && gain > -helps_by);
  return trial;
}

std::string filter_keys(const FilterOptions& o) {
  std::string keys;
  const auto add = [&](const std::string& key) { keys += (keys.empty() ? "" : ", ") + key; };
  if (o.background != Background::none) add("background = \"" + std::string(name_of(o.background)) + "\"");
  if (o.high_pass_px > 0) add("high_pass_px = " + number(o.high_pass_px));
  if (o.clahe_px > 0) add("clahe_px = " + number(o.clahe_px));
  if (o.cap_std > 0) add("cap_std = " + number(o.cap_std));
  if (o.local_px > 0) add("local_px = " + number(o.local_px));
  return keys;
}

std::string filter_name(const FilterOptions& o) {
  std::string name;
  const auto add = [&](const std::string& part) { name += (name.empty() ? "" : "_") + part; };
  if (o.background != Background::none) add("background_" + std::string(name_of(o.background)));
  if (o.high_pass_px > 0) add("high_pass");
  if (o.clahe_px > 0) add("clahe");
  if (o.cap_std > 0) add("cap");
  if (o.local_px > 0) add("local");
  return name;
}

// One filter each, with the lengths that the case states or usual ones.
std::vector<FilterOptions> candidates(const FilterOptions& given, double window, bool backgrounds) {
  FilterOptions none = given;
  none.choose = false;
  none.background = Background::none;
  none.high_pass_px = none.cap_std = none.local_px = 0, none.clahe_px = 0;
  std::vector<FilterOptions> all;
  const auto add = [&](const auto& change) {
    all.push_back(none);
    change(all.back());
  };
  if (backgrounds)
    for (const Background kind : {Background::mean, Background::minimum, Background::median})
      if (given.background == Background::none || given.background == kind)
        add([&](FilterOptions& o) { o.background = kind; });
  add([&](FilterOptions& o) { o.high_pass_px = given.high_pass_px > 0 ? given.high_pass_px : window / 2; });
  add([&](FilterOptions& o) { o.clahe_px = given.clahe_px > 0 ? given.clahe_px : int(2 * window); });
  add([&](FilterOptions& o) { o.cap_std = given.cap_std > 0 ? given.cap_std : 2; });
  add([&](FilterOptions& o) { o.local_px = given.local_px > 0 ? given.local_px : window / 2; });
  return all;
}

double gain_of(const FilterTrial& t) { return 1 - t.rms_px / t.plain_px; }

// All that help, of each kind the best.
FilterOptions together(const std::vector<FilterTrial>& trials) {
  FilterOptions all = trials.front().options;
  all.background = Background::none;
  all.high_pass_px = all.cap_std = all.local_px = 0, all.clahe_px = 0;
  double best = -INFINITY;
  for (const FilterTrial& t : trials) {
    if (!t.helps) continue;
    if (t.options.background != Background::none && gain_of(t) > best)
      all.background = t.options.background, best = gain_of(t);
    all.high_pass_px = std::max(all.high_pass_px, t.options.high_pass_px);
    all.clahe_px = std::max(all.clahe_px, t.options.clahe_px);
    all.cap_std = std::max(all.cap_std, t.options.cap_std);
    all.local_px = std::max(all.local_px, t.options.local_px);
  }
  return all;
}

}  // namespace

image::FrameFilter filter_of(const FilterOptions& options, image::FrameSource& source) {
  if (options.background == Background::none) return image::FrameFilter(options);
  if (options.background == Background::pattern) return image::FrameFilter(options, pattern_on_glass(source, options.background_frames));
  return image::FrameFilter(options, background_between(source, options.background, options.background_frames, 0,
                                                        int(source.frames().size())));
}

FilterTrials try_filters(const Case& c, const Setting& setting, image::FrameSource& source, int threads,
                         Progress& progress) {
  const piv::PivOptions options = c.piv.value_or(piv::PivOptions{});
  const FilterOptions given = c.preprocess.value_or(FilterOptions{});
  const int frames = int(source.frames().size());
  FilterTrials out;
  CarriedFrame carried = carried_frame(c, setting, source, threads, progress);
  std::vector<double> paths;
  for (std::size_t k = 0; k < carried.step_px.size(); ++k)
    if (carried.known.scored[k] && std::isfinite(carried.step_px[k]))
      paths.push_back(carried.step_px[k] * double(frames - 1) / 2);
  std::sort(paths.begin(), paths.end());
  const double path = paths.empty() ? 0 : paths[paths.size() / 20];
  const bool backgrounds = frames >= 6 && path >= least_path_px;
  if (frames < 6)
    out.left_out = "No background was tried: there are " + std::to_string(frames) + " frames, and six are the least.";
  else if (!backgrounds)
    out.left_out = "No background was tried: a twentieth of the material moves by less than " + number(path, 2) +
                   " px within half of the sequence, and the texture of what stays is background (" +
                   number(least_path_px) + " px are the least).";
  std::optional<Image> pattern;
  if (backgrounds)
    pattern =
        fixed_pattern(background_between(source, Background::median, given.background_frames, 0, frames / 2),
                      background_between(source, Background::median, given.background_frames, frames / 2, frames));
  const FootageTruth truth = footage_truth(std::move(carried), source, pattern ? &*pattern : nullptr);
  out.made_of = "Filters were tried on " + truth.from + ", carried by known fields of up to " + number(truth.shift, 2) +
                " px and " + number(100 * truth.slope, 2) + " % under the light of this frame and of the next one" +
                (backgrounds ? ", behind what both halves of the sequence have in common." : ".");
  const VectorErrors without = errors_in(truth, options, image::FrameFilter({}), threads);
  out.plain = judged_filter(without, without);
  out.plain.helps = false;
  const auto attempt = [&](const FilterOptions& tried) {
    if (progress.stop_requested()) throw Interrupted();
    Image background;
    if (tried.background !=
        Background::none)  // of the first half: what it shares with the other half is what the truth has
      background =
          image::part_of(background_between(source, tried.background, tried.background_frames, 0, frames / 2).view(),
                         truth.left, truth.top, truth.known.width, truth.known.height);
    FilterTrial trial =
        judged_filter(errors_in(truth, options, image::FrameFilter(tried, std::move(background)), threads), without);
    trial.options = tried;
    trial.keys = filter_keys(tried);
    trial.name = filter_name(tried);
    return trial;
  };
  const std::vector<FilterOptions> all = candidates(given, options.window_px, backgrounds);
  for (std::size_t k = 0; k < all.size(); ++k) {
    progress.update("filters", std::int64_t(k), std::int64_t(all.size()));
    out.trials.push_back(attempt(all[k]));
  }
  const FilterTrial* best = nullptr;
  for (const FilterTrial& t : out.trials)
    if (t.helps && (!best || gain_of(t) > gain_of(*best))) best = &t;
  if (!best) return out;
  out.best = best->options;
  const FilterOptions joined = together(out.trials);
  if (filter_keys(joined) == best->keys) return out;
  const double alone = gain_of(*best);
  FilterTrial both = attempt(joined);
  both.helps = both.helps && gain_of(both) > alone + helps_by / 2;
  if (both.helps) out.best = joined;
  out.trials.push_back(std::move(both));
  return out;
}

std::vector<std::string> words_of(const FilterTrials& trials) {
  std::vector<std::string> words = {trials.made_of + " Without any: " + number(trials.plain.rms_px, 2) + " px rms, " +
                                    number(100 * trials.plain.valid, 3) + " % valid."};
  for (const FilterTrial& t : trials.trials)
    words.push_back("preprocess: " + t.keys + ": " + number(t.rms_px, 2) + " px rms where it is " +
                    number(t.plain_px, 2) + " px without, " + number(100 * t.valid, 3) + " % valid; " +
                    (t.helps ? "helps." : "does not help."));
  if (!trials.left_out.empty()) words.push_back(trials.left_out);
  const std::string best = filter_keys(trials.best);
  words.push_back(best.empty() ? "No filter lowers the error on this footage: leave [preprocess] out."
                               : "Of the filters, this footage asks for " + best + ".");
  return words;
}

std::vector<std::string> set_filter(const Case& c, image::FrameSource& source, int threads, Progress& progress,
                                    Setting& setting) {
  setting.filter.reset();
  if (!c.preprocess) return {};
  FilterOptions options = *c.preprocess;
  std::vector<std::string> words;
  if (options.choose) {
    const FilterTrials trials = try_filters(c, setting, source, threads, progress);
    options = trials.best;
    words = words_of(trials);
  }
  if (options.background == Background::pattern)
    setting.filter = std::make_shared<const image::FrameFilter>(
        options, pattern_over_motion(c, setting, source, options.background_frames, threads, progress));
  else if (options.any())
    setting.filter = std::make_shared<const image::FrameFilter>(filter_of(options, source));
  return words;
}

}  // namespace pivnp::app
