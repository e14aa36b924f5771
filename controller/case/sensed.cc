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

std::vector<double> by_columns(const Matrix3& matrix) { return {matrix.data(), matrix.data() + 9}; }

// The members of a covariance, each by `body(name, matrix, unit)`.
template <class C, class Body>
struct Matrices {
  C& covariance;
  Body body;
  template <class P>
  void member(std::string_view name, P pointer, const About& about) {
    body(std::string(name), covariance.*pointer, std::string(about.unit));
  }
};

template <class C, class Body>
void each_matrix(C& covariance, Body body) {
  Matrices<C, Body> matrices{covariance, body};
  describe(matrices, Of<ObjectCovariance>{});
}

}  // namespace

VectorX read_named(const Node& node, const std::string& key, const std::vector<std::string>& names) {
  const int count = static_cast<int>(names.size());
  if (node.kind != Node::Kind::kSequence || static_cast<int>(node.items.size()) != count) {
    const std::string found =
        node.kind == Node::Kind::kSequence ? "a list of " + std::to_string(node.items.size()) : std::string("no list");
    std::string all;
    for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
    config::fail(node.mark, key, "found " + found + ", expected " + std::to_string(count) + " numbers: " + all);
  }
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

void write_pose(const Isometry& X, nlohmann::ordered_json& json) {
  json["position"] = std::vector<double>{X.translation().x(), X.translation().y(), X.translation().z()};
  json["rotation"] = by_columns(X.linear());
}

void read_value(const Node& node, const std::string& key, ObjectCovariance& value, const About& /*about*/) {
  MapReader in(node, key);
  each_matrix(value, [&](const std::string& name, Matrix3& matrix, const std::string& unit) {
    matrix = read_covariance(in, name, unit);
  });
  in.finish();
}

nlohmann::ordered_json write_value(const ObjectCovariance& value, const About& /*about*/) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  each_matrix(value, [&](const std::string& name, const Matrix3& matrix, const std::string& /*unit*/) {
    json[name] = by_columns(matrix);
  });
  return json;
}

}  // namespace moma
