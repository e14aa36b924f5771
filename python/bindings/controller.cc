#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <vector>

#include "controller/case/solve.h"
#include "controller/config/controller_file.h"
#include "controller/config/layout.h"
#include "controller/config/object_file.h"
#include "controller/controller_core.h"
#include "python/bindings/robot.h"

namespace moma::python {
namespace {

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
    objects_ = config::read_objects(node_of(shapes, "objects"), "objects");
    core_.reset(objects_);
    core_.prepare(result_);
    seen_.q.resize(robot_.model->num_joints());
    seen_.qdot.resize(robot_.model->num_velocities());
    seen_.objects.assign(objects_.size(), {});
  }

  /// The numbers of a StepResult.
  VectorX step(const Eigen::Ref<const VectorX>& values) {
    read(values);
    core_.step(seen_, result_);
    return packed(result_);
  }

  /// The step that would come next, shown; the controller does not go on.
  ControlCase next(const Eigen::Ref<const VectorX>& values) {
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
  /// The numbers of what the last step acted on.
  VectorX predicted() const { return packed(core_.predicted() != nullptr ? *core_.predicted() : seen_); }
  std::size_t num_objects() const { return objects_.size(); }

 private:
  void read(const Eigen::Ref<const VectorX>& values) {
    check_size(values.size(), static_cast<Eigen::Index>(count_numbers(seen_)), "observation");
    unpack(values.data(), seen_);
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
           [](Controller* self, const Robot& robot, const std::string& file, const std::string& json, double period) {
             new (self) Controller(robot, file.empty() ? node_of(json, "controller") : config::load_yaml(file), period);
           })
      .def("reset", &Controller::reset)
      .def("step", &Controller::step)
      .def("solve", [](Controller& self,
                       const Eigen::Ref<const VectorX>& values) { return layout(moma::solve(self.next(values))); })
      .def("explain",
           [](Controller& self, const Eigen::Ref<const VectorX>& values) { return moma::explain(self.next(values)); })
      .def_prop_ro("parameters", &Controller::parameters)
      .def_prop_ro("warnings", &Controller::warnings)
      .def("predicted", &Controller::predicted)
      .def_prop_ro("num_objects", &Controller::num_objects);
  module.def("layouts", [](int joints, int velocities) {
    const Lengths lengths{joints, velocities};
    return Json{{"observation", config::layout_of<Observation>(lengths)},
                {"details", config::layout_of<StepResult, Details>(lengths)},
                {"step", config::layout_of<StepResult>(lengths)}}
        .dump();
  });
}

void bind_case(nb::module_& module) {
  // Reads a file or, if its name is empty, a text.
  const auto read = [](const std::string& file, const std::string& json) {
    return file.empty() ? read_case(node_of(json, "case")) : read_case(file);
  };
  module.def("solve", [read](const std::string& file, const std::string& json) {
    return layout(moma::solve(read(file, json)));
  });
  module.def("explain",
             [read](const std::string& file, const std::string& json) { return moma::explain(read(file, json)); });
}

}  // namespace moma::python
