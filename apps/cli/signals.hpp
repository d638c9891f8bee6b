// Ctrl-C: the first asks the work to stop cleanly, the second ends the program at once.
#pragma once

namespace pivnp::app {

/// Takes SIGINT and SIGTERM, and ignores SIGPIPE (a closed pipe then shows as a failed write).
void install_signal_handlers();

/// True once a signal asked to stop.
bool stop_signalled();

/// Forgets an earlier request.
void clear_stop_signal();

}  // namespace pivnp::app
