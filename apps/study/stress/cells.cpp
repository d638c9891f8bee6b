#include "apps/study/stress/cells.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <fstream>
#include <iomanip>
#include <map>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>

#include "pivnp/core/error.hpp"
#include "pivnp/core/hash.hpp"
#include "pivnp/core/regular_file.hpp"
#include "pivnp/core/version.hpp"

namespace pivnp::app {

namespace {

using Counts = std::array<double Survival::*, 8>;
constexpr Counts counts = {&Survival::good,         &Survival::fair,          &Survival::flagged,      &Survival::wrong,
                           &Survival::wrong_values, &Survival::wrong_flagged, &Survival::right_values, &Survival::right_flagged};

// What tells a combination from all others, of other settings, levels and programs too.
std::string key_of(const MapPlan& plan, std::size_t i, std::size_t j) {
  std::ostringstream text;
  text << build_info().commit << '\n' << plan.map.name << '\n' << plan.map.made_of << '\n' << plan.settings << '\n' << std::setprecision(17);
  for (const auto& [axis, k] : {std::pair(&plan.map.x, i), std::pair(&plan.map.y, j)}) {
    if (axis->names.empty()) text << axis->levels[k] << '\n';
    else text << axis->names[k] << '\n';
  }
  return hexadecimal(hash64(text.str()));
}

std::map<std::string, Survival> read_kept(const std::filesystem::path& file) {
  std::map<std::string, Survival> found;
  if (!std::filesystem::exists(file)) return found;
  std::ifstream in = open_regular_file(file);
  std::string line;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string key, end;
    Survival s;
    words >> key;
    for (const auto count : counts) words >> s.*count;
    if (words >> end && end == ".") found[key] = s;
  }
  return found;
}

void append_kept(std::ofstream& out, const std::string& key, const Survival& s) {
  out << std::setprecision(17) << key;
  for (const auto count : counts) out << ' ' << s.*count;
  out << " .\n" << std::flush;
}

// Of a combination on a thread of its own: only the stop matters, and it comes from the thread that watches.
class Stop final : public Progress {
 public:
  explicit Stop(const std::atomic<bool>& asked) : asked_(asked) {}
  void update(std::string_view, std::int64_t, std::int64_t) override {}
  bool stop_requested() const override { return asked_; }

 private:
  const std::atomic<bool>& asked_;
};

struct Combination {
  std::size_t plan, i, j;
  std::string key;
};

// The workers' shared state; all but the atomics under the mutex.
class Work {
 public:
  Work(const std::vector<MapPlan>& plans, const std::vector<Combination>& todo, FilledMaps& filled, const std::filesystem::path& kept)
      : plans_(plans), todo_(todo), filled_(filled) {
    if (kept.empty()) return;
    out_.open(kept, std::ios::app);
    out_ << '\n';  // a line that was cut off ends here
  }

  void run(int threads, Progress& progress) {
    std::vector<std::jthread> workers;
    for (int k = 0; k < threads; ++k) workers.emplace_back([this] { work(); });
    const auto total = std::int64_t(filled_.combinations), before = std::int64_t(filled_.kept);
    std::unique_lock lock(mutex_);
    while (finished_ < todo_.size() && !stop_) {
      const std::size_t now = finished_;
      const std::string stage = now < todo_.size() ? plans_[todo_[now].plan].map.title : std::string();
      lock.unlock();
      progress.update(stage, before + std::int64_t(now), total);
      if (progress.stop_requested()) stop_ = true;
      lock.lock();
      if (finished_ == now && !stop_) changed_.wait_for(lock, std::chrono::milliseconds(100));
    }
    lock.unlock();
    workers.clear();  // joins
    if (failure_) std::rethrow_exception(failure_);
    if (stop_) throw Interrupted();
    progress.update("under stress", total, total);
  }

 private:
  void work() {
    Stop stop(stop_);
    for (std::size_t k = next_++; k < todo_.size() && !stop_; k = next_++) {
      const Combination& c = todo_[k];
      try {
        const Survival s = plans_[c.plan].result(c.i, c.j, stop);
        const std::lock_guard lock(mutex_);
        filled_.maps[c.plan].at(c.i, c.j) = s;
        if (out_.is_open()) append_kept(out_, c.key, s);
        ++finished_;
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (!stop_) failure_ = std::current_exception();
        stop_ = true;
      }
      changed_.notify_one();
    }
  }

  const std::vector<MapPlan>& plans_;
  const std::vector<Combination>& todo_;
  FilledMaps& filled_;
  std::ofstream out_;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<bool> stop_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t finished_ = 0;
  std::exception_ptr failure_;
};

}  // namespace

FilledMaps filled(const std::vector<MapPlan>& plans, const std::filesystem::path& kept, int threads, Progress& progress) {
  const std::map<std::string, Survival> known = kept.empty() ? std::map<std::string, Survival>() : read_kept(kept);
  FilledMaps out;
  std::vector<Combination> todo;
  for (std::size_t p = 0; p < plans.size(); ++p) {
    SurvivalMap& map = out.maps.emplace_back(plans[p].map);
    map.cells.assign(map.x.size() * map.y.size(), {});
    for (std::size_t j = 0; j < map.y.size(); ++j)
      for (std::size_t i = 0; i < map.x.size(); ++i) {
        ++out.combinations;
        std::string key = key_of(plans[p], i, j);
        if (const auto found = known.find(key); found != known.end()) map.at(i, j) = found->second, ++out.kept;
        else todo.push_back({p, i, j, std::move(key)});
      }
  }
  Work(plans, todo, out, kept).run(std::max(1, threads), progress);
  return out;
}

MapPlan thinned(const MapPlan& plan) {
  MapPlan out = plan;
  const auto thin = [](MapAxis& axis) {
    std::vector<std::size_t> left;
    const std::size_t step = axis.names.empty() ? 2 : 1;
    for (std::size_t k = 0; k < axis.size(); k += step) left.push_back(k);
    if (left.back() + 1 != axis.size()) left.push_back(axis.size() - 1);
    if (axis.names.empty()) {
      std::vector<double> levels;
      for (const std::size_t k : left) levels.push_back(axis.levels[k]);
      axis.levels = std::move(levels);
    }
    return left;
  };
  const std::vector<std::size_t> x = thin(out.map.x), y = thin(out.map.y);
  out.result = [whole = plan.result, x, y](std::size_t i, std::size_t j, Progress& progress) { return whole(x[i], y[j], progress); };
  return out;
}

}  // namespace pivnp::app
