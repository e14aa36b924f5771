#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plugin/moma_plugin.h"
#include "plugin/process/child.h"
#include "plugin/process/frame.h"

namespace moma {

/// One process that speaks the protocol. Whatever goes wrong throws PluginError with what a person should know, and
/// leaves the session broken: its process is of no use any more.
class Session {
 public:
  /// Starts the process. The limits' deadline is in control periods of this length [s].
  Session(const ProcessCommand& command, double control_period);
  /// The process sees the end of its input, and is killed where it does not go.
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// The process's own words about the robot and the parameters it refuses reach the caller. Does nothing where the
  /// process has this setup already.
  void set_up(const std::shared_ptr<const std::string>& setup, double control_period);
  /// `shapes`: JSON. Steps after this one, whose observations have so many numbers, allocate nothing.
  void reset(const std::string& shapes, std::size_t numbers);
  /// As moma_plugin_step().
  void step(const moma_observation& seen, std::size_t velocities, moma_step_result& result);

  bool broken() const noexcept { return broken_; }
  /// The files that the process names as part of itself.
  const std::vector<std::string>& files() const noexcept { return files_; }
  /// Lets the process go; the destructor waits for it.
  void hang_up() noexcept { child_.hang_up(); }

 private:
  /// Until when something is to be answered.
  struct Due {
    const char* to;  ///< "to a step"
    double seconds;
    Child::Clock::time_point until;
  };
  static Due due(const char* to, double seconds);
  std::span<const unsigned char> exchange(Frame kind, std::string_view payload, Frame wanted, const char* to);
  std::span<const unsigned char> answer(Frame wanted, const Due& due);
  [[noreturn]] void fail(const std::string& what);
  [[noreturn]] void ended(const Due& due);
  [[noreturn]] void late(const Due& due);
  [[noreturn]] void not_a_frame();

  const ProcessLimits limits_;
  double control_period_;
  Child child_;
  std::shared_ptr<const std::string> setup_;
  std::vector<std::string> files_;
  std::vector<unsigned char> out_;
  std::vector<unsigned char> in_;
  bool broken_ = false;
};

}  // namespace moma
