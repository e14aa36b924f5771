#include "python/bindings/robot.h"

#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "controller/case/case_file.h"
#include "controller/model/kinematics.h"
#include "controller/model/manipulability.h"

namespace moma::python {
namespace {

using RowMajor4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

/// A member of each item of one of the robot's lists.
template <class Item, class V>
auto of_each(std::vector<Item> RobotModel::*list, V Item::*member) {
  return [list, member](const Robot& robot) {
    std::vector<V> all;
    for (const Item& item : robot.model().*list) all.push_back(item.*member);
    return all;
  };
}

ManipulabilityRows rows_of(const std::string& word) {
  const std::optional<ManipulabilityRows> rows = from_string<ManipulabilityRows>(word);
  if (!rows) throw std::invalid_argument("rows: found '" + word + "', expected translation, rotation or all");
  return *rows;
}

void read_objects(const std::string& json, const RobotModel& model, std::vector<ObjectShape>& shapes,
                  std::vector<ObjectState>& states) {
  const config::Node node = node_of(json, "objects");
  config::for_items(node, "objects", "a list of objects", [&](const config::Node& item, const std::string& key) {
    const int i = static_cast<int>(shapes.size());
    read_object(item, key, i, model, shapes.emplace_back(), states.emplace_back());
  });
}

}  // namespace

template <class Body>
void Robot::each(const Rows& base, const Rows& q, Body body) const {
  check_size(base.cols(), 3, "base");
  check_size(q.cols(), model().num_joints(), "q");
  check_size(base.rows(), q.rows(), "configurations of the base");
  const nb::gil_scoped_release release;
  Kinematics kinematics(loaded_.model);
  for (Eigen::Index i = 0; i < q.rows(); ++i) {
    kinematics.update(base.row(i).transpose(), q.row(i).transpose());
    body(i, kinematics);
  }
}

Matrix Robot::fk(const Rows& base, const Rows& q, const std::string& link) const {
  const int index = link.empty() ? -1 : model().find_link(link);
  if (!link.empty() && index < 0) throw std::invalid_argument("link: " + model().name + " has no link '" + link + "'");
  Matrix out(q.rows(), 16);
  each(base, q, [&out, index](Eigen::Index i, const Kinematics& kinematics) {
    Eigen::Map<RowMajor4>(out.row(i).data()) = (index < 0 ? kinematics.X_WE() : kinematics.X_WL(index)).matrix();
  });
  return out;
}

Matrix Robot::jacobian(const Rows& base, const Rows& q) const {
  const int n = model().num_velocities();
  Matrix out(q.rows(), 6 * n);
  each(base, q, [&out, n](Eigen::Index i, const Kinematics& kinematics) {
    Eigen::Map<Matrix>(out.row(i).data(), 6, n) = kinematics.J_WE_W();
  });
  return out;
}

// Manipulability does not depend on the base, which stands at the origin here.

VectorX Robot::manipulability(const Rows& q, const std::string& rows) const {
  const ManipulabilityRows which = rows_of(rows);
  const int n = model().num_joints();
  VectorX out(q.rows());
  each(Matrix::Zero(q.rows(), 3), q, [&out, n, which](Eigen::Index i, const Kinematics& kinematics) {
    out[i] = moma::manipulability(kinematics.J_WE_W().rightCols(n), which);
  });
  return out;
}

Matrix Robot::manipulability_gradient(const Rows& q, const std::string& rows) const {
  const ManipulabilityRows which = rows_of(rows);
  const int n = model().num_joints();
  Eigen::VectorXi prismatic(n);
  for (int j = 0; j < n; ++j) prismatic[j] = model().joint(j).type == JointType::kPrismatic ? 1 : 0;
  Matrix out(q.rows(), n);
  each(Matrix::Zero(q.rows(), 3), q, [&](Eigen::Index i, const Kinematics& kinematics) {
    Eigen::Map<VectorX> gradient(out.row(i).data(), n);
    moma::manipulability_gradient(kinematics.J_WE_W().rightCols(n), prismatic, which, gradient);
  });
  return out;
}

std::pair<Matrix, Matrix> Robot::integrate(const Rows& base, const Rows& q, const Rows& velocity,
                                           double seconds) const {
  check_size(base.cols(), 3, "base");
  check_size(q.cols(), model().num_joints(), "q");
  check_size(velocity.cols(), model().num_velocities(), "velocity");
  check_size(base.rows(), q.rows(), "configurations of the base");
  check_size(velocity.rows(), q.rows(), "velocities");
  std::pair<Matrix, Matrix> moved{base, q};
  for (Eigen::Index i = 0; i < q.rows(); ++i) {
    Vector3 place = base.row(i).transpose();
    VectorX turned = q.row(i).transpose();
    moma::integrate(model(), place, turned, velocity.row(i).transpose(), seconds);
    moved.first.row(i) = place.transpose();
    moved.second.row(i) = turned.transpose();
  }
  return moved;
}

VectorX Robot::clearance(const Rows& base, const Rows& q, const std::string& objects) const {
  std::vector<ObjectShape> shapes;
  std::vector<ObjectState> states;
  read_objects(objects, model(), shapes, states);
  Proximity proximity(loaded_.model);
  proximity.set_objects(shapes);
  VectorX out = VectorX::Constant(q.rows(), kInfinity);
  each(base, q, [&](Eigen::Index i, const Kinematics& kinematics) {
    for (const ProximityPair& pair : proximity.query(kinematics, states, {.object = 1e6, .floor = -1.0, .self = -1.0}))
      out[i] = std::min(out[i], pair.distance.d);
  });
  return out;
}

nb::list Robot::distances(const Vector3& base, const VectorX& q, const std::string& objects,
                          const ProximityRanges& ranges) const {
  check_size(q.size(), model().num_joints(), "q");
  std::vector<ObjectShape> shapes;
  std::vector<ObjectState> states;
  read_objects(objects, model(), shapes, states);
  Kinematics kinematics(loaded_.model);
  kinematics.update(base, q);
  Proximity proximity(loaded_.model);
  proximity.set_objects(shapes);
  nb::list out;
  const auto name_of = [this](int shape) { return model().shape(shape).name; };
  for (const ProximityPair& pair : proximity.query(kinematics, states, ranges)) {
    const bool object = pair.kind == PairKind::kObject;
    const std::string second = object                         ? shapes[static_cast<std::size_t>(pair.second)].name
                               : pair.kind == PairKind::kSelf ? name_of(pair.second)
                                                              : std::string("floor");
    const char* kind = object ? "object" : pair.kind == PairKind::kSelf ? "self" : "floor";
    const auto& [d, n_W, p_first_W, p_second_W] = pair.distance;
    out.append(nb::make_tuple(kind, name_of(pair.first), second, d, n_W, p_first_W, p_second_W));
  }
  return out;
}

void bind_robot(nb::module_& module) {
  nb::class_<Robot>(module, "Robot")
      .def_static("load", [](const std::string& file) { return new Robot(config::load_robot(file)); })
      .def_static(
          "read",
          [](const std::string& json) { return new Robot(config::read_robot(node_of(json, "robot"), "robot")); })
      .def_prop_ro("name", [](const Robot& robot) { return robot.model().name; })
      .def_prop_ro("base", [](const Robot& robot) { return std::string(to_string(robot.model().base.type)); })
      .def_prop_ro("joints", of_each(&RobotModel::joints, &ControlledJoint::name))
      .def_prop_ro("links", of_each(&RobotModel::links, &Link::name))
      .def_prop_ro("velocities", [](const Robot& robot) { return robot.model().velocity_names(); })
      .def_prop_ro("lower", of_each(&RobotModel::joints, &ControlledJoint::lower))
      .def_prop_ro("upper", of_each(&RobotModel::joints, &ControlledJoint::upper))
      .def_prop_ro("ready", [](const Robot& robot) { return VectorX(robot.model().ready); })
      .def_prop_ro("velocity_limits", [](const Robot& robot) { return VectorX(robot.model().velocity_limits()); })
      .def_prop_ro("resolved", [](const Robot& robot) { return robot.loaded().resolved.dump(); })
      .def_prop_ro("warnings", [](const Robot& robot) { return robot.loaded().warnings; })
      .def_prop_ro("notes", [](const Robot& robot) { return robot.loaded().notes; })
      .def("fk", &Robot::fk)
      .def("jacobian", &Robot::jacobian)
      .def("manipulability", &Robot::manipulability)
      .def("manipulability_gradient", &Robot::manipulability_gradient)
      .def("integrate", &Robot::integrate)
      .def("clearance", &Robot::clearance)
      .def("distances", [](const Robot& robot, const Vector3& base, const VectorX& q, const std::string& objects,
                           double object, double floor, double self) {
        return robot.distances(base, q, objects, {.object = object, .floor = floor, .self = self});
      });
}

}  // namespace moma::python
