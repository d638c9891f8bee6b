#include "mpm/grid/grid_state.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pivnp::mpm {

namespace {

constexpr double round_off = 1e-9;  // of a cell, as in pivnp::locate

// At least one row stays empty between two sheets, and each begins a new band of rows.
int rows_of_sheet(int ny, int sheets) {
  constexpr int multiple = 8;
  return sheets == 1 ? ny : (ny + multiple) / multiple * multiple;
}

}  // namespace

GridState::GridState(const Grid& d, ShapeKind kind, int n_sheets, bool updated)
    : shape(kind),
      width(kind == ShapeKind::bilinear ? 2 : 3),
      stencil(width * width),
      domain(d),
      sheet(width == 3 ? padded(d, 1) : d),
      sheets(n_sheets),
      sheet_rows(rows_of_sheet(sheet.ny, n_sheets)),
      grid{sheet.origin, sheet.spacing, sheet.nx, n_sheets == 1 ? sheet.ny : n_sheets * sheet_rows},
      per_hx(1 / d.spacing.x()),
      per_hy(1 / d.spacing.y()),
      by_updated(updated),
      node(grid.node_count()),
      averages(grid),
      fold(grid.node_count(), fold_none),
      straining_(grid.node_count()),
      row_begin_(std::size_t(grid.ny) + 1, 0) {}

void GridState::stencil_nodes(std::size_t slot, std::size_t* out) const {
  const auto first = std::size_t(slot_cell[slot]);
  for (int b = 0; b < width; ++b)
    for (int a = 0; a < width; ++a) *out++ = first + std::size_t(b * grid.nx + a);
}

bool GridState::find(double x, double y, std::int32_t& cell, double& xi, double& eta, int on_sheet) const {
  double s = (x - domain.origin.x()) * per_hx, t = (y - domain.origin.y()) * per_hy;
  if (!(s >= -round_off && t >= -round_off && s <= domain.nx - 1 + round_off && t <= domain.ny - 1 + round_off))
    return false;
  s = std::clamp(s, 0.0, double(domain.nx - 1));
  t = std::clamp(t, 0.0, double(domain.ny - 1));
  // With the ring, node i - 1 of the domain, the first of three, is node i of the grid.
  const int i = width == 2 ? std::min(int(s), domain.nx - 2) : int(s + 0.5);
  const int j = width == 2 ? std::min(int(t), domain.ny - 2) : int(t + 0.5);
  xi = s - i;
  eta = t - j;
  cell = std::int32_t(grid.node(i, j + on_sheet * sheet_rows));
  return true;
}

Vec2 GridState::natural(const Particles& p, std::size_t k) const {
  const int i = p.cell[k] % grid.nx, j = p.cell[k] / grid.nx % sheet_rows, origin = width - 2;
  return {(p.x[k] - grid.origin.x()) * per_hx - (i + origin), (p.y[k] - grid.origin.y()) * per_hy - (j + origin)};
}

std::uint8_t GridState::fold_of(std::int32_t cell) const {
  return width == 2 ? std::uint8_t(fold_none) : fold[std::size_t(cell + grid.nx + 1)];
}

std::uint8_t GridState::marks_of(std::int32_t cell, int row) const {
  const int i = cell - row * grid.nx, j = sheets == 1 ? row : row % sheet_rows;
  const bool edge = width == 3 && (i == 0 || j == 0 || i == grid.nx - 3 || j == sheet.ny - 3);
  return std::uint8_t(fold_of(cell) | (edge ? at_edge : 0));
}

void GridState::set_folds(const std::vector<std::uint8_t>& folds) {
  fold = folds;
  for (std::size_t s = 0; s < slots(); ++s) slot_marks[s] = marks_of(slot_cell[s], slot_cell[s] / grid.nx);
}

void GridState::rebuild(const Particles& p) {
  located = false;
  strain_together();
  std::vector<std::uint32_t> count(grid.node_count(), 0);
  std::int32_t first = std::numeric_limits<std::int32_t>::max(), last = -1;
  for (const std::int32_t c : p.cell)
    if (c != Particles::ended) {
      first = std::min(first, c);
      last = std::max(last, c);
      ++count[std::size_t(c)];
    }
  std::vector<std::int32_t> cells;
  cells.reserve(slot_cell.size() + 16);
  slot_begin.clear();
  std::uint32_t begin = 0;
  for (std::int32_t c = first; c <= last; ++c)
    if (count[std::size_t(c)] > 0) {
      cells.push_back(c);
      slot_begin.push_back(begin);
      begin += count[std::size_t(c)];
      count[std::size_t(c)] = slot_begin.back();  // from here on: where the cell's next point goes
    }
  slot_begin.push_back(begin);
  order.resize(begin);
  for (std::uint32_t k = 0; k < p.cell.size(); ++k)
    if (p.cell[k] != Particles::ended) order[count[std::size_t(p.cell[k])]++] = k;
  if (cells == slot_cell) return;
  slot_cell.swap(cells);
  take_cells();
}

void GridState::follow(const Particles& p, const std::vector<Move>& moves) {
  arrivals.clear();
  for (const Move& move : moves)
    if (p.cell[order[move.place]] != Particles::ended) arrivals.emplace_back(p.cell[order[move.place]], order[move.place]);
  std::sort(arrivals.begin(), arrivals.end());

  strain_together();
  // What stands in the places of the slots from `first` on is put together beside them, until it fits again.
  std::vector<std::uint32_t>& next_order = scratch;
  next_order.clear();
  next_begin_.clear();
  next_cell_.clear();
  std::size_t a = 0, m = 0, first = 0;
  bool changed = false;  // the cells
  const auto put_back = [&](std::size_t end) {
    const auto at = std::ptrdiff_t(first);
    std::copy(next_order.begin(), next_order.end(), order.begin() + std::ptrdiff_t(slot_begin[first]));
    std::copy(next_begin_.begin(), next_begin_.end(), slot_begin.begin() + at);
    changed = changed || !std::equal(next_cell_.begin(), next_cell_.end(), slot_cell.begin() + at);
    std::copy(next_cell_.begin(), next_cell_.end(), slot_cell.begin() + at);
    next_order.clear();
    next_begin_.clear();
    next_cell_.clear();
    first = end;
  };
  const auto fits = [&](std::size_t end) {
    return next_cell_.size() == end - first && next_order.size() == slot_begin[end] - slot_begin[first];
  };
  // The first slot that a point leaves or enters, or before whose cell one enters a new one. It is never among those that
  // have been put back: that their rows may begin elsewhere now does not matter to first_slot_from().
  const auto next_changed = [&] {
    return std::min(m < moves.size() ? first_slot_from(moves[m].from) : slots(),
                    a < arrivals.size() ? first_slot_from(arrivals[a].first) : slots());
  };
  const auto open = [&](std::int32_t cell) {
    next_cell_.push_back(cell);
    next_begin_.push_back(std::uint32_t(slot_begin[first] + next_order.size()));
  };
  constexpr std::int32_t none = std::numeric_limits<std::int32_t>::max();
  const auto take_new_cells = [&](std::int32_t before) {
    while (a < arrivals.size() && arrivals[a].first < before) {
      if (next_cell_.empty() || next_cell_.back() != arrivals[a].first) open(arrivals[a].first);
      next_order.push_back(arrivals[a++].second);
    }
  };
  for (std::size_t s = 0; s < slots(); ++s) {
    const std::size_t next = next_changed();
    if (next > s) {  // as they were
      if (fits(s)) {
        put_back(next);
      } else {
        const auto from = std::ptrdiff_t(s), to = std::ptrdiff_t(next);
        const auto shift = std::uint32_t(slot_begin[first] + next_order.size() - slot_begin[s]);  // may be negative: wraps
        next_order.insert(next_order.end(), order.begin() + std::ptrdiff_t(slot_begin[s]),
                          order.begin() + std::ptrdiff_t(slot_begin[next]));
        next_cell_.insert(next_cell_.end(), slot_cell.begin() + from, slot_cell.begin() + to);
        const std::size_t before = next_begin_.size();
        next_begin_.resize(before + next - s);
        for (std::size_t k = s; k < next; ++k) next_begin_[before + k - s] = slot_begin[k] + shift;
      }
      s = next;
      if (s == slots()) break;
    }
    const std::int32_t c = slot_cell[s];
    take_new_cells(c);
    open(c);
    for (std::uint32_t q = slot_begin[s]; q < slot_begin[s + 1]; ++q) {
      if (m < moves.size() && moves[m].place == q) {
        ++m;
        continue;
      }
      while (a < arrivals.size() && arrivals[a].first == c && arrivals[a].second < order[q])
        next_order.push_back(arrivals[a++].second);
      next_order.push_back(order[q]);
    }
    while (a < arrivals.size() && arrivals[a].first == c) next_order.push_back(arrivals[a++].second);
    if (next_begin_.back() == slot_begin[first] + next_order.size()) {  // all have left
      next_cell_.pop_back();
      next_begin_.pop_back();
    }
  }
  take_new_cells(none);
  if (fits(slots())) {
    put_back(slots());
  } else {
    changed = changed || !std::equal(next_cell_.begin(), next_cell_.end(), slot_cell.begin() + std::ptrdiff_t(first), slot_cell.end());
    const std::size_t begin = slot_begin[first];
    order.resize(begin);
    order.insert(order.end(), next_order.begin(), next_order.end());
    slot_cell.resize(first);
    slot_cell.insert(slot_cell.end(), next_cell_.begin(), next_cell_.end());
    slot_begin.resize(first);
    slot_begin.insert(slot_begin.end(), next_begin_.begin(), next_begin_.end());
    slot_begin.push_back(std::uint32_t(order.size()));
  }
  if (changed) take_cells();
}

// What follows from the slots' cells.
void GridState::take_cells() {
  slot_marks.resize(slots());
  std::size_t row = 0;
  std::int32_t row_end = 0;  // first cell of `row`, which is the next to begin
  for (std::size_t s = 0; s < slots(); ++s) {
    for (; slot_cell[s] >= row_end; row_end += grid.nx) row_begin_[row++] = std::uint32_t(s);
    slot_marks[s] = marks_of(slot_cell[s], int(row) - 1);
  }
  std::fill(row_begin_.begin() + std::ptrdiff_t(row), row_begin_.end(), std::uint32_t(slots()));
  rebuild_lists();
}

// A row's cells mostly lie side by side.
std::size_t GridState::first_slot_from(std::int32_t cell) const {
  const auto row = std::size_t(cell / grid.nx);
  const std::uint32_t begin = row_begin_[row], end = row_begin_[row + 1];
  if (begin == end || cell <= slot_cell[begin]) return begin;
  const std::uint32_t guess = begin + std::uint32_t(cell - slot_cell[begin]);
  if (guess < end && slot_cell[guess] == cell) return guess;
  return std::size_t(std::lower_bound(slot_cell.begin() + begin, slot_cell.begin() + end, cell) - slot_cell.begin());
}

std::int32_t GridState::slot_of(std::int32_t cell) const {
  const std::size_t s = first_slot_from(cell);
  return s < slots() && slot_cell[s] == cell ? std::int32_t(s) : -1;
}

void GridState::set_asleep(const std::vector<std::uint8_t>& blocks) {
  asleep_ = blocks;
  rebuild_lists();
}

constexpr int band_rows = 4;  // more than a stencil has, less one: bands of one parity share no node

// The runs of neighbouring slots that keep(slot) wants, in bands.
template <class Keep>
Bands GridState::bands_of(Keep&& keep) const {
  struct Found {
    std::vector<SlotRange> runs;
    std::size_t before, size = 0;  // slots
  };
  std::vector<Found> found[2];
  Bands bands;
  Found* band = nullptr;
  std::int32_t beyond = -1;  // the band's first cell that is not
  bool open = false;
  for (std::size_t s = 0; s < slots(); ++s) {
    if (!keep(s)) {
      open = false;
      continue;
    }
    if (slot_cell[s] >= beyond) {
      const int place = slot_cell[s] / grid.nx / band_rows;
      beyond = (place + 1) * band_rows * grid.nx;
      band = &found[place % 2].emplace_back(Found{{}, bands.slots});
      open = false;
    }
    if (!open) band->runs.push_back({s, s});
    band->runs.back().end = s + 1;
    open = true;
    ++band->size;
    ++bands.slots;
  }
  for (int parity = 0; parity < 2; ++parity)
    for (const Found& f : found[parity]) {
      bands.parity[parity].push_back({{bands.runs.size(), bands.runs.size() + f.runs.size()}, {}, {}, f.before + f.size / 2});
      bands.runs.insert(bands.runs.end(), f.runs.begin(), f.runs.end());
    }
  return bands;
}

// The even bands come first: they find the rows fresh that they share with the odd ones, which finish them.
void GridState::share_nodes(Bands& bands) const {
  const auto place_of = [&](const Band& band) { return slot_cell[bands.runs[band.runs.begin].begin] / grid.nx / band_rows; };
  std::vector<std::uint8_t> there(std::size_t(grid.ny / band_rows + 3), 0);  // of the bands, from the one before the first
  for (const auto& of_parity : bands.parity)
    for (const Band& band : of_parity) there[std::size_t(place_of(band) + 1)] = 1;
  const auto nodes_from = [&](int row) {
    return std::size_t(std::lower_bound(nodes.begin(), nodes.end(), std::uint32_t(row) * std::uint32_t(grid.nx)) - nodes.begin());
  };
  const int shared = width - 1;  // rows of nodes
  for (int parity = 0; parity < 2; ++parity)
    for (Band& band : bands.parity[parity]) {
      const int place = place_of(band), low = place * band_rows, high = low + band_rows;
      const bool below = there[std::size_t(place)], above = there[std::size_t(place + 2)];
      const SlotRange inner = {nodes_from(below ? low + shared : low), nodes_from(above ? high : high + shared)};
      const SlotRange all = {nodes_from(low), nodes_from(high + shared)};
      band.fresh = parity == 0 ? all : inner;
      band.finished = parity == 0 ? inner : all;
    }
}

void GridState::rebuild_lists() {
  constexpr int margin = 5;  // cells, the rim's width: what its inner nodes lack does not reach the awake cells
  const auto all = [](auto) { return true; };
  resting.clear();
  border.clear();
  awake = bands_of([&](std::size_t s) { return !sleeps(slot_cell[s]); });
  if (std::none_of(asleep_.begin(), asleep_.end(), [](std::uint8_t a) { return a != 0; })) {
    mapped = awake;
    rebuild_nodes(CellBits(grid.nx, slot_cell, all));
  } else {
    const CellBits stepped(grid.nx, slot_cell, [&](std::int32_t c) { return !sleeps(c); });
    const CellBits near = stepped.grown(margin, margin), met = stepped.grown(0, width - 1);
    mapped = bands_of([&](std::size_t s) { return near.has(slot_cell[s]); });
    rebuild_nodes(CellBits(grid.nx, slot_cell, [&](std::int32_t c) { return near.has(c); }));
    CellBits(grid.nx, slot_cell, [&](std::int32_t c) { return near.has(c) && sleeps(c); })
        .grown(0, width - 1)
        .for_all([&](std::size_t n) {
          resting.push_back(std::uint32_t(n));
          if (met.has(std::int32_t(n))) border.push_back(std::uint32_t(n));
        });
  }
  share_nodes(awake);
  share_nodes(mapped);
  rebuild_pieces();
}

void GridState::rebuild_pieces() {
  constexpr std::size_t piece = 128;  // slots: what a piece touches stays in the second cache
  pieces.clear();
  std::vector<SlotRange> runs = awake.runs;
  std::sort(runs.begin(), runs.end(), [](const SlotRange& a, const SlotRange& b) { return a.begin < b.begin; });
  for (std::size_t r = 0; r < runs.size();) {
    SlotRange run = runs[r++];
    while (r < runs.size() && runs[r].begin == run.end) run.end = runs[r++].end;
    for (std::size_t s = run.begin; s < run.end; s += piece) pieces.push_back({s, std::min(run.end, s + piece)});
  }
}

void GridState::rebuild_nodes(const CellBits& cells) {
  nodes_before_.swap(nodes);
  nodes.clear();
  cells.grown(0, width - 1).for_all([&](std::size_t n) { nodes.push_back(std::uint32_t(n)); });
  auto next = nodes.begin();
  for (const std::uint32_t n : nodes_before_) {
    while (next != nodes.end() && *next < n) ++next;
    if (next != nodes.end() && *next == n) continue;
    if (strains_apart(n)) straining_[n] = {};
    node[n] = Node{};
    if (averages.used) averages.forget(n);
  }
}

CellView GridState::view() {
  return {order.data(), slot_begin.data(), slot_cell.data(), slot_marks.data(), order.size(), node.data(),
          by_updated ? &node.data()->nx : &straining_.data()->x,
          std::ptrdiff_t((by_updated ? sizeof(Node) : sizeof(NodeVelocity)) / sizeof(double)), &straining_.data()->x, averages.view(), grid.nx, sheet.ny, sheet_rows, width - 2,
          grid.spacing.x(), grid.spacing.y(), per_hx, per_hy, grid.origin.x(), grid.origin.y()};
}

}  // namespace pivnp::mpm
