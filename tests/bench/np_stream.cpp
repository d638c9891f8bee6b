#include "tests/bench/np_stream.hpp"

#include <fcntl.h>
#include <omp.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "pivnp/core/particles/seeding.hpp"
#include "pivnp/io/records/record.hpp"
#include "pivnp/np/analytic.hpp"
#include "pivnp/np/tracker.hpp"

namespace {

using namespace pivnp;
namespace fs = std::filesystem;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double peak_mebibytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return double(usage.ru_maxrss) / 1024;
}

// Seconds for `bytes` in files of at most 256 MiB, each fsynced: what a segment is to the disk, without its content.
double plain_write(const fs::path& directory, double bytes) {
  std::vector<char> block(1 << 20);
  for (std::size_t k = 0; k < block.size(); ++k) block[k] = char(k * 2654435761U >> 13);
  const double start = now();
  for (int n = 0; bytes > 0; ++n) {
    const fs::path path = directory / ("plain" + std::to_string(n));
    const int file = ::open(path.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0644);
    if (file < 0) return std::nan("");
    for (int k = 0; k < 256 && bytes > 0; ++k, bytes -= double(block.size()))
      if (::write(file, block.data(), block.size()) != ssize_t(block.size())) bytes = std::nan("");
    if (::fsync(file) != 0) bytes = std::nan("");
    ::close(file);
  }
  const double took = std::isnan(bytes) ? bytes : now() - start;
  for (const auto& entry : fs::directory_iterator(directory))
    if (entry.path().filename().string().starts_with("plain")) fs::remove(entry.path());
  return took;
}

double size_of(const fs::path& directory) {
  double bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(directory))
    if (entry.is_regular_file()) bytes += double(entry.file_size());
  return bytes;
}

}  // namespace

int stream(const fs::path& directory, int side, int frames) {
  const fs::path own = directory / "np_bench_stream";
  fs::create_directories(own);
  constexpr int margin = 2;
  const Grid grid{{0, 0}, {1, 1}, side + 2 * margin + 1, side + 2 * margin + 1};
  const double lo = margin, hi = margin + side, mib = 1 << 20;
  const ParticleSet particles = seed(grid, {{"all", Polygon({{lo, lo}, {hi, lo}, {hi, hi}, {lo, hi}}, "bench")}}, 4,
                                     SeedPattern::even, 0, "bench");
  const np::ReversingVortex motion({lo + side / 2.0, lo + side / 2.0}, side / 3.0, 3.5 / side, 2);
  std::array<VectorField, 2> pairs;  // there and back
  for (int k = 0; k < 2; ++k) {
    np::NodalIncrements d = np::sample_increments(motion, grid, Anchor::central, k, k + 1);
    d.cov.assign(grid.node_count(), {1e-6f, 1e-6f, 0});
    pairs[std::size_t(k)] = np::vector_field(d, {k, k + 1});
  }
  np::Tracker tracker({}, particles, 0);
  const double frame_bytes = double(particles.size()) * (9 * sizeof(float) + 1);
  const double before = peak_mebibytes(), all = frame_bytes * (frames + 1) / mib;

  double track = 0, first = 0, wall = 0, parts = 0, pack = 0, record = 0, grown = 0;
  {
    io::RecordHead head;
    head.grid = grid;
    io::RecordWriter writer(own / "run", head, false, omp_get_max_threads());
    first = plain_write(own, all * mib);
    const double start = now();
    writer.begin_motion("np", particles);
    writer.add_frame("np", tracker.frame());
    for (int k = 0; k < frames; ++k) {
      const double step = now();
      tracker.step(pairs[std::size_t(k % 2)], k + 1);
      track += now() - step;
      writer.add_frame("np", tracker.frame());
      if (writer.segment_full("motion/np")) writer.close_segment("motion/np", {});
    }
    writer.end_stage("motion/np", &tracker.particles());
    wall = now() - start;
    grown = peak_mebibytes() - before;
    parts = size_of(own / "run") / mib;
    const double again = plain_write(own, all * mib);
    first = std::min(first, again);  // the disk's better moment
    const double packing = now();
    writer.finish();
    pack = now() - packing;
    record = double(fs::file_size(own / "run" / "record.h5")) / mib;
  }
  const double peak = peak_mebibytes();
  fs::remove_all(own);
  const double in_frames = grown * mib / frame_bytes;
  std::printf("%zu particles, %d frames with F and covariance, written while tracked (%s)\n", particles.size(), frames,
              directory.c_str());
  std::printf("  bytes a particle and frame  %.2f in segments, %.2f in the record (shuffled, deflated)\n",
              parts * mib / double(particles.size()) / (frames + 1), record * mib / double(particles.size()) / (frames + 1));
  std::printf("  the disk's own speed        %.0f MiB/s (plain write and fsync of as many bytes)\n", all / first);
  std::printf("  tracked and written         %.0f MiB/s, %.1f s, of which tracking %.1f s: %.2f of the disk's own\n",
              all / wall, wall, track, first / wall);
  std::printf("  packed into record.h5       %.1f s more: all of it %.2f of the disk's own\n", pack, first / (wall + pack));
  std::printf("  memory                      %.0f MiB more than before the first frame: %.1f frames; peak %.0f MiB\n",
              grown, in_frames, peak);
  if (!(first / wall >= 0.5) || !(in_frames < 8)) {
    std::printf("missed: half the disk's own speed, and memory of a few frames\n");
    return 1;
  }
  return 0;
}
