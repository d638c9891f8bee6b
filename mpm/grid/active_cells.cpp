#include "mpm/grid/active_cells.hpp"

#include <algorithm>

namespace pivnp::mpm {

namespace {

constexpr int band_rows = 4;  // more than a stencil has, less one: bands of one parity share no node

// The runs of neighbouring occupied cells that keep(s) wants, in bands.
template <class Keep>
Bands bands_of(const CellList& cells, int nx, Keep&& keep) {
  struct Found {
    std::vector<Range> runs;
    std::size_t before, size = 0;  // cells
  };
  std::vector<Found> found[2];
  Bands bands;
  Found* band = nullptr;
  std::int32_t beyond = -1;  // the band's first cell that is not
  bool open = false;
  for (std::size_t s = 0; s < cells.size(); ++s) {
    if (!keep(s)) {
      open = false;
      continue;
    }
    if (cells.index[s] >= beyond) {
      const int place = cells.index[s] / nx / band_rows;
      beyond = (place + 1) * band_rows * nx;
      band = &found[place % 2].emplace_back(Found{{}, bands.cells});
      open = false;
    }
    if (!open) band->runs.push_back({s, s});
    band->runs.back().end = s + 1;
    open = true;
    ++band->size;
    ++bands.cells;
  }
  for (int parity = 0; parity < 2; ++parity)
    for (const Found& f : found[parity]) {
      bands.parity[parity].push_back({{bands.runs.size(), bands.runs.size() + f.runs.size()}, {}, {}, f.before + f.size / 2});
      bands.runs.insert(bands.runs.end(), f.runs.begin(), f.runs.end());
    }
  return bands;
}

// The even bands come first: they find the rows fresh that they share with the odd ones, which finish them.
void share_nodes(Bands& bands, const CellList& cells, const GridGeometry& g, const std::vector<std::uint32_t>& nodes) {
  const auto place_of = [&](const Band& band) { return cells.index[bands.runs[band.runs.begin].begin] / g.grid.nx / band_rows; };
  std::vector<std::uint8_t> there(std::size_t(g.grid.ny / band_rows + 3), 0);  // of the bands, from the one before the first
  for (const auto& of_parity : bands.parity)
    for (const Band& band : of_parity) there[std::size_t(place_of(band) + 1)] = 1;
  const auto nodes_from = [&](int row) {
    return std::size_t(std::lower_bound(nodes.begin(), nodes.end(), std::uint32_t(row) * std::uint32_t(g.grid.nx)) - nodes.begin());
  };
  const int shared = g.width - 1;  // rows of nodes
  for (int parity = 0; parity < 2; ++parity)
    for (Band& band : bands.parity[parity]) {
      const int place = place_of(band), low = place * band_rows, high = low + band_rows;
      const bool below = there[std::size_t(place)], above = there[std::size_t(place + 2)];
      const Range inner = {nodes_from(below ? low + shared : low), nodes_from(above ? high : high + shared)};
      const Range all = {nodes_from(low), nodes_from(high + shared)};
      band.fresh = parity == 0 ? all : inner;
      band.finished = parity == 0 ? inner : all;
    }
}

std::vector<Range> pieces_of(const Bands& awake) {
  constexpr std::size_t piece = 128;  // cells: what a piece touches stays in the second cache
  std::vector<Range> pieces, runs = awake.runs;
  std::sort(runs.begin(), runs.end(), [](const Range& a, const Range& b) { return a.begin < b.begin; });
  for (std::size_t r = 0; r < runs.size();) {
    Range run = runs[r++];
    while (r < runs.size() && runs[r].begin == run.end) run.end = runs[r++].end;
    for (std::size_t s = run.begin; s < run.end; s += piece) pieces.push_back({s, std::min(run.end, s + piece)});
  }
  return pieces;
}

}  // namespace

void ActiveCells::rebuild(const CellList& cells, const GridGeometry& g, const SleepingBlocks& blocks) {
  constexpr int margin = 5;  // cells, the rim's width: what its inner nodes lack does not reach the awake cells
  const int nx = g.grid.nx;
  resting.clear();
  border.clear();
  partial.clear();
  awake = bands_of(cells, nx, [&](std::size_t s) { return !blocks.sleeps(cells.index[s]); });
  if (!blocks.any()) {
    mapped = awake;
    list_nodes(CellBits(nx, cells.index, [](auto) { return true; }), g.width);
  } else {
    const CellBits stepped(nx, cells.index, [&](std::int32_t c) { return !blocks.sleeps(c); });
    const CellBits near = stepped.grown(margin, margin), met = stepped.grown(0, g.width - 1);
    mapped = bands_of(cells, nx, [&](std::size_t s) { return near.has(cells.index[s]); });
    list_nodes(CellBits(nx, cells.index, [&](std::int32_t c) { return near.has(c); }), g.width);
    CellBits(nx, cells.index, [&](std::int32_t c) { return near.has(c) && blocks.sleeps(c); })
        .grown(0, g.width - 1)
        .for_all([&](std::size_t n) {
          resting.push_back(std::uint32_t(n));
          if (met.has(std::int32_t(n))) border.push_back(std::uint32_t(n));
        });
    const CellBits beyond = CellBits(nx, cells.index, [&](std::int32_t c) { return !near.has(c); }).grown(0, g.width - 1);
    for (const std::uint32_t n : nodes)
      if (beyond.has(std::int32_t(n))) partial.push_back(n);
  }
  share_nodes(awake, cells, g, nodes);
  share_nodes(mapped, cells, g, nodes);
  pieces = pieces_of(awake);
  flowing = blocks.any() ? pieces_of(mapped) : pieces;
}

void ActiveCells::list_nodes(const CellBits& cells, int width) {
  nodes_before_.swap(nodes);
  nodes.clear();
  left.clear();
  cells.grown(0, width - 1).for_all([&](std::size_t n) { nodes.push_back(std::uint32_t(n)); });
  auto next = nodes.begin();
  for (const std::uint32_t n : nodes_before_) {
    while (next != nodes.end() && *next < n) ++next;
    if (next == nodes.end() || *next != n) left.push_back(n);
  }
}

}  // namespace pivnp::mpm
