#include "eval/trial/trial_detail.h"

#include <fmt/format.h>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <type_traits>

#include "controller/config/write_described.h"
#include "controller/controller_core.h"
#include "eval/trial/spec_file.h"
#include "world/world_json.h"

namespace moma {

namespace {

/// One of moma's controllers, recorded before a step: its observation and memory.
class Witness final : public StepController {
 public:
  struct Taken {
    bool found = false;
    bool waits = false;  // the map waits for the first frames, and the robot brakes
  };
  Witness(const TrialSpec& spec, long k, ControlCase& out, Taken& taken)
      : controller_(spec.robot->model, told_params(spec), spec.simulation.control_period),
        k_(k),
        period_(spec.simulation.control_period),
        out_(out),
        taken_(taken) {}

  void reset(std::span<const ObjectShape> objects) override {
    controller_.reset(objects);
    out_.objects.assign(objects.begin(), objects.end());
  }
  void step(const Observation& observation, StepResult& result) noexcept override {
    taken_.found = std::lround(observation.time / period_) == k_;
    if (taken_.found) {
      out_.observation = observation;
      controller_.get_memory(out_.memory);
    }
    controller_.step(observation, result);
    if (!taken_.found) return;
    taken_.waits = controller_.map().waits();
    out_.memory.map = controller_.map().boxes();  // by the frames that the step worked on
  }
  void see(const DepthFrame& frame) noexcept override { controller_.see(frame); }
  Gaze gaze(int sensor) const noexcept override { return controller_.gaze(sensor); }
  void prepare(StepResult& result) const override { controller_.prepare(result); }
  std::string_view failure() const noexcept override { return taken_.found ? "is where the case was taken" : ""; }

 private:
  ControllerCore controller_;
  long k_;
  double period_;
  ControlCase& out_;
  Taken& taken_;
};

}  // namespace

ControlCase case_of_step(const TrialSpec& spec, const World& world, long k) {
  if (spec.plugin != nullptr)
    throw std::invalid_argument("a plugin's steps have no cases: what it remembers is its own");
  ControlCase out;
  out.robot = *spec.robot;
  out.controller = told_params(spec);
  out.control_period = spec.simulation.control_period;
  out.has_plan = out.controller.plan.enabled;
  Witness::Taken taken;
  TrialParts parts;
  parts.controller = [&](const TrialSpec& p) { return std::make_unique<Witness>(p, k, out, taken); };
  const TrialOutput trial = run_trial(spec, world, parts);
  if (!taken.found) {
    throw std::invalid_argument(
        static_cast<std::size_t>(k) < trial.trace.size()
            ? fmt::format("control step {} of the trial was missed (disturbances.control.missed)", k)
            : fmt::format("the trial has no control step {}: it ends after {}", k, trial.trace.size()));
  }
  if (taken.waits)
    throw std::invalid_argument(
        fmt::format("control step {} has no case: the controller brakes until each sensor has sent a frame", k));
  return out;
}

namespace {

/// moma's controller, and after each of its steps the rows of its problem and the boxes of its map.
class DetailWitness final : public StepController {
 public:
  DetailWitness(const TrialSpec& spec, TrialDetail& out)
      : controller_(spec.robot->model, told_params(spec), spec.simulation.control_period), out_(out) {}

  void reset(std::span<const ObjectShape> objects) override {
    controller_.reset(objects);
    out_ = {};
    for (const auto& link : controller_.model().links) out_.names.push_back(link.name);
    for (const std::string& object : controller_.object_names()) out_.names.push_back(object);
    out_.names.emplace_back("floor");
    if (controller_.map().on()) out_.cell = controller_.map().map().cell();
    shown_.assign(controller_.map().count(), kNone);
    next_ = 0;
  }
  void see(const DepthFrame& frame) noexcept override {
    if (controller_.model().sensors[static_cast<std::size_t>(frame.sensor)].sensor.head.turns())
      out_.looks.push_back({frame.sensor, frame.time, frame.gaze});
    controller_.see(frame);
  }
  Gaze gaze(int sensor) const noexcept override { return controller_.gaze(sensor); }
  void step(const Observation& observation, StepResult& result) noexcept override {
    controller_.step(observation, result);
    if (controller_.params().method == Method::kQp && result.status != StepStatus::kInvalidInput)
      note_rows(observation.time, result.fallback != Fallback::kBrake);
    const auto picture = static_cast<int>(std::floor(observation.time * TrialDetail::kMapRate + 1e-6));
    if (picture >= next_) note_boxes(picture);
  }
  void prepare(StepResult& result) const override { controller_.prepare(result); }
  std::string_view failure() const noexcept override { return controller_.failure(); }

 private:
  int link_of(int shape) const { return controller_.model().shape(shape).link; }

  void note_rows(double t, bool solved) {
    const QpProblem problem = controller_.final_problem();
    const auto x = controller_.solution().x.head(problem.n());
    const int links = static_cast<int>(controller_.model().links.size());
    for (int i = 0; i < problem.rows; ++i) {
      const RowId& id = problem.ids[static_cast<std::size_t>(i)];
      if (!is_collision(id.kind)) continue;
      int second = links + id.second;
      if (id.kind == RowKind::kFloor) second = static_cast<int>(out_.names.size()) - 1;
      if (id.kind == RowKind::kSelf) second = link_of(id.second);
      out_.rows.push_back({t, id, link_of(id.first), second, solved && problem.holds(i, x)});
    }
  }

  void note_boxes(int picture) {
    next_ = picture + 1;
    const std::span<const ObjectState> states = controller_.map().states();
    for (std::size_t i = 0; i < shown_.size(); ++i) {
      const auto in_cells = [&](const Vector3& p) {
        return Eigen::Vector3i((p / out_.cell).array().round().cast<int>());
      };
      const ObjectState& state = states[i];
      if (!state.visible) {
        shown_[i] = kNone;
        continue;
      }
      const Vector3 half = 0.5 * state.box, middle = state.X_WO.translation();
      const CellBox cells{in_cells(middle - half), in_cells(middle + half)};
      const bool same = shown_[i] != kNone && out_.boxes[shown_[i]].cells.low == cells.low &&
                        out_.boxes[shown_[i]].cells.high == cells.high;
      if (!same) {
        shown_[i] = out_.boxes.size();
        out_.boxes.push_back({picture, picture, state.seen, cells});
      }
      out_.boxes[shown_[i]].to = next_;
    }
  }

  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  ControllerCore controller_;
  TrialDetail& out_;
  std::vector<std::size_t> shown_;  // of each object of the map its box in out_, or kNone
  int next_ = 0;                    // picture
};

}  // namespace

TrialOutput run_trial(const TrialSpec& spec, const World& world, TrialDetail& detail) {
  detail = {};
  TrialParts parts;
  if (spec.plugin == nullptr)
    parts.controller = [&](const TrialSpec& p) { return std::make_unique<DetailWitness>(p, detail); };
  return run_trial(spec, world, parts);
}

namespace {

Json sample_json(const Sample& sample) {
  Json json = Json::object();
  for_members<Sample>([&]<class M>(std::string_view name, M Sample::*member, const SampleColumn&) {
    const M& value = sample.*member;
    Json& out = json[std::string(name)];
    if constexpr (std::is_same_v<M, double>) {
      out = config::number_or_word(value);
    } else if constexpr (std::is_arithmetic_v<M>) {
      out = value;
    } else if constexpr (std::is_enum_v<M>) {
      out = to_string(value);
    } else if constexpr (Described<M>) {
      out = config::write_described(value);
    } else {
      out = Json::array();
      for (const double x : value) out.push_back(config::number_or_word(x));
    }
  });
  return json;
}

}  // namespace

Json trace_json(const TrialSpec& spec, const World& world, const TrialOutput& output, const std::string& trial) {
  Json json = Json::object();
  json["trial"] = trial;
  json["outcome"] = to_string(output.row.outcome);
  json["robot"] = spec.robot->resolved;
  const Json sections = sections_json(spec);
  for (const char* name : {"success", "stuck", "infeasible"}) json[name] = sections.at(name);
  json["controller"] = spec.controller_resolved;
  json["world"] = to_json(world);
  for (const char* name : {"simulation", "disturbances"})
    if (sections.contains(name)) json[name] = sections.at(name);
  Json& samples = json["samples"] = Json::array();
  for (const Sample& sample : output.trace) samples.push_back(sample_json(sample));
  return json;
}

}  // namespace moma
