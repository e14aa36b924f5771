#include "controller/qp/terms.h"

#include <algorithm>

namespace moma {
namespace {

// Inputs of terms, and the part of H and g that one term adds to. A new term is a function and its line in kList.
struct Input {
  const ControllerParams& params;
  const RobotModel& model;
  const Situation& now;
  const QpTask& asked;
  const QpProblem& problem;  // with its rows

  int base() const noexcept { return model.base_dof(); }
  int joints() const noexcept { return model.num_joints(); }
  int velocities() const noexcept { return model.num_velocities(); }
};

struct Part {
  Eigen::Ref<VectorX> H, g;
};

// 1/||e||, or the constant.
double value_of(const Weight& weight, const Input& in) noexcept {
  return weight.inverse_error ? 1.0 / in.asked.task.error_norm : weight.value;
}

// Every function returns whether its term is on.

// w_b I of the article's Q1.
bool move_base(const Input& in, Part out) noexcept {
  if (in.asked.pull || in.base() == 0) return false;
  out.H.head(in.base()).array() += value_of(in.params.base_weight, in);
  return true;
}

// lambda_qa of the article's Q1.
bool move_joints(const Input& in, Part out) noexcept {
  if (in.asked.pull) return false;
  out.H.segment(in.base(), in.joints()) += in.params.lambda_q;
  return true;
}

// -k_eps theta_eps of the article's C1, on the base's omega.
bool turn_base(const Input& in, Part out) noexcept {
  if (in.asked.pull || in.base() == 0 || in.params.k_epsilon == 0.0) return false;
  out.g[in.base() - 1] -= in.params.k_epsilon * in.asked.task.theta_eps;
  return true;
}

// -lambda_m J_m of the article's C1, on the joints.
bool raise_manipulability(const Input& in, Part out) noexcept {
  if (in.asked.pull || in.params.manipulability.weight == 0.0) return false;
  out.g.segment(in.base(), in.joints()) -= in.params.manipulability.weight * in.now.J_m;
  return true;
}

// The active collision cost of RMMI (Marticorena et al., arXiv 2408.16206): lambda times the weighted mean of the rows
// of objects, so that these distances grow. A row weighs (d_i - d)/(d_i - d_s); lambda = away ((d_i - d_min)/(d_i -
// d_s))^2. In RMMI a row is about a point of the robot's surface, here about a shape of the robot and an object.
bool move_away(const Input& in, Part out) noexcept {
  const CollisionParams& p = in.params.collision;
  if (p.away == 0.0) return false;
  const auto nearness = [&](double d) { return (p.object.influence - d) / (p.object.influence - p.object.stop); };
  double sum = 0.0, nearest = 0.0;
  for (int i = 0; i < in.problem.rows; ++i) {
    const RowId& id = in.problem.ids[static_cast<std::size_t>(i)];
    if (id.kind != RowKind::kObject) continue;
    const double weight = std::max(nearness(id.d), 0.0);
    sum += weight;
    nearest = std::max(nearest, weight);
    out.g += weight * in.problem.A.row(i).transpose();
  }
  if (sum <= 0.0) return false;
  out.g *= p.away * nearest * nearest / sum;
  return true;
}

// w/2 |qdot - wanted|^2 without its constant.
bool pull_to_velocities(const Input& in, Part out) noexcept {
  if (!in.asked.pull) return false;
  const QpTask::Pull& pull = *in.asked.pull;
  for (int i = 0; i < in.velocities(); ++i) {
    const double weight = i < in.base() ? pull.base_weight : pull.joint_weight;
    out.H[i] += weight;
    if (pull.velocities != nullptr) out.g[i] -= weight * (*pull.velocities)[i];
  }
  return true;
}

// lambda_delta of the article's Q1, row by row as a task scales it; a weight of 0 leaves delta free.
bool keep_slack_small(const Input& in, Part out) noexcept {
  const SlackParams& slack = in.params.slack;
  if (!slack.enabled || (!slack.weight.inverse_error && slack.weight.value == 0.0)) return false;
  out.H.segment(in.velocities(), 6) += value_of(slack.weight, in) * in.asked.task.slack_scale;
  return true;
}

// lambda_qdd of the article's Q2 and C2, around the measured velocity.
bool keep_velocity(const Input& in, Part out) noexcept {
  const VectorX& weight = in.params.acceleration_weight;
  if (!(weight.maxCoeff() > 0.0)) return false;
  out.H.head(weight.size()) += weight;
  out.g.head(weight.size()) -= weight.cwiseProduct(in.now.o.qdot);
  return true;
}

// lambda_qd of the article's Q3 and C3: joints go to `target` at the rate `gain`.
bool posture(const Input& in, double weight, double gain, const VectorX& target, Part out) noexcept {
  if (weight == 0.0) return false;
  out.H.segment(in.base(), in.joints()).array() += weight;
  out.g.segment(in.base(), in.joints()) -= weight * gain * (target - in.now.o.q);
  return true;
}

bool keep_posture(const Input& in, Part out) noexcept {
  const PostureParams& p = in.params.posture;
  return posture(in, p.weight, p.gain, p.target.value, out);
}

bool keep_detour_posture(const Input& in, Part out) noexcept {
  const EscapeParams& p = in.params.escape;
  return in.asked.task.detour && posture(in, p.posture_weight, p.posture_gain, in.model.ready, out);
}

struct Term {
  std::string_view words;
  bool (*add)(const Input&, Part) noexcept;
};

constexpr std::array<Term, Objective::kTerms> kList{{
    {"moving the base", move_base},
    {"moving the joints", move_joints},
    {"turning the base to its work", turn_base},
    {"manipulability", raise_manipulability},
    {"approaching objects", move_away},
    {"velocities other than those asked for", pull_to_velocities},
    {"slack (not following the goal)", keep_slack_small},
    {"acceleration", keep_velocity},
    {"posture", keep_posture},
    {"posture of the detour", keep_detour_posture},
}};

}  // namespace

void Objective::allocate(int num_variables) {
  H_ = MatrixX::Zero(num_variables, kTerms);
  g_ = MatrixX::Zero(num_variables, kTerms);
  on_ = {};
}

void Objective::pose(const ControllerParams& params, const RobotModel& model, const Situation& now, const QpTask& asked,
                     QpProblem& problem) noexcept {
  const Input in{params, model, now, asked, problem};
  problem.H.setZero();
  problem.g.setZero();
  for (int t = 0; t < kTerms; ++t) {
    const auto at = static_cast<std::size_t>(t);
    H_.col(t).setZero();
    g_.col(t).setZero();
    on_[at] = kList[at].add(in, {H_.col(t), g_.col(t)});
    if (!on_[at]) continue;
    problem.H += H_.col(t);
    problem.g += g_.col(t);
  }
}

std::vector<TermCost> Objective::costs(const VectorX& x) const {
  std::vector<TermCost> out;
  for (int t = 0; t < kTerms; ++t) {
    const auto at = static_cast<std::size_t>(t);
    if (!on_[at]) continue;
    const auto head = x.head(H_.rows()).array();
    out.push_back({kList[at].words, ((0.5 * H_.col(t).array() * head + g_.col(t).array()) * head).sum()});
  }
  return out;
}

}  // namespace moma
