// The tables by which a reader judges the measurement, and repeats the simulation.
#include <Eigen/LU>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>
#include <utility>

#include "apps/plot/numbers.hpp"
#include "apps/report/document/tables.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

using Items = std::vector<std::pair<std::string, std::string>>;

// Length of a pixel at the middle of the vectors' grid; NaN without a calibration.
double pixel_length(const Content& content) {
  if (content.pair_count == 0 || content.length_unit == "px") return nan_value;
  const Grid grid = content.pair(0).grid;
  const Vec2 middle = (grid.origin + grid.upper()) / 2;
  const auto image_of = [&](const Vec2& x) {
    const Eigen::Vector3d v = content.world_from_pixel.inverse() * Eigen::Vector3d(x.x(), x.y(), 1);
    return Vec2(v.x() / v.z(), v.y() / v.z());
  };
  const double h = grid.spacing.x();
  return h / (image_of(middle + Vec2(h, 0)) - image_of(middle)).norm();
}

std::string length(double value, const std::string& unit, int digits = 3) {
  const DisplayUnit shown = display_unit(unit, std::abs(value));
  return significant(value * shown.factor, digits) + unit_suffix(shown.name);
}

void add_image(const Content& content, double pixel, Items& items) {
  for (const Picture& picture : content.pictures) {
    if (picture.image.empty()) continue;
    items.emplace_back("Image", std::to_string(picture.image.width()) + " \u00d7 " + std::to_string(picture.image.height()) + " px");
    if (pixel > 0)
      items.emplace_back("Field of view", length(pixel * picture.image.width(), content.length_unit) + " \u00d7 " +
                                              length(pixel * picture.image.height(), content.length_unit));
    break;
  }
  if (pixel > 0) items.emplace_back("Scale", length(pixel, content.length_unit) + " a pixel");
  if (content.camera_residual > 0)
    items.emplace_back("Residual of the camera\u2019s targets, RMS", length(content.camera_residual, content.length_unit, 2));
}

void add_vectors(const Content& content, const std::vector<PairQuality>& pairs, double pixel, Items& items) {
  std::size_t nodes = 0, outside = 0, valid = 0, replaced = 0, lost = 0;
  std::vector<double> sigma;
  for (const PairQuality& q : pairs) {
    nodes += q.nodes;
    outside += q.outside;
    valid += q.valid;
    replaced += q.replaced;
    lost += q.rejected + q.failed;
    sigma.push_back(q.sigma);
  }
  if (content.pair_count > 0) {
    const double h = content.pair(0).grid.spacing.x();
    items.emplace_back("Spacing of the vectors", length(h, content.length_unit) + (pixel > 0 ? " (" + significant(h / pixel, 3) + " px)" : ""));
  }
  if (nodes > 0)
    items.emplace_back(pairs.front().material_known ? "Valid, in the material" : "Valid",
                       percent(double(valid) / double(nodes)) + " of " + count(nodes, "vector") + " in " + count(pairs.size(), "pair"));
  if (nodes > 0 && replaced + lost > 0)
    items.emplace_back("Replaced; rejected or failed", percent(double(replaced) / double(nodes)) + "; " + percent(double(lost) / double(nodes)));
  if (outside > 0) items.emplace_back("Nodes outside the material", std::to_string(outside) + ", left out here and in the figures");
  const double typical = quantile(sigma, 0.5);
  if (typical > 0)
    items.emplace_back("Noise floor of a vector, one component",
                       (pixel > 0 ? significant(typical / pixel, 2) + " px = " : std::string()) + length(typical, content.length_unit, 2) +
                           " (median over the pairs)");
}

void add_strain(const Content& content, Items& items) {
  if (!content.strain_note) return;
  const StrainNote& note = *content.strain_note;
  items.emplace_back("Strain gauge", length(note.gauge_length, content.length_unit) + " (shape function and window)");
  if (content.gauge) items.emplace_back("Strain gauge of the figures", length(*content.gauge, content.length_unit) + " (fitted plane)");
  items.emplace_back("Filtering of the strain", "none beside the gauge");
  items.emplace_back("Strain", "logarithmic, ln V, of the deformation gradient");
  items.emplace_back("Noise floor of the strain, RMS",
                     note.floor_source == StrainFloor::not_measured
                         ? "not measured (np.still_zone_m or np.still_frames would give it)"
                         : "deviatoric " + significant(note.floor_dev, 2) + ", volumetric " + significant(note.floor_vol, 2) + " (" +
                               std::string(name_of(note.floor_source)) + ")");
}

// What the guide asks for and only the owner knows, by the keys of [report.hardware].
std::string missing_hardware(const Content& content) {
  std::string missing;
  for (const char* what : {"Camera", "Lens", "Aperture", "Exposure", "Stand off", "Lighting", "Pattern", "Feature size"})
    if (std::none_of(content.hardware.begin(), content.hardware.end(), [&](const auto& row) { return row.first == what; }))
      missing += (missing.empty() ? "" : ", ") + std::string(what);
  if (missing.empty()) return "";
  std::transform(missing.begin() + 1, missing.end(), missing.begin() + 1, [](unsigned char ch) { return char(std::tolower(ch)); });
  return " Not stated ([report.hardware] of the case): " + missing + ".";
}

}  // namespace

Table measurement_table(const Content& content, const std::vector<PairQuality>& pairs) {
  Items items = content.hardware;
  items.emplace_back("Cameras", "one: motion in its plane, no stereo angle");
  const double pixel = pixel_length(content);
  add_image(content, pixel, items);
  if (!content.written_by.version.empty()) items.emplace_back("Software", "pivnp " + content.written_by.version);
  items.insert(items.end(), content.setup.begin(), content.setup.end());
  add_vectors(content, pairs, pixel, items);
  add_strain(content, items);
  Table t;
  t.caption = "The measurement, as the guide of the International Digital Image Correlation Society (2018) asks it to be reported." +
              missing_hardware(content);
  t.head = {"", "", "", ""};
  t.width = {0.19, 0.31, 0.2, 0.3};
  t.align = {'l', 'l', 'l', 'l'};
  t.fine = true;
  const std::size_t rows = (items.size() + 1) / 2;
  for (std::size_t r = 0; r < rows; ++r) {
    t.rows.emplace_back();
    for (const std::size_t k : {r, r + rows}) {
      t.rows.back().push_back(k < items.size() ? items[k].first : "");
      t.rows.back().push_back(k < items.size() ? items[k].second : "");
    }
  }
  return t;
}

std::optional<Table> simulation_table(const Content& content) {
  if (content.simulated_setup.empty()) return std::nullopt;
  Table t;
  t.caption = "The simulation. What is not listed is as by default (Settings).";
  t.head = {"", ""};
  t.width = {0.24, 0.76};
  t.align = {'l', 'l'};
  t.fine = true;
  for (const auto& [what, how] : content.simulated_setup) t.rows.push_back({what, how});
  return t;
}

}  // namespace pivnp::report
