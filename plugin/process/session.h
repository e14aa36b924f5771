#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "plugin/moma_plugin.h"
#include "plugin/process/child.h"

namespace moma {

// The protocol of controllers in processes of their own; docs/reference/process-protocol.md is the whole of it, for
// those who write one. Its frames have the numbers of plugin/moma_plugin.h: one version is raised with both.
inline constexpr int kProcessProtocol = MOMA_PLUGIN_ABI - 2;

enum class Frame : std::uint32_t {
  kSetup = 1,  ///< from moma: robot and parameters, as JSON
  kReset = 2,  ///< the objects of a motion, as JSON
  kStep = 3,   ///< the numbers of an Observation (describe/numbers.h)
  kReady = 101,
  kStarted = 102,
  kCommand = 103,  ///< the velocities, and the numbers of Details or none
  kError = 104     ///< UTF-8
};

inline constexpr std::size_t kFrameHeader = 8;                       ///< length of what follows, and kind, 32 bits each
inline constexpr std::size_t kLargestAnswer = std::size_t{1} << 20;  ///< [bytes] of one frame from the process

static_assert(std::endian::native == std::endian::little, "frames are little-endian");

/// One process that speaks the protocol. Every failure throws PluginError and leaves the session broken: its process is
/// of no use any more.
class Session {
 public:
  /// Starts the process.
  explicit Session(const ProcessCommand& command);
  /// The process sees the end of its input, and is killed where it does not go.
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Tells the process its setup, if it has not got this one already. The limits' deadline is in control periods of
  /// this length [s]. The reason of a process that refuses it reaches the caller.
  void set_up(const std::shared_ptr<const std::string>& setup, double control_period);
  /// `shapes`: JSON. Steps after this one, whose observations have so many numbers, allocate nothing.
  void reset(const std::string& shapes, std::size_t numbers);
  /// The same as moma_plugin_step().
  void step(const moma_observation& seen, std::size_t velocities, moma_step_result& result);

  bool broken() const noexcept { return broken_; }
  /// The files that the process names as part of itself.
  const std::vector<std::string>& files() const noexcept { return files_; }
  /// Lets the process go; the destructor waits for it.
  void hang_up() noexcept { child_.hang_up(); }

 private:
  /// Deadline of an answer.
  struct Due {
    const char* to;  ///< "to a step"
    double seconds;
    Child::Clock::time_point until;
  };
  static Due due(const char* to, double seconds);
  std::span<const unsigned char> exchange(Frame kind, std::span<const char> payload, Frame wanted, const Due& due);
  std::span<const unsigned char> answer(Frame wanted, const Due& due);
  [[noreturn]] void fail(const std::string& what);
  [[noreturn]] void ended(const Due& due);
  [[noreturn]] void late(const Due& due);
  [[noreturn]] void not_a_frame();

  const ProcessLimits limits_;
  double control_period_ = 0.0;
  Child child_;
  std::shared_ptr<const std::string> setup_;
  std::vector<std::string> files_;
  std::vector<unsigned char> out_;
  std::vector<unsigned char> in_;
  bool broken_ = false;
};

}  // namespace moma
