#include "pivnp/core/particles/places.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>

#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/particles/derived.hpp"
#include "pivnp/core/particles/fields.hpp"

namespace pivnp {

namespace {

// What a place is read from: particles with weights of sum 1 that reproduce affine fields, and for covariances cells of them.
struct Place {
  Vec2 x = Vec2::Zero();
  std::vector<std::size_t> particle;
  std::vector<double> weight;
  std::vector<std::size_t> cell;  // of each particle; empty: covariances are those of the first
  bool mean = false;              // over those that are followed; else all must be
};

bool born_later(const ParticleSet& set, std::size_t p, double start) { return p < set.born.size() && set.born[p] > start; }

double start_of(const MotionSource& motion) { return motion.times().empty() ? 0 : motion.times().front(); }

// The same where the source tells no area: the mean share of the box around all.
double spacing_about(const ParticleSet& set, std::size_t p) {
  if (const double known = particle_spacing(set, p); known > 0) return known;
  Vec2 lower = Vec2::Constant(std::numeric_limits<double>::infinity()), upper = -lower;
  for (const Vec2& x : set.x0)
    if (x.allFinite()) lower = lower.cwiseMin(x), upper = upper.cwiseMax(x);
  const Vec2 size = upper - lower;
  return size.allFinite() ? std::sqrt(size.x() * size.y() / double(set.size())) : 0;
}

Place place_of(const ParticleSet& set, const Vec2& point, double start) {
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t p = 0; p < set.size(); ++p)
    if (!born_later(set, p, start)) near.emplace_back((set.x0[p] - point).norm(), p);
  Place s{point, {}, {}, {}, false};
  if (near.empty()) return s;
  const std::size_t k = std::min<std::size_t>(6, near.size());
  std::partial_sort(near.begin(), near.begin() + std::ptrdiff_t(k), near.end());
  const double h = spacing_about(set, near[0].second);
  if (h > 0 && near[0].first > 2 * h) return s;
  s.particle = {near[0].second};
  s.weight = {1.0};
  if (near[0].first <= 1e-6 * h || k < 3) return s;
  // Least squares u = c + G (x - point): the weights of c.
  Eigen::MatrixXd A(Eigen::Index(k), 3);
  for (std::size_t j = 0; j < k; ++j) {
    const Vec2 d = (set.x0[near[j].second] - point) / near[k - 1].first;
    A.row(Eigen::Index(j)) << 1, d.x(), d.y();
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(A);
  if (qr.rank() < 3) return s;
  const Eigen::MatrixXd inverse = qr.solve(Eigen::MatrixXd::Identity(Eigen::Index(k), Eigen::Index(k)));
  s.particle.clear();
  s.weight.clear();
  for (std::size_t j = 0; j < k; ++j) {
    s.particle.push_back(near[j].second);
    s.weight.push_back(inverse(0, Eigen::Index(j)));
  }
  return s;
}

// A motion with a particle a place.
class AtPlaces final : public MotionSource {
 public:
  AtPlaces(std::shared_ptr<const MotionSource> motion, std::vector<Place> places) : motion_(std::move(motion)), places_(std::move(places)) {
    const ParticleSet& from = motion_->particles();
    set_.label_names = from.label_names;
    for (const Place& place : places_) {
      double area = 0, end = nan_value;  // the first of a point's particles, the last of a rectangle's
      bool open = false;
      EndReason reason = EndReason::none;
      for (const std::size_t p : place.particle) {
        if (p < from.area.size()) area += place.mean ? from.area[p] : from.area[p] / double(place.particle.size());
        const double e = p < from.end.size() ? from.end[p] : nan_value;
        open = open || !std::isfinite(e);
        if (!std::isfinite(e) || (place.mean ? e <= end : e >= end)) continue;
        end = e;
        reason = p < from.end_reason.size() ? from.end_reason[p] : EndReason::none;
      }
      if (place.mean && open) end = nan_value, reason = EndReason::none;
      const bool found = !place.particle.empty();
      set_.id.push_back(std::int64_t(set_.id.size()));
      set_.label.push_back(found && place.particle[0] < from.label.size() ? from.label[place.particle[0]] : 0);
      set_.x0.push_back(place.x);
      set_.area.push_back(area);
      set_.born.push_back(start_of(*motion_));
      set_.end.push_back(end);
      set_.end_reason.push_back(reason);
    }
  }
  const std::string& name() const override { return motion_->name(); }
  const std::string& length_unit() const override { return motion_->length_unit(); }
  const std::string& time_unit() const override { return motion_->time_unit(); }
  const ParticleSet& particles() const override { return set_; }
  const std::vector<double>& times() const override { return motion_->times(); }

  MotionFrame frame(std::size_t index) const override {
    const MotionFrame from = motion_->frame(index);
    MotionFrame to;
    to.time = from.time;
    to.status.resize(places_.size());
    for (const MotionField& field : motion_fields()) {
      if (field.form == FieldForm::code || particles_with(from, field) == 0) continue;
      const auto* values = static_cast<const float*>(values_of(from, field));
      auto* out = static_cast<float*>(make_room(to, field, places_.size()));
      const std::size_t n = field.components();
      const bool covariance = field.name == "cov_u" || field.name == "cov_F";
      for (std::size_t q = 0; q < places_.size(); ++q) {
        const Shares shares = shares_of(places_[q], from, covariance);
        to.status[q] = shares.status;
        for (std::size_t c = 0; c < n; ++c) {
          double sum = alive(shares.status) ? 0 : nan_value, least = 0;
          for (const auto& [p, w] : shares.of) {
            sum += w * double(values[p * n + c]);
            least = std::min(least, double(values[p * n + c]));
          }
          // (Beside the water's surface a plane through wet and dry particles is below zero.)
          if (field.form == FieldForm::scalar && least == 0 && sum < 0) sum = 0;
          out[q * n + c] = float(sum);
        }
      }
    }
    return to;
  }

 private:
  struct Shares {
    ParticleStatus status = ParticleStatus::unborn;
    std::vector<std::pair<std::size_t, double>> of;  // weights of the particles' values; none where it is not alive
  };

  Shares shares_of(const Place& place, const MotionFrame& frame, bool covariance) const {
    Shares shares;
    double followed = 0;
    bool flagged = false;
    for (std::size_t j = 0; j < place.particle.size(); ++j) {
      const ParticleStatus s = frame.status[place.particle[j]];
      flagged = flagged || s == ParticleStatus::flagged;
      if (!alive(s) && !place.mean) {
        shares.of.clear();
        shares.status = s;
        return shares;
      }
      if (!alive(s)) continue;
      followed += place.weight[j];
      shares.of.emplace_back(place.particle[j], place.weight[j]);
    }
    if (place.particle.empty()) return shares;
    if (shares.of.empty()) {
      shares.status = ParticleStatus::ended;
      return shares;
    }
    shares.status = flagged ? ParticleStatus::flagged : ParticleStatus::active;
    if (place.mean)
      for (auto& share : shares.of) share.second /= followed;
    if (!covariance) return shares;
    if (place.cell.empty()) {
      shares.of = {{shares.of.front().first, 1.0}};
      return shares;
    }
    std::map<std::size_t, double> in_cell;
    std::size_t at = 0;
    const auto each = [&](const auto& visit) {
      at = 0;
      for (std::size_t j = 0; j < place.particle.size() && at < shares.of.size(); ++j)
        if (shares.of[at].first == place.particle[j]) visit(place.cell[j], shares.of[at].second), ++at;
    };
    each([&](std::size_t cell, double& w) { in_cell[cell] += w; });
    each([&](std::size_t cell, double& w) { w *= in_cell[cell]; });
    return shares;
  }

  std::shared_ptr<const MotionSource> motion_;
  std::vector<Place> places_;
  ParticleSet set_;
};

// The particle of the first frame that is nearest to a point; the number of particles if none is within two spacings.
std::size_t nearest(const ParticleSet& set, const Vec2& point, double start) {
  std::size_t best = set.size();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t p = 0; p < set.size(); ++p) {
    if (born_later(set, p, start)) continue;
    const double d = (set.x0[p] - point).norm();
    if (d < least) least = d, best = p;
  }
  const double h = best < set.size() ? spacing_about(set, best) : 0;
  return h > 0 && least > 2 * h ? set.size() : best;
}

}  // namespace

double particle_spacing(const ParticleSet& particles, std::size_t p) {
  return p < particles.area.size() && particles.area[p] > 0 ? std::sqrt(particles.area[p]) : 0;
}

std::shared_ptr<const MotionSource> at_points(std::shared_ptr<const MotionSource> motion, const std::vector<Vec2>& points) {
  std::vector<Place> places;
  for (const Vec2& x : points) places.push_back(place_of(motion->particles(), x, start_of(*motion)));
  return std::make_shared<AtPlaces>(std::move(motion), std::move(places));
}

std::shared_ptr<const MotionSource> in_rectangle(std::shared_ptr<const MotionSource> motion, const Vec2& lower, const Vec2& upper,
                                                 double correlation_length) {
  const ParticleSet& set = motion->particles();
  Place place{Vec2::Zero(), {}, {}, {}, true};
  std::map<std::pair<std::int64_t, std::int64_t>, std::size_t> cells;
  double sum = 0;
  for (std::size_t p = 0; p < set.size(); ++p) {
    const Vec2& x = set.x0[p];
    if (born_later(set, p, start_of(*motion)) || !((x - lower).minCoeff() >= 0 && (upper - x).minCoeff() >= 0)) continue;
    const double w = p < set.area.size() && set.area[p] > 0 ? set.area[p] : 1;
    const Vec2 at = correlation_length > 0 ? Vec2((x - lower) / correlation_length) : Vec2(0, 0);
    place.particle.push_back(p);
    place.weight.push_back(w);
    place.cell.push_back(cells.emplace(std::pair(std::int64_t(at.x()), std::int64_t(at.y())), cells.size()).first->second);
    place.x += w * x;
    sum += w;
  }
  for (double& w : place.weight) w /= sum;
  place.x = sum > 0 ? Vec2(place.x / sum) : Vec2((lower + upper) / 2);
  return std::make_shared<AtPlaces>(std::move(motion), std::vector<Place>{std::move(place)});
}

ExtensometerCurve extensometer(const MotionSource& motion, const Vec2& from, const Vec2& to) {
  ExtensometerCurve curve;
  const ParticleSet& set = motion.particles();
  const double start = start_of(motion);
  const std::array<std::size_t, 2> end = {nearest(set, from, start), nearest(set, to, start)};
  const bool found = end[0] < set.size() && end[1] < set.size() && end[0] != end[1];
  const Vec2 first = found ? Vec2(set.x0[end[1]] - set.x0[end[0]]) : Vec2::Zero();
  for (std::size_t k = 0; k < motion.times().size(); ++k) {
    const MotionFrame frame = motion.frame(k);
    double strain = nan_value, variance = 0;
    if (found && alive(frame.status[end[0]]) && alive(frame.status[end[1]])) {
      Vec2 now = first;
      for (const int s : {0, 1}) {
        const auto& u = frame.u[end[std::size_t(s)]];
        now += (s == 0 ? -1 : 1) * Vec2(double(u[0]), double(u[1]));
      }
      strain = now.norm() / first.norm() - 1;
      const Vec2 e = now.normalized();
      for (const std::size_t p : end) {
        if (p >= frame.cov_u.size()) continue;
        const auto& c = frame.cov_u[p];
        variance += e.x() * e.x() * double(c[0]) + e.y() * e.y() * double(c[1]) + 2 * e.x() * e.y() * double(c[2]);
      }
    }
    curve.time.push_back(motion.times()[k]);
    curve.strain.push_back(strain);
    if (!frame.cov_u.empty()) curve.sigma.push_back(std::sqrt(std::max(0.0, variance)) / first.norm());
  }
  if (curve.sigma.size() != curve.time.size()) curve.sigma.clear();
  return curve;
}

SectionCurve section(const MotionSource& motion, const std::string& field, bool central, std::size_t index, const Vec2& from,
                     const Vec2& to) {
  constexpr int places = 121;
  SectionCurve curve;
  DerivedReader reader(motion, central);
  const MotionFrame frame = motion.frame(index);
  const std::vector<double> values = reader.values(field, index);
  const std::string error = sigma_field(field);
  std::vector<double> errors = error.empty() ? std::vector<double>{} : reader.values(error, index);
  if (std::none_of(errors.begin(), errors.end(), [](double s) { return std::isfinite(s); })) errors.clear();
  const ParticleSet& set = motion.particles();
  const double known = set.size() > 0 && particle_spacing(set, 0) > 0 ? 0 : spacing_about(set, 0);
  for (int k = 0; k < places; ++k) {
    const double share = double(k) / (places - 1);
    const Vec2 place = from + share * (to - from);
    double best = nan_value, sigma = nan_value, least = std::numeric_limits<double>::infinity();
    for (std::size_t p = 0; p < set.size(); ++p) {
      const Vec2 x = set.x0[p] + Vec2(double(frame.u[p][0]), double(frame.u[p][1]));
      const double d = (x - place).norm(), h = std::max(known, particle_spacing(set, p));
      if (!alive(frame.status[p]) || !(d < least) || (h > 0 && d > h)) continue;
      least = d;
      best = values[p];
      if (!errors.empty()) sigma = errors[p];
    }
    curve.distance.push_back(share * (to - from).norm());
    curve.value.push_back(best);
    if (!errors.empty()) curve.sigma.push_back(sigma);
  }
  return curve;
}

}  // namespace pivnp
