#include <algorithm>
#include <ctime>
#include <limits>
#include <string>

#include "tests/world/probe/probe.h"
#include "world/plant/plant.h"

namespace moma::probe {
namespace {

using nlohmann::json;

Vector3 vector_of(const json& v) { return {v.at(0).get<double>(), v.at(1).get<double>(), v.at(2).get<double>()}; }

VectorX values_of(const json& values) {
  VectorX out(static_cast<Eigen::Index>(values.size()));
  for (Eigen::Index i = 0; i < out.size(); ++i) out[i] = values[static_cast<std::size_t>(i)].get<double>();
  return out;
}

ShapeKind kind_of(const std::string& name) {
  for (const ShapeKind kind : {ShapeKind::kSphere, ShapeKind::kBox, ShapeKind::kCylinder, ShapeKind::kCapsule})
    if (name == to_string(kind)) return kind;
  throw std::invalid_argument("shape '" + name + "' is none of sphere, box, cylinder, capsule");
}

World world_of(const RobotModel& model, const json& request) {
  World world;
  world.start.q = request.contains("q") ? values_of(request.at("q")) : model.ready;
  if (request.contains("base")) world.start.base = vector_of(request.at("base"));
  world.witness = world.start;
  for (const json& in : request.value("objects", json::array())) {
    WorldObject object;
    object.name = "object" + std::to_string(world.objects.size());
    object.shape.kind = kind_of(in.at("kind").get<std::string>());
    object.shape.size = vector_of(in.at("size"));
    const json& q = in.at("quaternion");
    set_pose(object, vector_of(in.at("position")), Eigen::Quaterniond(q.at(0), q.at(1), q.at(2), q.at(3)));
    if (in.contains("velocity")) {
      LinearMotion motion;
      motion.V_W.tail<3>() = vector_of(in.at("velocity"));
      object.motion = motion;
    }
    world.objects.push_back(object);
  }
  return world;
}

SimulationConfig simulation_of(const json& request) {
  SimulationConfig simulation;
  simulation.physics_step = request.value("step", simulation.physics_step);
  return simulation;
}

/// Least distance of a robot shape to an object, by the distance library; infinite without objects.
double clearance(const Kinematics& kinematics, const std::vector<ObjectState>& states, const World& world) {
  double least = std::numeric_limits<double>::infinity();
  for (const CollisionShape& shape : kinematics.model().shapes)
    for (std::size_t i = 0; i < world.objects.size(); ++i)
      least = std::min(least,
                       shape_distance(shape.shape, kinematics.X_WS(shape), world.objects[i].shape, states[i].X_WO).d);
  return least;
}

json contact_json(const RobotModel& model, const Contact& contact) {
  return {{"shape", model.shapes[static_cast<std::size_t>(contact.first)].name},
          {"other", contact.second},
          {"time", contact.time},
          {"depth", contact.depth},
          {"by_ode", contact.by_ode}};
}

}  // namespace

json drive(const json& request) {
  const auto model = robot_of(request);
  const World world = world_of(*model, request);
  const auto plant = make_plant(model, world, simulation_of(request));
  const double period = request.value("period", 0.02);
  const bool until_contact = request.value("until_contact", false);
  Kinematics kinematics(model);
  std::vector<ObjectState> states(world.objects.size());
  json out = {{"base", json::array()},
              {"q", json::array()},
              {"gaps", json::array()},
              {"contacts", json::array()},
              {"own_contacts", json::array()}};
  PlantReport report;
  double slip = 0.0;
  const auto look = [&] {
    kinematics.update(plant->state().base, plant->state().q);
    object_states(world, plant->time(), states);
    const double d = clearance(kinematics, states, world);
    out["gaps"].push_back(d);
    const PlantState& s = plant->state();
    out["base"].push_back({s.base.x(), s.base.y(), s.base.z()});
    out["q"].push_back(std::vector<double>(s.q.data(), s.q.data() + s.q.size()));
  };
  look();
  for (const json& command : request.at("commands")) {
    plant->advance(values_of(command), period, report);
    slip = std::max(slip, report.slip_max);
    look();
    for (const Contact& contact : report.contacts)
      out[contact.kind == PairKind::kObject ? "contacts" : "own_contacts"].push_back(contact_json(*model, contact));
    if (until_contact && !out["contacts"].empty()) break;
    // After a contact only: what an object that nothing stops does to an arm bolted to the world is not to be solved.
    if (report.diverged || report.tipped) throw std::runtime_error(report.reason);
  }
  out["slip"] = slip;
  return out;
}

json cost(const json& request) {
  const auto model = robot_of(request);
  const World world = world_of(*model, request);
  const SimulationConfig simulation = simulation_of(request);
  const auto plant = make_plant(model, world, simulation);
  const json& commands = request.at("commands");
  std::vector<VectorX> wanted;
  for (const json& command : commands) wanted.push_back(values_of(command));
  const double period = request.value("period", 0.02);
  PlantReport report;
  const auto seconds = [] {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  };
  const double before = seconds();
  for (const VectorX& command : wanted) {
    plant->advance(command, period, report);
    if (report.diverged) throw std::runtime_error(report.reason);
  }
  const double spent = seconds() - before;
  const double steps = static_cast<double>(wanted.size()) * std::round(period / simulation.physics_step);
  return {{"us_per_step", 1e6 * spent / steps}};
}

}  // namespace moma::probe
