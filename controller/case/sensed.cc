#include "controller/case/sensed.h"

#include <cmath>

namespace moma {
namespace {

using config::MapReader;
using config::Node;

constexpr double kQuaternionTolerance = 1e-3;  // hand-written quaternions have four digits

Matrix3 read_quaternion(const Node& node, const std::string& key) {
  const std::vector<double> v = config::read_numbers(node, key, 4);
  const Eigen::Vector4d wxyz(v[0], v[1], v[2], v[3]);
  const double norm = wxyz.stableNorm();
  if (!(std::abs(norm - 1.0) <= kQuaternionTolerance)) {
    config::fail(
        node.mark, key,
        "found length " + std::to_string(norm) + ", expected a unit quaternion [w, x, y, z] (length 1 within 0.001)");
  }
  return Eigen::Quaterniond(v[0] / norm, v[1] / norm, v[2] / norm, v[3] / norm).toRotationMatrix();
}

// Rotation matrix, column by column: what a quaternion cannot give back to the last bit.
Matrix3 read_rotation(const Node& node, const std::string& key) {
  const std::vector<double> v = config::read_numbers(node, key, 9);
  const Matrix3 R = Eigen::Map<const Matrix3>(v.data());
  if (!((R * R.transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff() < 1e-6 && R.determinant() > 0.0))
    config::fail(node.mark, key, "expected a rotation matrix, column by column");
  return R;
}

}  // namespace

VectorX read_named(const Node& node, const std::string& key, const std::vector<std::string>& names) {
  const int count = static_cast<int>(names.size());
  if (node.kind != Node::Kind::kSequence || static_cast<int>(node.items.size()) != count)
    config::fail(
        node.mark, key,
        "found " + config::found_text(node) + ", expected " + std::to_string(count) + " numbers: " + joined(names));
  const std::vector<double> v = config::read_numbers(node, key, count);
  return Eigen::Map<const VectorX>(v.data(), count);
}

Isometry read_pose(MapReader& in, bool required) {
  Isometry X = Isometry::Identity();
  const Node& position = in.require("position", "[x, y, z] in metres");
  const Node* quaternion = in.get("quaternion");
  const Node* rotation = in.get("rotation");
  if (required && rotation == nullptr) in.require("quaternion", "[w, x, y, z]");
  X.translation() = Eigen::Map<const Vector3>(config::read_numbers(position, in.key_of("position"), 3).data());
  if (quaternion != nullptr) X.linear() = read_quaternion(*quaternion, in.key_of("quaternion"));
  if (rotation != nullptr) X.linear() = read_rotation(*rotation, in.key_of("rotation"));
  return X;
}

void write_pose(const Isometry& X, Json& json) {
  json["position"] = std::vector<double>{X.translation().x(), X.translation().y(), X.translation().z()};
  json["rotation"] = write_value(Matrix3(X.linear()), {});
}

std::string accepted(Of<Matrix3>, const About& about) {
  return "nine numbers, a covariance matrix [" + std::string(about.unit) + "]";
}

void read_value(const Node& node, const std::string& key, Matrix3& value, const About& about) {
  const std::vector<double> v = config::read_numbers(node, key, 9);
  value = Eigen::Map<const Matrix3>(v.data());
  constexpr double kRounding = 1e-9;
  const double size = kRounding * value.cwiseAbs().maxCoeff();
  const bool symmetric = (value - value.transpose()).cwiseAbs().maxCoeff() <= size;
  if (!symmetric || Eigen::SelfAdjointEigenSolver<Matrix3>(value, Eigen::EigenvaluesOnly).eigenvalues()[0] < -size)
    config::fail(node.mark, key,
                 "expected a symmetric matrix without negative eigenvalues: " + accepted(Of<Matrix3>{}, about));
}

}  // namespace moma
