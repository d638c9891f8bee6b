#include <algorithm>
#include <cmath>
#include <cstring>

#include "apps/study/stress/piv/piv_maps.hpp"
#include "apps/study/stress/piv/vectors.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/image/masks/mask.hpp"
#include "pivnp/image/synthetic/synthetic_pair.hpp"

namespace pivnp::app {

namespace {

constexpr int width_px = 512, height_px = 256, node_step_px = 16, columns_rim_px = 64;
constexpr double edge_row = 128, depth_px = 64, slip_px = 2;  // the material lies below the row

enum class Edge { surface, wall, masked_wall };

// The material slides by slip_px; beside a wall faster with the distance, under a surface faster towards it; along the rows alone, so
// that the edge stays where it is.
image::Motion motion_beside(Edge edge, double slope) {
  return [=](const Vec2& p) -> Vec2 {
    const double depth = p.y() - edge_row;
    if (depth < 0) return {0, 0};
    return {slip_px + slope * (edge != Edge::surface ? std::min(depth, depth_px) : std::max(depth_px - depth, 0.0)), 0};
  };
}

// Nodes 16 px apart, a row of them `distance` below the edge; `scored` are those of this row.
piv::NodeLattice nodes_beside(double distance, std::vector<std::uint8_t>& scored) {
  piv::NodeLattice nodes;
  nodes.nx = (width_px - 2 * columns_rim_px) / node_step_px + 1;
  double bottom = edge_row + distance;
  while (bottom + node_step_px < height_px - 24) bottom += node_step_px;
  for (double row = bottom; row > 24; row -= node_step_px, ++nodes.ny)
    for (int i = 0; i < nodes.nx; ++i) {
      nodes.pixel.push_back({float(columns_rim_px + i * node_step_px), float(row)});
      scored.push_back(std::abs(row - edge_row - distance) < 0.5);
    }
  return nodes;
}

Survival beside(Edge edge, const piv::PivOptions& options, double distance, double slope, int seeds, std::size_t cell, const Progress& progress) {
  std::vector<std::uint8_t> scored;
  const piv::NodeLattice nodes = nodes_beside(distance, scored);
  image::Mask mask(width_px, height_px);
  for (int r = 0; r < height_px; ++r) std::fill_n(mask.row(r), width_px, std::uint8_t(r >= int(edge_row)));
  Survival sum;
  for (int seed = 1; seed <= seeds; ++seed) {
    if (progress.stop_requested()) throw Interrupted();
    image::TextureOptions texture;
    texture.noise = 0.01;
    texture.seed = int(1000 * std::size_t(seed) + cell);
    image::SyntheticPair pair = image::synthetic_pair(motion_beside(edge, slope), width_px, height_px, texture);
    if (edge == Edge::surface) {  // above it there is an even background, with noise
      texture.density_per_px = 1e-9;
      const image::SyntheticPair air = image::synthetic_pair(image::uniform(0, 0), width_px, height_px, texture);
      for (int r = 0; r < int(edge_row); ++r) {
        std::memcpy(pair.first.row<std::byte>(r), air.first.view().row<std::byte>(r), std::size_t(pair.first.stride()));
        std::memcpy(pair.second.row<std::byte>(r), air.second.view().row<std::byte>(r), std::size_t(pair.second.stride()));
      }
    }
    sum.add(measured(options, nodes, {pair.first, pair.second, [&](const Vec2& place, Anchor anchor) { return pair.truth(place, anchor); }, edge == Edge::masked_wall ? mask.view() : MaskView{}}, scored));
  }
  return sum;
}

}  // namespace

std::vector<MapPlan> piv_edge_maps(const piv::PivOptions& options, int seeds) {
  std::vector<MapPlan> all;
  for (const Edge edge : {Edge::surface, Edge::wall, Edge::masked_wall}) {
    MapPlan plan;
    SurvivalMap& map = plan.map;
    const bool wall = edge != Edge::surface, masked = edge == Edge::masked_wall;
    map.name = masked ? "piv_masked_wall_shear" : wall ? "piv_wall_shear" : "piv_surface_shear";
    map.title = masked ? "Distance to a wall under a mask, and shear" : wall ? "Distance to a wall, and shear" : "Distance to a free surface, and shear";
    map.made_of = std::string("Drawn texture that slides by 2 px ") +
                  (wall ? std::string("along a wall with a texture of its own") + (masked ? " that is masked" : "") + ", and faster away from it" : "under air without texture, and faster towards its surface") + ", " +
                  std::to_string(2 * seeds) + " pairs of 25 vectors a combination. Right: less than " + number(vector_bounds.right) + " px off; wrong: more than " +
                  number(vector_bounds.wrong) + " px.";
    map.x = {wall ? "distance to the wall (px)" : "distance to the surface (px)", {1, 2, 4, 8, 12, 16, 24, 32}};
    map.y = {"displacement gradient", {0, 0.05, 0.1, 0.2, 0.3}};
    map.theory = {{"half a window", {{options.window_px / 2.0, 0}, {options.window_px / 2.0, 0.3}}}};
    plan.settings = words_of(options);
    plan.result = [=, x = map.x.levels, y = map.y.levels](std::size_t i, std::size_t j, Progress& progress) {
      return beside(edge, options, x[i], y[j], 2 * seeds, 37 * i + j, progress);
    };
    all.push_back(std::move(plan));
  }
  return all;
}

}  // namespace pivnp::app
