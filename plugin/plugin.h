#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "controller/config/json_node.h"
#include "controller/config/reader.h"
#include "controller/config/robot_file.h"
#include "controller/step.h"
#include "plugin/border.h"

/// A C++ controller as a plugin of moma's evaluation (CMake target moma::plugin):
///
///   std::unique_ptr<MyController> make(const moma::plugin::Setup& setup);
///   MOMA_PLUGIN(make)
///
/// once, in one source file of a shared library. MyController is a StepController, or any class with its three
/// functions; step() of the latter may throw, which ends the trial with what() as the reason, while an exception that
/// leaves a noexcept step() ends the program. The library holds its own copy of moma's controller library; what
/// crosses the border are the C types of plugin/moma_plugin.h.
namespace moma::plugin {

/// Inputs from which a controller is made. The parameters are read as strictly as moma's own with config::MapReader;
/// its messages reach the user with the place in the suite.
struct Setup {
  std::shared_ptr<const RobotModel> robot;
  config::Node parameters;      ///< a map
  double control_period = 0.0;  ///< [s]
};

template <typename T>
concept SteppedController = requires(T& controller, const T& constant, std::span<const ObjectShape> objects,
                                     const Observation& observation, StepResult& result) {
  controller.reset(objects);
  controller.step(observation, result);
  constant.prepare(result);
};

// ---- How MOMA_PLUGIN works; not for users ------------------------------------------------------------------------

inline Setup read_setup(const moma_plugin_setup& setup) {
  Setup out;
  out.robot = config::robot_from_resolved(Json::parse(setup.robot)).model;
  out.parameters = config::node_from_json(Json::parse(setup.parameters), "");
  out.control_period = setup.control_period;
  return out;
}

template <typename Make>
class Exports {
 public:
  using Controller = typename std::invoke_result_t<Make, const Setup&>::element_type;
  static_assert(SteppedController<Controller>, "the controller lacks reset(), step() or prepare()");

  static void* open(Make make, const moma_plugin_setup* setup, char* error, std::size_t error_size) noexcept {
    return guarded<void*>(nullptr, error, error_size, [&]() -> void* {
      auto plugin = std::make_unique<Plugin>(Plugin{read_setup(*setup), make});
      plugin->make(plugin->setup);  // what is wrong with the parameters shows here, not in the first trial
      return plugin.release();
    });
  }
  static void close(void* plugin) noexcept { delete static_cast<Plugin*>(plugin); }

  static void* start(void* plugin, const moma_object_shape* objects, std::size_t num_objects, char* error,
                     std::size_t error_size) noexcept {
    return guarded<void*>(nullptr, error, error_size, [&]() -> void* {
      const Plugin& p = *static_cast<Plugin*>(plugin);
      auto motion = std::make_unique<Motion>();
      motion->robot = p.setup.robot;
      motion->observation.q.resize(p.setup.robot->num_joints());
      motion->observation.qdot.resize(p.setup.robot->num_velocities());
      motion->controller = p.make(p.setup);
      if (motion->controller == nullptr) throw std::runtime_error("no controller was made");
      std::vector<ObjectShape> shapes;
      for (std::size_t i = 0; i < num_objects; ++i) shapes.push_back(read_shape(objects[i]));
      motion->controller->reset(shapes);
      std::as_const(*motion->controller).prepare(motion->result);
      return motion.release();
    });
  }
  static void stop(void* controller) noexcept { delete static_cast<Motion*>(controller); }

  static int step(void* controller, const moma_observation* seen, moma_step_result* out, char* error,
                  std::size_t error_size) noexcept {
    return guarded<int>(1, error, error_size, [&] {
      Motion& m = *static_cast<Motion*>(controller);
      m.observation.objects.resize(seen->num_objects);
      unpack(seen->numbers, m.observation);
      m.controller->step(m.observation, m.result);
      const StepResult& r = m.result;
      if (r.command.size() != m.robot->num_velocities()) {
        throw std::runtime_error("the command has " + std::to_string(r.command.size()) + " values, the robot has " +
                                 std::to_string(m.robot->num_velocities()) + " velocities");
      }
      std::copy(r.command.begin(), r.command.end(), out->command);
      double details[fixed_numbers<Details>()];
      pack_part<Details>(r, details);
      std::memcpy(details_of(*out), details, sizeof details);
      out->solve_seconds = r.solve_seconds;
      return 0;
    });
  }

 private:
  struct Plugin {
    Setup setup;
    Make make;
  };
  struct Motion {
    std::shared_ptr<const RobotModel> robot;
    std::unique_ptr<Controller> controller;
    Observation observation;
    StepResult result;
  };
};

}  // namespace moma::plugin

/// `make` is a function: std::unique_ptr<C>(const moma::plugin::Setup&), called by several threads at once; it throws
/// where the parameters are wrong.
#define MOMA_PLUGIN(make)                                                                                            \
  extern "C" {                                                                                                       \
  uint32_t moma_plugin_abi(void) { return MOMA_PLUGIN_ABI; }                                                         \
  void* moma_plugin_open(const moma_plugin_setup* setup, char* error, size_t error_size) {                           \
    return moma::plugin::Exports<decltype(&(make))>::open(&(make), setup, error, error_size);                        \
  }                                                                                                                  \
  void moma_plugin_close(void* plugin) { moma::plugin::Exports<decltype(&(make))>::close(plugin); }                  \
  void* moma_plugin_start(void* plugin, const moma_object_shape* objects, size_t num_objects, char* error,           \
                          size_t error_size) {                                                                       \
    return moma::plugin::Exports<decltype(&(make))>::start(plugin, objects, num_objects, error, error_size);         \
  }                                                                                                                  \
  int moma_plugin_step(void* controller, const moma_observation* observation, moma_step_result* result, char* error, \
                       size_t error_size) {                                                                          \
    return moma::plugin::Exports<decltype(&(make))>::step(controller, observation, result, error, error_size);       \
  }                                                                                                                  \
  void moma_plugin_stop(void* controller) { moma::plugin::Exports<decltype(&(make))>::stop(controller); }            \
  }
