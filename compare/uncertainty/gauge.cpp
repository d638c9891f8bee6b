#include "compare/uncertainty/gauge.hpp"

#include <cmath>
#include <map>
#include <utility>

namespace pivnp::compare {

GaugeAverage::GaugeAverage(const std::vector<Vec2>& X, double side) {
  std::map<std::pair<long, long>, int> cells;
  for (const Vec2& x : X) {
    const Vec2 at = 5 * x / side;
    cell_.push_back(
        cells.try_emplace({long(std::floor(at.x())), long(std::floor(at.y()))}, int(cells.size())).first->second);
  }
  neighbours_.resize(cells.size());
  for (const auto& [place, cell] : cells)
    for (long j = -2; j <= 2; ++j)
      for (long i = -2; i <= 2; ++i)
        if (const auto other = cells.find({place.first + i, place.second + j}); other != cells.end())
          neighbours_[std::size_t(cell)].push_back(other->second);
}

std::vector<Mat2> GaugeAverage::of(const std::vector<Mat2>& F) const {
  if (!given()) return F;
  struct Sum {
    Mat2 F = Mat2::Zero();
    double count = 0;
  };
  std::vector<Sum> own(neighbours_.size()), all(neighbours_.size());
  for (std::size_t p = 0; p < F.size(); ++p) {
    if (!F[p].allFinite()) continue;
    Sum& s = own[std::size_t(cell_[p])];
    s.F += F[p];
    ++s.count;
  }
  for (std::size_t c = 0; c < all.size(); ++c)
    for (const int n : neighbours_[c]) all[c].F += own[std::size_t(n)].F, all[c].count += own[std::size_t(n)].count;
  std::vector<Mat2> out(F.size());
  for (std::size_t p = 0; p < F.size(); ++p) out[p] = all[std::size_t(cell_[p])].F / all[std::size_t(cell_[p])].count;
  return out;
}

}  // namespace pivnp::compare
