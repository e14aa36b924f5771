#pragma once

#include <memory>

#include "controller/config/robot_file.h"
#include "plugin/host/plugin.h"
#include "plugin/process/pool.h"

namespace moma {

/// Opens a controller in processes of its own as a Plugin: behind the same functions as a shared library, with the same
/// checks of commands. Starts a process and lets it check the parameters. Throws PluginError.
std::shared_ptr<const Plugin> open_process(const ProcessCommand& command,
                                           std::shared_ptr<const config::LoadedRobot> robot, const Json& parameters,
                                           double control_period);

/// The processes behind a plugin; nullptr where it is a shared library.
const ProcessPool* processes_of(const Plugin& plugin);

}  // namespace moma
