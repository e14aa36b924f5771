#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "controller/config/json_node.h"
#include "controller/config/object_file.h"
#include "controller/model/kinematics.h"
#include "eval/trial/stepped_trial.h"
#include "eval/trial/trial_detail.h"
#include "python/bindings/robot.h"
#include "world/world_json.h"

namespace moma::python {
namespace {

/// Written to in place.
using Numbers = Eigen::Ref<Matrix>;
using Indices = Eigen::Ref<const Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>>;

constexpr auto kDetails = static_cast<Eigen::Index>(fixed_numbers<Details>());
constexpr std::size_t kFrame = fixed_numbers<Isometry>() + 6;  // a pose and its twist: how an ObjectState begins
constexpr std::size_t kSlot = kFrame + 4;                      // of an object: the same, edges 3, visible
constexpr Eigen::Index kSignals = 6;  // outcome or -1, time, errors of position and rotation, manipulability, clearance

/// Edges of the box around a shape, along its own axes.
Vector3 edges(const Shape& shape) {
  const Isometry here = Isometry::Identity();
  Vector3 sizes;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 n = Vector3::Unit(axis);
    sizes[axis] = extent_along(shape, here, n) + extent_along(shape, here, -n);
  }
  return sizes;
}

Json number(double value) { return std::isfinite(value) ? Json(value == 0.0 ? 0.0 : value) : nullptr; }

/// A row's members under their names, as the store keeps them; without its timing.
Json to_json(const TrialRow& row) {
  Json json = Json::object();
  for_members<TrialRow>([&]<class M>(std::string_view name, M TrialRow::*member, const Column&) {
    Json& out = json[std::string(name)];
    if constexpr (std::is_same_v<M, double>) {
      out = number(row.*member);
    } else if constexpr (std::is_same_v<M, Outcome>) {
      out = to_string(row.*member);
    } else if constexpr (std::is_same_v<M, std::string>) {
      if (!(row.*member).empty()) out = row.*member;
    } else {
      out = row.*member;
    }
  });
  return json;
}

/// Several trials of one point of a suite, each stepped from outside. Different ones may be stepped by different
/// threads.
class Trials {
 public:
  Trials(const Suite& suite, std::size_t point, std::size_t count, std::size_t slots, bool truth)
      : worlds_(point_of(suite, point)), slots_(slots), truth_(truth), trials_(count) {
    // The suite's own controllers are no part of a trial whose controller is outside.
    worlds_.plugin = nullptr;
    worlds_.controller_params = {};
    worlds_.controller_resolved = {};
    spec_ = std::make_shared<const TrialSpec>(worlds_);
    for (Slot& slot : trials_) slot.kinematics = std::make_unique<Kinematics>(spec_->robot->model);
  }

  Trials(const Trials&) = delete;
  Trials& operator=(const Trials&) = delete;

  Eigen::Index joints() const { return spec_->robot->model->num_joints(); }
  Eigen::Index velocities() const { return spec_->robot->model->num_velocities(); }
  Eigen::Index width() const {
    return static_cast<Eigen::Index>(fixed_numbers<Observation>() + 6 + slots_ * kSlot) + joints() + velocities();
  }
  Robot robot() const { return Robot(*spec_->robot); }
  const TrialSpec& spec() const { return *spec_; }

  /// Steps the trials first to last - 1: those with a world's number begin in it, the others answer with their row of
  /// `actions` (velocities, or the numbers of a command with details). Rows of all are written.
  void step(std::size_t first, std::size_t last, const Rows& actions, const Indices& worlds, Numbers seen,
            Numbers signals) {
    const auto count = static_cast<Eigen::Index>(trials_.size());
    check_size(actions.rows(), count, "actions");
    check_size(worlds.size(), count, "worlds");
    check_size(seen.size(), count * width(), "seen");
    check_size(signals.size(), count * kSignals, "signals");
    if (last > trials_.size() || first > last) throw std::invalid_argument("there are no such trials");
    if (actions.cols() != velocities() + kDetails) check_size(actions.cols(), velocities(), "action");
    const nb::gil_scoped_release release;
    for (std::size_t i = first; i < last; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      if (worlds[row] >= 0) {
        begin(i, make_world(worlds_, static_cast<std::uint64_t>(worlds[row])));
      } else {
        answer(i, actions.row(row).transpose());
      }
      write(i, seen.row(row).data(), signals.row(row).data());
    }
  }

  void begin_in(std::size_t i, const std::string& world) {
    World given = world_from_json(config::parse_json(world, "world"), "world");
    check_size(given.start.q.size(), joints(), "world: start.q");
    begin(i, std::move(given));
  }

  void look(std::size_t i, Numbers seen, Numbers signals) {
    check_size(seen.cols(), width(), "seen");
    check_size(signals.cols(), kSignals, "signals");
    write(i, seen.data(), signals.data());
  }

  /// The observation as a controller in a process of its own gets it.
  VectorX numbers(std::size_t i) { return packed(observation(i)); }

  /// And at a reset, as JSON.
  std::string objects(std::size_t i) { return config::objects_to_json(told(i)).dump(); }

  std::string world(std::size_t i) { return to_json(trial(i).world()).dump(); }
  std::string row(std::size_t i) { return to_json(trial(i).output().row).dump(); }
  std::string trace(std::size_t i) {
    const SteppedTrial& stepped = trial(i);
    return trace_json(stepped.spec(), stepped.world(), stepped.output(), "").dump();
  }

 private:
  struct Slot {
    std::unique_ptr<SteppedTrial> trial;
    std::unique_ptr<Kinematics> kinematics;
    std::vector<Vector3> edges;
    Observation truth;
    StepResult answer;
  };

  SteppedTrial& trial(std::size_t i) {
    if (i >= trials_.size() || !trials_[i].trial) throw std::logic_error("no trial has begun: call reset()");
    return *trials_[i].trial;
  }

  std::span<const ObjectShape> told(std::size_t i) {
    const std::span<const ObjectShape> all = trial(i).objects();
    return truth_ ? all.first(std::min(all.size(), trial(i).world().objects.size())) : all;
  }

  const Observation& observation(std::size_t i) {
    if (!truth_) return trial(i).seen();
    trial(i).truth(trials_[i].truth);
    return trials_[i].truth;
  }

  void begin(std::size_t i, World world) {
    if (i >= trials_.size()) throw std::logic_error("there is no such trial");
    Slot& slot = trials_[i];
    slot.trial = std::make_unique<SteppedTrial>(spec_, std::move(world));
    slot.edges.clear();
    for (const ObjectShape& object : told(i)) slot.edges.push_back(edges(object.shape));
    if (slot.edges.size() > slots_) {
      throw std::invalid_argument("objects: world " + std::to_string(slot.trial->world().index) + " has " +
                                  std::to_string(slot.edges.size()) + ", the observation has room for " +
                                  std::to_string(slots_));
    }
    slot.answer = StepResult();
  }

  void answer(std::size_t i, const Eigen::Ref<const VectorX>& numbers) {
    StepResult& answer = trials_[i].answer;
    answer.command = numbers.head(velocities());
    if (numbers.size() > velocities()) unpack_part<Details>(numbers.data() + velocities(), answer);
    trial(i).step(answer);
  }

  void write(std::size_t i, double* seen, double* signals) {
    const SteppedTrial& stepped = trial(i);
    Slot& slot = trials_[i];
    const Observation& now = observation(i);
    std::fill_n(seen, width(), 0.0);
    if (now.q.size() == joints()) {  // a trial that ended by an exception at its start has none
      Eigen::Map<Vector6> error(pack_without_items(now, seen));
      slot.kinematics->update(now.base, now.q);
      const Isometry& X_WE = slot.kinematics->X_WE();
      error = pose_error(X_WE, nearest_pose(now.goal.X_WG, now.goal.free, X_WE));
      for (std::size_t o = 0; o < std::min(slots_, now.objects.size()); ++o) {
        if (!now.objects[o].visible) continue;
        double* const to = error.data() + 6 + o * kSlot;
        double object[fixed_numbers<ObjectState>()];
        pack(now.objects[o], object);
        std::copy_n(object, kFrame, to);
        Eigen::Map<Vector3>(to + kFrame) = slot.edges[o];
        to[kFrame + 3] = 1.0;
      }
    }
    const StateRecord* state = stepped.state();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double values[kSignals] = {stepped.ended() ? static_cast<double>(stepped.outcome()) : -1.0,
                                     now.time,
                                     state != nullptr ? state->position_error : nan,
                                     state != nullptr ? state->orientation_error : nan,
                                     state != nullptr ? state->manipulability : nan,
                                     stepped.clearance()};
    std::copy_n(values, kSignals, signals);
  }

  SuitePoint worlds_;
  std::shared_ptr<const TrialSpec> spec_;
  std::size_t slots_;
  bool truth_;
  std::vector<Slot> trials_;
};

}  // namespace

void bind_trials(nb::module_& module) {
  nb::class_<Trials>(module, "Trials")
      .def(nb::init<const Suite&, std::size_t, std::size_t, std::size_t, bool>())
      .def_prop_ro("robot", &Trials::robot)
      .def_prop_ro("width", &Trials::width)
      .def_prop_ro("control_period", [](const Trials& trials) { return trials.spec().simulation.control_period; })
      .def("step", &Trials::step)
      .def("begin", &Trials::begin_in)
      .def("look", &Trials::look)
      .def("numbers", &Trials::numbers)
      .def("objects", &Trials::objects)
      .def("world", &Trials::world)
      .def("row", &Trials::row)
      .def("trace", &Trials::trace);
  std::vector<std::string> outcomes;
  for (const std::string_view word : words(Of<Outcome>{})) outcomes.emplace_back(word);
  module.attr("OUTCOMES") = nb::cast(outcomes);
}

}  // namespace moma::python
