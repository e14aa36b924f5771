#include "python/bindings/robot.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

#include "controller/case/case_file.h"
#include "controller/model/kinematics.h"
#include "controller/model/manipulability.h"

namespace moma::python {
namespace {

using RowMajor4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
using RowMajorX = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

nb::object array_of(const Eigen::Ref<const VectorX>& values) {
  double* data = nullptr;
  Array array = make_array({static_cast<std::size_t>(values.size())}, data);
  std::copy(values.begin(), values.end(), data);
  return nb::cast(std::move(array));
}

/// What each item of one of the robot's lists says of itself.
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
  for (const config::Node& item : node.items) {
    const int i = static_cast<int>(shapes.size());
    read_object(item, "objects[" + std::to_string(i) + "]", i, model, shapes.emplace_back(), states.emplace_back());
  }
}

}  // namespace

template <class Body>
void Robot::each(const Rows& base, const Rows& q, Body body) const {
  check_size(base.shape(1), 3, "base");
  check_size(q.shape(1), static_cast<std::size_t>(model().num_joints()), "q");
  check_size(base.shape(0), q.shape(0), "configurations of the base");
  const nb::gil_scoped_release release;
  Kinematics kinematics(loaded_.model);
  for (std::size_t i = 0; i < q.shape(0); ++i) {
    kinematics.update(Eigen::Map<const Vector3>(base.data() + 3 * i),
                      Eigen::Map<const VectorX>(q.data() + i * q.shape(1), static_cast<Eigen::Index>(q.shape(1))));
    body(i, kinematics);
  }
}

Array Robot::fk(const Rows& base, const Rows& q, const std::string& link) const {
  const int index = link.empty() ? -1 : model().find_link(link);
  if (!link.empty() && index < 0) throw std::invalid_argument("link: " + model().name + " has no link '" + link + "'");
  double* data = nullptr;
  Array out = make_array({q.shape(0), 4, 4}, data);
  each(base, q, [data, index](std::size_t i, const Kinematics& kinematics) {
    Eigen::Map<RowMajor4> pose(data + 16 * i);
    pose = (index < 0 ? kinematics.X_WE() : kinematics.X_WL(index)).matrix();
  });
  return out;
}

Array Robot::jacobian(const Rows& base, const Rows& q) const {
  const int n = model().num_velocities();
  double* data = nullptr;
  Array out = make_array({q.shape(0), 6, static_cast<std::size_t>(n)}, data);
  each(base, q, [data, n](std::size_t i, const Kinematics& kinematics) {
    Eigen::Map<RowMajorX>(data + 6 * n * static_cast<Eigen::Index>(i), 6, n) = kinematics.J_WE_W();
  });
  return out;
}

// With the base at the origin, which manipulability does not depend on.
template <class Body>
void Robot::each(const Rows& q, Body body) const {
  const std::vector<double> zero(3 * q.shape(0), 0.0);
  const std::size_t shape[] = {q.shape(0), 3};
  each(Rows(zero.data(), 2, shape, nb::handle()), q, body);
}

Array Robot::manipulability(const Rows& q, const std::string& rows) const {
  const ManipulabilityRows which = rows_of(rows);
  double* data = nullptr;
  Array out = make_array({q.shape(0)}, data);
  const int n = model().num_joints();
  each(q, [=](std::size_t i, const Kinematics& kinematics) {
    data[i] = moma::manipulability(kinematics.J_WE_W().rightCols(n), which);
  });
  return out;
}

Array Robot::manipulability_gradient(const Rows& q, const std::string& rows) const {
  const ManipulabilityRows which = rows_of(rows);
  const int n = model().num_joints();
  double* data = nullptr;
  Array out = make_array({q.shape(0), static_cast<std::size_t>(n)}, data);
  Eigen::VectorXi prismatic(n);
  for (int j = 0; j < n; ++j)
    prismatic[j] = model().joints[static_cast<std::size_t>(j)].type == JointType::kPrismatic ? 1 : 0;
  each(q, [&](std::size_t i, const Kinematics& kinematics) {
    Eigen::Map<VectorX> gradient(data + n * static_cast<Eigen::Index>(i), n);
    moma::manipulability_gradient(kinematics.J_WE_W().rightCols(n), prismatic, which, gradient);
  });
  return out;
}

nb::tuple Robot::integrate(const Rows& base, const Rows& q, const Rows& velocity, double seconds) const {
  const std::size_t rows = q.shape(0);
  const auto joints = static_cast<std::size_t>(model().num_joints());
  const auto velocities = static_cast<std::size_t>(model().num_velocities());
  check_size(base.shape(1), 3, "base");
  check_size(q.shape(1), joints, "q");
  check_size(velocity.shape(1), velocities, "velocity");
  check_size(base.shape(0), rows, "configurations of the base");
  check_size(velocity.shape(0), rows, "velocities");
  double* bases = nullptr;
  double* qs = nullptr;
  Array next_base = make_array({rows, 3}, bases);
  Array next_q = make_array({rows, joints}, qs);
  for (std::size_t i = 0; i < rows; ++i) {
    Vector3 moved = Eigen::Map<const Vector3>(base.data() + 3 * i);
    VectorX turned = Eigen::Map<const VectorX>(q.data() + joints * i, static_cast<Eigen::Index>(joints));
    const Eigen::Map<const VectorX> rate(velocity.data() + velocities * i, static_cast<Eigen::Index>(velocities));
    moma::integrate(model(), moved, turned, rate, seconds);
    std::copy(moved.begin(), moved.end(), bases + 3 * i);
    std::copy(turned.begin(), turned.end(), qs + joints * i);
  }
  return nb::make_tuple(nb::cast(std::move(next_base)), nb::cast(std::move(next_q)));
}

Array Robot::clearance(const Rows& base, const Rows& q, const std::string& objects) const {
  std::vector<ObjectShape> shapes;
  std::vector<ObjectState> states;
  read_objects(objects, model(), shapes, states);
  Proximity proximity(loaded_.model);
  proximity.set_objects(shapes);
  double* data = nullptr;
  Array out = make_array({q.shape(0)}, data);
  each(base, q, [&](std::size_t i, const Kinematics& kinematics) {
    data[i] = kInfinity;
    for (const ProximityPair& pair : proximity.query(kinematics, states, {.object = 1e6, .floor = -1.0, .self = -1.0}))
      data[i] = std::min(data[i], pair.distance.d);
  });
  return out;
}

nb::list Robot::distances(const Values& base, const Values& q, const std::string& objects, double object_range,
                          double floor_range, double self_range) const {
  check_size(base.size(), 3, "base");
  check_size(q.size(), static_cast<std::size_t>(model().num_joints()), "q");
  std::vector<ObjectShape> shapes;
  std::vector<ObjectState> states;
  read_objects(objects, model(), shapes, states);
  Kinematics kinematics(loaded_.model);
  kinematics.update(Eigen::Map<const Vector3>(base.data()),
                    Eigen::Map<const VectorX>(q.data(), static_cast<Eigen::Index>(q.size())));
  Proximity proximity(loaded_.model);
  proximity.set_objects(shapes);
  const ProximityRanges ranges{.object = object_range, .floor = floor_range, .self = self_range};
  nb::list out;
  const auto name_of = [this](int shape) { return model().shapes[static_cast<std::size_t>(shape)].name; };
  for (const ProximityPair& pair : proximity.query(kinematics, states, ranges)) {
    const bool object = pair.kind == PairKind::kObject;
    const std::string second = object                         ? shapes[static_cast<std::size_t>(pair.second)].name
                               : pair.kind == PairKind::kSelf ? name_of(pair.second)
                                                              : std::string("floor");
    const char* kind = object ? "object" : pair.kind == PairKind::kSelf ? "self" : "floor";
    out.append(nb::make_tuple(kind, name_of(pair.first), second, pair.distance.d, array_of(pair.distance.n_W),
                              array_of(pair.distance.p_first_W), array_of(pair.distance.p_second_W)));
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
      .def_prop_ro("ready", [](const Robot& robot) { return array_of(robot.model().ready); })
      .def_prop_ro("velocity_limits", [](const Robot& robot) { return array_of(robot.model().velocity_limits()); })
      .def_prop_ro("resolved", [](const Robot& robot) { return robot.loaded().resolved.dump(); })
      .def_prop_ro("warnings", [](const Robot& robot) { return robot.loaded().warnings; })
      .def_prop_ro("notes", [](const Robot& robot) { return robot.loaded().notes; })
      .def("fk", &Robot::fk)
      .def("jacobian", &Robot::jacobian)
      .def("manipulability", &Robot::manipulability)
      .def("manipulability_gradient", &Robot::manipulability_gradient)
      .def("integrate", &Robot::integrate)
      .def("clearance", &Robot::clearance)
      .def("distances", &Robot::distances);
}

}  // namespace moma::python
