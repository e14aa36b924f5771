#include "controller/qp/passing.h"

#include <algorithm>
#include <cmath>

#include "controller/model/base_kind.h"

namespace moma {
namespace {

constexpr double kAbove = 0.05;     // least vertical distance of solids without a row [m]
constexpr double kNear = 1.0;       // nearer objects count as traffic [m]
constexpr double kWidest = 0.8;     // sine of the largest rotation of a tangent by the clearance
constexpr double kTiny = 1e-9;      // [m]
constexpr int kMaxIterations = 30;  // of Newton's method, which usually takes six or seven

Vector3 horizontal(const Vector3& v) noexcept { return {v.x(), v.y(), 0.0}; }
Vector3 left_of(const Vector3& v) noexcept { return {-v.y(), v.x(), 0.0}; }

double highest_point(const Shape& shape, const Isometry& X_WS) noexcept {
  return extent_along(shape, X_WS, Vector3::UnitZ());
}

}  // namespace

Tangent passing_tangent(const Shape& robot, const Isometry& X_WR, const Shape& object, const Isometry& X_WO,
                        const Vector3& v_W) noexcept {
  const Vector3 centre = horizontal(X_WO.translation() - X_WR.translation());
  const double distance = centre.norm();
  if (!(distance > kTiny)) return {};
  Vector3 n = left_of(centre) / distance;
  const double side = n.dot(v_W) > 0.0 ? -1.0 : 1.0;
  n *= side;
  // Newton's method in the angle of n for max {n^T m : m in M} = 0. Across the line of centres the maximum is positive;
  // each further n is perpendicular to the extreme point of the last one, so that no step overshoots.
  for (int k = 0; k < kMaxIterations; ++k) {
    const Vector3 m = horizontal(support_point(object, X_WO, n) - support_point(robot, X_WR, -n));
    const double length = m.norm();
    if (!(length > kTiny)) return {};
    if (n.dot(m) <= kTiny * length) return {true, n, m / length, length};
    n = side / length * left_of(m);
  }
  return {};
}

PassingRows::PassingRows(const RobotModel& model, const CollisionParams& params)
    : model_(&model),
      params_(params.passing),
      max_rows_(static_cast<std::size_t>(params.max_pairs)),
      J_(3, model.num_velocities()),
      row_(model.num_velocities()) {
  if (!params.object.enabled || !params_.enabled || model.base_dof() == 0) return;
  for (std::size_t i = 0; i < model.shapes.size(); ++i)
    if (model.shapes[i].rigid_with_base) shapes_.push_back(static_cast<int>(i));
}

int PassingRows::allocate(int num_objects) {
  const std::size_t pairs = shapes_.size() * static_cast<std::size_t>(num_objects);
  chosen_.clear();
  chosen_.reserve(pairs);
  return static_cast<int>(std::min(pairs, max_rows_));
}

void PassingRows::select(const Kinematics& kinematics, const Proximity& proximity,
                         std::span<const ObjectState> states) noexcept {
  chosen_.clear();
  if (shapes_.empty()) return;
  const std::size_t count = std::min(states.size(), static_cast<std::size_t>(proximity.num_objects()));
  for (std::size_t j = 0; j < count; ++j) {
    const ObjectState& state = states[j];
    const double speed = horizontal(state.V_WO_W.tail<3>()).norm();
    if (!state.visible || !(speed > kAtRest) || !is_pose(state.X_WO)) continue;
    const Shape& object = proximity.object_shape(static_cast<int>(j));
    const double top = highest_point(object, state.X_WO) + kAbove, bottom = lowest_point(object, state.X_WO) - kAbove;
    for (const int i : shapes_) {
      const CollisionShape& shape = model_->shapes[static_cast<std::size_t>(i)];
      const Isometry X_WS = kinematics.X_WS(shape);
      if (lowest_point(shape.shape, X_WS) > top || highest_point(shape.shape, X_WS) < bottom) continue;
      const Vector3 centre = horizontal(state.X_WO.translation() - X_WS.translation());
      const double distance = centre.norm();
      if (!(distance > kTiny) || chosen_.size() == chosen_.capacity()) continue;
      const Vector3 to = centre / distance;
      const double gap = to.dot(support_point(object, state.X_WO, -to) - support_point(shape.shape, X_WS, to));
      // Largest speed of the shape's centre, which also turns about B.
      const double offset = horizontal(X_WS.translation() - kinematics.X_WB().translation()).norm();
      const double fastest =
          std::sqrt(static_cast<double>(kind_of(model_->base.type).num_linear())) * model_->base.max_linear +
          offset * model_->base.max_angular;
      if (gap < params_.horizon * (speed + fastest)) chosen_.push_back({gap, i, static_cast<int>(j)});
    }
  }
  std::sort(chosen_.begin(), chosen_.end(), [](const ApproachingPair& a, const ApproachingPair& b) {
    if (a.gap != b.gap) return a.gap < b.gap;
    return a.object != b.object ? a.object < b.object : a.shape < b.shape;
  });
}

bool PassingRows::near() const noexcept { return !chosen_.empty() && chosen_.front().gap < kNear; }

void PassingRows::add(const Kinematics& kinematics, const Proximity& proximity, std::span<const ObjectState> states,
                      QpProblem& problem) noexcept {
  const std::size_t kept = std::min(chosen_.size(), max_rows_);
  for (std::size_t k = 0; k < kept; ++k) {
    const ApproachingPair& pair = chosen_[k];
    append(kinematics, pair, proximity.object_shape(pair.object), states[static_cast<std::size_t>(pair.object)],
           problem);
  }
}

void PassingRows::append(const Kinematics& kinematics, const ApproachingPair& pair, const Shape& object,
                         const ObjectState& state, QpProblem& problem) noexcept {
  const CollisionShape& shape = model_->shapes[static_cast<std::size_t>(pair.shape)];
  const Isometry X_WS = kinematics.X_WS(shape);
  const Vector3 v = horizontal(state.V_WO_W.tail<3>());
  const Tangent tangent = passing_tangent(shape.shape, X_WS, object, state.X_WO, v);
  if (!tangent.exists) return;
  const double sine = std::min(params_.clearance / tangent.length, kWidest);
  const Vector3 n = std::sqrt(1.0 - sine * sine) * tangent.n_W - sine * tangent.along_W;
  kinematics.point_jacobian(shape.link, X_WS.translation(), J_);
  row_.noalias() = -J_.transpose() * n;
  if (row_.cwiseAbs().maxCoeff() < kNoEffect) return;
  const double limit = std::max(pair.gap, 0.0) / params_.horizon - n.dot(v);
  const Vector3 centre = X_WS.translation();
  const int row = problem.append({RowKind::kPassing, pair.shape, pair.object, 0, true, pair.gap, centre, centre + n},
                                 -kInfinity, limit);
  if (row < 0) return;
  problem.A.row(row).head(row_.size()) = row_.transpose();
}

}  // namespace moma
