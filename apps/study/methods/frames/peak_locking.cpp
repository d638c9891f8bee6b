#include "apps/study/methods/frames/peak_locking.hpp"

#include <Eigen/LU>
#include <cmath>

#include "pivnp/core/text.hpp"
#include "pivnp/image/frames/compression.hpp"
#include "pivnp/piv/validation/block_edges.hpp"
#include "pivnp/piv/validation/interlace.hpp"
#include "pivnp/piv/validation/peak_locking.hpp"

namespace pivnp::app {

namespace {

// Vectors of the record back in pixels: the inverse of world_vectors.
std::vector<std::array<float, 2>> pixel_displacements(const VectorField& field, const piv::NodeLattice& lattice,
                                                      const Setting& setting) {
  const image::Camera &camera = setting.camera_at(field.pair[0]), &second = setting.camera_at(field.pair[1]);
  std::vector<std::array<float, 2>> pixels(field.displacement.size());
  for (std::size_t n = 0; n < pixels.size(); ++n) {
    const Vec2 at(double(lattice.pixel[n][0]), double(lattice.pixel[n][1]));
    const Vec2 moved(double(field.displacement[n][0]), double(field.displacement[n][1]));
    if (!setting.cameras.empty()) {
      const Vec2 x = setting.grid.position(int(n) % setting.grid.nx, int(n) / setting.grid.nx);
      const Vec2 start = field.anchor == Anchor::forward ? x : Vec2(x - moved / 2);
      const Vec2 d = second.to_pixel(start + moved) - camera.to_pixel(start);
      pixels[n] = {float(d.x()), float(d.y())};
      continue;
    }
    const Vec2 d = field.anchor == Anchor::forward
                       ? Vec2(camera.to_pixel(camera.to_world(at) + moved) - at)
                       : Vec2(camera.jacobian(at).inverse() * moved);  // about the middle: exact to second order
    pixels[n] = {float(d.x()), float(d.y())};
  }
  return pixels;
}

}  // namespace

std::vector<std::string> texture_remarks(const Setting& setting, const Image& frame,
                                         const std::filesystem::path& file) {
  const double diameter = piv::blob_diameter(frame.view(), setting.mask.view());
  std::vector<std::string> remarks;
  if (diameter < piv::least_blob_px)
    remarks.push_back("The texture is too fine for the pixels: its blobs are about " + number(diameter, 2) +
                      " px wide, and below " + number(piv::least_blob_px, 2) +
                      " px displacements are drawn towards whole pixels by hundredths of a pixel (peak locking).");
  const double blocks = piv::block_edge_ratio(frame.view(), setting.mask.view());
  if (blocks > piv::most_block_edges)
    remarks.push_back("The blocks of a strong compression show in the frames: grey values step " + (std::isfinite(blocks) ? number(blocks, 2) + " times as far" : std::string("only")) +
                      " across their edges, where 1 is usual. Blocks stand still, and vectors follow them where little texture is left (JPEG below quality 20, or as little of a video).");
  const auto stated = file.empty() ? std::nullopt : image::jpeg_quality(file),
             quality = stated ? stated : image::jpeg_quality(frame.view());
  if (quality && *quality < image::least_jpeg_quality && !(blocks > piv::most_block_edges))
    remarks.push_back("The frames were compressed as JPEG of quality " + std::to_string(*quality) +
                      " or so: the finer part of the texture is lost or rounded, and what is rounded stays with the "
                      "blocks while the material moves. Record uncompressed, or at quality 90 or more.");
  return remarks;
}

std::vector<std::string> interlace_remarks(const Setting& setting, const Image& frame, const VectorField& field) {
  const piv::NodeLattice lattice = node_lattice(setting);
  if (piv::field_delay(frame.view(), setting.mask.view(), lattice, pixel_displacements(field, lattice, setting),
                       field.status) == 0)
    return {};
  return {
      "The frames are interlaced: their even and odd lines show instants half a frame apart, and windows follow both. "
      "Take every second line of "
      "each frame (ffmpeg -vf separatefields or bwdif), or film progressively."};
}

std::vector<std::string> fraction_remarks(const Setting& setting, std::size_t pairs,
                                          const std::function<VectorField(std::size_t)>& pair) {
  if (pairs == 0) return {};
  const piv::NodeLattice lattice = node_lattice(setting);
  piv::FractionStatistics statistics;
  const std::size_t step = (pairs + 15) / 16;
  for (std::size_t k = 0; k < pairs; k += step) {
    const VectorField field = pair(k);
    statistics.add(lattice.nx, pixel_displacements(field, lattice, setting), field.status);
  }
  if (!statistics.locked()) return {};
  const auto shares = statistics.histogram();
  constexpr std::size_t middle = piv::FractionStatistics::bins / 2;
  const double near = shares[middle - 2] + shares[middle - 1] + shares[middle] + shares[middle + 1];
  return {"Displacements are drawn towards whole pixels (peak locking) by up to " + number(statistics.amplitude(), 2) +
          " px, standard error " + number(statistics.amplitude_error(), 2) + " px; " + number(100 * near, 3) +
          " % of them lie within 0.1 px of a whole pixel."};
}

}  // namespace pivnp::app
