#include "controller/case/case_file.h"

#include <cmath>
#include <set>
#include <utility>

#include "controller/case/plan_case.h"
#include "controller/config/controller_file.h"
#include "controller/config/read_described.h"
#include "controller/config/reader.h"
#include "controller/safe/predictor.h"

namespace moma {
namespace {

using config::MapReader;
using config::Node;
using config::Range;

constexpr double kQuaternionTolerance = 1e-3;  // hand-written quaternions have four digits

Vector3 read_vector3(const Node& node, const std::string& key) {
  const std::vector<double> v = config::read_numbers(node, key, 3);
  return {v[0], v[1], v[2]};
}

Vector6 read_vector6(const Node& node, const std::string& key) {
  const std::vector<double> v = config::read_numbers(node, key, 6);
  return Eigen::Map<const Vector6>(v.data());
}

Eigen::Quaterniond read_quaternion(const Node& node, const std::string& key) {
  const std::vector<double> v = config::read_numbers(node, key, 4);
  const Eigen::Vector4d wxyz(v[0], v[1], v[2], v[3]);
  const double norm = wxyz.stableNorm();
  if (!(std::abs(norm - 1.0) <= kQuaternionTolerance)) {
    config::fail(
        node.mark, key,
        "found length " + std::to_string(norm) + ", expected a unit quaternion [w, x, y, z] (length 1 within 0.001)");
  }
  return Eigen::Quaterniond(v[0] / norm, v[1] / norm, v[2] / norm, v[3] / norm);
}

std::string join(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

// One number per name; the message lists the names, for the order is easy to get wrong.
VectorX read_named(const Node& node, const std::string& key, const std::vector<std::string>& names) {
  const int count = static_cast<int>(names.size());
  if (node.kind != Node::Kind::kSequence || static_cast<int>(node.items.size()) != count) {
    const std::string found =
        node.kind == Node::Kind::kSequence ? "a list of " + std::to_string(node.items.size()) : std::string("no list");
    config::fail(node.mark, key, "found " + found + ", expected " + std::to_string(count) + " numbers: " + join(names));
  }
  const std::vector<double> v = config::read_numbers(node, key, count);
  return Eigen::Map<const VectorX>(v.data(), count);
}

Shape read_shape(MapReader& in) {
  Shape shape;
  in.require("shape", "sphere, box, cylinder or capsule");
  in.read_enum<ShapeKind>("shape", shape.kind, kPrimitiveShapes);
  const Node& size = in.require("size", "the shape's size in metres");
  const std::string key = in.key_of("size");
  const int count = num_sizes(shape.kind);
  if (size.kind != Node::Kind::kSequence || static_cast<int>(size.items.size()) != count) {
    static constexpr const char* kWanted[] = {"[radius]", "[x, y, z], full edge lengths", "[radius, length]",
                                              "[radius, length without caps]"};
    in.fail_at("size", std::string("a ") + std::string(to_string(shape.kind)) + " has the size " +
                           kWanted[static_cast<int>(shape.kind)]);
  }
  for (int i = 0; i < count; ++i) {
    // A capsule of length 0 is a sphere, which is harmless.
    const bool cap = shape.kind == ShapeKind::kCapsule && i == 1;
    shape.size[i] = config::read_number(size.items[static_cast<std::size_t>(i)], key + "[" + std::to_string(i) + "]",
                                        cap ? Range::non_negative() : Range::positive());
  }
  return shape;
}

void read_objects(const Node& node, ControlCase& out) {
  if (node.kind != Node::Kind::kSequence) config::fail(node.mark, "objects", "expected a list of objects");
  std::set<std::string> names;
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    const std::string key = "objects[" + std::to_string(i) + "]";
    ObjectShape shape;
    ObjectState state;
    read_object(node.items[i], key, static_cast<int>(i), shape, state);
    if (!names.insert(shape.name).second) {
      config::fail(node.items[i].mark, key + ".name", "'" + shape.name + "' is the name of an earlier object");
    }
    out.objects.push_back(std::move(shape));
    out.observation.objects.push_back(state);
  }
}

// Rotation matrix, column by column: what a quaternion cannot give back to the last bit.
Matrix3 read_rotation(const Node& node, const std::string& key) {
  const std::vector<double> v = config::read_numbers(node, key, 9);
  const Matrix3 R = Eigen::Map<const Matrix3>(v.data());
  if (!((R * R.transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff() < 1e-6 && R.determinant() > 0.0))
    config::fail(node.mark, key, "expected a rotation matrix, column by column");
  return R;
}

Matrix3 read_covariance(MapReader& in, const std::string& name, const std::string& unit) {
  const std::string wanted = "nine numbers, a covariance matrix [" + unit + "]";
  const Node& node = in.require(name, wanted);
  const std::vector<double> v = config::read_numbers(node, in.key_of(name), 9);
  const Matrix3 P = Eigen::Map<const Matrix3>(v.data());
  constexpr double kRounding = 1e-9;
  const double size = kRounding * P.cwiseAbs().maxCoeff();
  const bool symmetric = (P - P.transpose()).cwiseAbs().maxCoeff() <= size;
  if (!symmetric || Eigen::SelfAdjointEigenSolver<Matrix3>(P, Eigen::EigenvaluesOnly).eigenvalues()[0] < -size)
    config::fail(node.mark, in.key_of(name), "expected a symmetric matrix without negative eigenvalues: " + wanted);
  return P;
}

// Position with a quaternion or a rotation; neither is required.
void read_orientation(MapReader& in, Isometry& X) {
  if (const Node* quaternion = in.get("quaternion"))
    X.linear() = read_quaternion(*quaternion, in.key_of("quaternion")).toRotationMatrix();
  if (const Node* rotation = in.get("rotation")) X.linear() = read_rotation(*rotation, in.key_of("rotation"));
}

void read_remembered(MapReader& in, ControllerMemory& memory) {
  if (const Node* escape = in.get("escape")) config::read_described(*escape, in.key_of("escape"), memory.escape.state);
  if (const Node* node = in.get("last_goal")) {
    MapReader goal(*node, in.key_of("last_goal"));
    GoalState& last = memory.escape.last_goal;
    last.X_WG.translation() = read_vector3(goal.require("position", "[x, y, z] in metres"), goal.key_of("position"));
    read_orientation(goal, last.X_WG);
    if (const Node* twist = goal.get("twist")) last.V_WG_W = read_vector6(*twist, goal.key_of("twist"));
    goal.finish();
    memory.escape.has_goal = true;
  }
  if (const Node* prediction = in.get("prediction"))
    config::read_described(*prediction, in.key_of("prediction"), memory.prediction);
}

// A memory has the sizes of its controller, or nothing is known of what it means.
void check_prediction(const ControlCase& c, const Node& state) {
  if (c.memory.prediction.computed.empty()) return;
  const Node* node = state.find("prediction");
  const auto wrong = [&](const std::string& what) { config::fail(node->mark, "state.prediction", what); };
  if (!c.controller.prediction.enabled) wrong("the controller has no `prediction`");
  const std::string mismatch =
      prediction_mismatch(c.memory.prediction, *c.robot.model, c.controller, c.control_period, c.objects.size());
  if (!mismatch.empty()) wrong(mismatch);
}

void read_state(const Node& node, const RobotModel& model, ControlCase& c) {
  MapReader in(node, "state");
  Observation& out = c.observation;
  if (const Node* remembered = in.get("plan")) {
    in.check(c.controller.plan.enabled, "plan", "the controller does not look ahead: its `plan` is off");
    c.memory.plan = read_plan_state(*remembered, in.key_of("plan"), model);
    c.has_plan = true;
  }
  read_remembered(in, c.memory);
  // A fixed base may stand anywhere, but it has to stand somewhere only where it can move.
  if (model.mobile()) in.require("base", "[x, y, phi] of the base in metres and radians");
  if (const Node* base = in.get("base")) out.base = read_vector3(*base, in.key_of("base"));
  std::vector<std::string> joints;
  for (const ControlledJoint& joint : model.joints) joints.push_back(joint.name);
  out.q = read_named(in.require("q", "one value per joint: " + join(joints)), in.key_of("q"), joints);
  out.qdot = VectorX::Zero(model.num_velocities());
  if (const Node* qdot = in.get("qdot")) out.qdot = read_named(*qdot, in.key_of("qdot"), model.velocity_names());
  in.finish();
}

void read_goal(const Node& node, GoalState& out) {
  MapReader in(node, "goal");
  out.X_WG = read_pose(in);
  if (const Node* twist = in.get("twist")) out.V_WG_W = read_vector6(*twist, in.key_of("twist"));
  in.finish();
}

}  // namespace

Isometry read_pose(MapReader& in) {
  Isometry X = Isometry::Identity();
  const Node& position = in.require("position", "[x, y, z] in metres");
  if (in.get("rotation") == nullptr) in.require("quaternion", "[w, x, y, z]");
  X.translation() = read_vector3(position, in.key_of("position"));
  read_orientation(in, X);
  return X;
}

void read_object(const Node& node, const std::string& key, int index, ObjectShape& shape, ObjectState& state) {
  MapReader in(node, key);
  shape.name = "object" + std::to_string(index);
  in.read("name", shape.name);
  in.check(!shape.name.empty(), "name", "expected a name that is not empty");
  shape.shape = read_shape(in);
  const Node& position = in.require("position", "[x, y, z] in metres");
  state.X_WO.setIdentity();
  state.X_WO.translation() = read_vector3(position, in.key_of("position"));
  read_orientation(in, state.X_WO);
  state.V_WO_W.setZero();
  if (const Node* velocity = in.get("velocity")) state.V_WO_W = read_vector6(*velocity, in.key_of("velocity"));
  in.read("visible", state.visible);
  if (const Node* covariance = in.get("covariance")) {
    MapReader stated(*covariance, in.key_of("covariance"));
    state.covariance =
        ObjectCovariance{read_covariance(stated, "position", "m^2"), read_covariance(stated, "velocity", "(m/s)^2")};
    stated.finish();
  }
  in.finish();
}

ControlCase read_case(const Node& root) {
  ControlCase out;
  MapReader in(root, "");
  out.robot = config::read_robot(in.require("robot", "the path of a robot file"), "robot");
  const RobotModel& model = *out.robot.model;
  out.warnings = out.robot.warnings;
  in.read("control_period", out.control_period, Range::positive());
  const Node& controller = in.require("controller", "the path of a controller file, or its parameters");
  out.controller = config::read_controller(controller, "controller", model, out.control_period, out.warnings);
  read_state(in.require("state", "{base, q, qdot}"), model, out);
  read_goal(in.require("goal", "{position, quaternion, twist}"), out.observation.goal);
  if (const Node* objects = in.get("objects")) read_objects(*objects, out);
  check_prediction(out, in.require("state", ""));
  in.finish();
  return out;
}

ControlCase read_case(const std::filesystem::path& file) { return read_case(config::load_yaml(file)); }

}  // namespace moma
