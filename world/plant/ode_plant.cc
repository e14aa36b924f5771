#include "world/plant/ode_plant.h"

#include <stdexcept>

namespace moma {

std::unique_ptr<Plant> make_ode_plant(std::shared_ptr<const RobotModel>, const World&, const SimulationConfig&) {
  throw std::runtime_error("simulation.mode: dynamic is not built yet");
}

}  // namespace moma
