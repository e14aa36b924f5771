#include "world/plant/plant.h"

#include <cmath>
#include <stdexcept>

namespace moma {

void check_command(const RobotModel& model, const VectorX& command, double duration) {
  if (command.size() != model.num_velocities())
    throw std::invalid_argument("a command of " + std::to_string(command.size()) + " velocities for a robot of " +
                                std::to_string(model.num_velocities()));
  if (!(duration > 0.0) || !std::isfinite(duration))
    throw std::invalid_argument("a command for " + std::to_string(duration) + " s");
  if (command.allFinite()) return;
  const std::vector<std::string> names = model.velocity_names();
  for (Eigen::Index i = 0; i < command.size(); ++i)
    if (!std::isfinite(command[i]))
      throw std::invalid_argument("the command for '" + names[static_cast<std::size_t>(i)] +
                                  "' is not a finite number");
}

void Plant::carry(const std::optional<Carried>&) {
  throw std::runtime_error("this plant carries no objects, which the world asks for (held, take)");
}

std::shared_ptr<const RobotModel> with_carried(const std::shared_ptr<const RobotModel>& empty, const RobotModel& now,
                                               const Isometry& X_WE, const std::optional<Carried>& carried,
                                               World& world) {
  if (now.carried && !carried)
    world.objects[static_cast<std::size_t>(now.carried->object)].X_WO = X_WE * now.carried->X_EO;
  if (!carried) return empty;
  auto model = with_spare_shape(*empty);
  carry(*model, carried, &world.objects[static_cast<std::size_t>(carried->object)].shape);
  std::erase_if(model->self_pairs, [&](const SelfPair& pair) { return model->may_touch(pair); });
  return model;
}

std::unique_ptr<Plant> make_plant(std::shared_ptr<const RobotModel> model, const World& world,
                                  const SimulationConfig& simulation, const PlantConditions& conditions) {
  if (world.start.q.size() != model->num_joints())
    throw std::runtime_error("the world's start has " + std::to_string(world.start.q.size()) + " joint values, robot " +
                             model->name + " has " + std::to_string(model->num_joints()) + " joints");
  if (simulation.mode == SimulationMode::kKinematic)
    return make_kinematic_plant(std::move(model), world, simulation.joint_limits == AtJointLimit::kClamp);
  return make_ode_plant(std::move(model), world, simulation, conditions);
}

}  // namespace moma
