#include "apps/view/model/frames.hpp"

#include <cstring>

namespace pivnp::view {

Image SharedFrames::read(int index) {
  const std::lock_guard lock(mutex_);
  return source_->read(index);
}

std::shared_ptr<const Image> SharedFrames::shared(int index) {
  constexpr std::size_t room = std::size_t(256) << 20;
  const std::lock_guard lock(mutex_);
  for (auto it = kept_.begin(); it != kept_.end(); ++it)
    if (it->first == index) {
      kept_.splice(kept_.begin(), kept_, it);
      return kept_.front().second;
    }
  kept_.emplace_front(index, std::make_shared<const Image>(source_->read(index)));
  const Image& image = *kept_.front().second;
  const std::size_t each = std::size_t(image.stride()) * std::size_t(image.height());
  while (kept_.size() > 1 && kept_.size() * each > room) kept_.pop_back();
  return kept_.front().second;
}

double grey_at(const ImageView& image, int column, int row) {
  switch (image.depth) {
    case PixelDepth::u8: return image.row<std::uint8_t>(row)[column];
    case PixelDepth::u16: return image.row<std::uint16_t>(row)[column];
    case PixelDepth::f32: break;
  }
  return double(image.row<float>(row)[column]);
}

}  // namespace pivnp::view
