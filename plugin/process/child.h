#pragma once

#include <sys/types.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "plugin/process/command.h"

namespace moma {

/// The environment variable that every process of a Child has, and whatever that starts: its mark.
inline constexpr const char* kWorkerVariable = "MOMA_WORKER";

/// Kills what processes of controllers leave behind: what left its group (setsid), and everything where this process
/// ends, however it does. A process without moma's memory, sh, does it: it finds by the mark in /proc/*/environ, which
/// all descendants inherit. (A parent-death signal is bound to the thread that started the child, and threads end.)
/// A descendant that clears its environment and leaves its group escapes.
class Leftovers {
 public:
  /// Returns the instance of this process, which the first call starts. Without sh, nothing is killed that left its
  /// group.
  static Leftovers& of_this_process();

  /// A mark that no process has yet.
  std::string new_mark();
  /// Kills all processes of this mark, soon.
  void kill(const std::string& mark) noexcept;

  Leftovers();
  ~Leftovers();
  Leftovers(const Leftovers&) = delete;
  Leftovers& operator=(const Leftovers&) = delete;

 private:
  pid_t owner_;
  std::string prefix_;
  std::atomic<std::uint64_t> marks_{0};
  int line_ = -1;  ///< of the process; where it ends, all of `prefix_` are killed
};

/// A process of a command, in a group of its own (keys pressed at the terminal do not reach it), with one socket as its
/// standard input and output, and what it writes to its standard error kept as far as its last words. No other
/// descriptor of ours is open in it. It dies with this object and with this process, and so does what it started
/// (Leftovers).
class Child {
 public:
  using Clock = std::chrono::steady_clock;
  enum class Wait { kDone, kLate, kEnded };

  /// Throws PluginError where it cannot be started, and within a process that a Child started: what is started while a
  /// controller is read would start itself without end.
  explicit Child(const ProcessCommand& command);
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// All of `bytes`. kEnded: it does not read any more.
  Wait send(std::span<const unsigned char> bytes, Clock::time_point until) noexcept;
  /// At least one byte; `got` of them.
  Wait receive(std::span<unsigned char> room, std::size_t& got, Clock::time_point until) noexcept;

  /// Lets it see the end of its input, upon which it should go.
  void hang_up() noexcept;
  /// Waits for its end, kills it where that does not come. True where it had to be killed.
  bool end(Clock::time_point until) noexcept;
  /// How it ended, after end(): "ended with exit code 3", "was ended by signal 11 (Segmentation fault)".
  std::string ending() const;
  /// What it wrote last to its standard error, without control characters.
  std::string last_words();

 private:
  Wait wait_for(short events, Clock::time_point until) noexcept;
  bool gone() noexcept;
  void hear() noexcept;

  std::string mark_;
  pid_t pid_ = -1;
  int socket_ = -1;
  int errors_ = -1;
  int status_ = 0;
  std::array<char, 2048> said_{};
  std::size_t said_size_ = 0;
};

}  // namespace moma
