// A thread for what takes longer than a frame of the screen. Newer work on a channel supersedes what waits there or runs.
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <thread>

#include <QMetaObject>
#include <QObject>

namespace pivnp::view {

class Worker {
 public:
  using Stop = std::function<bool()>;
  using Job = std::function<void(const Stop&)>;

  Worker() : thread_([this] { run(); }) {}
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// A job of a lower channel comes first. What it throws is lost: jobs catch.
  void post(int channel, Job job);
  /// Nothing waits or runs.
  bool idle();

  /// Calls `what` later in the thread of `target`, unless that is gone by then.
  template <class F>
  static void tell(QObject* target, F what) {
    QMetaObject::invokeMethod(target, std::move(what), Qt::QueuedConnection);
  }

 private:
  void run();

  std::mutex mutex_;
  std::condition_variable wake_;
  std::map<int, Job> waiting_;
  std::map<int, unsigned> number_;  // of the newest job of a channel
  bool end_ = false, busy_ = false;
  std::thread thread_;
};

}  // namespace pivnp::view
