// Displacement between two images, by image correlation.
//   correlate FIRST SECOND [WINDOW_PX]
// Prints a line a node: column, row, displacement (right, down), its standard deviation (right), all in px, and the status.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "pivnp/image/files/image_file.hpp"
#include "pivnp/piv/piv.hpp"

int main(int argc, char** argv) try {
  if (argc < 3 || argc > 4) {
    std::fprintf(stderr, "usage: correlate FIRST SECOND [WINDOW_PX]\n");
    return 2;
  }
  const pivnp::Image first = pivnp::image::read_image_file(argv[1], "FIRST");
  const pivnp::Image second = pivnp::image::read_image_file(argv[2], "SECOND");
  if (first.width() != second.width() || first.height() != second.height()) {
    std::fprintf(stderr, "error: the images differ in size\n");
    return 2;
  }

  pivnp::piv::PivOptions options;
  if (argc == 4) options.window_px = std::atoi(argv[3]);

  // Nodes half a window apart, and half a window from the edges; node (i, j) has j upward, pixels have rows downward.
  const int step = options.window_px / 2;
  pivnp::piv::NodeLattice nodes;
  nodes.nx = (first.width() - options.window_px) / step + 1;
  nodes.ny = (first.height() - options.window_px) / step + 1;
  for (int j = 0; j < nodes.ny; ++j)
    for (int i = 0; i < nodes.nx; ++i)
      nodes.pixel.push_back({float(step + i * step), float(step + (nodes.ny - 1 - j) * step)});

  pivnp::piv::PairCorrelator correlator(options, nodes, first.width(), first.height(), 1);
  const pivnp::piv::PixelVectors found = correlator.correlate(first.view(), second.view(), {});

  for (std::size_t k = 0; k < nodes.pixel.size(); ++k)
    std::printf("%6.0f %6.0f %9.4f %9.4f %8.4f %d\n", double(nodes.pixel[k][0]), double(nodes.pixel[k][1]),
                double(found.displacement[k][0]), double(found.displacement[k][1]), std::sqrt(double(found.cov[k][0])),
                int(found.status[k]));
} catch (const std::exception& error) {
  std::fprintf(stderr, "error: %s\n", error.what());
  return 1;
}
