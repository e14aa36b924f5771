#include "eval/trial/observe.h"

namespace moma {

void observe(const PlantState& truth, const std::vector<ObjectState>& objects, const GoalState& goal, double t,
             Observation& observation) {
  observation.time = t;
  observation.base = truth.base;
  observation.q = truth.q;
  observation.qdot = truth.qdot;
  observation.goal = goal;
  observation.objects = objects;
}

}  // namespace moma
