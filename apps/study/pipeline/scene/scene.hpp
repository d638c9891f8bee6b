// What a case's geometry comes to once the frames' size is known: camera, mask, grid, regions, numerical particles.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "apps/case/case.hpp"
#include "pivnp/core/particles/motion.hpp"
#include "pivnp/core/particles/region.hpp"
#include "pivnp/core/record/camera_motion.hpp"
#include "pivnp/core/record/vectors.hpp"
#include "pivnp/image/camera/camera.hpp"
#include "pivnp/image/frames/filter.hpp"
#include "pivnp/image/masks/mask.hpp"
#include "pivnp/image/masks/moving_mask.hpp"
#include "pivnp/io/files/file_identity.hpp"
#include "pivnp/io/imports/import_vectors.hpp"
#include "pivnp/piv/piv.hpp"

namespace pivnp::app {

/// What messages call a case: its file, or its name where it has none.
std::string of_file(const Case& c);

constexpr double round_off = 1e-9;  // of a cell

struct Extent {
  Vec2 lower, upper;
};
/// Of two opposite corners. Throws InputError "WHAT: found 3 points, expected two opposite corners".
Extent corners(const Points& points, const std::string& what);

/// Takes the particles off that are not to be kept.
void keep_only(ParticleSet& set, const std::vector<bool>& keep);

struct Setting {
  int width = 0, height = 0;  // of the frames, px; 0 without frames
  image::Camera camera;               // of the first frame
  CameraMotion camera_motion;         // empty: the camera is at rest
  std::vector<image::Camera> cameras;  // one a frame where it moves (set_camera_motion)
  image::Mask mask;                   // of what stays where it is; where the camera moves, as in the first frame
  image::Mask image_mask;             // where the camera moves: of that, what goes with the image, not with the world
  image::MovingMasks moving_masks;
  std::shared_ptr<const image::FrameFilter> filter;  // of frames that are correlated; null: none
  Grid grid;                    // the shared nodes
  std::vector<Region> regions;  // in the world; the whole grid if the case names none
  bool imported = false;        // the nodes are those of other programs' vectors
  std::vector<io::FileIdentity> sources;  // of a run: the files its frames and masks come from (sources_of)

  const image::Camera& camera_at(int frame) const { return cameras.empty() ? camera : cameras.at(std::size_t(frame)); }
};

/// The frame as it is correlated.
Image prepared(const Setting& setting, Image frame);

/// What may be used of frame `k`.
image::Mask mask_of(const Setting& setting, int k, const ImageView& frame);

/// From now on frame k of `setting` is seen by its camera after motion.at[k].
void set_camera_motion(CameraMotion motion, Setting& setting);

/// Throws InputError where grid, masks or regions do not fit the frames. `width` = 0: no frames; the grid then comes
/// from [grid] area_m and spacing_m, or from the MPM domain or the regions' extent. `measured`: other programs' vectors,
/// whose nodes the grid then has; in pixels, and without frames, the image is taken to end with their last row and
/// column.
Setting make_setting(const Case& c, int width, int height, const io::VectorFiles* measured = nullptr);

/// Where the grid's nodes are in the first frame.
piv::NodeLattice node_lattice(const Setting& setting);
/// Where vectors of a pair are to be measured so that they are at the grid's nodes: a camera that moves sees them
/// elsewhere in every frame.
piv::NodeLattice node_lattice(const Setting& setting, std::array<int, 2> pair, Anchor anchor);
/// How what is at rest moves in the image between the frames of a pair (piv::CameraStep).
std::array<double, 6> motion_at_rest(const Setting& setting, std::array<int, 2> pair);

/// Pixels from node to node at the image's centre.
double node_spacing_px(const Setting& setting);

/// Vectors of one pair brought to the world: each end of a vector goes through the camera as it was in its frame. The
/// uncertainty of where the camera was is added.
VectorField world_vectors(const piv::PixelVectors& pixels, const piv::NodeLattice& lattice, const Setting& setting,
                          std::array<int, 2> pair);

/// The numerical particles at the first frame: none under the mask.
ParticleSet seed_particles(const Case& c, const Setting& setting);

}  // namespace pivnp::app
