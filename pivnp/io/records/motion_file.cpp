#include "pivnp/io/records/motion_file.hpp"

#include <cmath>
#include <utility>

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/fields.hpp"
#include "pivnp/io/records/segment.hpp"

namespace pivnp::io {

namespace {

class FileMotion final : public MotionSource {
 public:
  FileMotion(const h5::Source& source, const std::string& name, const Units& units, std::shared_ptr<const void> keep)
      : keep_(std::move(keep)), name_(name), units_(units), particles_(read_particles(source, "/motion/" + name)) {
    const std::string group = "/motion/" + name;
    const h5::Dataset time = source.dataset(group + "/time");
    time.expect({h5::product(time.shape())});
    times_ = time.all<double>();
    check(time.label());
    for (const ItemArray& a : frame_arrays(particles_.size(), units_, nullptr)) {
      const MotionField* field = motion_fields().find(a.name);
      if (!field || (!field->always && !source.has(group + "/" + a.name))) continue;
      h5::Dataset d = source.dataset(group + "/" + a.name);
      h5::Shape expected{times_.size()};
      expected.insert(expected.end(), a.item.begin(), a.item.end());
      d.expect(expected);
      arrays_.push_back({field, a.type, std::move(d)});
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
    for (const Array& a : arrays_) a.dataset.read(a.type, index, 1, make_room(f, *a.field, particles_.size()));
    // A state that a later version added is none to count on.
    for (ParticleStatus& status : f.status)
      if (status > ParticleStatus::ended) status = ParticleStatus::ended;
    return f;
  }

 private:
  // What everything that reads a motion takes for granted.
  void check(const std::string& label) const {
    for (std::size_t k = 0; k < times_.size(); ++k)
      if (!std::isfinite(times_[k]) || (k > 0 && !(times_[k] > times_[k - 1])))
        throw InputError(label + ": item " + std::to_string(k) + " is " + std::to_string(times_[k]) +
                         ", expected finite times that ascend");
    for (std::size_t p = 0; p < particles_.size(); ++p) {
      const auto who = [&] {
        return label.substr(0, label.rfind('/')) + ": the particle with id " + std::to_string(particles_.id[p]);
      };
      if (!particles_.x0[p].allFinite() || !std::isfinite(particles_.area[p]))
        throw InputError(who() + " has a place or an area that is not finite");
      const std::int32_t name = particles_.label[p];
      if (name < 0 || std::size_t(name) >= particles_.label_names.size())
        throw InputError(who() + " has label " + std::to_string(name) + ", but there are " +
                         std::to_string(particles_.label_names.size()) + " names");
    }
  }

  struct Array {
    const MotionField* field;
    h5::Type type;
    h5::Dataset dataset;  // kept open: its chunk cache serves the next frame
  };
  std::shared_ptr<const void> keep_;  // first: goes last
  std::string name_;
  Units units_;
  ParticleSet particles_;
  std::vector<double> times_;
  std::vector<Array> arrays_;
};

}  // namespace

std::unique_ptr<MotionSource> open_motion(const h5::Source& source, const std::string& name, const Units& units,
                                          std::shared_ptr<const void> keep) {
  return std::make_unique<FileMotion>(source, name, units, std::move(keep));
}

}  // namespace pivnp::io
