#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "controller/case/solve.h"
#include "controller/config/controller_file.h"
#include "controller/config/json_node.h"
#include "controller/controller_core.h"
#include "python/bindings/robot.h"

namespace moma::python {
namespace {

/// Reads numbers one after the other.
class NumberReader {
 public:
  explicit NumberReader(const double* from) : from_(from) {}
  double number() noexcept { return *from_++; }
  Eigen::Map<const VectorX> vector(Eigen::Index size) noexcept {
    const Eigen::Map<const VectorX> values(from_, size);
    from_ += size;
    return values;
  }
  Matrix3 matrix() noexcept { return vector(9).reshaped<Eigen::RowMajor>(3, 3); }
  Isometry pose() noexcept {
    Isometry X = Isometry::Identity();
    X.translation() = vector(3);
    X.linear() = matrix();
    return X;
  }

 private:
  const double* from_;
};

/// moma's controller, of which observations are the numbers that a process gets.
class Controller {
 public:
  Controller(const Robot& robot, const config::Node& parameters, double control_period)
      : robot_(robot.loaded()),
        params_(config::read_controller(parameters, "", *robot_.model, control_period, warnings_)),
        core_(robot_.model, params_, control_period) {
    reset("[]");
  }

  void reset(const std::string& shapes) {
    objects_.clear();
    for (const nlohmann::ordered_json& json : config::parse_json(shapes, "objects")) {
      ObjectShape& object = objects_.emplace_back();
      object.name = json.at("name").get<std::string>();
      const auto kind = from_string<ShapeKind>(json.at("kind").get<std::string>());
      if (!kind) throw std::invalid_argument("object " + object.name + ": no such kind of shape");
      object.shape.kind = *kind;
      const auto size = json.at("size").get<std::vector<double>>();
      check_size(size.size(), static_cast<std::size_t>(num_sizes(*kind)), "size of an object");
      std::copy(size.begin(), size.end(), object.shape.size.begin());
      if (*kind != ShapeKind::kConvex) continue;
      auto hull = std::make_shared<ConvexHull>();
      for (const auto& v : json.at("vertices"))
        hull->vertices.emplace_back(v.at(0).get<double>(), v.at(1).get<double>(), v.at(2).get<double>());
      for (const auto& t : json.at("triangles"))
        hull->triangles.emplace_back(t.at(0).get<int>(), t.at(1).get<int>(), t.at(2).get<int>());
      object.shape.hull = std::move(hull);
    }
    core_.reset(objects_);
    core_.prepare(result_);
    seen_.objects.assign(objects_.size(), {});
  }

  nb::tuple step(const Values& values) {
    read(values);
    core_.step(seen_, result_);
    return nb::make_tuple(array(result_.command), std::string(to_string(result_.status)),
                          std::string(to_string(result_.fallback)), array(result_.slack), array(result_.error),
                          result_.manipulability, result_.least_distance, result_.rows, result_.active_rows,
                          result_.iterations);
  }

  /// The step that would come next, shown; the controller does not go on.
  ControlCase next(const Values& values) {
    read(values);
    ControlCase out;
    out.robot = robot_;
    out.controller = params_;
    out.control_period = core_.control_period();
    out.objects = objects_;
    core_.get_memory(out.memory);
    out.has_plan = params_.plan.enabled;
    out.observation = seen_;
    return out;
  }

  std::string parameters() const { return config::to_json(core_.params()).dump(); }
  const std::vector<std::string>& warnings() const { return warnings_; }
  double control_period() const { return core_.control_period(); }

 private:
  static nb::object array(const Eigen::Ref<const VectorX>& values) {
    double* data = nullptr;
    Array out = make_array({static_cast<std::size_t>(values.size())}, data);
    std::copy(values.begin(), values.end(), data);
    return nb::cast(std::move(out));
  }

  void read(const Values& values) {
    const Eigen::Index n = robot_.model->num_joints();
    const Eigen::Index m = robot_.model->num_velocities();
    check_size(values.size(), kFixedNumbers + static_cast<std::size_t>(n + m) + kObjectNumbers * objects_.size(),
               "observation");
    NumberReader in(values.data());
    seen_.time = in.number();
    seen_.base = in.vector(3);
    seen_.goal.X_WG = in.pose();
    seen_.goal.V_WG_W = in.vector(6);
    seen_.q = in.vector(n);
    seen_.qdot = in.vector(m);
    for (ObjectState& object : seen_.objects) {
      object.X_WO = in.pose();
      object.V_WO_W = in.vector(6);
      object.visible = in.number() != 0.0;
      object.covariance.reset();
      const bool tracked = in.number() != 0.0;
      ObjectCovariance covariance;
      covariance.position_W = in.matrix();
      covariance.velocity_W = in.matrix();
      if (tracked) object.covariance = covariance;
    }
  }

  std::vector<std::string> warnings_;
  config::LoadedRobot robot_;
  ControllerParams params_;
  ControllerCore core_;
  std::vector<ObjectShape> objects_;
  Observation seen_;
  StepResult result_;
};

}  // namespace

void bind_controller(nb::module_& module) {
  nb::class_<Controller>(module, "Controller")
      .def("__init__",
           [](Controller* self, const Robot& robot, const std::string& json, double control_period) {
             new (self) Controller(robot, node_of(json, "controller"), control_period);
           })
      .def_static("load",
                  [](const Robot& robot, const std::string& file, double control_period) {
                    return std::make_unique<Controller>(robot, config::load_yaml(file), control_period).release();
                  })
      .def("reset", &Controller::reset)
      .def("step", &Controller::step)
      .def("solve", [](Controller& self, const Values& values) { return layout(moma::solve(self.next(values))); })
      .def("explain", [](Controller& self, const Values& values) { return moma::explain(self.next(values)); })
      .def_prop_ro("parameters", &Controller::parameters)
      .def_prop_ro("warnings", &Controller::warnings)
      .def_prop_ro("control_period", &Controller::control_period);
}

void bind_case(nb::module_& module) {
  module.def("solve_file", [](const std::string& file) { return layout(moma::solve(read_case(file))); });
  module.def("solve_json",
             [](const std::string& json) { return layout(moma::solve(read_case(node_of(json, "case")))); });
  module.def("explain_file", [](const std::string& file) { return moma::explain(read_case(file)); });
  module.def("explain_json", [](const std::string& json) { return moma::explain(read_case(node_of(json, "case"))); });
}

}  // namespace moma::python
