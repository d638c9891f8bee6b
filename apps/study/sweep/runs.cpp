#include "apps/study/sweep/runs.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <map>
#include <thread>

#include "apps/plot/files.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/regular_file.hpp"

namespace pivnp::app {

namespace {

pid_t start(const SweepJob& job) {
  plot::make_folder(job.folder);
  const std::string log = (job.folder / "run.log").string();
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW, 0644);
  posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
  std::vector<char*> words;
  for (const std::string& word : job.words) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  // A group of its own: Ctrl-C on the terminal reaches the runs through this program alone, once.
  posix_spawnattr_t how;
  posix_spawnattr_init(&how);
  posix_spawnattr_setflags(&how, POSIX_SPAWN_SETPGROUP);
  pid_t child = 0;
  const int failed = posix_spawn(&child, words[0], &files, &how, words.data(), environ);
  posix_spawnattr_destroy(&how);
  posix_spawn_file_actions_destroy(&files);
  if (failed != 0) throw RunError(job.words[0] + ": " + std::strerror(failed));
  return child;
}

// The line of the log that says why.
std::string message_in(const std::filesystem::path& log, int status) {
  std::ifstream in = open_regular_file(log);
  std::string found, last;
  for (std::string line; std::getline(in, line);) {
    if (!line.empty()) last = line;
    if (const std::size_t at = line.find("error: "); at != std::string::npos) found = line.substr(at + 7);
  }
  if (found.empty()) found = last;
  if (!found.empty()) return found;
  return WIFSIGNALED(status) ? "ended by signal " + std::to_string(WTERMSIG(status)) : "ended with code " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

void make_jobs(std::vector<SweepJob>& jobs, int at_once, std::int64_t before, Progress& progress) {
  std::map<pid_t, std::size_t> running;
  std::size_t next = 0, finished = 0;
  bool stopped = false;
  const auto total = before + std::int64_t(jobs.size());
  const auto stop = [&] {
    for (const auto& [child, job] : running) kill(child, SIGINT);
    stopped = true;
  };
  while (finished < jobs.size() && !(stopped && running.empty())) {
    while (!stopped && next < jobs.size() && running.size() < std::size_t(at_once)) try {
        running[start(jobs[next])] = next;
        ++next;
      } catch (...) {
        stop();
        for (const auto& [child, job] : running) waitpid(child, nullptr, 0);
        throw;
      }
    bool ended = false;
    for (auto at = running.begin(); at != running.end();) {
      int status = 0;
      const pid_t got = waitpid(at->first, &status, WNOHANG);
      if (got == 0 || (got < 0 && errno == EINTR)) {
        ++at;
        continue;
      }
      SweepJob& job = jobs[at->second];
      if (got < 0) job.failure = "lost: " + std::string(std::strerror(errno));
      else if (!stopped && !(WIFEXITED(status) && WEXITSTATUS(status) == 0)) job.failure = message_in(job.folder / "run.log", status);
      at = running.erase(at);
      ++finished;
      ended = true;
    }
    if (ended) continue;
    const std::string title = running.empty() ? "sweep" : jobs[running.begin()->second].title;
    progress.update(title, before + std::int64_t(finished), total);
    if (!stopped && progress.stop_requested()) stop();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  if (stopped) throw Interrupted();
  progress.update("sweep", total, total);
}

}  // namespace pivnp::app
