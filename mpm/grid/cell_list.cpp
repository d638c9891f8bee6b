#include "mpm/grid/cell_list.hpp"

#include <algorithm>
#include <limits>

namespace pivnp::mpm {

CellList::CellList(const Grid& grid) : nx_(grid.nx), ny_(grid.ny), row_begin_(std::size_t(grid.ny) + 1, 0) {}

bool CellList::rebuild(const Particles& p) {
  std::vector<std::uint32_t> count(std::size_t(nx_) * std::size_t(ny_), 0);
  std::int32_t first = std::numeric_limits<std::int32_t>::max(), last = -1;
  for (const std::int32_t c : p.cell)
    if (c != Particles::ended) {
      first = std::min(first, c);
      last = std::max(last, c);
      ++count[std::size_t(c)];
    }
  std::vector<std::int32_t> cells;
  cells.reserve(index.size() + 16);
  begin.clear();
  std::uint32_t at = 0;
  for (std::int32_t c = first; c <= last; ++c)
    if (count[std::size_t(c)] > 0) {
      cells.push_back(c);
      begin.push_back(at);
      at += count[std::size_t(c)];
      count[std::size_t(c)] = begin.back();  // from here on: where the cell's next point goes
    }
  begin.push_back(at);
  order.resize(at);
  for (std::uint32_t k = 0; k < p.cell.size(); ++k)
    if (p.cell[k] != Particles::ended) order[count[std::size_t(p.cell[k])]++] = k;
  if (cells == index) return false;
  index.swap(cells);
  index_rows();
  return true;
}

bool CellList::follow(const Particles& p, const std::vector<Move>& moves) {
  arrivals.clear();
  for (const Move& move : moves)
    if (p.cell[order[move.place]] != Particles::ended) arrivals.emplace_back(p.cell[order[move.place]], order[move.place]);
  std::sort(arrivals.begin(), arrivals.end());

  // What stands in the places of the cells from `first` on is put together beside them, until it fits again.
  next_order_.clear();
  next_begin_.clear();
  next_index_.clear();
  std::size_t a = 0, m = 0, first = 0;
  bool changed = false;  // the cells
  const auto put_back = [&](std::size_t end) {
    const auto at = std::ptrdiff_t(first);
    std::copy(next_order_.begin(), next_order_.end(), order.begin() + std::ptrdiff_t(begin[first]));
    std::copy(next_begin_.begin(), next_begin_.end(), begin.begin() + at);
    changed = changed || !std::equal(next_index_.begin(), next_index_.end(), index.begin() + at);
    std::copy(next_index_.begin(), next_index_.end(), index.begin() + at);
    next_order_.clear();
    next_begin_.clear();
    next_index_.clear();
    first = end;
  };
  const auto fits = [&](std::size_t end) {
    return next_index_.size() == end - first && next_order_.size() == begin[end] - begin[first];
  };
  // The first cell that a point leaves or enters, or before which one enters a new cell. It is never among those that
  // have been put back: that their rows may begin elsewhere now does not matter to first_from().
  const auto next_changed = [&] {
    return std::min(m < moves.size() ? first_from(moves[m].from) : size(),
                    a < arrivals.size() ? first_from(arrivals[a].first) : size());
  };
  const auto open = [&](std::int32_t cell) {
    next_index_.push_back(cell);
    next_begin_.push_back(std::uint32_t(begin[first] + next_order_.size()));
  };
  constexpr std::int32_t none = std::numeric_limits<std::int32_t>::max();
  const auto take_new_cells = [&](std::int32_t before) {
    while (a < arrivals.size() && arrivals[a].first < before) {
      if (next_index_.empty() || next_index_.back() != arrivals[a].first) open(arrivals[a].first);
      next_order_.push_back(arrivals[a++].second);
    }
  };
  for (std::size_t s = 0; s < size(); ++s) {
    const std::size_t next = next_changed();
    if (next > s) {  // as they were
      if (fits(s)) {
        put_back(next);
      } else {
        const auto from = std::ptrdiff_t(s), to = std::ptrdiff_t(next);
        const auto shift = std::uint32_t(begin[first] + next_order_.size() - begin[s]);  // may be negative: wraps
        next_order_.insert(next_order_.end(), order.begin() + std::ptrdiff_t(begin[s]),
                           order.begin() + std::ptrdiff_t(begin[next]));
        next_index_.insert(next_index_.end(), index.begin() + from, index.begin() + to);
        const std::size_t before = next_begin_.size();
        next_begin_.resize(before + next - s);
        for (std::size_t k = s; k < next; ++k) next_begin_[before + k - s] = begin[k] + shift;
      }
      s = next;
      if (s == size()) break;
    }
    const std::int32_t c = index[s];
    take_new_cells(c);
    open(c);
    for (std::uint32_t q = begin[s]; q < begin[s + 1]; ++q) {
      if (m < moves.size() && moves[m].place == q) {
        ++m;
        continue;
      }
      while (a < arrivals.size() && arrivals[a].first == c && arrivals[a].second < order[q])
        next_order_.push_back(arrivals[a++].second);
      next_order_.push_back(order[q]);
    }
    while (a < arrivals.size() && arrivals[a].first == c) next_order_.push_back(arrivals[a++].second);
    if (next_begin_.back() == begin[first] + next_order_.size()) {  // all have left
      next_index_.pop_back();
      next_begin_.pop_back();
    }
  }
  take_new_cells(none);
  if (fits(size())) {
    put_back(size());
  } else {
    changed = changed || !std::equal(next_index_.begin(), next_index_.end(), index.begin() + std::ptrdiff_t(first), index.end());
    const std::size_t at = begin[first];
    order.resize(at);
    order.insert(order.end(), next_order_.begin(), next_order_.end());
    index.resize(first);
    index.insert(index.end(), next_index_.begin(), next_index_.end());
    begin.resize(first);
    begin.insert(begin.end(), next_begin_.begin(), next_begin_.end());
    begin.push_back(std::uint32_t(order.size()));
  }
  if (changed) index_rows();
  return changed;
}

void CellList::index_rows() {
  std::size_t row = 0;
  std::int32_t row_end = 0;  // first cell of `row`, which is the next to begin
  for (std::size_t s = 0; s < size(); ++s)
    for (; index[s] >= row_end; row_end += nx_) row_begin_[row++] = std::uint32_t(s);
  std::fill(row_begin_.begin() + std::ptrdiff_t(row), row_begin_.end(), std::uint32_t(size()));
}

// A row's cells mostly lie side by side.
std::size_t CellList::first_from(std::int32_t cell) const {
  const auto row = std::size_t(cell / nx_);
  const std::uint32_t first = row_begin_[row], end = row_begin_[row + 1];
  if (first == end || cell <= index[first]) return first;
  const std::uint32_t guess = first + std::uint32_t(cell - index[first]);
  if (guess < end && index[guess] == cell) return guess;
  return std::size_t(std::lower_bound(index.begin() + first, index.begin() + end, cell) - index.begin());
}

std::int32_t CellList::find(std::int32_t cell) const {
  const std::size_t s = first_from(cell);
  return s < size() && index[s] == cell ? std::int32_t(s) : -1;
}

Range CellList::points_in(std::int32_t cell) const {
  const std::int32_t s = find(cell);
  return s < 0 ? Range{} : Range{begin[std::size_t(s)], begin[std::size_t(s) + 1]};
}

}  // namespace pivnp::mpm
