#pragma once

#include <string>
#include <vector>

#include "controller/config/node.h"
#include "controller/config/reader.h"
#include "controller/config/robot_file.h"
#include "controller/memory.h"
#include "controller/params.h"
#include "controller/step.h"

namespace moma {

/// One control step, frozen: what `moma solve CASE.json` reads (format: controller.md, "The case file").
struct ControlCase {
  config::LoadedRobot robot;
  ControllerParams controller;
  double control_period = 0.02;  ///< [s]
  std::vector<ObjectShape> objects;
  ControllerMemory memory;            ///< what the controller remembers of earlier steps; by default nothing
  bool has_plan = false;              ///< memory.plan is part of it
  Observation observation;            ///< observation.objects in the order of `objects`
  std::vector<std::string> warnings;  ///< of the robot and the controller, for a person
};

/// Reads a case file, JSON or YAML. Paths in it are relative to the file.
/// Throws config::ConfigError naming file, line, column and key: unreadable, unknown or missing keys, wrong types and
/// sizes, numbers that are not finite, quaternions off unit length by more than 1e-3 (others are normalised).
ControlCase read_case(const fs::path& file);

/// The same from a value already read.
ControlCase read_case(const config::Node& root);

/// One entry of `objects`: {name, shape, size, position, quaternion or rotation, twist (or velocity), visible,
/// covariance}, of a convex shape vertices and triangles in place of a size; any further key is an error. `name` may be
/// absent: "object" and its index then.
void read_object(const config::Node& node, const std::string& key, int index, const RobotModel& model,
                 ObjectShape& shape, ObjectState& state);

/// The file that read_case() takes back to the same bits: robot and controller as they were resolved, rotations as
/// matrices, what is remembered in `state`.
Json case_to_json(const ControlCase& control_case);

}  // namespace moma
