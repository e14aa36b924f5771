// Answers requests about the ODE plant: one JSON object a line in, one out. tests/world/mujoco_test.py and
// bench/physics_against_mujoco.py ask; a person can, too:
//
//   echo '{"ask": "model", "robot": "configs/robots/frankie.yaml"}' | build/tests/physics_probe
#include <exception>
#include <iostream>
#include <string>

#include "tests/world/probe/probe.h"

namespace {

nlohmann::json answer(const nlohmann::json& request) {
  using namespace moma::probe;
  const auto ask = request.at("ask").get<std::string>();
  if (ask == "model") return model(request);
  if (ask == "gravity") return gravity(request);
  if (ask == "torque") return torque(request);
  if (ask == "drive") return drive(request);
  if (ask == "cost") return cost(request);
  throw std::invalid_argument("ask '" + ask + "' is none of model, gravity, torque, drive, cost");
}

}  // namespace

int main() {
  std::string line;
  while (std::getline(std::cin, line)) {
    nlohmann::json out;
    try {
      out = answer(nlohmann::json::parse(line));
    } catch (const std::exception& error) {
      out = {{"error", error.what()}};
    }
    std::cout << out.dump() << std::endl;
  }
}
