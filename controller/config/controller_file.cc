#include "controller/config/controller_file.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "controller/config/read_described.h"
#include "controller/config/reader.h"
#include "controller/config/text_file.h"
#include "controller/config/write_described.h"
#include "controller/params_described.h"

namespace moma::config {
namespace {

// The place of the deepest part of a dotted key that was written.
Mark mark_of(const Node& node, std::string_view key) {
  const std::size_t dot = std::min(key.find('.'), key.size());
  const Node* next = node.find(key.substr(0, dot));
  if (next == nullptr) return node.mark;
  return dot == key.size() ? next->mark : mark_of(*next, key.substr(dot + 1));
}

}  // namespace

ControllerParams read_controller(const Node& node, const std::string& key, const RobotModel& model,
                                 double control_period, std::vector<std::string>& warnings) {
  if (node.kind == Node::Kind::kScalar) {
    const fs::path file = directory_of(node.mark) / node.scalar;
    std::error_code error;
    if (!fs::is_regular_file(file, error))
      fail(node.mark, key,
           "found '" + node.scalar + "', expected a map of parameters or the path of a controller file (no file " +
               file.string() + ")");
    const Node inside = load_yaml(file);
    if (inside.kind == Node::Kind::kScalar)
      fail(inside.mark, "", "found '" + shortened(inside.scalar) + "', expected a map of parameters");
    return read_controller(inside, "", model, control_period, warnings);
  }
  ControllerParams params;
  read_described(node, key, params, {model.num_joints(), model.num_velocities()});
  params = resolved(std::move(params), model);
  for (const ParamsIssue& issue : check_params(params, model, control_period)) {
    const std::string full = key.empty() ? issue.key : key + "." + issue.key;
    if (!issue.warning) fail(mark_of(node, issue.key), full, issue.message);
    warnings.push_back(placed(mark_of(node, issue.key), full, "warning: " + issue.message));
  }
  return params;
}

Json to_json(const ControllerParams& params) { return write_described(params); }

}  // namespace moma::config
