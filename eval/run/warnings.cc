#include "eval/run/warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "controller/config/robot_build.h"
#include "controller/config/urdf_collision.h"
#include "controller/model/convex_distance.h"
#include "controller/model/kinematics.h"
#include "controller/model/statics.h"

namespace moma::run {
namespace {

constexpr double kPointRadius = 1e-4;  // radius of the sphere that represents a point [m]

/// Returns the outermost points of a visual in directions that are spread evenly (a Fibonacci lattice), in its link.
std::vector<Vector3> outermost(const config::UrdfCollision& visual) {
  constexpr int kDirections = 200;
  constexpr double kTurn = std::numbers::pi * (3.0 - 2.2360679774997896);
  std::vector<Vector3> points;
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / kDirections, r = std::sqrt(1.0 - z * z);
    const Vector3 n(r * std::cos(kTurn * i), r * std::sin(kTurn * i), z);
    const std::vector<Vector3>& vertices = visual.surface.vertices;
    const auto before = [&](const Vector3& a, const Vector3& b) { return n.dot(a) < n.dot(b); };
    const Vector3 p_S = visual.mesh.empty() ? support_point(visual.shape, Isometry::Identity(), n)
                                            : *std::ranges::max_element(vertices, before);
    const Vector3 p_L = visual.X_LS * p_S;
    if (std::ranges::find(points, p_L) == points.end()) points.push_back(p_L);
  }
  return points;
}

/// The model's shapes at `ready`, built once for many distances.
class ShapesAtReady {
 public:
  explicit ShapesAtReady(const RobotModel& model) : model_(model), kinematics_(std::make_shared<RobotModel>(model)) {
    for (const CollisionShape& shape : model.shapes) solids_.emplace_back(shape.shape);
  }

  const Kinematics& kinematics() const { return kinematics_; }

  /// Gap from a small solid at X_WP to the nearest shape for which `counts` is true; infinite without any. [m]
  template <class Counts>
  double gap(const Solid& small, const Isometry& X_WP, const Counts& counts) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < solids_.size(); ++i) {
      const CollisionShape& shape = model_.shapes[i];
      const Isometry X_WS = kinematics_.X_WS(shape);
      if (!counts(shape) || least_gap(small, X_WP, solids_[i], X_WS) + kPointRadius > least) continue;
      least = std::min(least, signed_distance(small, X_WP, solids_[i], X_WS, convex_).d + kPointRadius);
    }
    return least;
  }

 private:
  const RobotModel& model_;
  Kinematics kinematics_;
  std::vector<Solid> solids_;
  ConvexDistance convex_{0};  // buffers grow on use
};

}  // namespace

std::vector<std::string> wheel_warnings(const RobotModel& model) {
  constexpr double kReach = 0.005;  // [m]
  if (!model.mobile() || !model.base.wheels) return {};
  const Wheels& wheels = *model.base.wheels;
  ShapesAtReady at_ready(model);
  const Solid upright({ShapeKind::kCapsule, Vector3(kPointRadius, 20.0, 0.0), nullptr});
  double most = 0.0;
  for (const double side : {-0.5, 0.5}) {
    for (const double end : {-0.5, 0.5}) {
      for (int i = -4; i <= 4; ++i) {
        Isometry X_WP = at_ready.kinematics().X_WB();
        X_WP.translate(Vector3(end * wheels.wheelbase + 0.25 * i * wheels.radius, side * wheels.separation, 0.0));
        most = std::max(most,
                        at_ready.gap(upright, X_WP, [](const CollisionShape& shape) { return shape.rigid_with_base; }));
      }
    }
  }
  if (std::isinf(most))
    return {"the base has wheels but no collision shape: give it a `footprint`, and its wheels a `width`"};
  if (!(most > kReach)) return {};
  return {
      fmt::format("the wheels extend {:.0f} mm beyond the base's collision shapes, so that their contacts do not "
                  "count: give `wheels` a `width`",
                  1e3 * most)};
}

std::vector<std::string> visual_warnings(const fs::path& robot_file, const RobotModel& model) {
  constexpr double kReach = 0.02;  // [m]
  const bool arm =
      std::ranges::any_of(model.shapes, [](const CollisionShape& shape) { return !shape.rigid_with_base; });
  if (!arm) return {};
  ShapesAtReady at_ready(model);
  const Solid point({ShapeKind::kSphere, Vector3(kPointRadius, 0.0, 0.0), nullptr});
  std::map<std::string, double> reach;
  std::vector<config::UrdfCollision> visuals;
  try {
    visuals = config::load_urdf_collision(robot_file, config::UrdfPart::kVisual);
  } catch (const config::ConfigError&) {
    return {};
  }
  for (const config::UrdfCollision& visual : visuals) {
    const int link = model.find_link(visual.link);
    if (link < 0) continue;
    double& most = reach[visual.link];
    for (const Vector3& p_L : outermost(visual)) {
      Isometry X_WP = at_ready.kinematics().X_WL(link);
      X_WP.translate(p_L);
      most = std::max(most, at_ready.gap(point, X_WP, [&](const CollisionShape& shape) {
        return !config::can_move_against(model, link, shape.link);
      }));
    }
  }
  std::vector<std::pair<double, std::string>> worst;
  for (const auto& [link, most] : reach)
    if (most > kReach) worst.emplace_back(-most, link);
  if (worst.empty()) return {};
  std::ranges::sort(worst);
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(worst.size(), 4); ++i) {
    const auto& [most, link] = worst[i];
    text += (i == 0 ? "" : ", ") + link +
            (std::isinf(most) ? std::string(" (no shape)") : fmt::format(" by {:.0f} mm", -1e3 * most));
  }
  if (worst.size() > 4) text += fmt::format(" and {} more", worst.size() - 4);
  return {fmt::format("{} of {} links look larger than their collision shapes: {}", worst.size(), reach.size(), text)};
}

std::vector<std::string> holding_warnings(const std::shared_ptr<const RobotModel>& model) {
  std::vector<std::string> out;
  for (const JointLoad& load : joint_loads(model)) {
    const ControlledJoint& joint = model->joint(load.joint);
    const char* unit = joint.type == JointType::kPrismatic ? "N" : "Nm";
    if (load.ready > load.limit) {
      out.push_back(
          fmt::format("joint {}: holding the arm at `ready` takes {:.4g} {}, its effort limit is {:.4g}: with physics "
                      "the arm falls",
                      joint.name, load.ready, unit, load.limit));
    } else if (load.largest > load.limit) {
      out.push_back(
          fmt::format("joint {}: in {:.3g} % of the joints' ranges holding the arm takes more than its effort limit of "
                      "{:.4g} {} (up to {:.4g}, at q = [{:.2f}]): with physics it sags there, unless "
                      "arm.limits.{}.effort has the share of springs that help it",
                      joint.name, 100.0 * load.beyond, load.limit, unit, load.largest, fmt::join(load.q_largest, ", "),
                      joint.name));
    }
  }
  return out;
}

void RowWarnings::look(const TrialRow& row, bool identifies) {
  if (row.detector_disagreements > 0) {
    ++contradicted_;
    deepest_ = std::max(deepest_, row.detector_deepest_m);
  }
  messages_ += row.lcp_messages > 0;
  // NaN is no difference.
  if (!identifies) {
    latencies_ += std::abs(row.latency_base_off_s) > 0.0 || std::abs(row.latency_joints_off_s) > 0.0;
    for (const double off : {row.latency_base_off_s, row.latency_joints_off_s})
      if (std::abs(off) > std::abs(latency_off_)) latency_off_ = off;
  }
  errors_ += row.outcome == Outcome::kError;
  diverged_ += row.outcome == Outcome::kDiverged;
}

std::vector<std::string> RowWarnings::sentences() const {
  std::vector<std::string> out;
  const auto add = [&out](int trials, const std::string& what, const char* where) {
    if (trials == 0) return;
    out.push_back(fmt::format("{} {} {}: SELECT trial, outcome, reason FROM v_trials WHERE {}", trials,
                              trials == 1 ? "trial" : "trials", what, where));
  };
  add(contradicted_, fmt::format("where the two detectors of contact disagree, by {:.2g} m at most", deepest_),
      "detector_disagreements > 0");
  add(messages_, "with messages of the physics solver", "lcp_messages > 0");
  add(latencies_,
      fmt::format("whose motion contradicts the latencies that the controller was told, by {:+.3g} s at most; "
                  "`prediction.identify` would identify them",
                  latency_off_),
      "latency_base_off_s <> 0 OR latency_joints_off_s <> 0");
  add(diverged_, "that diverged", "outcome = 'diverged'");
  add(errors_, "ended by an error", "outcome = 'error'");
  return out;
}

void SameError::look(std::size_t point, const TrialRow& row) {
  if (working_.count(point) > 0) return;
  const auto [at, fresh] = failing_.try_emplace(point, Found{point, 0, row.reason});
  if (row.outcome != Outcome::kError || row.reason != at->second.reason) {
    failing_.erase(at);
    working_.insert(point);
    return;
  }
  ++at->second.trials;
}

const SameError::Found* SameError::found() const {
  const Found* most = nullptr;
  for (const auto& [point, found] : failing_)
    if (most == nullptr || found.trials > most->trials) most = &found;
  return most;
}

}  // namespace moma::run
