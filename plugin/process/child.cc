#include "plugin/process/child.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <mutex>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include "plugin/host/library.h"

namespace moma {
namespace {

/// The environment variable that marks every process of a Child and its descendants.
constexpr const char* kWorkerVariable = "MOMA_WORKER";

// $1: common prefix of all marks. Each line of its input is a mark whose processes are killed; end of input: moma died.
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

[[noreturn]] void fail(const char* what, int error) {
  throw PluginError(fmt::format("{}: {}", what, std::generic_category().message(error)));
}

// posix_spawn copies nothing of this process and takes no lock of it: other threads may be anywhere.
struct Spawning {
  Spawning() {
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
  }
  ~Spawning() {
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
  }
  Spawning(const Spawning&) = delete;
  Spawning& operator=(const Spawning&) = delete;

  /// Redirects descriptors 0, 1 and 2 and closes all others. Returns an error number, 0 for success.
  int redirect(int input, int output, int errors, const char* directory) {
    const int from[] = {input, output, errors};
    int error = 0;
    for (int i = 0; i < 3 && error == 0; ++i)
      error = from[i] >= 0 ? posix_spawn_file_actions_adddup2(&actions, from[i], i)
                           : posix_spawn_file_actions_addopen(&actions, i, "/dev/null", O_WRONLY, 0);
    if (error == 0) error = posix_spawn_file_actions_addclosefrom_np(&actions, 3);
    return error != 0 ? error : posix_spawn_file_actions_addchdir_np(&actions, directory);
  }

  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
};

/// Kills processes that outlive their Child: those that left its group (setsid), and all of them if this process ends,
/// however it does. A process of sh does so, by their mark in /proc/*/environ. (A parent-death signal is bound to the
/// thread that started the child, and threads end.) Without sh, processes that left their group stay.
class Leftovers {
 public:
  /// The instance of this process, which the first call creates.
  static Leftovers& of_this_process() {
    static std::mutex mutex;
    static std::unique_ptr<Leftovers> own;
    const std::scoped_lock lock(mutex);
    if (own == nullptr || own->owner_ != ::getpid()) own = std::make_unique<Leftovers>();  // after a fork, another
    return *own;
  }

  Leftovers() {
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) return;
    line_.reset(ends[0]);
    const Descriptor theirs(ends[1]);
    Spawning spawning;
    posix_spawnattr_setflags(&spawning.attributes, POSIX_SPAWN_SETSID);  // signals to moma's group do not reach it
    spawning.redirect(theirs.get(), -1, -1, "/");
    const char* const arguments[] = {"sh", "-c", kScript, "moma-leftovers", prefix_.c_str(), nullptr};
    pid_t pid = -1;
    if (posix_spawnp(&pid, "sh", &spawning.actions, &spawning.attributes, const_cast<char* const*>(arguments),
                     environ) != 0)
      line_.reset();
  }

  /// Returns a mark that no process has yet.
  std::string new_mark() { return prefix_ + std::to_string(++marks_); }
  /// Kills all processes of this mark, soon.
  void kill(const std::string& mark) noexcept {
    char text[128];
    const auto end = fmt::format_to_n(text, sizeof text, "{}\n", mark);
    if (line_.get() >= 0) [[maybe_unused]]
      const ssize_t sent = ::send(line_.get(), text, end.size, MSG_NOSIGNAL | MSG_DONTWAIT);
  }

 private:
  const pid_t owner_ = ::getpid();
  const std::string prefix_ =
      fmt::format("{}-{}-", owner_, std::chrono::steady_clock::now().time_since_epoch().count());
  std::atomic<std::uint64_t> marks_{0};
  Descriptor line_;  // to the process of sh, which kills all processes of `prefix_` when it closes
};

pid_t spawn(const ProcessCommand& command, int line, int errors, char* const* environment) {
  Spawning spawning;
  sigset_t none, pipe;
  sigemptyset(&none);
  sigemptyset(&pipe);
  sigaddset(&pipe, SIGPIPE);
  posix_spawnattr_setsigmask(&spawning.attributes, &none);
  posix_spawnattr_setsigdefault(&spawning.attributes, &pipe);
  posix_spawnattr_setpgroup(&spawning.attributes, 0);
  posix_spawnattr_setflags(&spawning.attributes,
                           POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  int error = spawning.redirect(line, line, errors, command.directory.c_str());
  std::vector<char*> arguments;
  for (const std::string& argument : command.arguments) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  pid_t pid = -1;
  if (error == 0)
    error = posix_spawnp(&pid, arguments[0], &spawning.actions, &spawning.attributes, arguments.data(), environment);
  if (error != 0) fail(command.arguments.front().c_str(), error);
  return pid;
}

// This process's environment with the command's values in it.
std::vector<char*> environment_of(const ProcessCommand& command, std::string& mark) {
  const auto name_of = [](std::string_view entry) { return entry.substr(0, entry.find('=')); };
  std::vector<char*> all;
  for (const std::string& entry : command.environment) all.push_back(const_cast<char*>(entry.c_str()));
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const bool replaced = std::ranges::any_of(command.environment,
                                              [&](const std::string& own) { return name_of(own) == name_of(*entry); });
    if (!replaced) all.push_back(*entry);
  }
  all.push_back(mark.data());
  all.push_back(nullptr);
  return all;
}

void limit(pid_t pid, const ProcessLimits& limits) {
  rlimit none{0, 0};
  ::prlimit(pid, RLIMIT_CORE, &none, nullptr);  // a controller that crashes is no reason for files in its folder
  if (std::isinf(limits.memory)) return;
  const auto bytes = static_cast<rlim_t>(limits.memory * 1e9);
  rlimit data{bytes, bytes};
  ::prlimit(pid, RLIMIT_DATA, &data, nullptr);
}

}  // namespace

void Descriptor::reset(int value) noexcept {
  if (value_ >= 0) ::close(value_);
  value_ = value;
}

Child::Child(const ProcessCommand& command) {
  if (std::getenv(kWorkerVariable) != nullptr) {
    throw PluginError(
        "a process that moma started as a controller starts controllers in turn, which would have no end; in a Python "
        "script, what evaluates belongs under: if __name__ == \"__main__\":");
  }
  Leftovers& leftovers = Leftovers::of_this_process();
  mark_ = leftovers.new_mark();
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) fail("no socket for it", errno);
  socket_.reset(ends[0]);
  const Descriptor theirs(ends[1]);
  if (::pipe2(ends, O_CLOEXEC) != 0) fail("no pipe for it", errno);
  errors_.reset(ends[0]);
  const Descriptor their_errors(ends[1]);
  ::fcntl(socket_.get(), F_SETFL, O_NONBLOCK);
  ::fcntl(errors_.get(), F_SETFL, O_NONBLOCK);
  std::string mark = fmt::format("{}={}", kWorkerVariable, mark_);
  const std::vector<char*> environment = environment_of(command, mark);
  pid_ = spawn(command, theirs.get(), their_errors.get(), environment.data());
  limit(pid_, command.limits);
}

Child::~Child() {
  end(Clock::now());
  Leftovers::of_this_process().kill(mark_);
}

void Child::hear() noexcept {
  std::array<char, 4096> room;
  const ssize_t got = ::read(errors_.get(), room.data(), room.size());
  if (got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR)) errors_.reset();
  if (got <= 0) return;
  const auto size = static_cast<std::size_t>(got);
  const std::size_t fresh = std::min(size, said_.size());
  const std::size_t kept = std::min(said_size_, said_.size() - fresh);
  std::memmove(said_.data(), said_.data() + said_size_ - kept, kept);
  std::memcpy(said_.data() + kept, room.data() + size - fresh, fresh);
  said_size_ = kept + fresh;
}

Child::Wait Child::wait_for(short events, Clock::time_point until) noexcept {
  for (;;) {
    pollfd both[2] = {{socket_.get(), events, 0}, {errors_.get(), POLLIN, 0}};
    const auto left = std::chrono::duration<double, std::milli>(until - Clock::now()).count();
    const int milliseconds = static_cast<int>(std::clamp(std::ceil(left), 0.0, 60000.0));
    const int ready = ::poll(both, errors_.get() >= 0 ? 2 : 1, milliseconds);
    if (ready < 0 && errno != EINTR) return Wait::kEnded;
    if (ready > 0 && errors_.get() >= 0 && both[1].revents != 0) hear();
    if (ready > 0 && both[0].revents != 0) return Wait::kDone;
    if (left <= 0.0) return Wait::kLate;
  }
}

Child::Wait Child::send(std::span<const unsigned char> bytes, Clock::time_point until) noexcept {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent >= 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
    } else if (errno == EAGAIN) {
      if (const Wait wait = wait_for(POLLOUT, until); wait != Wait::kDone) return wait;
    } else if (errno != EINTR) {
      return Wait::kEnded;
    }
  }
  return Wait::kDone;
}

Child::Wait Child::receive(std::span<unsigned char> room, std::size_t& got, Clock::time_point until) noexcept {
  for (;;) {
    if (const Wait wait = wait_for(POLLIN, until); wait != Wait::kDone) return wait;
    const ssize_t received = ::recv(socket_.get(), room.data(), room.size(), 0);
    if (received > 0) {
      got = static_cast<std::size_t>(received);
      return Wait::kDone;
    }
    if (received == 0 || (errno != EAGAIN && errno != EINTR)) return Wait::kEnded;
  }
}

void Child::hang_up() noexcept { ::shutdown(socket_.get(), SHUT_WR); }

bool Child::gone() noexcept {
  if (pid_ < 0) return true;
  if (::waitpid(pid_, &status_, WNOHANG) != pid_) return false;
  ::kill(-pid_, SIGKILL);  // what it left behind
  pid_ = -1;
  return true;
}

bool Child::end(Clock::time_point until) noexcept {
  while (!gone()) {
    if (Clock::now() >= until) {
      ::kill(-pid_, SIGKILL);
      while (::waitpid(pid_, &status_, 0) < 0 && errno == EINTR) continue;
      pid_ = -1;
      return true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

std::string Child::ending() const {
  if (WIFEXITED(status_)) return fmt::format("ended with exit code {}", WEXITSTATUS(status_));
  const int signal = WTERMSIG(status_);
  const char* name = sigdescr_np(signal);
  return fmt::format("was ended by signal {} ({})", signal, name != nullptr ? name : "unknown");
}

std::string Child::last_words() {
  for (std::size_t before = said_.size() + 1; errors_.get() >= 0 && before != said_size_;) {
    before = said_size_;
    hear();
  }
  std::string words = without_controls({said_.data(), said_size_});
  while (!words.empty() && words.back() == ' ') words.pop_back();
  return words;
}

}  // namespace moma
