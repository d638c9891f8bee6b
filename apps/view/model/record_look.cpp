#include "apps/view/model/record_look.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "apps/case/case.hpp"
#include "apps/plot/numbers.hpp"
#include "apps/report/content/selection.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/particles/derived.hpp"
#include "pivnp/core/particles/fields.hpp"
#include "pivnp/core/particles/strain.hpp"
#include "pivnp/core/particles/strain_error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::view {

namespace {

constexpr const char* stated_error = "displacement_error";

double component_error(const std::array<float, 3>& cov) { return std::sqrt((double(cov[0]) + double(cov[1])) / 2); }

// What the record states of the error of a field, where it does.
std::vector<double> stated_sigma(const MotionFrame& frame, const std::string& field) {
  std::vector<double> out;
  if (field.starts_with("displacement_") && field != stated_error)
    for (const auto& cov : frame.cov_u)
      out.push_back(field.ends_with("_x") ? std::sqrt(double(cov[0])) : field.ends_with("_y") ? std::sqrt(double(cov[1])) : component_error(cov));
  if (field == "strain_dev" || field == "strain_vol")
    if (const FieldValues* cov = frame.find("cov_F"))
      for (std::size_t p = 0; p < frame.F.size(); ++p) {
        const StrainVariance v = strain_variance(matrix(frame.F[p]), {double((*cov)(p, 0)), double((*cov)(p, 1)), double((*cov)(p, 2))});
        out.push_back(std::sqrt(field == "strain_dev" ? v.dev : v.vol));
      }
  return out;
}

}  // namespace

RecordLook::RecordLook(const std::filesystem::path& record)
    : file_(std::filesystem::is_directory(record) ? record / "record.h5" : record), reader_(std::make_unique<io::RecordReader>(file_)),
      head_(reader_->head()), listed_(reader_->frames()) {
  const app::Case c = app::parse_recorded_case(head_.case_text, file_.string() + " (its case)", file_.parent_path());
  if (c.piv) central_ = c.piv->anchor == Anchor::central;
  std::vector<std::vector<Vec2>> places;
  for (const std::string& name : reader_->motion_names()) {
    names_.push_back(name);
    motions_.push_back(reader_->motion(name));
    const MotionSource& motion = *motions_.back();
    times_.insert(times_.end(), motion.times().begin(), motion.times().end());
    for (const std::size_t k : {std::size_t(0), motion.times().size() / 2, motion.times().size() - 1}) {
      if (motion.times().empty()) break;
      const MotionFrame frame = motion.frame(k);
      std::vector<Vec2>& at = places.emplace_back();
      for (std::size_t p = 0; p < motion.particles().size(); ++p)
        if (alive(frame.status[p])) at.push_back(motion.particles().x0[p] + Vec2(double(frame.u[p][0]), double(frame.u[p][1])));
    }
  }
  for (const Frame& frame : listed_) times_.push_back(frame.time);
  std::sort(times_.begin(), times_.end());
  const double close = times_.empty() ? 0 : 1e-9 * std::max(std::abs(times_.front()), std::abs(times_.back()));
  times_.erase(std::unique(times_.begin(), times_.end(), [&](double a, double b) { return b - a <= close; }), times_.end());

  if (c.frames && !c.frames->path.empty() && reader_->pair_count() > 0) {
    try {
      auto source = image::open_frames(*c.frames, c.folder);
      const bool same = std::equal(source->frames().begin(), source->frames().end(), listed_.begin(), listed_.end(),
                                   [](const Frame& a, const Frame& b) { return a.name == b.name; });
      if (same) frames_ = std::make_shared<SharedFrames>(std::move(source));
      else complaint_ = "The frames at " + c.frames->path + " are not those that were measured.";
    } catch (const InputError& error) {
      complaint_ = error.what();
    }
  }
  std::vector<const std::vector<Vec2>*> pointers;
  for (const auto& list : places) pointers.push_back(&list);
  box_ = report::box_around(pointers, 0.001);
  if (frames_) {
    box_ = plot::image_box(frames_->width(), frames_->height(), head_.world_from_pixel);
  } else if (names_.empty() && head_.grid.node_count() > 0) {
    box_ = {head_.grid.origin, head_.grid.upper()};
  }

  const auto carried = [&](const std::string& source) {
    return std::any_of(motions_.begin(), motions_.end(), [&](const auto& m) {
      return !m->times().empty() && m->frame(m->times().size() - 1).find(source) != nullptr;
    });
  };
  for (const DerivedField& f : derived_fields())
    if (!motions_.empty() && (f.source.empty() || carried(f.source)))
      fields_.push_back({f.name, f.label.empty() ? f.name : f.label, unit_in(f.unit, head_.length_unit, head_.time_unit)});
  const bool known = std::any_of(motions_.begin(), motions_.end(), [](const auto& m) { return !m->times().empty() && !m->frame(0).cov_u.empty(); });
  if (known) fields_.push_back({stated_error, "stated error of a displacement", head_.length_unit});
}

const MotionSource& RecordLook::motion(const std::string& name) const {
  const auto at = std::find(names_.begin(), names_.end(), name);
  if (at == names_.end()) throw InputError(file_.string() + ": no motion '" + name + "'" + did_you_mean(name, names_));
  return *motions_[std::size_t(at - names_.begin())];
}

ParticlePicture RecordLook::picture(const std::string& name, const std::string& field, double time) const {
  const MotionSource& source = motion(name);
  ParticlePicture out;
  out.motion = name;
  const bool error = field == stated_error;
  out.field = std::move(report::fields_at(source, error ? "displacement_magnitude" : field, central_, {time}).front());
  const std::optional<std::size_t> k = report::frame_at(source, time);
  out.known = k.has_value();
  if (!k) return out;
  out.index = *k;
  const MotionFrame frame = source.frame(*k);
  if (error)
    for (std::size_t p = 0; p < out.field.value.size(); ++p)
      out.field.value[p] = p < frame.cov_u.size() && alive(frame.status[p]) ? component_error(frame.cov_u[p]) : nan_value;
  out.sigma = stated_sigma(frame, field);
  return out;
}

std::shared_ptr<const Image> RecordLook::frame(double time) const {
  if (!frames_ || listed_.empty()) return nullptr;
  const auto nearest = std::min_element(listed_.begin(), listed_.end(), [&](const Frame& a, const Frame& b) { return std::abs(a.time - time) < std::abs(b.time - time); });
  return frames_->shared(int(nearest - listed_.begin()));
}

std::optional<VectorField> RecordLook::vectors(double time) const {
  const std::size_t pairs = reader_->pair_count();
  if (pairs == 0 || listed_.size() < 2) return std::nullopt;
  std::size_t k = 0;
  const bool twos = listed_.size() == 2 * pairs && pairs > 1;
  while (k + 1 < pairs && listed_[(k + 1) * (twos ? 2 : 1)].time <= time) ++k;
  return reader_->pair(k);
}

ParticlePicture RecordLook::difference(const ParticlePicture& first, const ParticlePicture& second, const MotionSource& of_first,
                                       const MotionSource& of_second) {
  ParticlePicture out = first;
  out.sigma.clear();
  std::unordered_map<std::int64_t, std::size_t> where;
  for (std::size_t p = 0; p < of_second.particles().size(); ++p) where.emplace(of_second.particles().id[p], p);
  for (std::size_t p = 0; p < out.field.value.size(); ++p) {
    const auto other = where.find(of_first.particles().id[p]);
    const bool same = other != where.end() && (of_second.particles().x0[other->second] - of_first.particles().x0[p]).norm() <=
                                                  0.01 * particle_spacing(of_first.particles(), p);
    out.field.value[p] = same && other->second < second.field.value.size() ? second.field.value[other->second] - first.field.value[p] : nan_value;
  }
  return out;
}

History RecordLook::history(const std::string& name, const ParticlePicture& shown, const Vec2& place, const std::vector<std::string>& sides) const {
  const ParticleSet& particles = motion(name).particles();
  std::size_t best = particles.size();
  double nearest = 0;
  for (std::size_t p = 0; p < shown.field.position.size(); ++p) {
    if (!alive(shown.field.status[p])) continue;
    const double d = (shown.field.position[p] - place).norm();
    if (best == particles.size() || d < nearest) best = p, nearest = d;
  }
  if (best == particles.size() || nearest > 3 * particle_spacing(particles, best))
    throw InputError(name + ": no particle is followed at (" + number(place.x(), 4) + ", " + number(place.y(), 4) + ") " + head_.length_unit);
  History out;
  out.x0 = particles.x0[best];
  for (const std::string& side : sides) out.sides.push_back({side, report::point_curves(motion(side), {out.x0}).front()});
  return out;
}

plot::Scale scale_of(const std::vector<const ParticlePicture*>& pictures, double share) {
  std::vector<double> values;
  for (const ParticlePicture* picture : pictures)
    for (std::size_t p = 0; p < picture->field.value.size(); ++p)
      if (alive(picture->field.status[p]) && std::isfinite(picture->field.value[p])) values.push_back(picture->field.value[p]);
  if (values.empty()) return {};
  double lower = plot::quantile(values, share / 2), upper = plot::quantile(values, 1 - share / 2);
  plot::Scale scale;
  if (lower < 0 && upper > 0) {
    upper = std::max(-lower, upper);
    lower = -upper;
    scale.map = plot::Colours::diverging;
  } else if (lower >= 0) {
    lower = 0;
  } else {
    upper = 0;
  }
  if (!(upper > lower)) upper = lower + 1;
  scale.lower = lower;
  scale.upper = upper;
  for (const double v : values) scale.below |= v < lower, scale.above |= v > upper;
  return scale;
}

plot::Raster raster_of(const ParticlePicture& picture, const plot::Scale& scale, const plot::Box& box, int width) {
  std::vector<plot::Tile> tiles;
  for (const bool live : {false, true})  // those that ended lie below
    for (std::size_t p = 0; p < picture.field.position.size(); ++p) {
      const ParticleStatus status = picture.field.status[p];
      if (status == ParticleStatus::unborn || alive(status) != live || !picture.field.position[p].allFinite()) continue;
      tiles.push_back({picture.field.position[p], picture.field.half_x[p], picture.field.half_y[p],
                       live ? scale.at(picture.field.value[p]) : plot::ended_colour});
    }
  return plot::draw_tiles(tiles, box, width);
}

std::string csv_of(const ParticlePicture& picture, const MotionSource& motion, const ShownField& field) {
  const std::string length = " [" + motion.length_unit() + "]", unit = " [" + field.unit + "]";
  std::string out = "id,x0" + length + ",y0" + length + ",x" + length + ",y" + length + ",status," + field.name + unit + ",sigma" + unit + "\n";
  const auto cell = [](double value) { return std::isfinite(value) ? number(value, 9) : std::string(); };
  for (std::size_t p = 0; p < picture.field.position.size(); ++p) {
    out += std::to_string(motion.particles().id[p]);
    const Vec2 &x0 = motion.particles().x0[p], &x = picture.field.position[p];
    for (const double value : {x0.x(), x0.y(), x.x(), x.y()}) out += "," + cell(value);
    out += "," + std::to_string(int(picture.field.status[p])) + "," + cell(picture.field.value[p]) + "," +
           cell(p < picture.sigma.size() ? picture.sigma[p] : nan_value) + "\n";
  }
  return out;
}

}  // namespace pivnp::view
