#include "controller/config/controller_file.h"

#include <algorithm>
#include <filesystem>

#include "controller/config/controller_escape.h"
#include "controller/config/json_node.h"
#include "controller/config/reader.h"
#include "controller/solver/solver.h"

namespace moma::config {
namespace {

using Json = nlohmann::ordered_json;

bool is_word(const Node* node, std::string_view word) {
  return node != nullptr && node->kind == Node::Kind::kScalar && node->scalar == word;
}

// A number for every entry, or a list with one each.
void read_vector(MapReader& in, std::string_view name, VectorX& value, int size, const Range& range) {
  const Node* node = in.get(name);
  if (node == nullptr) return;
  if (node->kind != Node::Kind::kSequence) {
    value = VectorX::Constant(size, read_number(*node, in.key_of(name), range));
    return;
  }
  const std::vector<double> list = read_numbers(*node, in.key_of(name), size, range);
  value = Eigen::Map<const VectorX>(list.data(), size);
}

void read_vector(MapReader& in, std::string_view name, Vector6& value, const Range& range) {
  VectorX full = value;
  read_vector(in, name, full, 6, range);
  value = full;
}

// A number, or the word inverse_error.
void read_weight(MapReader& in, std::string_view name, Weight& weight) {
  const Node* node = in.get(name);
  if (node == nullptr) return;
  weight.inverse_error = is_word(node, "inverse_error");
  weight.value = 0.0;
  if (weight.inverse_error) return;
  if (node->kind == Node::Kind::kScalar && !node->scalar.empty() &&
      std::isalpha(static_cast<unsigned char>(node->scalar[0])))
    fail(node->mark, in.key_of(name), "found '" + node->scalar + "', expected inverse_error or a number of at least 0");
  weight.value = read_number(*node, in.key_of(name), Range::non_negative());
}

class Reader {
 public:
  Reader(const RobotModel& model, ControllerParams& params) : model_(model), p_(params) {}

  void read(const Node& node, const std::string& key) {
    MapReader in(node, key);
    in.read_enum<Method>(
        "method", p_.method,
        {{"qp", Method::kQp}, {"rrmc", Method::kRrmc}, {"park", Method::kPark}, {"baur", Method::kBaur}});
    with(in, "servo", [&](MapReader& m) {
      m.read("position", p_.servo.position, Range::non_negative());
      m.read("orientation", p_.servo.orientation, Range::non_negative());
      m.read("max_linear", p_.servo.max_linear, Range::positive_or_inf());
      m.read("max_angular", p_.servo.max_angular, Range::positive_or_inf());
      read_vortex(m, p_.servo.vortex);
    });
    with(in, "error_norm", [&](MapReader& m) {
      m.read_enum<ErrorNormKind>(
          "kind", p_.error_norm.kind,
          {{"euclidean", ErrorNormKind::kEuclidean}, {"l1", ErrorNormKind::kL1}, {"pose", ErrorNormKind::kPose}});
      m.read("min", p_.error_norm.min, Range::positive());
      m.read("max", p_.error_norm.max, Range::positive());
      m.read("scale", p_.error_norm.scale, Range::non_negative());
    });
    read_weight(in, "base_weight", p_.base_weight);
    read_vector(in, "lambda_q", p_.lambda_q, model_.num_joints(), Range::non_negative());
    slack(in);
    read_vector(in, "tracking_band", p_.tracking_band, Range::non_negative());
    in.read("k_epsilon", p_.k_epsilon, Range::non_negative());
    with(in, "manipulability", [&](MapReader& m) {
      m.read("weight", p_.manipulability.weight, Range::non_negative());
      m.read_enum<ManipulabilityRows>("rows", p_.manipulability.rows,
                                      {{"translation", ManipulabilityRows::kTranslation},
                                       {"rotation", ManipulabilityRows::kRotation},
                                       {"all", ManipulabilityRows::kAll}});
    });
    joint_limits(in);
    collision(in);
    with(in, "acceleration", [&](MapReader& m) {
      read_vector(m, "weight", p_.acceleration_weight, model_.num_velocities(), Range::non_negative());
    });
    posture(in);
    with(in, "limits", [&](MapReader& m) {
      read_vector(m, "acceleration", p_.acceleration_limit, model_.num_velocities(), Range::positive_or_inf());
    });
    output_scaling(in);
    read_escape(in, p_.escape);
    solver(in);
    in.finish();
  }

 private:
  template <typename Body>
  void with(MapReader& in, std::string_view name, Body body) {
    const Node* node = in.get(name);
    if (node == nullptr) return;
    MapReader m(*node, in.key_of(name));
    body(m);
    m.finish();
  }

  void slack(MapReader& in) {
    if (is_word(in.get("slack"), "none")) {
      p_.slack.enabled = false;
      return;
    }
    with(in, "slack", [&](MapReader& m) {
      read_weight(m, "weight", p_.slack.weight);
      read_vector(m, "limit", p_.slack.limit, Range::positive_or_inf());
    });
  }

  void joint_limits(MapReader& in) {
    JointLimitParams& j = p_.joint_limits;
    if (is_word(in.get("joint_limits"), "none")) {
      j.method = JointLimitMethod::kNone;
      return;
    }
    with(in, "joint_limits", [&](MapReader& m) {
      m.read_enum<JointLimitMethod>("method", j.method,
                                    {{"source", JointLimitMethod::kSource},
                                     {"damper", JointLimitMethod::kDamper},
                                     {"none", JointLimitMethod::kNone}});
      if (is_word(m.get("margin"), "auto")) {
        j.auto_margin = true;
      } else if (m.get("margin") != nullptr) {
        j.auto_margin = false;
        read_vector(m, "margin", j.margin, model_.num_joints(), Range::positive());
      }
      m.read("influence", j.influence, Range::positive());
      m.read("stop", j.stop, Range::non_negative());
      m.read("gain", j.gain, Range::positive());
    });
  }

  static void damper(MapReader& m, DamperParams& d) {
    m.read("enabled", d.enabled);
    m.read("influence", d.influence, Range::positive());
    m.read("stop", d.stop, Range::non_negative());
    m.read("gain", d.gain, Range::positive());
  }

  void collision(MapReader& in) {
    with(in, "collision", [&](MapReader& m) {
      damper(m, p_.collision.object);
      m.read("max_pairs", p_.collision.max_pairs, 0, 10000);
      m.read("end_rows", p_.collision.end_rows, Range::non_negative());
      passing(m);
      with(m, "floor", [&](MapReader& f) { damper(f, p_.collision.floor); });
      with(m, "self", [&](MapReader& s) { damper(s, p_.collision.self); });
    });
  }

  void passing(MapReader& in) {
    PassingParams& p = p_.collision.passing;
    if (is_word(in.get("passing"), "none")) return;
    with(in, "passing", [&](MapReader& m) {
      p.enabled = true;
      m.read("enabled", p.enabled);
      m.read("horizon", p.horizon, Range::positive());
      m.read("clearance", p.clearance, Range::non_negative());
    });
  }

  void posture(MapReader& in) {
    with(in, "posture", [&](MapReader& m) {
      m.read("weight", p_.posture.weight, Range::non_negative());
      m.read("gain", p_.posture.gain, Range::non_negative());
      const Node* target = m.get("target");
      p_.posture.ready = target == nullptr || is_word(target, "ready");
      if (p_.posture.ready) return;
      if (target->kind != Node::Kind::kSequence) {
        fail(target->mark, m.key_of("target"),
             "expected ready or a list of " + std::to_string(model_.num_joints()) + " joint values");
      }
      read_vector(m, "target", p_.posture.target, model_.num_joints(), Range::any());
    });
  }

  void output_scaling(MapReader& in) {
    OutputScalingParams& s = p_.output_scaling;
    const Node* node = in.get("output_scaling");
    if (node == nullptr || is_word(node, "none")) return;
    with(in, "output_scaling", [&](MapReader& m) {
      s.enabled = true;
      m.read("far", s.far, Range::positive());
      m.read("near", s.near, Range::positive());
      m.read("switch", s.switch_distance, Range::positive());
    });
  }

  void solver(MapReader& in) {
    in.read_enum<SolverKind>(
        "solver", p_.solver,
        {{"daqp", SolverKind::kDaqp}, {"qpoases", SolverKind::kQpoases}, {"eiquadprog", SolverKind::kEiquadprog}});
    const std::vector<SolverKind> built = available_solvers();
    if (std::find(built.begin(), built.end(), p_.solver) != built.end()) return;
    std::string names;
    for (const SolverKind kind : built) names += (names.empty() ? "" : ", ") + std::string(to_string(kind));
    in.fail_at("solver",
               "found '" + std::string(to_string(p_.solver)) + "', which this build was made without; it has " + names);
  }

  const RobotModel& model_;
  ControllerParams& p_;
};

// The place of the deepest part of a dotted key that was written.
Mark mark_of(const Node& root, const std::string& key) {
  const Node* node = &root;
  std::size_t start = 0;
  while (start <= key.size()) {
    const std::size_t dot = std::min(key.find('.', start), key.size());
    const Node* next = node->find(std::string_view(key).substr(start, dot - start));
    if (next == nullptr) break;
    node = next;
    start = dot + 1;
  }
  return node->mark;
}

std::string placed(const Mark& mark, const std::string& key, const std::string& message) {
  try {
    fail(mark, key, message);
  } catch (const ConfigError& e) {
    return e.what();
  }
}

template <typename Vector>
Json vector_json(const Vector& v) {
  if (v.size() > 0 && (v.array() == v[0]).all()) return number_to_json(v[0]);
  Json list = Json::array();
  for (Eigen::Index i = 0; i < v.size(); ++i) list.push_back(number_to_json(v[i]));
  return list;
}

Json weight_json(const Weight& weight) {
  return weight.inverse_error ? Json("inverse_error") : number_to_json(weight.value);
}

Json damper_json(const DamperParams& d) {
  return {{"enabled", d.enabled},
          {"influence", number_to_json(d.influence)},
          {"stop", number_to_json(d.stop)},
          {"gain", number_to_json(d.gain)}};
}

const char* name_of(Method m) {
  switch (m) {
    case Method::kQp:
      return "qp";
    case Method::kRrmc:
      return "rrmc";
    case Method::kPark:
      return "park";
    case Method::kBaur:
      return "baur";
  }
  return "?";
}

const char* name_of(ErrorNormKind k) {
  switch (k) {
    case ErrorNormKind::kEuclidean:
      return "euclidean";
    case ErrorNormKind::kL1:
      return "l1";
    case ErrorNormKind::kPose:
      return "pose";
  }
  return "?";
}

const char* name_of(ManipulabilityRows r) {
  switch (r) {
    case ManipulabilityRows::kTranslation:
      return "translation";
    case ManipulabilityRows::kRotation:
      return "rotation";
    case ManipulabilityRows::kAll:
      return "all";
  }
  return "?";
}

const char* name_of(JointLimitMethod m) {
  switch (m) {
    case JointLimitMethod::kNone:
      return "none";
    case JointLimitMethod::kSource:
      return "source";
    case JointLimitMethod::kDamper:
      return "damper";
  }
  return "?";
}

}  // namespace

ControllerParams read_controller(const Node& node, const std::string& key, const RobotModel& model,
                                 double control_period, std::vector<std::string>& warnings) {
  if (node.kind == Node::Kind::kScalar) {
    const std::filesystem::path file = std::filesystem::path(node.mark.file).parent_path() / node.scalar;
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error))
      fail(node.mark, key,
           "found '" + node.scalar + "', expected a map of parameters or the path of a controller file (no file " +
               file.string() + ")");
    return read_controller(load_yaml(file), "", model, control_period, warnings);
  }
  ControllerParams params;
  Reader(model, params).read(node, key);
  params = resolved(std::move(params), model);
  for (const ParamsIssue& issue : check_params(params, model, control_period)) {
    const std::string full = key.empty() ? issue.key : key + "." + issue.key;
    if (!issue.warning) fail(mark_of(node, issue.key), full, issue.message);
    warnings.push_back(placed(mark_of(node, issue.key), full, "warning: " + issue.message));
  }
  return params;
}

nlohmann::ordered_json to_json(const ControllerParams& p) {
  Json j;
  j["method"] = name_of(p.method);
  j["servo"] = {{"position", number_to_json(p.servo.position)},
                {"orientation", number_to_json(p.servo.orientation)},
                {"max_linear", number_to_json(p.servo.max_linear)},
                {"max_angular", number_to_json(p.servo.max_angular)},
                {"vortex", to_json(p.servo.vortex)}};
  j["error_norm"] = {{"kind", name_of(p.error_norm.kind)},
                     {"min", number_to_json(p.error_norm.min)},
                     {"max", number_to_json(p.error_norm.max)},
                     {"scale", number_to_json(p.error_norm.scale)}};
  j["base_weight"] = weight_json(p.base_weight);
  j["lambda_q"] = vector_json(p.lambda_q);
  if (p.slack.enabled)
    j["slack"] = {{"weight", weight_json(p.slack.weight)}, {"limit", vector_json(p.slack.limit)}};
  else
    j["slack"] = "none";
  j["tracking_band"] = vector_json(p.tracking_band);
  j["k_epsilon"] = number_to_json(p.k_epsilon);
  j["manipulability"] = {{"weight", number_to_json(p.manipulability.weight)}, {"rows", name_of(p.manipulability.rows)}};
  j["joint_limits"] = {{"method", name_of(p.joint_limits.method)},
                       {"margin", p.joint_limits.auto_margin ? Json("auto") : vector_json(p.joint_limits.margin)},
                       {"influence", number_to_json(p.joint_limits.influence)},
                       {"stop", number_to_json(p.joint_limits.stop)},
                       {"gain", number_to_json(p.joint_limits.gain)}};
  j["collision"] = damper_json(p.collision.object);
  j["collision"]["max_pairs"] = p.collision.max_pairs;
  j["collision"]["end_rows"] = number_to_json(p.collision.end_rows);
  if (p.collision.passing.enabled) {  // off, nothing: the keys of trials without these rows stay what they were
    j["collision"]["passing"] = {{"horizon", number_to_json(p.collision.passing.horizon)},
                                 {"clearance", number_to_json(p.collision.passing.clearance)}};
  }
  j["collision"]["floor"] = damper_json(p.collision.floor);
  j["collision"]["self"] = damper_json(p.collision.self);
  j["acceleration"] = {{"weight", vector_json(p.acceleration_weight)}};
  j["posture"] = {{"weight", number_to_json(p.posture.weight)}, {"gain", number_to_json(p.posture.gain)}};
  if (p.posture.ready) {
    j["posture"]["target"] = "ready";
  } else {
    Json list = Json::array();
    for (const double v : p.posture.target) list.push_back(number_to_json(v));
    j["posture"]["target"] = std::move(list);
  }
  j["limits"] = {{"acceleration", vector_json(p.acceleration_limit)}};
  if (p.output_scaling.enabled) {
    j["output_scaling"] = {{"far", number_to_json(p.output_scaling.far)},
                           {"near", number_to_json(p.output_scaling.near)},
                           {"switch", number_to_json(p.output_scaling.switch_distance)}};
  } else {
    j["output_scaling"] = "none";
  }
  j["escape"] = to_json(p.escape);
  j["solver"] = std::string(to_string(p.solver));
  return j;
}

}  // namespace moma::config
