#include "apps/view/window/worker.hpp"

#include <utility>

namespace pivnp::view {

Worker::~Worker() {
  {
    const std::lock_guard lock(mutex_);
    end_ = true;
    waiting_.clear();
  }
  wake_.notify_all();
  thread_.join();
}

void Worker::post(int channel, Job job) {
  {
    const std::lock_guard lock(mutex_);
    ++number_[channel];
    waiting_[channel] = std::move(job);
  }
  wake_.notify_all();
}

bool Worker::idle() {
  const std::lock_guard lock(mutex_);
  return waiting_.empty() && !busy_;
}

void Worker::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [&] { return end_ || !waiting_.empty(); });
    if (end_) return;
    const int channel = waiting_.begin()->first;
    const unsigned mine = number_[channel];
    const Job job = std::move(waiting_.begin()->second);
    waiting_.erase(waiting_.begin());
    busy_ = true;
    lock.unlock();
    job([&] {
      const std::lock_guard look(mutex_);
      return end_ || number_[channel] != mine;
    });
    lock.lock();
    busy_ = false;
  }
}

}  // namespace pivnp::view
