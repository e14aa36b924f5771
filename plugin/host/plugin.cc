#include "plugin/host/plugin.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "controller/closed_form/closed_form.h"
#include "controller/describe/check.h"
#include "controller/model/text_check.h"
#include "controller/step.h"
#include "plugin/border.h"

namespace moma {
namespace {

static_assert(static_cast<int>(BaseType::kFixed) == MOMA_BASE_FIXED &&
              static_cast<int>(BaseType::kDifferential) == MOMA_BASE_DIFFERENTIAL &&
              static_cast<int>(BaseType::kOmnidirectional) == MOMA_BASE_OMNIDIRECTIONAL &&
              words(Of<BaseType>{}).size() == MOMA_BASE_TYPES);
static_assert(static_cast<int>(ShapeKind::kSphere) == MOMA_SPHERE && static_cast<int>(ShapeKind::kBox) == MOMA_BOX &&
              static_cast<int>(ShapeKind::kCylinder) == MOMA_CYLINDER &&
              static_cast<int>(ShapeKind::kCapsule) == MOMA_CAPSULE &&
              static_cast<int>(ShapeKind::kConvex) == MOMA_CONVEX);
static_assert(static_cast<int>(StepStatus::kSolved) == MOMA_SOLVED &&
              static_cast<int>(StepStatus::kInvalidInput) == MOMA_INVALID_INPUT &&
              static_cast<int>(Fallback::kNone) == MOMA_NONE && static_cast<int>(Fallback::kBrake) == MOMA_BRAKE);

static_assert(sizeof(Vector3) == sizeof(double[3]) && sizeof(Eigen::Vector3i) == sizeof(std::int32_t[3]));

// The objects' shapes as C has them; they point into `objects`.
std::vector<moma_object_shape> shapes_of(std::span<const ObjectShape> objects) {
  std::vector<moma_object_shape> shapes;
  for (const ObjectShape& object : objects) {
    moma_object_shape& out = shapes.emplace_back();
    out.name = object.name.c_str();
    out.kind = static_cast<std::int32_t>(object.shape.kind);
    std::copy(object.shape.size.begin(), object.shape.size.end(), out.size);
    if (object.shape.hull == nullptr) continue;
    const ConvexHull& hull = *object.shape.hull;
    out.num_vertices = hull.vertices.size();
    out.vertices = reinterpret_cast<const double*>(hull.vertices.data());
    out.num_triangles = hull.triangles.size();
    out.triangles = reinterpret_cast<const std::int32_t*>(hull.triangles.data());
  }
  return shapes;
}

/// Buffer for a plugin's message.
using PluginText = std::array<char, 4096>;

/// Returns its message without control characters and invalid UTF-8; `otherwise` if there is none.
std::string plugin_says(PluginText& text, const char* otherwise) {
  text.back() = '\0';
  std::string message = without_controls(text.data());
  for (std::size_t i = 0; i < message.size();) {
    const std::size_t length = utf8_length(std::string_view(message).substr(i));
    if (length == 0) message[i] = '?';
    i += std::max<std::size_t>(length, 1);
  }
  return message.empty() ? otherwise : message;
}

/// See Plugin::make().
class PluginController final : public StepController {
 public:
  explicit PluginController(std::shared_ptr<const Plugin> plugin)
      : plugin_(std::move(plugin)),
        limits_(plugin_->model().velocity_limits()),
        command_(VectorX::Zero(limits_.size())) {}
  ~PluginController() override { stop(); }
  PluginController(const PluginController&) = delete;
  PluginController& operator=(const PluginController&) = delete;

  void reset(std::span<const ObjectShape> objects) override {
    stop();
    failure_.clear();
    failure_.reserve(2 * text_.size());
    const std::vector<moma_object_shape> shapes = shapes_of(objects);
    text_ = {};
    const auto thrown = plugin::thrown_by([&] {
      controller_ = plugin_->library().functions.start(plugin_->handle(), shapes.data(), shapes.size(), text_.data(),
                                                       text_.size());
    });
    if (thrown) throw PluginError("the plugin throws when it starts: " + *thrown);
    if (controller_ == nullptr)
      throw PluginError("the plugin does not start: " + plugin_says(text_, "no reason given"));
    num_objects_ = objects.size();
    const RobotModel& model = plugin_->model();
    numbers_.resize(plugin::count_numbers(model.joints.size(), static_cast<std::size_t>(limits_.size()), num_objects_));
  }
  void step(const Observation& observation, StepResult& result) noexcept override {
    if (!failure_.empty() || controller_ == nullptr || observation.q.size() != plugin_->model().num_joints() ||
        observation.qdot.size() != limits_.size() || observation.objects.size() != num_objects_ ||
        result.command.size() != limits_.size()) {
      if (failure_.empty()) fail("got an observation of another robot or of other objects", {}, result);
      return;
    }
    pack(observation, numbers_.data());
    std::memcpy(&seen_, numbers_.data(), offsetof(moma_observation, q));
    seen_.q = numbers_.data() + fixed_numbers<Observation>();
    seen_.qdot = seen_.q + observation.q.size();
    seen_.objects = reinterpret_cast<const moma_object_state*>(seen_.qdot + observation.qdot.size());
    seen_.num_objects = num_objects_;
    seen_.numbers = numbers_.data();
    seen_.num_numbers = numbers_.size();

    answer_ = {};
    answer_.command = command_.data();
    answer_.least_distance = kInfinity;
    command_.setConstant(std::numeric_limits<double>::quiet_NaN());
    text_[0] = '\0';
    int failed = 0;
    const auto thrown = plugin::thrown_by(
        [&] { failed = plugin_->library().functions.step(controller_, &seen_, &answer_, text_.data(), text_.size()); });
    if (thrown) return fail("throws", *thrown, result);
    if (failed != 0) return fail("fails", plugin_says(text_, "no reason given"), result);
    for (Eigen::Index i = 0; i < command_.size(); ++i) {
      if (std::isfinite(command_[i])) continue;
      return fail(fmt::format("commands {} for {}", command_[i],
                              plugin_->model().velocity_names()[static_cast<std::size_t>(i)]),
                  {}, result);
    }
    read(result);
  }
  void prepare(StepResult& result) const override { result.command = VectorX::Zero(limits_.size()); }
  std::string_view failure() const noexcept override { return failure_; }

 private:
  void stop() noexcept {
    if (controller_ != nullptr) plugin::thrown_by([&] { plugin_->library().functions.stop(controller_); });
    controller_ = nullptr;
  }
  void fail(std::string_view what, std::string_view detail, StepResult& result) noexcept {
    result.command.setZero();
    result.status = StepStatus::kInvalidInput;
    result.fallback = Fallback::kBrake;
    try {
      failure_ = fmt::format("the plugin {}{}{}", what, detail.empty() ? "" : ": ", detail);
    } catch (...) {
      failure_ = "the plugin failed";  // short enough to need no memory
    }
  }
  void read(StepResult& result) noexcept {
    double details[fixed_numbers<Details>()];
    std::memcpy(details, plugin::details_of(answer_), sizeof details);
    unpack_part<Details>(details, checked_);
    std::vector<Violation> wrong;
    description::Check<StepResult> check(checked_, {}, "", wrong);
    describe(check, Of<Details>{});
    if (!wrong.empty())
      return fail(fmt::format("answers, but {} {}", wrong.front().key, wrong.front().message), {}, result);
    result.command = command_;
    scale_into_limits(plugin_->model(), limits_, result.command);
    unpack_part<Details>(details, result);
    result.solve_seconds = std::isfinite(answer_.solve_seconds) ? std::max(0.0, answer_.solve_seconds) : 0.0;
  }

  std::shared_ptr<const Plugin> plugin_;
  void* controller_ = nullptr;
  const VectorX limits_;
  std::size_t num_objects_ = 0;
  std::vector<double> numbers_;  // of an observation
  VectorX command_;
  moma_observation seen_{};
  moma_step_result answer_{};
  StepResult checked_;  // its details
  PluginText text_{};
  std::string failure_;
};

}  // namespace

std::shared_ptr<const Plugin> Plugin::open(std::shared_ptr<const PluginLibrary> library,
                                           std::shared_ptr<const config::LoadedRobot> robot, const Json& parameters,
                                           double control_period) {
  std::shared_ptr<Plugin> plugin(new Plugin);
  plugin->library_ = std::move(library);
  plugin->robot_ = std::move(robot);
  const RobotModel& model = plugin->model();

  const std::string robot_text = plugin->robot_->resolved.dump();
  const std::string parameters_text = parameters.dump();
  std::vector<const char*> names;
  std::vector<double> lower, upper;
  for (const ControlledJoint& joint : model.joints) {
    names.push_back(joint.name.c_str());
    lower.push_back(joint.lower);
    upper.push_back(joint.upper);
  }
  const VectorX limits = model.velocity_limits();
  moma_plugin_setup setup{};
  setup.robot = robot_text.c_str();
  setup.parameters = parameters_text.c_str();
  setup.control_period = control_period;
  setup.base_type = static_cast<std::int32_t>(model.base.type);
  setup.num_joints = model.joints.size();
  setup.num_velocities = static_cast<std::size_t>(limits.size());
  setup.joints = names.data();
  setup.lower = lower.data();
  setup.upper = upper.data();
  setup.ready = model.ready.data();
  setup.velocity_limits = limits.data();

  PluginText text{};
  const auto thrown =
      plugin::thrown_by([&] { plugin->handle_ = plugin->library_->functions.open(&setup, text.data(), text.size()); });
  if (thrown) throw PluginError("moma_plugin_open() throws: " + *thrown);
  if (plugin->handle_ == nullptr) throw PluginError(plugin_says(text, "it refuses this robot and these parameters"));
  return plugin;
}

Plugin::~Plugin() {
  if (handle_ != nullptr) plugin::thrown_by([&] { library_->functions.close(handle_); });
}

std::unique_ptr<StepController> Plugin::make() const { return std::make_unique<PluginController>(shared_from_this()); }

}  // namespace moma
