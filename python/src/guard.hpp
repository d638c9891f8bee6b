// Long work without the interpreter's lock, that Ctrl-C can stop.
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <mutex>
#include <string>

#include "pivnp/core/error.hpp"
#include "pivnp/core/progress.hpp"

namespace pivnp::python {

namespace py = pybind11;

/// Looks for signals twenty times a second; where Python's handler of one raises, work is asked to stop.
class PythonProgress final : public Progress {
 public:
  void update(std::string_view, std::int64_t, std::int64_t) override {}
  bool stop_requested() const override {
    const auto now = std::chrono::steady_clock::now();
    if (raised_ || now - looked_ < std::chrono::milliseconds(50)) return raised_;
    looked_ = now;
    const py::gil_scoped_acquire lock;
    raised_ = PyErr_CheckSignals() != 0;
    if (raised_) PyErr_Fetch(&type_, &value_, &trace_);
    return raised_;
  }
  /// With the interpreter's lock: raises what the handler raised.
  void raise() const {
    if (!raised_) return;
    PyErr_Restore(type_, value_, trace_);
    throw py::error_already_set();
  }

 private:
  mutable std::chrono::steady_clock::time_point looked_{};
  mutable bool raised_ = false;
  mutable PyObject *type_ = nullptr, *value_ = nullptr, *trace_ = nullptr;
};

/// Calls work(progress) without the interpreter's lock.
template <class Work>
auto unlocked(const Work& work) {
  PythonProgress progress;
  try {
    const py::gil_scoped_release release;
    return work(progress);
  } catch (const Interrupted&) {
    progress.raise();
    throw;
  }
}

/// Of an object whose state changes while the interpreter is free: one call at a time. Calls from other threads and from
/// handlers of signals meanwhile are refused, since waiting could be for oneself. To be asked with the interpreter's lock.
class Turn {
 public:
  explicit Turn(const char* whose) : whose_(whose) {}
  void demand() const {
    if (taken_) throw RunError(std::string(whose_) + ": at work in another thread, expected one call at a time");
  }
  /// Calls work(progress) without the interpreter's lock, as unlocked() does.
  template <class Work>
  auto unlocked(const Work& work) {
    demand();
    struct Taken {
      bool& taken;
      explicit Taken(bool& t) : taken(t) { taken = true; }
      ~Taken() { taken = false; }
    } const taken(taken_);
    return python::unlocked(work);
  }

 private:
  const char* whose_;
  bool taken_ = false;
};

/// Whether this process is a child that was made by fork: the threads of the parent's engines are not there, and OpenMP
/// would wait for them. Engines use one thread then; what they find does not depend on it.
inline bool& forked() {
  static bool is = false;
  return is;
}
inline int threads_here(int threads) { return forked() ? 1 : threads; }

/// HDF5 takes one thread at a time. To be held without the interpreter's lock.
inline std::mutex& hdf5_mutex() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace pivnp::python
