#pragma once

#include <memory>
#include <string_view>

#include "controller/config/robot_file.h"
#include "plugin/host/library.h"

namespace moma {

class StepController;

/// A plugin opened for one robot, with one set of parameters: makes controllers, for several threads at once.
class Plugin : public std::enable_shared_from_this<Plugin> {
 public:
  /// Throws PluginError with what the plugin says where it refuses robot or parameters.
  static std::shared_ptr<const Plugin> open(std::shared_ptr<const PluginLibrary> library,
                                            std::shared_ptr<const config::LoadedRobot> robot, const Json& parameters,
                                            double control_period);
  ~Plugin();
  Plugin(const Plugin&) = delete;
  Plugin& operator=(const Plugin&) = delete;

  const PluginLibrary& library() const noexcept { return *library_; }
  const RobotModel& model() const noexcept { return *robot_->model; }
  void* handle() const noexcept { return handle_; }

  /// A controller behind moma's step interface. Its reset() throws PluginError if the plugin fails to start. Its step()
  /// allocates as little as the plugin's; if the plugin fails, throws or answers with numbers that are not finite, the
  /// command is zero and failure() says why. Commands beyond the robot's speeds, wheels included, are scaled as a
  /// whole.
  std::unique_ptr<StepController> make() const;

 private:
  Plugin() = default;
  std::shared_ptr<const PluginLibrary> library_;
  std::shared_ptr<const config::LoadedRobot> robot_;
  void* handle_ = nullptr;
};

/// Parts of the reason of a trial that ended because real time ran out (plugin/process/session.cc). It depends on the
/// machine and not on the controller, so such a trial is not kept. Stores of earlier versions hold the same words.
inline constexpr std::string_view kLateBefore = "its process gave no answer ", kLateAfter = " s and was killed";

inline bool is_late(std::string_view reason) noexcept {
  const std::size_t at = reason.find(kLateBefore);
  return at != std::string_view::npos && reason.find(kLateAfter, at) != std::string_view::npos;
}

}  // namespace moma
