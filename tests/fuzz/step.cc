// The control step with any robot, gains, states, goals and objects: a finite command within the limits, whatever
// comes. Robots and controllers with changed numbers are built once for each choice, few enough that all stay; an input
// chooses one of them, and what is seen at each of its steps.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <stdexcept>

#include "controller/config/controller_file.h"
#include "controller/config/json_node.h"
#include "controller/config/robot_file.h"
#include "controller/controller.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/draws.h"
#include "tests/fuzz/target.h"
#include "tests/fuzz/values.h"

namespace moma {
namespace {

constexpr double kPeriod = 0.02;
constexpr std::array<const char*, 4> kRobots = {"frankie", "panda", "frankie_omni", "ur5"};
constexpr std::array<const char*, 6> kControllers = {"holistic", "neo", "rrmc", "moma", "moma-safe", "moma-ahead"};
constexpr std::size_t kSettings = 16;  // of the numbers of robot and gains; building one takes as long as many steps
constexpr std::size_t kRobotSettings = 4;
// Checks of predictions in a step: with the files' hundreds all else would wait for them. More in the last setting.
constexpr const char* kFewChecks = "4";
constexpr const char* kMoreChecks = "40";

/// Numbers that are multiplied, so that a file's structure stays while its numbers do not.
void scale(config::Node& node, fuzz::Bytes& bytes, std::size_t one_of) {
  static constexpr std::array<double, 8> kFactors = {0.0, 1e-6, 0.1, 0.5, 2.0, 10.0, 1e6, -1.0};
  for (config::Node& item : node.items) scale(item, bytes, one_of);
  for (auto& [key, inner] : node.entries) scale(inner, bytes, one_of);
  if (node.kind != config::Node::Kind::kScalar || node.quoted || bytes.below(one_of) != 0) return;
  char* end = nullptr;
  const double number = std::strtod(node.scalar.c_str(), &end);
  if (end == node.scalar.c_str() || *end != '\0' || !std::isfinite(number)) return;
  node.scalar = config::number_to_json(number * kFactors[bytes.below(kFactors.size())]).dump();
}

/// A file with the numbers of this setting; as it is in setting 0.
config::Node file(const std::string& name, std::size_t setting, std::size_t one_of) {
  config::Node node = config::load_yaml(name);
  std::vector<std::uint8_t> seeds(4096);
  fuzz::Draws draws{setting};
  for (std::uint8_t& seed : seeds) seed = static_cast<std::uint8_t>(draws.next());
  fuzz::Bytes numbers(seeds.data(), seeds.size());
  if (setting > 0) scale(node, numbers, one_of);
  return node;
}

std::shared_ptr<const RobotModel> robot_of(std::size_t robot, std::size_t setting) {
  static std::map<std::array<std::size_t, 2>, std::shared_ptr<const RobotModel>> built;
  const auto [place, fresh] = built.try_emplace({robot, setting});
  if (!fresh) return place->second;
  try {
    place->second =
        config::read_robot(file(std::string("configs/robots/") + kRobots[robot] + ".yaml", setting, 20), "").model;
  } catch (const config::ConfigError&) {
  }
  return place->second;
}

/// nullptr where robot or gains are refused.
Controller* controller_of(fuzz::Bytes& bytes) {
  static std::map<std::array<std::size_t, 3>, std::unique_ptr<Controller>> built;
  const std::array<std::size_t, 3> choice = {bytes.below(kRobots.size()), bytes.below(kControllers.size()),
                                             bytes.below(kSettings)};
  if (const auto found = built.find(choice); found != built.end()) return found->second.get();
  std::unique_ptr<Controller> controller;
  if (const auto robot = robot_of(choice[0], choice[2] % kRobotSettings); robot != nullptr) {
    const std::string name = std::string("configs/controllers/") + kControllers[choice[1]] + ".yaml";
    try {
      std::vector<std::string> warnings;
      config::Node gains = file(name, choice[2], 4);
      if (gains.find("plan") != nullptr)
        config::set_value(gains, "plan.budget", choice[2] + 1 < kSettings ? kFewChecks : kMoreChecks);
      const auto params = config::read_controller(gains, "", *robot, kPeriod, warnings);
      controller = std::make_unique<Controller>(robot, params, kPeriod);
    } catch (const config::ConfigError&) {
    } catch (const std::invalid_argument&) {
    }
  }
  return (built[choice] = std::move(controller)).get();
}

void disturb(Observation& seen, fuzz::Bytes& bytes) {
  const auto any = [&](auto&& vector) {
    vector[static_cast<Eigen::Index>(bytes.below(static_cast<std::size_t>(vector.size())))] = fuzz::value(bytes);
  };
  switch (bytes.below(9)) {
    case 0:
      return any(seen.base);
    case 1:
      return any(seen.q);
    case 2:
      return any(seen.qdot);
    case 3:
      return any(seen.goal.X_WG.translation());
    case 4:
      return any(seen.goal.V_WG_W);
    case 5:
      seen.goal.X_WG.linear()(static_cast<Eigen::Index>(bytes.below(3)), static_cast<Eigen::Index>(bytes.below(3))) =
          fuzz::value(bytes);
      return;
    case 6:
      seen.time = fuzz::value(bytes);
      return;
    default:
      break;
  }
  if (seen.objects.empty()) return;
  ObjectState& object = seen.objects[bytes.below(seen.objects.size())];
  switch (bytes.below(4)) {
    case 0:
      return any(object.X_WO.translation());
    case 1:
      return any(object.V_WO_W);
    case 2:
      object.visible = !object.visible;
      return;
    default:
      object.X_WO.linear()(static_cast<Eigen::Index>(bytes.below(3)), static_cast<Eigen::Index>(bytes.below(3))) =
          fuzz::value(bytes);
  }
}

void check(const Controller& controller, const StepResult& result) {
  const VectorX limits = controller.model().velocity_limits();
  for (Eigen::Index i = 0; i < result.command.size(); ++i) {
    const double v = result.command[i];
    if (std::isfinite(v) && std::abs(v) <= limits[i] * (1.0 + 1e-6) + 1e-9) continue;
    std::fprintf(stderr, "command %ld is %g, its limit %g; status %d, fallback %d\n", static_cast<long>(i), v,
                 limits[i], static_cast<int>(result.status), static_cast<int>(result.fallback));
    std::abort();
  }
}

std::vector<ObjectShape> objects_of(fuzz::Bytes& bytes) {
  static constexpr std::array<double, 6> kSizes = {1e-6, 0.02, 0.1, 0.5, 3.0, 1e3};
  std::vector<ObjectShape> objects(bytes.below(5));
  for (ObjectShape& object : objects) {
    object.name = "o";
    object.shape.kind = static_cast<ShapeKind>(bytes.below(4));
    for (double& size : object.shape.size) size = kSizes[bytes.below(kSizes.size())];
  }
  return objects;
}

}  // namespace
}  // namespace moma

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moma;
  fuzz::Bytes bytes(data, size);
  Controller* controller = controller_of(bytes);
  if (controller == nullptr) return 0;
  const std::vector<ObjectShape> objects = objects_of(bytes);
  controller->reset(objects);
  StepResult result;
  controller->prepare(result);
  const RobotModel& robot = controller->model();
  Observation seen;
  seen.q = robot.ready;
  seen.qdot = VectorX::Zero(robot.num_velocities());
  seen.goal.X_WG.translation() = Vector3(2.0, 0.5, 0.8);
  seen.objects.resize(objects.size());
  for (std::size_t i = 0; i < objects.size(); ++i)
    seen.objects[i].X_WO.translation() = Vector3(0.6 + 0.4 * static_cast<double>(i), 0.2, 0.5);
  const std::size_t steps = 1 + bytes.below(3);
  for (std::size_t k = 0; k < steps; ++k) {
    for (std::size_t n = bytes.below(4); n > 0; --n) disturb(seen, bytes);
    controller->step(seen, result);
    check(*controller, result);
    seen.time += kPeriod;
    if (result.command.size() == seen.qdot.size()) seen.qdot = result.command;
  }
  return 0;
}
