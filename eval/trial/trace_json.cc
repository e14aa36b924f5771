#include "eval/trial/trace_json.h"

#include <cmath>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

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

class SampleJson {
 public:
  explicit SampleJson(const Sample& sample) : sample_(sample) {}
  ordered_json json = ordered_json::object();
  template <class M>
  void member(std::string_view name, M Sample::*member, const SampleColumn&) {
    json[std::string(name)] = written(sample_.*member);
  }

 private:
  template <class M>
  static ordered_json written(const M& value) {
    if constexpr (std::is_same_v<M, double>) {
      return number(value);
    } else if constexpr (std::is_arithmetic_v<M>) {
      return value;
    } else if constexpr (std::is_enum_v<M>) {
      return to_string(value);
    } else if constexpr (Described<M>) {
      return config::write_described(value);
    } else {
      return numbers(value);
    }
  }
  const Sample& sample_;
};

ordered_json sample_json(const Sample& sample) {
  SampleJson writer(sample);
  describe(writer, Of<Sample>{});
  return std::move(writer.json);
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
