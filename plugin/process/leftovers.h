#pragma once

#include <sys/types.h>

#include <atomic>
#include <cstdint>
#include <string>

namespace moma {

/// The environment variable that every process of a Child has, and whatever that starts: its mark.
inline constexpr const char* kWorkerVariable = "MOMA_WORKER";

/// Kills what processes of controllers leave behind: what left its group (setsid), and everything where this process
/// ends, however it does. A process without moma's memory, sh, does it: it finds by the mark in /proc/*/environ, which
/// all descendants inherit. (A parent-death signal is bound to the thread that started the child, and threads end.)
/// A descendant that clears its environment and leaves its group escapes.
class Leftovers {
 public:
  /// That of this process; the first call starts it. Where there is no sh, nothing is killed that left its group.
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

}  // namespace moma
