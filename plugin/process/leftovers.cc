#include "plugin/process/leftovers.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <memory>
#include <mutex>

namespace moma {
namespace {

// $1: what the marks of all begin with. Each line: a mark whose processes are to go. Its end: moma is gone.
constexpr const char* kScript = R"(
sweep() {
  for round in 1 2 3 4 5 6 7 8; do
    found=$(grep -lsz "^MOMA_WORKER=$1" /proc/[0-9]*/environ 2>/dev/null | cut -d/ -f3)
    [ -n "$found" ] || return
    kill -KILL $found 2>/dev/null
  done
}
while read -r mark; do sweep "$mark\$"; done
sweep "$1"
)";

}  // namespace

Leftovers& Leftovers::of_this_process() {
  static std::mutex mutex;
  static std::unique_ptr<Leftovers> own;
  const std::scoped_lock lock(mutex);
  if (own == nullptr || own->owner_ != ::getpid()) own = std::make_unique<Leftovers>();  // after a fork, another
  return *own;
}

Leftovers::Leftovers()
    : owner_(::getpid()),
      prefix_(fmt::format("{}-{}-", owner_, std::chrono::steady_clock::now().time_since_epoch().count())) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) return;
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&actions);
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);  // a signal to moma's group does not reach it
  posix_spawn_file_actions_adddup2(&actions, ends[1], 0);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addclosefrom_np(&actions, 3);
  posix_spawn_file_actions_addchdir_np(&actions, "/");
  const char* const arguments[] = {"sh", "-c", kScript, "moma-leftovers", prefix_.c_str(), nullptr};
  pid_t pid = -1;
  const int error = posix_spawnp(&pid, "sh", &actions, &attributes, const_cast<char* const*>(arguments), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  ::close(ends[1]);
  line_ = ends[0];
  if (error != 0) {
    ::close(line_);
    line_ = -1;
  }
}

Leftovers::~Leftovers() {
  if (line_ >= 0) ::close(line_);
}

std::string Leftovers::new_mark() { return prefix_ + std::to_string(++marks_); }

void Leftovers::kill(const std::string& mark) noexcept {
  char text[128];
  const auto end = fmt::format_to_n(text, sizeof text, "{}\n", mark);
  if (line_ >= 0) [[maybe_unused]]
    const ssize_t sent = ::send(line_, text, end.size, MSG_NOSIGNAL | MSG_DONTWAIT);
}

}  // namespace moma
