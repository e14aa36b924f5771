#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "controller/controller_core.h"
#include "tests/controller/qp_robots.h"

namespace moma::test {

/// A controller that is ready for steps of 20 ms among the objects.
struct Rig {
  std::shared_ptr<const RobotModel> model;
  std::vector<ObjectShape> shapes;
  ControllerCore controller;
  StepResult result;

  Rig(std::shared_ptr<const RobotModel> m, ControllerParams p, std::vector<ObjectShape> s = {})
      : model(std::move(m)), shapes(std::move(s)), controller(model, std::move(p), 0.02) {
    controller.reset(shapes);
    controller.prepare(result);
  }
  void step(const Observation& o) { controller.step(o, result); }

  /// Sum of the last problem's terms at its solution: the cost.
  double sum_of_terms() const {
    double sum = 0.0;
    for (const TermCost& term : controller.term_costs()) sum += term.value;
    return sum;
  }

  /// How many rows of the last problem are of this kind.
  int rows(RowKind kind) const {
    int count = 0;
    for (int r = 0; r < controller.problem().rows; ++r)
      count += controller.problem().ids[static_cast<std::size_t>(r)].kind == kind ? 1 : 0;
    return count;
  }
};

}  // namespace moma::test
