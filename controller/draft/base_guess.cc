#include "controller/draft/guess.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace moma::draft {
namespace {

constexpr double kLevel = 0.2, kUpright = 0.9;  // z components of level and upright axes
constexpr double kNearFloor = 0.03;             // of the lowest points of wheels [m]

struct Wheel {
  int link = 0;
  Vector3 p_R = Vector3::Zero();
  Vector3 axis_R = Vector3::UnitY();
  double radius = 0.0;  // 0: unknown
  bool round = true;
  bool steered = false;
  bool within_limits = false;  // steered as a car's
};

std::string names(const UrdfFacts& urdf, const std::vector<Wheel>& wheels) {
  return joined(wheels, [&](const Wheel& wheel) { return urdf.link(wheel.link).joint.name; });
}

class BaseFinder {
 public:
  explicit BaseFinder(const UrdfFacts& urdf) : urdf_(urdf) {}

  BaseGuess find() {
    guess_.joints.assign(static_cast<std::size_t>(urdf_.size()), false);
    find_virtual();
    find_rotors();
    find_wheels();
    decide();
    return std::move(guess_);
  }

 private:
  bool has_shape(int link) const {
    const std::string& name = urdf_.link(link).name;
    return !urdf_.link(link).collision.empty() ||
           std::any_of(urdf_.visuals.begin(), urdf_.visuals.end(), [&](const UrdfVisual& v) { return v.link == name; });
  }

  // Finds joints one after another from the root, before any link with a shape.
  void find_virtual() {
    std::vector<int> chain;
    int linear = 0, turns = 0;
    double mass = 0.0;
    bool shapes = false;
    for (int link = 0; urdf_.children_of(link).size() == 1;) {
      mass += urdf_.link(link).inertial ? urdf_.link(link).inertial->mass : 0.0;
      shapes = shapes || has_shape(link);
      link = urdf_.children_of(link).front();
      const UrdfJoint& joint = urdf_.link(link).joint;
      if (joint.type == UrdfJointType::kFixed) continue;
      if (!drivable(joint)) return;
      const double z = std::abs(urdf_.axis_R(link).z());
      if (joint.type == UrdfJointType::kPrismatic && z < kLevel)
        ++linear;
      else if (joint.type != UrdfJointType::kPrismatic && z > kUpright)
        ++turns;
      else
        break;
      chain.push_back(link);
      if (linear > 0 && turns > 0) break;
    }
    if (linear == 0 || linear > 2 || turns != 1 || (shapes && linear < 2)) return;
    std::vector<std::string> joints;
    for (const int i : chain) joints.push_back(urdf_.link(i).joint.name);
    const std::string listed = joined(joints);
    guess_.doubtful = shapes || mass > 0.0;
    if (shapes) {
      guess_.reason = "a gantry, or virtual joints of a mobile base: " + listed;
      return;
    }
    guess_.type = linear == 2 ? BaseType::kOmnidirectional : BaseType::kDifferential;
    for (const int i : chain) guess_.joints[static_cast<std::size_t>(i)] = true;
    guess_.virtual_joints = std::move(joints);
    guess_.reason = "joints that stand for a base: " + listed;
    if (mass > 0.0) guess_.reason += fmt::format("; before the last of them weigh {:.3g} kg without a shape", mass);
  }

  bool nothing_driven_behind(int link) const {
    for (const int child : urdf_.children_of(link))
      if (drivable(urdf_.link(child).joint) || !nothing_driven_behind(child)) return false;
    return true;
  }

  // Propellers: three or more parts that turn without end about upright axes and carry no driven joint.
  void find_rotors() {
    constexpr double kEndless = 100.0;  // range of joints that describe endless ones by limits [rad]
    constexpr std::size_t kLeast = 3;
    for (int i = 1; i < urdf_.size(); ++i) {
      const UrdfJoint& joint = urdf_.link(i).joint;
      const bool endless =
          joint.type == UrdfJointType::kContinuous || (joint.type == UrdfJointType::kRevolute && joint.lower &&
                                                       joint.upper && *joint.upper - *joint.lower > kEndless);
      if (endless && drivable(joint) && std::abs(urdf_.axis_R(i).z()) > kUpright && driven_before(i) == 0 &&
          nothing_driven_behind(i))
        rotors_.push_back(i);
    }
    if (rotors_.size() < kLeast) rotors_.clear();
    for (const int i : rotors_) guess_.joints[static_cast<std::size_t>(i)] = true;
  }

  // Number of joints between the apparent base and the link's own.
  int driven_before(int link) const {
    int count = 0;
    for (int i = urdf_.link(link).parent; i > 0; i = urdf_.link(i).parent)
      count += drivable(urdf_.link(i).joint) && !guess_.joints[static_cast<std::size_t>(i)] ? 1 : 0;
    return count;
  }

  // For a shape that is round about the axis the largest distance from it; for others half the least width.
  void measure(Wheel& wheel) const {
    const UrdfLink& link = urdf_.link(wheel.link);
    std::vector<Vector3> solid, seen;
    const auto add = [&](std::vector<Vector3>& to, const UrdfGeometry& shape) {
      const std::vector<Vector3> points = outline(urdf_, shape);
      to.insert(to.end(), points.begin(), points.end());
    };
    for (const UrdfGeometry& shape : link.collision) add(solid, shape);
    if (fit(wheel, solid, link.joint.axis)) return;
    for (const UrdfVisual& visual : urdf_.visuals)
      if (visual.link == link.name) add(seen, visual.geometry);
    Wheel looks = wheel;
    if (fit(looks, seen, link.joint.axis) || solid.empty()) wheel = looks;
  }

  static bool fit(Wheel& wheel, const std::vector<Vector3>& points, const Vector3& axis) {
    constexpr int kDirections = 36;
    constexpr double kRound = 1.15;  // an octagon counts as round
    if (points.empty()) return false;
    const Vector3 u = axis.unitOrthogonal(), v = axis.cross(u);
    double least = std::numeric_limits<double>::infinity(), most = 0.0;
    for (int i = 0; i < kDirections; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kDirections;
      const Vector3 d = std::cos(angle) * u + std::sin(angle) * v;
      double reach = 0.0;
      for (const Vector3& p : points) reach = std::max(reach, p.dot(d));
      least = std::min(least, reach);
    }
    for (const Vector3& p : points) most = std::max(most, (p - axis.dot(p) * axis).norm());
    wheel.round = most <= kRound * least;
    wheel.radius = wheel.round ? most : least;
    return wheel.round;
  }

  void find_wheels() {
    for (int i = 1; i < urdf_.size(); ++i) {
      const UrdfJoint& joint = urdf_.link(i).joint;
      const bool endless = joint.type == UrdfJointType::kContinuous;
      const bool by_name = named(joint.name, {"wheel"}) || named(urdf_.link(i).name, {"wheel"});
      if (!drivable(joint) || joint.type == UrdfJointType::kPrismatic || !(endless || by_name)) continue;
      if (std::abs(urdf_.axis_R(i).z()) > kLevel || !nothing_driven_behind(i)) continue;
      // A wheel is behind a fork at most; a wrist is behind an arm.
      if (!by_name && driven_before(i) > 1) continue;
      Wheel wheel{i, urdf_.X_R(i).translation(), urdf_.axis_R(i)};
      measure(wheel);
      for (int up = urdf_.link(i).parent; up > 0; up = urdf_.link(up).parent) {
        const UrdfJoint& above = urdf_.link(up).joint;
        const bool turns = above.type == UrdfJointType::kContinuous || above.type == UrdfJointType::kRevolute;
        if (!turns || std::abs(urdf_.axis_R(up).z()) <= kUpright) continue;
        wheel.steered = true;
        wheel.within_limits = above.type == UrdfJointType::kRevolute;
      }
      if (by_name || wheel.radius > 0.0) wheels_.push_back(wheel);
    }
    if (wheels_.empty()) return;
    double lowest = std::numeric_limits<double>::infinity();
    for (const Wheel& wheel : wheels_) lowest = std::min(lowest, wheel.p_R.z() - wheel.radius);
    // A joint without limits is a wrist as well, unless it is on the floor or called a wheel.
    std::erase_if(wheels_, [&](const Wheel& wheel) {
      const UrdfLink& link = urdf_.link(wheel.link);
      return !named(link.joint.name, {"wheel"}) && !named(link.name, {"wheel"}) &&
             wheel.p_R.z() - wheel.radius > lowest + kNearFloor;
    });
    for (const Wheel& wheel : wheels_) {
      for (int i = wheel.link; i > 0; i = urdf_.link(i).parent)
        if (drivable(urdf_.link(i).joint)) guess_.joints[static_cast<std::size_t>(i)] = true;
    }
  }

  bool called_caster(const Wheel& wheel) const {
    for (int i = wheel.link; i > 0; i = urdf_.link(i).parent)
      for (const std::string& name : {urdf_.link(i).name, urdf_.link(i).joint.name})
        if (named(name, {"caster", "castor"})) return true;
    return false;
  }

  bool caster(const Wheel& wheel) const { return wheel.steered || called_caster(wheel); }

  // Links called wheels with fixed joints, as in URDFs for arms alone.
  std::string stuck() const {
    std::vector<std::string> names;
    for (const UrdfLink& link : urdf_.tree.links)
      if (link.parent >= 0 && link.joint.type == UrdfJointType::kFixed && named(link.name, {"wheel"}))
        names.push_back(link.name);
    return joined(names);
  }

  // Lowest point of what does not move against the root [m, in R].
  double foot_of_root() const {
    double lowest = 0.0;
    std::vector<int> rigid{0};
    for (std::size_t k = 0; k < rigid.size(); ++k) {
      for (const UrdfGeometry& shape : urdf_.link(rigid[k]).collision)
        for (const Vector3& p : outline(urdf_, shape)) lowest = std::min(lowest, (urdf_.X_R(rigid[k]) * p).z());
      for (const int child : urdf_.children_of(rigid[k]))
        if (!drivable(urdf_.link(child).joint)) rigid.push_back(child);
    }
    return lowest;
  }

  static bool allows_zero(const UrdfJoint& joint) {
    return joint.type != UrdfJointType::kRevolute ||
           (joint.lower.value_or(0.0) <= 0.0 && joint.upper.value_or(0.0) >= 0.0);
  }

  // Evidence that the root does not stand on the floor: propellers, two chains of driven joints that reach below its
  // own shapes or four chains as legs, an arm that hangs from it.
  std::string not_standing() const {
    constexpr int kLegJoints = 2, kLegs = 4;
    constexpr double kHangs = 0.05;  // [m]; the wrist of an arm stretched over the floor is not as low
    if (!rotors_.empty())
      return "propellers seem to carry the root: " + joined(rotors_, [&](int i) { return urdf_.link(i).joint.name; });
    const double foot = foot_of_root();
    double lowest = foot;
    std::vector<std::string> chains, below;  // by the first joint
    std::vector<int> first(static_cast<std::size_t>(urdf_.size()), 0), count = first;
    std::vector<bool> beyond(first.size(), false);  // with all joints at 0 one on the way to the link is beyond a limit
    for (int i = 1; i < urdf_.size(); ++i) {
      const auto at = static_cast<std::size_t>(i), parent = static_cast<std::size_t>(urdf_.link(i).parent);
      const bool drives = drivable(urdf_.link(i).joint) && !guess_.joints[at];
      first[at] = first[parent] == 0 && drives ? i : first[parent];
      count[at] = count[parent] + (drives ? 1 : 0);
      beyond[at] = beyond[parent] || !allows_zero(urdf_.link(i).joint);
      if (count[at] < kLegJoints) continue;
      const std::string& name = urdf_.link(first[at]).joint.name;
      const auto note = [&](std::vector<std::string>& names) {
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
      };
      note(chains);
      const double z = urdf_.X_R(i).translation().z();
      if (!beyond[at]) lowest = std::min(lowest, z);
      if (z < foot) note(below);
    }
    if (below.size() >= 2)
      return fmt::format("legs seem to carry the root, by chains that reach below it from {}", fmt::join(below, ", "));
    if (chains.size() >= kLegs)
      return fmt::format("legs may carry the root, of {} chains from {}", chains.size(), fmt::join(chains, ", "));
    if (lowest < foot - kHangs)
      return fmt::format("the arm hangs below the root from {}, as on a ceiling or on a robot that flies",
                         below.front());
    return "";
  }

  void decide() {
    std::vector<Wheel> driven;
    std::copy_if(wheels_.begin(), wheels_.end(), std::back_inserter(driven),
                 [&](const Wheel& wheel) { return !caster(wheel); });
    const bool all_steered = driven.empty() && wheels_.size() >= 3;
    if (all_steered) driven = wheels_;
    if (driven.size() < 2) {
      if (guess_.type != BaseType::kFixed || guess_.doubtful) return;
      const std::string still = stuck();
      guess_.reason =
          still.empty() ? not_standing() : "these are called wheels, but their joints do not turn: " + still;
      guess_.doubtful = !guess_.reason.empty();
      return;
    }
    const bool one_axis = std::all_of(driven.begin(), driven.end(), [&](const Wheel& wheel) {
      return std::abs(wheel.axis_R.dot(driven.front().axis_R)) > kUpright;
    });
    const bool rollers = std::any_of(driven.begin(), driven.end(), [&](const Wheel& wheel) {
      return named(urdf_.link(wheel.link).name + urdf_.link(wheel.link).joint.name, {"mecanum", "omni"});
    });
    const bool omni =
        all_steered || rollers || !one_axis || (guess_.type == BaseType::kOmnidirectional && driven.size() >= 3);
    guess_.type = omni ? BaseType::kOmnidirectional : BaseType::kDifferential;
    const std::string also = guess_.reason.empty() ? "" : "; " + guess_.reason;
    guess_.reason = (all_steered ? "steered wheels " : "wheels ") + names(urdf_, driven) + also;
    const bool skids = !omni && driven.size() > 2;
    if (skids) guess_.reason += ", which skid where it turns; omnidirectional, were they mecanum wheels";
    std::vector<Wheel> front;  // what a differential base is not turned by
    std::copy_if(wheels_.begin(), wheels_.end(), std::back_inserter(front),
                 [&](const Wheel& wheel) { return !omni && wheel.within_limits && !called_caster(wheel); });
    if (!front.empty())
      guess_.reason += "; a car, which cannot turn on the spot, if " + names(urdf_, front) + " steer it";
    guess_.doubtful = skids || !front.empty();
    place(driven);
  }

  // B is midway between the wheels, on the floor, with x ahead.
  void place(std::vector<Wheel> driven) {
    Vector3 middle = Vector3::Zero();
    double lowest = std::numeric_limits<double>::infinity(), height = 0.0, radius = 0.0;
    for (const Wheel& wheel : driven) {
      middle += wheel.p_R / static_cast<double>(driven.size());
      radius = std::max(radius, wheel.radius);
      guess_.round = guess_.round && wheel.round;
    }
    for (const Wheel& wheel : wheels_) lowest = std::min(lowest, wheel.p_R.z() - wheel.radius);
    height = middle.z() - lowest;
    Wheels wheels;
    wheels.radius = radius > 0.0 ? radius : height;
    Vector3 axis = driven.front().axis_R;
    axis.z() = 0.0;
    axis.normalize();
    const bool ahead_is_x = std::abs(axis.y()) > std::abs(axis.x());
    const Isometry turn(Eigen::AngleAxisd(ahead_is_x ? 0.0 : -0.5 * std::numbers::pi, Vector3::UnitZ()));
    Vector3 least = Vector3::Constant(std::numeric_limits<double>::infinity()), most = -least;
    double speed = 0.0;
    for (const Wheel& wheel : driven) {
      const Vector3 p_B = turn * wheel.p_R;
      least = least.cwiseMin(p_B);
      most = most.cwiseMax(p_B);
      const double fastest = urdf_.link(wheel.link).joint.velocity.value_or(0.0);
      constexpr double kBelievable = 100.0;  // [rad/s]; a larger limit means none
      if (fastest > 0.0 && fastest < kBelievable) speed = speed > 0.0 ? std::min(speed, fastest) : fastest;
    }
    wheels.separation = most.y() - least.y();
    if (guess_.type == BaseType::kOmnidirectional) wheels.wheelbase = most.x() - least.x();
    wheels.max_speed = speed;
    guess_.X_BR = turn;
    guess_.X_BR.translation() = -(turn * Vector3(middle.x(), middle.y(), lowest));
    const bool whole = wheels.radius > 0.0 && wheels.separation > 0.0 &&
                       (guess_.type == BaseType::kDifferential || wheels.wheelbase > 0.0);
    if (whole) guess_.wheels = wheels;
  }

  const UrdfFacts& urdf_;
  BaseGuess guess_;
  std::vector<Wheel> wheels_;
  std::vector<int> rotors_;  // links of propellers
};

}  // namespace

BaseGuess guess_base(const UrdfFacts& urdf) { return BaseFinder(urdf).find(); }

}  // namespace moma::draft
