#include "plugin/host/plugin_controller.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <utility>

#include "controller/closed_form/closed_form.h"
#include "controller/model/utf8.h"

namespace moma {
namespace {

static_assert(static_cast<int>(BaseType::kFixed) == MOMA_BASE_FIXED &&
              static_cast<int>(BaseType::kDifferential) == MOMA_BASE_DIFFERENTIAL &&
              static_cast<int>(BaseType::kOmnidirectional) == MOMA_BASE_OMNIDIRECTIONAL);
static_assert(static_cast<int>(ShapeKind::kSphere) == MOMA_SPHERE && static_cast<int>(ShapeKind::kBox) == MOMA_BOX &&
              static_cast<int>(ShapeKind::kCylinder) == MOMA_CYLINDER &&
              static_cast<int>(ShapeKind::kCapsule) == MOMA_CAPSULE &&
              static_cast<int>(ShapeKind::kConvex) == MOMA_CONVEX);
static_assert(static_cast<int>(StepStatus::kSolved) == MOMA_SOLVED &&
              static_cast<int>(StepStatus::kInvalidInput) == MOMA_INVALID_INPUT &&
              static_cast<int>(Fallback::kNone) == MOMA_NONE && static_cast<int>(Fallback::kBrake) == MOMA_BRAKE);

void write_matrix(const Matrix3& matrix, double (&by_rows)[9]) {
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> out(by_rows);
  out = matrix;
}

void write_pose(const Isometry& X, double (&position)[3], double (&rotation)[9]) {
  Eigen::Map<Vector3> p(position);
  p = X.translation();
  write_matrix(X.linear(), rotation);
}

// Flat copies of the objects' shapes, for one call.
class Shapes {
 public:
  explicit Shapes(std::span<const ObjectShape> objects) : vertices_(objects.size()), triangles_(objects.size()) {
    for (std::size_t i = 0; i < objects.size(); ++i) {
      const ObjectShape& object = objects[i];
      moma_object_shape& out = shapes_.emplace_back();
      out.name = object.name.c_str();
      out.kind = static_cast<std::int32_t>(object.shape.kind);
      std::copy(object.shape.size.begin(), object.shape.size.end(), out.size);
      if (object.shape.hull == nullptr) continue;
      for (const Vector3& v : object.shape.hull->vertices) vertices_[i].insert(vertices_[i].end(), v.begin(), v.end());
      for (const Eigen::Vector3i& t : object.shape.hull->triangles)
        triangles_[i].insert(triangles_[i].end(), t.begin(), t.end());
      out.num_vertices = object.shape.hull->vertices.size();
      out.vertices = vertices_[i].data();
      out.num_triangles = object.shape.hull->triangles.size();
      out.triangles = triangles_[i].data();
    }
  }
  const std::vector<moma_object_shape>& get() const { return shapes_; }

 private:
  std::vector<moma_object_shape> shapes_;
  std::vector<std::vector<double>> vertices_;
  std::vector<std::vector<std::int32_t>> triangles_;
};

}  // namespace

std::string plugin_says(PluginText& text, const char* otherwise) {
  text.back() = '\0';
  std::string message(text.data());
  for (std::size_t i = 0; i < message.size();) {
    const std::size_t length = utf8_length(std::string_view(message).substr(i));
    if (length == 0) message[i] = '?';
    if (length == 1 && (static_cast<unsigned char>(message[i]) < ' ' || message[i] == 0x7f)) message[i] = ' ';
    i += std::max<std::size_t>(length, 1);
  }
  return message.empty() ? otherwise : message;
}

PluginController::PluginController(std::shared_ptr<const Plugin> plugin)
    : plugin_(std::move(plugin)),
      limits_(plugin_->model().velocity_limits()),
      command_(VectorX::Zero(limits_.size())) {}

PluginController::~PluginController() { stop(); }

void PluginController::stop() noexcept {
  std::string thrown;
  if (controller_ != nullptr) plugin_call(thrown, [&] { plugin_->library().functions.stop(controller_); });
  controller_ = nullptr;
}

void PluginController::reset(std::span<const ObjectShape> objects) {
  stop();
  failure_.clear();
  failure_.reserve(2 * text_.size());
  const Shapes shapes(objects);
  text_ = {};
  std::string thrown;
  const bool returned = plugin_call(thrown, [&] {
    controller_ = plugin_->library().functions.start(plugin_->handle(), shapes.get().data(), shapes.get().size(),
                                                     text_.data(), text_.size());
  });
  if (!returned) throw PluginError("the plugin throws when it starts: " + thrown);
  if (controller_ == nullptr) throw PluginError("the plugin does not start: " + plugin_says(text_, "no reason given"));
  objects_.resize(objects.size());
}

void PluginController::prepare(StepResult& result) const { result.command = VectorX::Zero(limits_.size()); }

void PluginController::fail(std::string_view what, std::string_view detail, StepResult& result) noexcept {
  result.command.setZero();
  result.status = StepStatus::kInvalidInput;
  result.fallback = Fallback::kBrake;
  try {
    failure_ = fmt::format("the plugin {}{}{}", what, detail.empty() ? "" : ": ", detail);
  } catch (...) {
    failure_ = "the plugin failed";  // short enough to need no memory
  }
}

void PluginController::step(const Observation& observation, StepResult& result) noexcept {
  if (!failure_.empty() || controller_ == nullptr || observation.q.size() != plugin_->model().num_joints() ||
      observation.qdot.size() != limits_.size() || observation.objects.size() != objects_.size() ||
      result.command.size() != limits_.size()) {
    if (failure_.empty()) fail("got an observation of another robot or of other objects", {}, result);
    return;
  }
  seen_.time = observation.time;
  std::copy(observation.base.begin(), observation.base.end(), seen_.base);
  seen_.q = observation.q.data();
  seen_.qdot = observation.qdot.data();
  write_pose(observation.goal.X_WG, seen_.goal_position, seen_.goal_rotation);
  std::copy(observation.goal.V_WG_W.begin(), observation.goal.V_WG_W.end(), seen_.goal_twist);
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const ObjectState& object = observation.objects[i];
    write_pose(object.X_WO, objects_[i].position, objects_[i].rotation);
    std::copy(object.V_WO_W.begin(), object.V_WO_W.end(), objects_[i].twist);
    objects_[i].visible = object.visible ? 1 : 0;
    objects_[i].has_covariance = object.covariance ? 1 : 0;
    if (!object.covariance) continue;
    write_matrix(object.covariance->position_W, objects_[i].position_covariance);
    write_matrix(object.covariance->velocity_W, objects_[i].velocity_covariance);
  }
  seen_.objects = objects_.data();
  seen_.num_objects = objects_.size();

  answer_ = {};
  answer_.command = command_.data();
  answer_.least_distance = kInfinity;
  command_.setConstant(std::numeric_limits<double>::quiet_NaN());
  text_[0] = '\0';
  int failed = 0;
  std::string thrown;
  const bool returned = plugin_call(thrown, [&] {
    failed = plugin_->library().functions.step(controller_, &seen_, &answer_, text_.data(), text_.size());
  });
  if (!returned) return fail("throws", thrown, result);
  if (failed != 0) return fail("fails", plugin_says(text_, "no reason given"), result);
  for (Eigen::Index i = 0; i < command_.size(); ++i) {
    if (std::isfinite(command_[i])) continue;
    return fail(
        fmt::format("commands {} for {}", command_[i], plugin_->model().velocity_names()[static_cast<std::size_t>(i)]),
        {}, result);
  }
  if (!read(result)) fail("answers with a status, fallback or slack that does not exist", {}, result);
}

bool PluginController::read(StepResult& result) noexcept {
  const auto exists = [](std::int32_t value) { return value >= 0 && value <= 3; };
  const Eigen::Map<const Vector6> slack(answer_.slack);
  if (!exists(answer_.status) || !exists(answer_.fallback) || !slack.allFinite()) return false;
  result.command = command_;
  scale_into_limits(plugin_->model(), limits_, result.command);
  result.status = static_cast<StepStatus>(answer_.status);
  result.fallback = static_cast<Fallback>(answer_.fallback);
  result.slack = slack;
  result.least_distance = std::isnan(answer_.least_distance) ? kInfinity : answer_.least_distance;
  result.rows = answer_.rows;
  result.active_rows = answer_.active_rows;
  result.iterations = answer_.iterations;
  result.solve_seconds = std::isfinite(answer_.solve_seconds) ? std::max(0.0, answer_.solve_seconds) : 0.0;
  return true;
}

}  // namespace moma
