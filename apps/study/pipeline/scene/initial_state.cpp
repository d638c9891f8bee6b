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
class StressField {
 public:
  StressField(const std::filesystem::path& file, const std::string& key)
      : key_(key), values_(io::read_stress(file)), apart_(compare::median_neighbour_distance(values_.at)),
        mesh_(values_.at, std::vector<double>(values_.at.size(), everywhere)) {}

  Stress at(const Vec2& x) const {
    const auto place = mesh_.find(x);
    if (!place || place->beyond.norm() > apart_)
      throw InputError(key_ + ": no value within " + number(apart_) + " m of the material point at (" + number(x.x()) + ", " +
                       number(x.y()) + "), expected values over the whole region");
    Stress sum{};
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t c = 0; c < 4 && place->vertex[k] >= 0; ++c)
        sum[c] += place->weight[k] * values_.stress[std::size_t(place->vertex[k])][c];
    return sum;
  }

 private:
  static constexpr double everywhere = 1e12;  // no triangle is a gap
  std::string key_;
  io::StressValues values_;
  double apart_;
  compare::MaterialMesh mesh_;
};

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
    if (o.stress_pa.empty() && o.stress_file.empty()) continue;
    scene.stress0.resize(set.size(), Stress{std::numeric_limits<double>::quiet_NaN(), 0, 0, 0});
    if (!o.stress_file.empty()) {
      const StressField field(c.folder / o.stress_file, of_file(c) + ": initial." + name + ".stress_file");
      for (const std::size_t k : points) scene.stress0[k] = field.at(set.x0[k]);
      continue;
    }
    for (const std::size_t k : points)
      for (std::size_t component = 0; component < 4; ++component)
        scene.stress0[k][component] =
            o.stress_pa[component] +
            (o.stress_gradient_pa_m.empty() ? 0.0 : o.stress_gradient_pa_m[component] * (set.x0[k].y() - o.stress_level_m));
  }
}

}  // namespace pivnp::app
