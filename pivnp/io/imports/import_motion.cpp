#include "pivnp/io/imports/import_motion.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>
#include <utility>

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/displacement_gradient.hpp"
#include "pivnp/io/imports/import_format.hpp"
#include "pivnp/io/imports/numbered_files.hpp"

namespace pivnp::io {

namespace fs = std::filesystem;

namespace {

class ImportedMotion final : public MotionSource {
 public:
  ImportedMotion(const FileFormat& format, const std::string& pattern, const ImportOptions& options)
      : format_(format), options_(options) {
    const auto files = numbered_files(pattern);
    if (format_.read_table && files.size() == 1 && files.begin()->second.size() == 1) {
      table_ = format_.read_table(files.begin()->second[0], options.step);
      times_ = table_.time;
      if (!table_.length_unit.empty()) options_.length_unit = table_.length_unit;
      if (!table_.time_unit.empty()) options_.time_unit = table_.time_unit;
    } else {
      for (const auto& [number, list] : files) {
        if (list.size() > 1 && !format_.several)
          throw InputError(list[1].string() + ": has the same number as " + list[0].filename().string() +
                           ", expected one file a step");
        times_.push_back(double(number) * options.step);
        files_.push_back(list);
      }
    }
    find_particles(pattern);
    gradient_ = std::make_unique<DisplacementGradient>(particles_.x0);
  }

  const std::string& name() const override { return format_.name; }
  const std::string& length_unit() const override { return options_.length_unit; }
  const std::string& time_unit() const override { return options_.time_unit; }
  const ParticleSet& particles() const override { return particles_; }
  const std::vector<double>& times() const override { return times_; }

  MotionFrame frame(std::size_t index) const override {
    const ImportedState state = read(index);
    const std::size_t count = particles_.size();
    MotionFrame f;
    f.time = times_.at(index);
    f.u.assign(count, {0, 0});
    f.status.assign(count, ParticleStatus::unborn);
    for (std::size_t p = 0; p < count; ++p)
      if (particles_.end[p] < f.time) f.status[p] = ParticleStatus::ended;
    if (!state.v.empty()) f.v.assign(count, {0, 0});
    std::vector<std::span<float>> rooms;
    for (const ImportedField& field : state.fields) rooms.push_back(f.add(field.name, count));
    if (!state.sigma.empty()) f.cov_u.assign(count, {0, 0, 0});
    std::vector<std::int32_t> since(count, 0);
    for (std::size_t k = 0; k < state.x.size(); ++k) {
      if (!known(state.x[k])) continue;
      const std::size_t p = index_.at(id_of(state, k));
      if (f.status[p] == ParticleStatus::ended) continue;
      since[p] = since_[p];
      f.status[p] = ParticleStatus::active;
      f.u[p] = {float(state.x[k][0] - particles_.x0[p].x()), float(state.x[k][1] - particles_.x0[p].y())};
      if (!state.v.empty()) f.v[p] = {float(state.v[k][0]), float(state.v[k][1])};
      if (!state.sigma.empty())
        f.cov_u[p] = {float(state.sigma[k][0] * state.sigma[k][0]), float(state.sigma[k][1] * state.sigma[k][1]), 0};
      for (std::size_t i = 0; i < rooms.size(); ++i) {
        const std::size_t n = rooms[i].size() / count;
        for (std::size_t c = 0; c < n; ++c) rooms[i][p * n + c] = float(state.fields[i].values[k * n + c]);
      }
    }
    f.F = gradient_->gradients(f.u, since);
    return f;
  }

 private:
  ImportedState read(std::size_t index) const {
    if (files_.empty()) return table_.state.at(index);
    const std::vector<fs::path>& files = files_.at(index);
    if (format_.read_time) return format_.read_time(files);
    ImportedTable table = format_.read_table(files[0], options_.step);
    if (table.timed)
      throw InputError(files[0].string() + ": has a column of times, but the pattern names several files; expected one "
                       "file with all times, or files without a column of times");
    return std::move(table.state.at(0));
  }

  static std::int64_t id_of(const ImportedState& state, std::size_t k) {
    return state.id.empty() ? std::int64_t(k) : state.id[k];
  }

  static bool known(const std::array<double, 2>& x) { return std::isfinite(x[0]) && std::isfinite(x[1]); }

  // Frames hold single precision; nothing of a particle may be infinite there. (Not known is NaN.)
  static void refuse_infinite(const ImportedState& state, const std::string& file) {
    const auto check = [&](const char* what, const std::vector<std::array<double, 2>>& values) {
      for (std::size_t k = 0; k < values.size(); ++k)
        for (const double v : values[k])
          if (std::isinf(float(v)))
            throw InputError(file + ": " + what + " of the particle with id " + std::to_string(id_of(state, k)) +
                             ": found " + std::to_string(v) + ", expected a finite number (of single precision)");
    };
    check("position", state.x);
    check("displacement", state.u);
    check("velocity", state.v);
  }

  static void refuse_twins(const ImportedState& state, const std::string& file) {
    std::vector<std::int64_t> sorted = state.id;
    std::sort(sorted.begin(), sorted.end());
    if (const auto twice = std::adjacent_find(sorted.begin(), sorted.end()); twice != sorted.end())
      throw InputError(file + ": id " + std::to_string(*twice) + " occurs twice at the same time");
  }

  // Everyone who ever appears, in order of appearance: born where the position is known first, ended where it is last.
  void find_particles(const std::string& pattern) {
    particles_.label_names = {"material"};
    std::size_t unnamed = 0;  // particles of the first time, where they have no ids
    for (std::size_t t = 0; t < times_.size(); ++t) {
      const ImportedState state = read(t);
      const std::string file = files_.empty() ? pattern : files_[t][0].string();
      refuse_twins(state, file);
      refuse_infinite(state, file);
      if (t == 0) unnamed = state.x.size();
      if (state.id.empty() && state.x.size() != unnamed)
        throw InputError(file + ": found " + std::to_string(state.x.size()) + " particles without ids, expected " +
                         std::to_string(unnamed) + " as at the first time (or ids, to tell them apart)");
      for (std::size_t k = 0; k < state.x.size(); ++k) {
        if (!known(state.x[k])) continue;
        const auto [it, fresh] = index_.emplace(id_of(state, k), particles_.size());
        if (fresh) {
          const bool from_u = !state.u.empty() && known(state.u[k]);
          const Vec2 x(state.x[k][0], state.x[k][1]);
          particles_.id.push_back(it->first);
          particles_.label.push_back(0);
          particles_.x0.push_back(from_u ? Vec2(x - Vec2(state.u[k][0], state.u[k][1])) : x);
          particles_.area.push_back(k < state.area.size() && std::isfinite(state.area[k]) ? double(state.area[k]) : 0.0);
          particles_.born.push_back(times_[t]);
          since_.push_back(from_u ? 1 : std::int32_t(t) + 1);
          particles_.end.push_back(times_[t]);
          particles_.end_reason.push_back(EndReason::left_grid);
        } else {
          particles_.end[it->second] = times_[t];
        }
      }
    }
    if (particles_.size() == 0) throw InputError(pattern + ": holds no particle whose position is known");
    for (std::size_t p = 0; p < particles_.size(); ++p)
      if (particles_.end[p] == times_.back()) {
        particles_.end[p] = std::numeric_limits<double>::quiet_NaN();
        particles_.end_reason[p] = EndReason::none;
      }
  }

  FileFormat format_;
  ImportOptions options_;
  std::vector<std::vector<fs::path>> files_;  // a step each; empty: the table
  ImportedTable table_;
  std::vector<double> times_;
  ParticleSet particles_;
  std::vector<std::int32_t> since_;  // the time that a particle's u counts from: its place among the times, from 1
  std::unordered_map<std::int64_t, std::size_t> index_;
  std::unique_ptr<DisplacementGradient> gradient_;
};

}  // namespace

bool is_import(const std::string& text) {
  const FileFormat* format = format_of(text);
  return format && format->motion();
}

std::unique_ptr<MotionSource> open_import(const std::string& text, const ImportOptions& options) {
  if (!is_import(text))
    throw InputError(text + ": expected FORMAT=PATTERN with FORMAT " + formats_text(&FileFormat::motion));
  return std::make_unique<ImportedMotion>(*format_of(text), text.substr(text.find('=') + 1), options);
}

}  // namespace pivnp::io
