#include "pivnp/io/motion_file.hpp"

#include <utility>

#include "pivnp/io/segment.hpp"

namespace pivnp::io {

namespace {

class FileMotion final : public MotionSource {
 public:
  FileMotion(const h5::Source& source, const std::string& name, const Units& units, std::shared_ptr<const void> keep)
      : keep_(std::move(keep)), name_(name), units_(units), particles_(read_particles(source, "/motion/" + name)) {
    const std::string group = "/motion/" + name;
    const h5::Dataset time = source.dataset(group + "/time");
    times_ = time.all<double>();
    for (const ItemArray& a : frame_arrays(particles_.size(), units_, nullptr)) {
      const bool optional = a.name != "time" && a.name != "u" && a.name != "F" && a.name != "status";
      if (a.name == "time" || (optional && !source.has(group + "/" + a.name))) continue;
      h5::Dataset d = source.dataset(group + "/" + a.name);
      h5::Shape expected{times_.size()};
      expected.insert(expected.end(), a.item.begin(), a.item.end());
      d.expect(expected);
      arrays_.emplace_back(a.name, std::move(d));
    }
  }

  const std::string& name() const override { return name_; }
  const std::string& length_unit() const override { return units_.length; }
  const std::string& time_unit() const override { return units_.time; }
  const ParticleSet& particles() const override { return particles_; }
  const std::vector<double>& times() const override { return times_; }

  MotionFrame frame(std::size_t index) const override {
    MotionFrame f;
    f.time = times_.at(index);
    const auto fill = [&](const std::string& array, h5::Type type, auto& values) {
      for (const auto& [name, dataset] : arrays_) {
        if (name != array) continue;
        values.resize(particles_.size());
        dataset.read(type, index, 1, values.data());
      }
    };
    fill("u", h5::Type::f32, f.u);
    fill("F", h5::Type::f32, f.F);
    fill("status", h5::Type::u8, f.status);
    fill("cov_u", h5::Type::f32, f.cov_u);
    fill("v", h5::Type::f32, f.v);
    fill("stress", h5::Type::f32, f.stress);
    fill("plastic_dev", h5::Type::f32, f.plastic_dev);
    return f;
  }

 private:
  std::shared_ptr<const void> keep_;  // first: goes last
  std::string name_;
  Units units_;
  ParticleSet particles_;
  std::vector<double> times_;
  std::vector<std::pair<std::string, h5::Dataset>> arrays_;  // kept open: their chunk caches serve the next frame
};

}  // namespace

std::unique_ptr<MotionSource> open_motion(const h5::Source& source, const std::string& name, const Units& units,
                                          std::shared_ptr<const void> keep) {
  return std::make_unique<FileMotion>(source, name, units, std::move(keep));
}

}  // namespace pivnp::io
