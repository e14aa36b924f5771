#include "plugin/process/process_plugin.h"

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "controller/config/layout.h"
#include "controller/config/object_file.h"
#include "controller/describe/enumeration.h"
#include "controller/model/base_kind.h"
#include "plugin/border.h"
#include "plugin/host/library.h"

namespace moma {

extern const char* const kPythonRunner;  // runner.py, by CMake

ProcessCommand python_command(const std::string& interpreter, const fs::path& file, const std::string& class_name) {
  ProcessCommand command;
  command.arguments = {interpreter, "-c", kPythonRunner, file.string(), class_name};
  command.directory = file.parent_path();
  command.environment = {"PYTHONHASHSEED=0",  "PYTHONDONTWRITEBYTECODE=1", "PYTHONIOENCODING=utf-8",
                         "OMP_NUM_THREADS=1", "OPENBLAS_NUM_THREADS=1",    "MKL_NUM_THREADS=1"};
  command.files = {file};
  return command;
}

namespace {

using plugin::guarded;

/// The object behind moma_plugin_open()'s handle: one robot with one set of parameters.
struct Opened {
  std::shared_ptr<ProcessPool> pool;
  std::shared_ptr<const std::string> setup;
  double control_period = 0.0;
  std::size_t joints = 0;
  std::size_t velocities = 0;
};

/// And behind moma_plugin_start()'s: one motion.
struct Motion {
  const Opened* opened;
  std::unique_ptr<Session> session;
};

/// Docs: process-protocol.md, "setup".
std::string setup_text(const moma_plugin_setup& setup, Json robot, Json parameters) {
  const auto base = static_cast<BaseType>(setup.base_type);
  const std::vector<std::string> joints(setup.joints, setup.joints + setup.num_joints);
  std::vector<std::string> velocities(kind_of(base).velocities.begin(), kind_of(base).velocities.end());
  velocities.insert(velocities.end(), joints.begin(), joints.end());
  const auto numbers = [](const double* values, std::size_t count) {
    return config::layout::finite_or_null({values, count});
  };
  const Lengths lengths{static_cast<int>(setup.num_joints), static_cast<int>(setup.num_velocities)};
  const Json json = {{"protocol", kProcessProtocol},
                     {"base", std::string(to_string(base))},
                     {"joints", joints},
                     {"velocities", velocities},
                     {"lower", numbers(setup.lower, setup.num_joints)},
                     {"upper", numbers(setup.upper, setup.num_joints)},
                     {"ready", numbers(setup.ready, setup.num_joints)},
                     {"velocity_limits", numbers(setup.velocity_limits, setup.num_velocities)},
                     {"control_period", setup.control_period},
                     {"parameters", std::move(parameters)},
                     {"observation", config::layout_of<Observation>(lengths)},
                     {"details", config::layout_of<StepResult, Details>(lengths)},
                     {"robot", std::move(robot)}};
  return json.dump();
}

/// Docs: process-protocol.md, "reset".
std::string shapes_text(std::span<const moma_object_shape> shapes) {
  std::vector<ObjectShape> objects;
  for (const moma_object_shape& shape : shapes) objects.push_back(plugin::read_shape(shape));
  return config::objects_to_json(objects).dump();
}

void* open(const ProcessCommand& command, const moma_plugin_setup* setup, char* error, std::size_t size) {
  return guarded<void*>(nullptr, error, size, [&]() -> void* {
    auto opened = std::make_unique<Opened>();
    opened->pool = ProcessPool::of(command);
    opened->setup = std::make_shared<const std::string>(
        setup_text(*setup, Json::parse(setup->robot), Json::parse(setup->parameters)));
    opened->control_period = setup->control_period;
    opened->joints = setup->num_joints;
    opened->velocities = setup->num_velocities;
    opened->pool->give_back(opened->pool->take(opened->setup, opened->control_period));
    return opened.release();
  });
}

void* start(void* plugin, const moma_object_shape* shapes, std::size_t count, char* error, std::size_t size) {
  return guarded<void*>(nullptr, error, size, [&]() -> void* {
    const Opened& opened = *static_cast<Opened*>(plugin);
    auto motion = std::make_unique<Motion>();
    motion->opened = &opened;
    motion->session = opened.pool->take(opened.setup, opened.control_period);
    motion->session->reset(shapes_text({shapes, count}),
                           plugin::count_numbers(opened.joints, opened.velocities, count));
    return motion.release();
  });
}

int step(void* controller, const moma_observation* seen, moma_step_result* result, char* error, std::size_t size) {
  return guarded<int>(1, error, size, [&] {
    const Motion& motion = *static_cast<Motion*>(controller);
    motion.session->step(*seen, motion.opened->velocities, *result);
    return 0;
  });
}

void stop(void* controller) {
  const std::unique_ptr<Motion> motion(static_cast<Motion*>(controller));
  motion->opened->pool->give_back(std::move(motion->session));
}

void close(void* plugin) { delete static_cast<Opened*>(plugin); }

}  // namespace

std::shared_ptr<const Plugin> open_process(const ProcessCommand& command,
                                           std::shared_ptr<const config::LoadedRobot> robot, const Json& parameters,
                                           double control_period) {
  auto library = std::make_shared<PluginLibrary>();
  library->file = command.directory / command.arguments.front();
  library->functions = {[command](const moma_plugin_setup* setup, char* error, std::size_t size) {
                          return open(command, setup, error, size);
                        },
                        close, start, step, stop};
  return Plugin::open(std::move(library), std::move(robot), parameters, control_period);
}

const ProcessPool* processes_of(const Plugin& plugin) {
  if (plugin.library().functions.step != &step) return nullptr;
  return static_cast<const Opened*>(plugin.handle())->pool.get();
}

}  // namespace moma
