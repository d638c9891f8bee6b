#include "apps/cli/signals.hpp"

#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <exception>
#include <new>

namespace pivnp::app {

namespace {

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch lock-free atomics");

extern "C" void on_stop_signal(int) {
  if (stop.exchange(true)) _exit(130);
  constexpr char note[] = "\npivnp: stopping; Ctrl-C once more ends at once\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, note, sizeof note - 1);
}

// Where memory ends within a library that lets nothing through (Qt's destructors).
[[noreturn]] void on_terminate() {
  try {
    if (const std::exception_ptr thrown = std::current_exception()) std::rethrow_exception(thrown);
  } catch (const std::bad_alloc&) {
    constexpr char note[] = "pivnp: error: out of memory\n";
    [[maybe_unused]] const auto written = write(STDERR_FILENO, note, sizeof note - 1);
    _exit(1);
  } catch (...) {
  }
  std::abort();
}

}  // namespace

void install_signal_handlers() {
  std::set_terminate(on_terminate);
  struct sigaction action {};
  action.sa_handler = on_stop_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;  // a frame that is being read is read to its end
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction before {};
  if (sigaction(SIGHUP, nullptr, &before) == 0 && before.sa_handler != SIG_IGN)  // else nohup started the program
    sigaction(SIGHUP, &action, nullptr);
  action.sa_handler = SIG_IGN;
  sigaction(SIGPIPE, &action, nullptr);
  sigaction(SIGXFSZ, &action, nullptr);  // a limit on file size is a full disk, not a signal
}

bool stop_signalled() { return stop.load(); }

void clear_stop_signal() { stop.store(false); }

}  // namespace pivnp::app
