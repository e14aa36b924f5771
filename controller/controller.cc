#include "controller/controller.h"

#include <utility>

#include "controller/controller_core.h"

namespace moma {

Controller::Controller(std::shared_ptr<const RobotModel> model, ControllerParams params, double control_period)
    : core_(std::make_unique<ControllerCore>(std::move(model), std::move(params), control_period)) {}

Controller::~Controller() = default;
Controller::Controller(Controller&&) noexcept = default;
Controller& Controller::operator=(Controller&&) noexcept = default;

void Controller::reset(std::span<const ObjectShape> objects) { core_->reset(objects); }
void Controller::see(const DepthFrame& frame) noexcept { core_->see(frame); }
Gaze Controller::gaze(int sensor) const noexcept { return core_->gaze(sensor); }
void Controller::step(const Observation& observation, StepResult& result) noexcept { core_->step(observation, result); }
void Controller::prepare(StepResult& result) const { core_->prepare(result); }
void Controller::enable_timing(bool on) noexcept { core_->enable_timing(on); }
void Controller::set_clock(StepClock* clock) noexcept { core_->set_clock(clock); }

const RobotModel& Controller::model() const noexcept { return core_->model(); }
const ControllerParams& Controller::params() const noexcept { return core_->params(); }
double Controller::control_period() const noexcept { return core_->control_period(); }
const Kinematics& Controller::kinematics() const noexcept { return core_->kinematics(); }
VectorX Controller::wheels() const { return core_->wheels(); }

}  // namespace moma
