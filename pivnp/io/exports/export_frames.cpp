#include "pivnp/io/exports/export_frames.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <unordered_map>
#include <utility>

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/derived.hpp"
#include "pivnp/core/particles/fields.hpp"

namespace pivnp::io {

const std::vector<std::string>& exported_fields() {
  static const std::vector<std::string> fields = {"displacement_x", "displacement_y", "strain_xx",  "strain_yy",
                                                  "strain_xy",      "strain_dev",     "strain_vol"};
  return fields;
}

std::vector<std::string> chosen_motions(const RecordReader& record, const ExportOptions& options, bool& vectors) {
  const std::vector<std::string> known = record.motion_names();
  vectors = options.motions.empty() && record.pair_count() > 0;
  if (options.motions.empty()) return known;
  std::vector<std::string> chosen;
  for (const std::string& name : options.motions) {
    if (name == "piv" && record.pair_count() > 0) {
      vectors = true;
      continue;
    }
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      std::string list = record.pair_count() > 0 ? "piv" : "";
      for (const std::string& k : known) list += (list.empty() ? "" : ", ") + k;
      throw InputError("motion '" + name + "': the record has none of that name, expected " + list);
    }
    chosen.push_back(name);
  }
  return chosen;
}

std::vector<std::size_t> chosen_frames(const std::vector<double>& all, const std::vector<double>& asked) {
  std::set<std::size_t> chosen;
  for (const double time : asked) {
    std::size_t best = 0;
    for (std::size_t k = 1; k < all.size(); ++k)
      if (std::abs(all[k] - time) < std::abs(all[best] - time)) best = k;
    if (!all.empty()) chosen.insert(best);
  }
  if (asked.empty())
    for (std::size_t k = 0; k < all.size(); ++k) chosen.insert(k);
  return {chosen.begin(), chosen.end()};
}

namespace {

// Of those that the comparison has on this motion's particles: its first data set's.
class Differences {
 public:
  Differences(const RecordReader& record, const MotionSource& motion) : size_(motion.particles().size()) {
    comparison_ = record.comparison();
    if (!comparison_ || comparison_->names[0] != motion.name()) return;
    const std::vector<std::int64_t>& ids = motion.particles().id;
    for (std::size_t p = 0; p < ids.size(); ++p) place_[ids[p]] = p;
    for (const ComparisonField& field : comparison_->fields)
      if (field.name.starts_with("difference_")) fields_.push_back(&field);
  }
  void add(double time, std::vector<ExportColumn>& columns) const {
    for (const ComparisonField* field : fields_) {
      ExportColumn column{field->name, field->unit, std::vector<double>(size_, nan_value)};
      for (std::size_t t = 0; t < field->time.size(); ++t) {
        if (std::abs(field->time[t] - time) > 1e-9 * std::max(1.0, std::abs(time))) continue;
        for (std::size_t k = 0; k < field->id.size(); ++k)
          if (const auto at = place_.find(field->id[k]); at != place_.end())
            column.values[at->second] = double(field->values[t * field->id.size() + k]);
      }
      columns.push_back(std::move(column));
    }
  }

 private:
  std::size_t size_;
  std::optional<Comparison> comparison_;
  std::unordered_map<std::int64_t, std::size_t> place_;
  std::vector<const ComparisonField*> fields_;
};

}  // namespace

void for_each_frame(const RecordReader& record, const MotionSource& motion, const ExportOptions& options,
                    const std::function<void(const ExportFrame&)>& take) {
  std::vector<DerivedField> fields;
  for (const std::string& name : options.fields.empty() ? exported_fields() : options.fields) fields.push_back(derived_field(name));
  DerivedReader reader(motion, record.pair_count() == 0 || record.pair(0).anchor == Anchor::central);
  const Differences differences(record, motion);
  const std::size_t n = motion.particles().size();
  for (const std::size_t k : chosen_frames(motion.times(), options.times)) {
    ExportFrame frame{motion.times()[k], motion.frame(k), {}};
    if (frame.state.cov_u.size() == n)
      for (const std::size_t axis : {0u, 1u}) {
        ExportColumn sigma{axis == 0 ? "sigma_x" : "sigma_y", motion.length_unit(), {}};
        for (const auto& c : frame.state.cov_u) sigma.values.push_back(std::sqrt(double(c[axis])));
        frame.columns.push_back(std::move(sigma));
      }
    for (const DerivedField& field : fields)
      frame.columns.push_back({field.name, unit_in(field.unit, motion.length_unit(), motion.time_unit()), reader.values(field.name, k)});
    differences.add(frame.time, frame.columns);
    take(frame);
  }
}

}  // namespace pivnp::io
