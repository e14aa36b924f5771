#include "eval/trial/rows_of_trial.h"

#include "controller/controller_core.h"
#include "eval/trial/told_params.h"

namespace moma {
namespace {

/// A row whose value is this near to its bound is at it [m/s].
constexpr double kActive = 1e-7;

/// moma's controller, and after each of its steps the rows of its problem.
class RowWitness final : public StepController {
 public:
  RowWitness(const TrialSpec& spec, TrialRows& out)
      : controller_(spec.robot->model, told_params(spec), spec.simulation.control_period), out_(out) {}

  void reset(std::span<const ObjectShape> objects) override {
    controller_.reset(objects);
    out_ = {};
    for (const auto& link : controller_.model().links) out_.names.push_back(link.name);
    for (const std::string& object : controller_.object_names()) out_.names.push_back(object);
    out_.names.emplace_back("floor");
  }
  void step(const Observation& observation, StepResult& result) noexcept override {
    controller_.step(observation, result);
    if (controller_.params().method == Method::kQp && result.status != StepStatus::kInvalidInput)
      note(observation.time, result.fallback != Fallback::kBrake);
  }
  void prepare(StepResult& result) const override { controller_.prepare(result); }
  std::string_view failure() const noexcept override { return controller_.failure(); }

 private:
  int link_of(int shape) const { return controller_.model().shapes[static_cast<std::size_t>(shape)].link; }

  void note(double t, bool solved) {
    const QpProblem problem = controller_.final_problem();
    const VectorX& x = controller_.solution().x;
    const int links = static_cast<int>(controller_.model().links.size());
    for (int i = 0; i < problem.rows; ++i) {
      const RowId& id = problem.ids[static_cast<std::size_t>(i)];
      if (!is_collision(id.kind) && id.kind != RowKind::kPassing) continue;
      const double value = problem.A.row(i).dot(x.head(problem.n()));
      int second = links + id.second;
      if (id.kind == RowKind::kFloor) second = static_cast<int>(out_.names.size()) - 1;
      if (id.kind == RowKind::kSelf) second = link_of(id.second);
      out_.rows.push_back({t, id, link_of(id.first), second,
                           solved && (value - problem.lbA[i] < kActive || problem.ubA[i] - value < kActive)});
    }
  }

  ControllerCore controller_;
  TrialRows& out_;
};

}  // namespace

TrialOutput run_trial(const TrialSpec& spec, const World& world, TrialRows& rows) {
  rows = {};
  TrialParts parts;
  if (spec.plugin == nullptr)
    parts.controller = [&](const TrialSpec& p) { return std::make_unique<RowWitness>(p, rows); };
  return run_trial(spec, world, parts);
}

}  // namespace moma
