// Pictures of an animation: the frame with its vectors, the measured particles by strain, the simulation beside them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "apps/plot/raster.hpp"
#include "apps/plot/scale.hpp"
#include "apps/report/content/content.hpp"

namespace pivnp::report {

class Animation {
 public:
  /// `content` must outlive it. One picture a time of the comparison, or else of the first motion.
  explicit Animation(const Content& content);
  std::size_t size() const { return times_.size(); }
  /// The frame of the experiment nearest to a picture's time; -1 where there are no frames.
  int frame_of(std::size_t index) const;
  /// One picture; all have one size. `picture`: that frame, without an image if it is not there.
  std::string png(std::size_t index, const Picture& picture) const;

 private:
  const Content& content_;
  std::vector<double> times_;
  std::string field_ = "strain_dev";
  plot::Box box_;
  plot::Scale scale_;
};

}  // namespace pivnp::report
