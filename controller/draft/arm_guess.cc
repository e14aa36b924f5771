#include "controller/draft/guess.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace moma::draft {
namespace {

// Largest number of joints of a dexterous hand's finger, and least number of an arm's joints before its hand.
constexpr int kFingerJoints = 4, kArmJoints = 3;

class ArmFinder {
 public:
  ArmFinder(const UrdfFacts& urdf, const std::vector<bool>& not_arm)
      : urdf_(urdf),
        not_arm_(not_arm),
        below_(static_cast<std::size_t>(urdf.size()), 0),
        until_(static_cast<std::size_t>(urdf.size()), 0) {
    for (int i = urdf.size() - 1; i > 0; --i) {
      int& most = below_[static_cast<std::size_t>(urdf.link(i).parent)];
      most = std::max(most, below_[static_cast<std::size_t>(i)] + (counts(i) ? 1 : 0));
    }
    for (int i = 1; i < urdf.size(); ++i) {
      const auto parent = static_cast<std::size_t>(urdf.link(i).parent);
      // Everything beyond a finger belongs to the hand.
      until_[static_cast<std::size_t>(i)] = until_[parent] < 0 || finger(i) ? -1 : until_[parent] + (counts(i) ? 1 : 0);
    }
  }

  ArmGuess find() const {
    ArmGuess guess;
    const int most = *std::max_element(until_.begin(), until_.end());
    if (most <= 0) return guess;
    std::vector<int> ends;  // the links that a last joint moves
    for (int i = 1; i < urdf_.size(); ++i)
      if (until_[static_cast<std::size_t>(i)] == most && counts(i)) ends.push_back(i);
    const auto right = std::find_if(ends.begin(), ends.end(), [&](int end) { return is_right(end); });
    const int end = right == ends.end() ? ends.front() : *right;
    guess.tip = tool_of(end);
    for (const int other : ends)
      if (other != end) guess.others.push_back(urdf_.link(tool_of(other)).name);
    for (int i = end; i > 0; i = urdf_.link(i).parent)
      if (counts(i)) guess.joints.push_back(i);
    std::reverse(guess.joints.begin(), guess.joints.end());
    guess.p_TE = between_fingers(end, guess.tip);
    return guess;
  }

 private:
  bool counts(int i) const { return i > 0 && drivable(urdf_.link(i).joint) && !not_arm_[static_cast<std::size_t>(i)]; }

  // Links rigid with `link` on its far side, itself first.
  std::vector<int> rigid_with(int link) const {
    std::vector<int> group{link};
    for (std::size_t k = 0; k < group.size(); ++k)
      for (const int child : urdf_.children_of(group[k]))
        if (urdf_.link(child).joint.type == UrdfJointType::kFixed) group.push_back(child);
    return group;
  }

  // Recognises a finger by its name, or as one of several short chains behind an arm.
  bool finger(int i) const {
    const UrdfJoint& joint = urdf_.link(i).joint;
    if (joint.type == UrdfJointType::kFixed) return false;
    if (joint.mimic || named(joint.name, {"finger", "jaw", "knuckle", "thumb", "gripper"})) return true;
    if (named(urdf_.link(i).name, {"finger", "jaw", "knuckle", "thumb"})) return true;
    int before = urdf_.link(i).parent;
    if (until_[static_cast<std::size_t>(before)] < kArmJoints) return false;
    if (named(joint.name, {"hand"})) return true;
    while (before > 0 && urdf_.link(before).joint.type == UrdfJointType::kFixed) before = urdf_.link(before).parent;
    int chains = 0, longest = 0;
    for (const int link : rigid_with(before)) {
      for (const int child : urdf_.children_of(link)) {
        if (!counts(child)) continue;
        ++chains;
        longest = std::max(longest, 1 + below_[static_cast<std::size_t>(child)]);
      }
    }
    return chains > 1 && longest <= kFingerJoints;
  }

  bool is_right(int end) const {
    for (int i = end; i > 0; i = urdf_.link(i).parent) {
      const std::string& name = urdf_.link(i).name;
      if (named(name, {"right", "_r_"}) || name.starts_with("r_") || name.ends_with("_r")) return true;
    }
    return false;
  }

  // Point between the fingertips, in the tip's frame along its axis nearest to the fingers; zero without fingers, or if
  // it is hardly beyond the tip.
  Vector3 between_fingers(int end, int tip) const {
    constexpr double kBeyond = 0.05, kPads = 0.9;  // [m]; share of the fingers' length at which they close
    if (named(urdf_.link(tip).name, {"tcp", "grasp"})) return Vector3::Zero();
    std::vector<int> fingers;
    for (const int link : rigid_with(end))
      for (const int child : urdf_.children_of(link))
        if (urdf_.link(child).joint.type != UrdfJointType::kFixed) fingers.push_back(child);
    const std::size_t roots = fingers.size();
    const Isometry X_TR = urdf_.X_R(tip).inverse();
    Vector3 middle = Vector3::Zero();
    std::vector<Vector3> points;
    for (std::size_t k = 0; k < fingers.size(); ++k) {
      const int link = fingers[k];
      if (k < roots) middle += X_TR * urdf_.X_R(link).translation() / static_cast<double>(roots);
      fingers.insert(fingers.end(), urdf_.children_of(link).begin(), urdf_.children_of(link).end());
      for (const UrdfGeometry& shape : urdf_.link(link).collision)
        for (const Vector3& p_L : outline(urdf_, shape)) points.push_back(X_TR * (urdf_.X_R(link) * p_L));
    }
    if (points.empty()) return Vector3::Zero();
    Vector3 away = -(X_TR * urdf_.X_R(end).translation());  // from the wrist
    for (const Vector3& p_T : points) away += p_T / static_cast<double>(points.size());
    Eigen::Index axis = 0;
    away.cwiseAbs().maxCoeff(&axis);
    const double sign = away[axis] < 0.0 ? -1.0 : 1.0;
    double reach = 0.0;
    for (const Vector3& p_T : points) reach = std::max(reach, sign * p_T[axis]);
    if (reach < kBeyond) return Vector3::Zero();
    middle[axis] = sign * kPads * reach;
    return middle;
  }

  int tool_of(int end) const {
    const std::vector<int> group = rigid_with(end);
    const auto last = [&](std::initializer_list<std::string_view> words) {
      const auto found = std::find_if(group.rbegin(), group.rend(), [&](int link) {
        const std::string& name = urdf_.link(link).name;
        return named(name, words) &&
               !named(name, {"camera", "optical", "sensor", "imu", "finger", "collision", "visual", "inertia"});
      });
      return found == group.rend() ? -1 : *found;
    };
    for (const auto& words : {std::initializer_list<std::string_view>{"tcp", "grasp"},
                              std::initializer_list<std::string_view>{"tool0", "tool_link", "tool"},
                              std::initializer_list<std::string_view>{"end_effector", "ee_link", "eef", "_ee"},
                              std::initializer_list<std::string_view>{"gripper", "palm", "hand"},
                              std::initializer_list<std::string_view>{"flange"}})
      if (const int found = last(words); found >= 0) return found;
    return end;
  }

  const UrdfFacts& urdf_;
  const std::vector<bool>& not_arm_;
  std::vector<int> below_;  // largest number of driven joints on a chain below the link
  std::vector<int> until_;  // number of driven joints from the root to the link; -1 in a hand
};

}  // namespace

ArmGuess guess_arm(const UrdfFacts& urdf, const std::vector<bool>& not_arm) { return ArmFinder(urdf, not_arm).find(); }

}  // namespace moma::draft
