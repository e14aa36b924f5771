#include "plugin/host/plugin.h"

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "plugin/host/plugin_controller.h"

namespace moma {

std::shared_ptr<const Plugin> Plugin::open(std::shared_ptr<const PluginLibrary> library,
                                           std::shared_ptr<const config::LoadedRobot> robot,
                                           const nlohmann::ordered_json& parameters, double control_period) {
  std::shared_ptr<Plugin> plugin(new Plugin);
  plugin->library_ = std::move(library);
  plugin->robot_ = std::move(robot);
  const RobotModel& model = plugin->model();

  const std::string robot_text = plugin->robot_->resolved.dump();
  const std::string parameters_text = parameters.dump();
  std::vector<const char*> names;
  std::vector<double> lower, upper;
  for (const ControlledJoint& joint : model.joints) {
    names.push_back(joint.name.c_str());
    lower.push_back(joint.lower);
    upper.push_back(joint.upper);
  }
  const VectorX limits = model.velocity_limits();
  moma_plugin_setup setup{};
  setup.robot = robot_text.c_str();
  setup.parameters = parameters_text.c_str();
  setup.control_period = control_period;
  setup.base_type = static_cast<std::int32_t>(model.base.type);
  setup.num_joints = model.joints.size();
  setup.num_velocities = static_cast<std::size_t>(limits.size());
  setup.joints = names.data();
  setup.lower = lower.data();
  setup.upper = upper.data();
  setup.ready = model.ready.data();
  setup.velocity_limits = limits.data();

  PluginText text{};
  std::string thrown;
  if (!plugin_call(thrown,
                   [&] { plugin->handle_ = plugin->library_->functions.open(&setup, text.data(), text.size()); }))
    throw PluginError("moma_plugin_open() throws: " + thrown);
  if (plugin->handle_ == nullptr) throw PluginError(plugin_says(text, "it refuses this robot and these parameters"));
  return plugin;
}

Plugin::~Plugin() {
  std::string thrown;
  if (handle_ != nullptr) plugin_call(thrown, [&] { library_->functions.close(handle_); });
}

std::unique_ptr<StepController> Plugin::make() const { return std::make_unique<PluginController>(shared_from_this()); }

}  // namespace moma
