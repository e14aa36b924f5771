#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "controller/config/robot_file.h"
#include "controller/step.h"
#include "plugin/host/library.h"

namespace moma {

/// A plugin opened for one robot, with one set of parameters: makes controllers, for several threads at once.
class Plugin : public std::enable_shared_from_this<Plugin> {
 public:
  /// Throws PluginError with what the plugin says where it refuses robot or parameters.
  static std::shared_ptr<const Plugin> open(std::shared_ptr<const PluginLibrary> library,
                                            std::shared_ptr<const config::LoadedRobot> robot,
                                            const nlohmann::ordered_json& parameters, double control_period);
  ~Plugin();
  Plugin(const Plugin&) = delete;
  Plugin& operator=(const Plugin&) = delete;

  const PluginLibrary& library() const noexcept { return *library_; }
  const RobotModel& model() const noexcept { return *robot_->model; }
  void* handle() const noexcept { return handle_; }

  /// A controller behind moma's step interface. Its reset() throws PluginError where the plugin fails to start. Its
  /// step() is as free of allocations as the plugin's; where the plugin fails, throws, or answers with numbers that are
  /// not finite, the command is zero and failure() says why. Commands beyond the robot's speeds are scaled into them as
  /// a whole, wheels included, as those of moma's closed-form methods.
  std::unique_ptr<StepController> make() const;

 private:
  Plugin() = default;
  std::shared_ptr<const PluginLibrary> library_;
  std::shared_ptr<const config::LoadedRobot> robot_;
  void* handle_ = nullptr;
};

}  // namespace moma
