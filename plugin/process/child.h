#pragma once

#include <sys/types.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <span>
#include <string>
#include <utility>

#include "plugin/process/command.h"

namespace moma {

/// A file descriptor that is closed at its end.
class Descriptor {
 public:
  explicit Descriptor(int value = -1) noexcept : value_(value) {}
  ~Descriptor() { reset(); }
  Descriptor(Descriptor&& other) noexcept : value_(std::exchange(other.value_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    reset(std::exchange(other.value_, -1));
    return *this;
  }
  int get() const noexcept { return value_; }
  void reset(int value = -1) noexcept;

 private:
  int value_;
};

/// A child process in a process group of its own, which signals of the terminal's keys do not reach. Its standard input
/// and output are one socket; the tail of its standard error is kept. It inherits no other descriptor. The child and
/// its descendants are killed with this object and with this process; descendants are found by a mark in their
/// environment. A descendant that clears its environment and leaves the process group escapes.
class Child {
 public:
  using Clock = std::chrono::steady_clock;
  enum class Wait { kDone, kLate, kEnded };

  /// Throws PluginError if the command cannot be started, or if this process is itself a Child: a controller's file
  /// that starts processes while it is read would recur without end.
  explicit Child(const ProcessCommand& command);
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// All of `bytes`. kEnded: it does not read any more.
  Wait send(std::span<const unsigned char> bytes, Clock::time_point until) noexcept;
  /// Receives at least one byte; `got`: number of bytes.
  Wait receive(std::span<unsigned char> room, std::size_t& got, Clock::time_point until) noexcept;

  /// Ends the child's standard input, which asks it to exit.
  void hang_up() noexcept;
  /// Waits for the child's exit until `until`, then kills it. Returns true if it was killed.
  bool end(Clock::time_point until) noexcept;
  /// Words for its end, after end(): "ended with exit code 3", "was ended by signal 11 (Segmentation fault)".
  std::string ending() const;
  /// The end of its standard error, without control characters.
  std::string last_words();

 private:
  Wait wait_for(short events, Clock::time_point until) noexcept;
  bool gone() noexcept;
  void hear() noexcept;

  std::string mark_;
  pid_t pid_ = -1;
  Descriptor socket_;
  Descriptor errors_;
  int status_ = 0;
  std::array<char, 2048> said_{};
  std::size_t said_size_ = 0;
};

}  // namespace moma
