#include "apps/study/methods/frames/exposure.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

double grey_at(const ImageView& frame, int column, int row) {
  return frame.depth == PixelDepth::u8    ? double(frame.row<std::uint8_t>(row)[column])
         : frame.depth == PixelDepth::u16 ? double(frame.row<std::uint16_t>(row)[column])
                                          : double(frame.row<float>(row)[column]);
}

// Pixels of the material that is looked at: not masked, in a region where there are any, every `apart`-th.
template <class Visit>
void visit_material(const Setting& setting, const ImageView& frame, int apart, const Visit& visit) {
  const MaskView mask = setting.mask.view();
  for (int r = 0; r + 1 < frame.height; r += apart)
    for (int c = 0; c + 1 < frame.width; c += apart) {
      if (!mask.usable(c, r)) continue;
      const Vec2 x = setting.camera.to_world({double(c), double(r)});
      const bool there = setting.regions.empty() || std::any_of(setting.regions.begin(), setting.regions.end(),
                                                                [&](const Region& region) { return region.polygon.contains(x); });
      if (there) visit(c, r);
    }
}

}  // namespace

std::vector<std::string> exposure_remarks(const Setting& setting, const Image& image) {
  constexpr double most_white = 0.1, most_black = 0.5, least_part = 0.01, errors = 8;
  const ImageView frame = image.view();
  // Even steps: pixels of two by two keep their place in a colour filter's pattern.
  const int apart = 2 * std::max(1, int(std::sqrt(double(frame.width) * double(frame.height) / 2e6)));
  std::vector<double> greys;
  double sum = 0, part = 0, square = 0, cells = 0;
  visit_material(setting, frame, apart, [&](int c, int r) {
    const double a = grey_at(frame, c, r), b = grey_at(frame, c + 1, r), d = grey_at(frame, c, r + 1), e = grey_at(frame, c + 1, r + 1);
    greys.insert(greys.end(), {a, b, d, e});
    const double checker = (a - b - d + e) / 4;
    sum += (a + b + d + e) / 4;
    part += checker;
    square += checker * checker;
    ++cells;
  });
  if (cells < 100) return {};
  std::vector<std::string> out;
  const auto [least, most] = std::minmax_element(greys.begin(), greys.end());
  const auto share_of = [&](double value) { return double(std::count(greys.begin(), greys.end(), value)) / double(greys.size()); };
  const double white = share_of(*most), black = share_of(*least);
  const auto clipped = [&](double share, const char* which) {
    out.push_back(number(100 * share, 3) + " % of the material's pixels in the first frame have the " + which +
                  " grey value: they are clipped, and hold no texture. Expose so that hardly any is.");
  };
  if (white > most_white) clipped(white, "greatest");
  else if (black > most_black) clipped(black, "least");
  const double mean = part / cells, error = std::sqrt(std::max(0.0, square / cells - mean * mean) / cells);
  if (std::abs(mean) > least_part * sum / cells && std::abs(mean) > errors * error)
    out.push_back("The frames are the mosaic of a colour sensor: in squares of two by two pixels the grey values alternate by " +
                  number(200 * std::abs(mean) / (sum / cells), 2) + " % of their mean, a pattern that stands still while the material moves. "
                  "Convert the frames to grey ones (demosaic), or film in monochrome.");
  return out;
}

}  // namespace pivnp::app
