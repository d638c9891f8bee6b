#include "pivnp/io/imports/import_vectors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/io/files/quoting.hpp"
#include "pivnp/io/imports/numbered_files.hpp"

namespace pivnp::io {

namespace fs = std::filesystem;

namespace {

constexpr double off_node = 0.02;       // spacings that a place may lie off its node: digits of a text
constexpr double most_pixels = 100000;  // of an image, along an axis
constexpr float unknown = std::numeric_limits<float>::quiet_NaN();

std::string at(const fs::path& file, int line) { return file.string() + ":" + std::to_string(line) + ": "; }

std::string text(const std::array<double, 2>& x) { return "(" + number(x[0]) + ", " + number(x[1]) + ")"; }

struct Axis {
  double origin = 0, spacing = 0;
  double count = 0;
};

// The regular axis that the vectors' places have along `c`.
Axis axis_of(const ImportedVectors& v, std::size_t c, const fs::path& file) {
  const std::string name = c == 0 ? "x" : "y";
  std::vector<std::pair<double, int>> values;  // with their lines
  for (std::size_t k = 0; k < v.x.size(); ++k) values.emplace_back(v.x[k][c], v.line[k]);
  std::sort(values.begin(), values.end());
  const auto same = [](const auto& a, const auto& b) { return a.first == b.first; };
  values.erase(std::unique(values.begin(), values.end(), same), values.end());
  if (values.size() < 2)
    throw InputError(at(file, v.line.front()) + "all vectors have " + name + " = " + number(values.front().first) +
                     ", expected a grid of at least 2 x 2");
  // The usual gap, or the least one where columns are missing; then, where that comes to the same, the mean of all.
  std::vector<double> gaps;
  for (std::size_t k = 1; k < values.size(); ++k) gaps.push_back(values[k].first - values[k - 1].first);
  std::sort(gaps.begin(), gaps.end());
  const double usual = gaps[(gaps.size() - 1) / 2];
  Axis axis{values.front().first, gaps.front() < 0.75 * usual ? gaps.front() : usual, 0};
  const double extent = values.back().first - axis.origin;
  axis.count = std::round(extent / axis.spacing) + 1;
  const double mean = extent / (axis.count - 1);
  if (std::abs(mean - axis.spacing) <= off_node * axis.spacing) axis.spacing = mean;
  for (const auto& [value, line] : values) {
    const double steps = (value - axis.origin) / axis.spacing;
    if (!(std::abs(steps - std::round(steps)) <= off_node))
      throw InputError(at(file, line) + "found " + name + " = " + number(value) + ", expected an even spacing: " +
                       number(axis.origin) + " and a multiple of " + number(axis.spacing));
  }
  return axis;
}

}  // namespace

std::vector<std::string> vector_format_names() { return format_names(&FileFormat::vectors); }

VectorFiles::VectorFiles(const VectorOptions& options, const fs::path& base, std::optional<double> rate_hz)
    : y_axis_(options.y_axis) {
  const FileFormat* format = file_formats().find(options.format);
  if (!format || !format->vectors())
    throw InputError("vectors.format: found '" + options.format + "', expected " + formats_text(&FileFormat::vectors));
  format_ = *format;
  anchor_ = options.anchor.value_or(format->anchor);
  if (rate_hz) step_ = 1 / *rate_hz;
  for (auto& [number, list] : numbered_files((base / options.path).string())) {
    if (list.size() > 1)
      throw InputError(list[1].string() + ": has the same number as " + list[0].filename().string() +
                       ", expected one file a pair of frames");
    files_.push_back(list[0]);
  }
  for (std::size_t k = 0; k < files_.size(); ++k) {
    const ImportedVectors v = checked(k);
    if (k == 0) {
      pixels_ = v.pixels;
      y_up_ = v.y_up;
      count_ = v.x.size();
      states_uncertainty_ = !v.sigma.empty();
      const Axis x = axis_of(v, 0, files_[0]), y = axis_of(v, 1, files_[0]);
      const std::string first = at(files_[0], v.line.front());
      if (!(x.count * y.count <= 20 * double(count_)))
        throw InputError(first + "found " + std::to_string(count_) + " vectors on a grid of " + number(x.count, 12) +
                         " x " + number(y.count, 12) + " nodes, expected one at every twentieth at least");
      const double top = y.origin + (y.count - 1) * y.spacing;
      y_sum_ = y.origin + top;
      // (0, 0) is the lowest node: that of the greatest row, with y turned to point upward.
      grid_ = {{x.origin, pixels_ ? -top : y.origin}, {x.spacing, y.spacing}, int(x.count), int(y.count)};
    }
    const std::string name = v.first.empty() ? "frame " + std::to_string(k + 1) : v.first;
    if (k > 0 && !v.first.empty() && v.first != frame_names_.back())
      throw InputError(at(files_[k], 1) + "found vectors from '" + shown(v.first) + "' to '" + shown(v.second) +
                       "', expected them from '" + shown(frame_names_.back()) + "', the second image of " +
                       files_[k - 1].filename().string());
    if (k == 0) frame_names_.push_back(name);
    frame_names_.push_back(v.second.empty() ? "frame " + std::to_string(k + 2) : v.second);
    placed(v, k);
  }
}

// A file's vectors: arrays that fit, numbers that can be used, and what must be the same in all files.
ImportedVectors VectorFiles::checked(std::size_t index) const {
  const fs::path& file = files_.at(index);
  ImportedVectors v = format_.read_vectors(file, step_);
  if (v.x.empty()) throw InputError(file.string() + ": no row of values");
  if (y_axis_ != VerticalAxis::format) v.y_up = y_axis_ == VerticalAxis::up;
  const std::size_t count = v.x.size();
  if (v.status.empty()) v.status.assign(count, VectorStatus::valid);
  for (std::size_t k = 0; k < count; ++k) {
    const std::string here = at(file, v.line[k]);
    if (!std::isfinite(v.x[k][0] + v.x[k][1])) throw InputError(here + "no place, expected numbers x and y");
    if (v.pixels && !(std::abs(v.x[k][0]) <= most_pixels && std::abs(v.x[k][1]) <= most_pixels))
      throw InputError(here + "found a vector at " + text(v.x[k]) + " px, expected a place in an image");
    for (const double s : v.sigma.empty() ? std::array<double, 2>{0, 0} : v.sigma[k])
      if (s < 0 || s > 1e15)
        throw InputError(here + "found an uncertainty of " + number(s) + ", expected 0 or more, to 1e15");
    if (!(std::abs(v.d[k][0]) <= 1e30 && std::abs(v.d[k][1]) <= 1e30) && v.status[k] != VectorStatus::masked)
      v.status[k] = VectorStatus::failed;
    if (v.status[k] == VectorStatus::failed || v.status[k] == VectorStatus::masked) v.d[k] = {std::nan(""), std::nan("")};
  }
  if (grid_.nx == 0) return v;
  const std::string first = files_[0].filename().string();
  if (v.pixels != pixels_)
    throw InputError(at(file, v.line[0]) + "found lengths in " + (v.pixels ? "px" : "m") + ", expected them in " +
                     (pixels_ ? "px" : "m") + " as in " + first);
  if (v.y_up != y_up_)
    throw InputError(at(file, v.line[0]) + "y points " + (v.y_up ? "upward" : "downward") +
                     ", expected the other way as in " + first);
  if (count != count_)
    throw InputError(at(file, v.line[0]) + "found " + std::to_string(count) + " vectors, expected " +
                     std::to_string(count_) + " as in " + first);
  return v;
}

VectorField VectorFiles::read(std::size_t index) const { return placed(checked(index), index); }

VectorField VectorFiles::placed(const ImportedVectors& v, std::size_t index) const {
  const std::size_t nodes = grid_.node_count();
  VectorField out;
  out.pair = {int(index), int(index) + 1};
  out.anchor = anchor_;
  out.grid = grid_;
  out.displacement.assign(nodes, {unknown, unknown});
  out.status.assign(nodes, VectorStatus::masked);
  out.cov.assign(nodes, {unknown, unknown, unknown});
  out.score.assign(nodes, unknown);
  out.correlation_length = unknown;
  std::vector<int> taken(nodes, 0);  // by the vector of this line
  const double sign = v.y_up ? 1 : -1;
  for (std::size_t k = 0; k < v.x.size(); ++k) {
    const auto& [x, y] = v.x[k];
    // In px y falls where the row grows, and a y that points upward was turned over within the grid; a length that points
    // downward is turned over likewise.
    const double up = pixels_ ? (v.y_up ? y - y_sum_ : -y) : (v.y_up ? y : y_sum_ - y);
    const double i = (x - grid_.origin.x()) / grid_.spacing.x(), j = (up - grid_.origin.y()) / grid_.spacing.y();
    const double column = std::round(i), row = std::round(j);
    if (!(std::abs(i - column) <= off_node && std::abs(j - row) <= off_node && column >= 0 && row >= 0 &&
          column < grid_.nx && row < grid_.ny))
      throw InputError(at(files_[index], v.line[k]) + "found a vector at " + text(v.x[k]) +
                       ", expected the places of " + files_[0].filename().string());
    const std::size_t n = grid_.node(int(column), int(row));
    if (taken[n] != 0)
      throw InputError(at(files_[index], v.line[k]) + "found a second vector at " + text(v.x[k]) +
                       ", expected one, as in line " + std::to_string(taken[n]));
    taken[n] = v.line[k];
    out.displacement[n] = {float(v.d[k][0]), float(sign * v.d[k][1])};
    out.status[n] = v.status[k];
    if (!v.sigma.empty()) out.cov[n] = {float(v.sigma[k][0] * v.sigma[k][0]), float(v.sigma[k][1] * v.sigma[k][1]), 0};
    if (!v.score.empty()) out.score[n] = float(v.score[k]);
  }
  return out;
}

}  // namespace pivnp::io
