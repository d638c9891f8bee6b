#include "apps/study/pipeline/scene/initial_state.hpp"

#include <cmath>
#include <limits>

#include "apps/study/pipeline/scene/scene.hpp"
#include "compare/data/triangulation.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/io/imports/stress_file.hpp"

namespace pivnp::app {

namespace {

using Stress = std::array<double, 4>;

// Linear between the values of a file. Points beyond them take the edge's, as far as the values are apart: what a mesh keeps at
// its own points ends before the material does.
class Between {
 public:
  Between(const std::vector<Vec2>& at, const std::string& key)
      : key_(key),
        apart_(compare::median_neighbour_distance(at)),
        mesh_(at, std::vector<double>(at.size(), everywhere)) {}

  // add(k, weight) of each value that counts at x.
  template <class Add>
  void at(const Vec2& x, Add&& add) const {
    const auto place = mesh_.find(x);
    if (!place || place->beyond.norm() > apart_)
      throw InputError(key_ + ": no value within " + number(apart_) + " m of the material point at (" + number(x.x()) +
                       ", " + number(x.y()) + "), expected values over the whole region");
    for (std::size_t k = 0; k < 3; ++k)
      if (place->vertex[k] >= 0) add(std::size_t(place->vertex[k]), place->weight[k]);
  }

 private:
  static constexpr double everywhere = 1e12;  // no triangle is a gap
  std::string key_;
  double apart_;
  compare::MaterialMesh mesh_;
};

void put_pressure(const Case& c, const std::string& name, const InitialOptions& o,
                  const std::vector<std::size_t>& points, mpm::Scene& scene) {
  const ParticleSet& set = scene.particles;
  scene.pressure0.resize(set.size(), std::numeric_limits<double>::quiet_NaN());
  if (o.pressure_pa) {
    for (const std::size_t k : points)
      scene.pressure0[k] = *o.pressure_pa + o.pressure_gradient_pa_m.value_or(0) * (set.x0[k].y() - o.pressure_level_m.value_or(0));
    return;
  }
  const io::PressureValues values = io::read_pressure(c.folder / o.pressure_file);
  const Between between(values.at, of_file(c) + ": initial." + name + ".pressure_file");
  for (const std::size_t k : points) {
    double sum = 0;
    between.at(set.x0[k], [&](std::size_t value, double weight) { sum += weight * values.pressure[value]; });
    scene.pressure0[k] = sum;
  }
}

}  // namespace

void put_initial_state(const Case& c, mpm::Scene& scene) {
  const ParticleSet& set = scene.particles;
  for (const auto& [name, o] : c.initial) {
    std::vector<std::size_t> points;
    Vec2 centre = Vec2::Zero();
    double area = 0;
    for (std::size_t k = 0; k < set.size(); ++k) {
      if (set.label_names[std::size_t(set.label[k])] != name) continue;
      points.push_back(k);
      centre += double(set.area[k]) * set.x0[k];
      area += double(set.area[k]);
    }
    if (points.empty()) continue;
    centre /= area;

    const Vec2 velocity(o.velocity_m_s[0], o.velocity_m_s[1]);
    if (velocity.norm() > 0 || o.spin_rad_s != 0) {
      scene.v0.resize(set.size(), Vec2::Zero());
      for (const std::size_t k : points) {
        const Vec2 arm = set.x0[k] - centre;
        scene.v0[k] = velocity + o.spin_rad_s * Vec2(-arm.y(), arm.x());
      }
      if (o.spin_rad_s != 0) {
        scene.grad_v0.resize(set.size(), std::array<double, 4>{});
        for (const std::size_t k : points) scene.grad_v0[k] = {0, -o.spin_rad_s, o.spin_rad_s, 0};
      }
    }
    if (o.pressure_pa || !o.pressure_file.empty()) put_pressure(c, name, o, points, scene);
    if (o.stress_pa.empty() && o.stress_file.empty()) continue;
    scene.stress0.resize(set.size(), Stress{std::numeric_limits<double>::quiet_NaN(), 0, 0, 0});
    if (!o.stress_file.empty()) {
      const io::StressValues values = io::read_stress(c.folder / o.stress_file);
      const Between between(values.at, of_file(c) + ": initial." + name + ".stress_file");
      for (const std::size_t k : points) {
        Stress& sum = scene.stress0[k] = {};
        between.at(set.x0[k], [&](std::size_t value, double weight) {
          for (std::size_t component = 0; component < 4; ++component)
            sum[component] += weight * values.stress[value][component];
        });
      }
      continue;
    }
    for (const std::size_t k : points)
      for (std::size_t component = 0; component < 4; ++component)
        scene.stress0[k][component] =
            o.stress_pa[component] +
            (o.stress_gradient_pa_m.empty() ? 0.0 : o.stress_gradient_pa_m[component] * (set.x0[k].y() - o.stress_level_m.value_or(0)));
  }
}

}  // namespace pivnp::app
