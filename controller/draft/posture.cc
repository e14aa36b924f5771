#include "controller/draft/posture.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "controller/config/robot_build.h"
#include "controller/model/floor_reach.h"
#include "controller/model/manipulability.h"
#include "controller/model/proximity.h"
#include "controller/model/sampling.h"
#include "controller/model/statics.h"

namespace moma::draft {
namespace {

constexpr int kSamples = 2000;
constexpr double kInner = 0.9;   // share of the limits
constexpr double kMostly = 0.8;  // share of configurations; pairs that touch in more of them are ignored
constexpr double kFloor = 0.05;  // [m]
constexpr double kApart = 0.03;  // between the arm's shapes: simpler shapes, fitted later, are larger [m]
constexpr double kSpare = 0.9;   // share of an effort
constexpr double kRoom = 0.15;   // share of a joint's range to its limit that is enough
constexpr double kTurn = 0.6 * std::numbers::pi;  // [rad]
constexpr double kLow = 0.2;                      // height of E above the floor [m]

class PostureFinder {
 public:
  explicit PostureFinder(const RobotModel& source)
      : model_(with_pairs(source)), kinematics_(model_), proximity_(model_), reach_(floor_reach(*model_)) {}

  Posture find(PostureFor what) {
    what_ = what;
    leave_out_touching();
    Posture best;
    double most = -1.0;
    for (int s = 1; s <= kSamples; ++s) {
      VectorX q = sample(s);
      for (double& value : q) value = std::round(100.0 * value) / 100.0;
      const double score = judge(std::move(q));
      if (score <= most) continue;
      most = score;
      best = judged_;
    }
    return best;
  }

 private:
  static std::shared_ptr<const RobotModel> with_pairs(const RobotModel& source) {
    RobotModel model = source;
    model.self_pairs = config::movable_pairs(source);
    return std::make_shared<const RobotModel>(std::move(model));
  }

  VectorX sample(int s) const {
    VectorX q(model_->num_joints());
    for (int i = 0; i < q.size(); ++i) {
      const ControlledJoint& joint = model_->joint(i);
      auto [lower, upper] = drawn_range(joint);
      // A range of more than one turn is best near zero.
      if (joint.type != JointType::kPrismatic && upper - lower > 1.5 * std::numbers::pi) {
        lower = std::max(lower, -kTurn);
        upper = std::min(upper, kTurn);
      }
      const double share = halton_coordinate(s, i);
      q[i] = lower + (upper - lower) * (0.5 + kInner * (share - 0.5));
    }
    return q;
  }

  // Ignores pairs of neighbouring shapes, which are near each other in any posture.
  void leave_out_touching() {
    std::vector<int> touches(model_->self_pairs.size(), 0);
    constexpr int kLooks = 200;
    for (int s = 1; s <= kLooks; ++s) {
      kinematics_.update(Vector3::Zero(), sample(s));
      config::visit_near_pairs(proximity_, kinematics_, kApart, [&](std::size_t pair, double) { ++touches[pair]; });
    }
    for (const int count : touches) ignored_.push_back(count > kMostly * kLooks);
  }

  bool on_floor(std::size_t i) const {
    const CollisionShape& shape = model_->shapes[i];
    return reach_.lifted[i] && lowest_point(shape.shape, kinematics_.X_WS(shape)) < kFloor;
  }

  bool clear() {
    bool touching = false;
    config::visit_near_pairs(proximity_, kinematics_, kApart,
                             [&](std::size_t pair, double) { touching = touching || !ignored_[pair]; });
    if (touching) return false;
    for (std::size_t i = 0; i < model_->shapes.size(); ++i)
      if (on_floor(i)) return false;
    return true;
  }

  bool held() const {
    const VectorX efforts = holding_efforts(kinematics_);
    for (int i = 0; i < efforts.size(); ++i) {
      const double limit = model_->joint(i).effort;
      if (limit > 0.0 && std::abs(efforts[i]) > kSpare * limit) return false;
    }
    return true;
  }

  double room(const VectorX& q) const {
    double least = kRoom;
    for (int i = 0; i < q.size(); ++i) {
      const ControlledJoint& joint = model_->joint(i);
      if (joint.type == JointType::kContinuous) continue;
      least = std::min(least, std::min(q[i] - joint.lower, joint.upper - q[i]) / (joint.upper - joint.lower));
    }
    return std::max(0.0, least) / kRoom;
  }

  // Largest distance of the arm's shapes from the upright line through B, counting distances ahead twice: another arm
  // works there [m].
  double spread() const {
    double most = 0.0;
    for (const CollisionShape& shape : model_->shapes) {
      if (shape.rigid_with_base) continue;
      const Vector3 p = kinematics_.X_WS(shape).translation();
      most = std::max(most, std::hypot(p.x() > 0.0 ? 2.0 * p.x() : p.x(), p.y()) + bounding_radius(shape.shape));
    }
    return most;
  }

  double judge(VectorX q) {
    kinematics_.update(Vector3::Zero(), q);
    const auto arm = kinematics_.J_WE_W().rightCols(model_->num_joints());
    judged_ = {std::move(q), manipulability(arm, ManipulabilityRows::kTranslation), clear(), held()};
    const Vector3 p_E = kinematics_.X_WE().translation();
    const double inviting = (p_E.x() < 0.0 ? 0.5 : 1.0) * (p_E.z() < kLow ? 0.5 : 1.0);
    // Robots whose E cannot move in all directions have no manipulability, and are ranked by their joints' distances
    // from limits.
    const double worth = what_ == PostureFor::kReady ? (1e-3 + judged_.manipulability) * room(judged_.q) * inviting
                                                     : 1.0 / (0.1 + spread());
    constexpr double kFar = 1e3;  // above any worth
    return worth + (judged_.clear ? 2.0 * kFar : 0.0) + (judged_.held ? kFar : 0.0);
  }

  std::shared_ptr<const RobotModel> model_;
  Kinematics kinematics_;
  Proximity proximity_;
  FloorReach reach_;
  std::vector<bool> ignored_;
  PostureFor what_ = PostureFor::kReady;
  Posture judged_;
};

}  // namespace

Posture find_posture(const RobotModel& model, PostureFor what) { return PostureFinder(model).find(what); }

}  // namespace moma::draft
