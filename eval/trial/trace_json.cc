#include "eval/trial/trace_json.h"

#include <cmath>
#include <span>

#include "controller/config/write_described.h"
#include "eval/trial/spec_file.h"
#include "world/sensing/disturbances_file.h"
#include "world/world_json.h"

namespace moma {
namespace {

using nlohmann::ordered_json;

ordered_json number(double value) {
  if (std::isnan(value)) return nullptr;
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

template <typename Vector>
ordered_json numbers(const Vector& vector) {
  ordered_json list = ordered_json::array();
  for (Eigen::Index i = 0; i < vector.size(); ++i) list.push_back(number(vector[i]));
  return list;
}

ordered_json sample_json(const Sample& sample) {
  ordered_json json = ordered_json::object();
  json["t"] = sample.t;
  json["base"] = numbers(sample.base);
  json["q"] = numbers(sample.q);
  json["qdot"] = numbers(sample.qdot);
  json["command"] = numbers(sample.command);
  json["error"] = numbers(sample.error);
  json["slack"] = numbers(sample.slack);
  json["manipulability"] = number(sample.manipulability);
  json["least_distance"] = number(sample.least_distance);
  json["status"] = to_string(sample.status);
  json["fallback"] = to_string(sample.fallback);
  json["escape"] = config::write_described(sample.escape);
  return json;
}

}  // namespace

ordered_json trace_json(const TrialSpec& spec, const World& world, const TrialOutput& output,
                        const std::string& trial) {
  ordered_json json = ordered_json::object();
  json["trial"] = trial;
  json["outcome"] = to_string(output.row.outcome);
  json["robot"] = spec.robot->resolved;
  json["success"] = to_json(spec.success);
  json["stuck"] = to_json(spec.stuck);
  json["infeasible"] = to_json(spec.infeasible);
  json["controller"] = spec.controller_resolved;
  json["world"] = to_json(world);
  json["simulation"] = to_json(spec.simulation);
  if (any(spec.disturbances)) json["disturbances"] = to_json(spec.disturbances);
  ordered_json& samples = json["samples"] = ordered_json::array();
  for (const Sample& sample : output.trace) samples.push_back(sample_json(sample));
  return json;
}

}  // namespace moma
