#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "controller/config/json_node.h"
#include "controller/config/node.h"
#include "controller/config/read_described.h"
#include "controller/config/robot_build.h"
#include "controller/config/write_described.h"

namespace moma::config {
namespace {

/// `limits` of a joint.
struct JointLimits {
  std::optional<double> lower, upper, velocity, effort, acceleration, jerk;
};

constexpr void describe(auto& v, Of<JointLimits>) {
  using T = JointLimits;
  v.member("lower", &T::lower, {.unit = "rad or m"});
  v.member("upper", &T::upper, {.unit = "rad or m"});
  v.member("velocity", &T::velocity, {.unit = "rad/s or m/s", .range = Range::positive()});
  v.member("effort", &T::effort, {.unit = "Nm or N", .range = Range::non_negative()});
  v.member("acceleration", &T::acceleration, {.unit = "rad/s^2 or m/s^2", .range = Range::positive()});
  v.member("jerk", &T::jerk, {.unit = "rad/s^3 or m/s^3", .range = Range::positive()});
}

/// Floating and planar joints are taken as fixed.
JointType type_of(UrdfJointType type) { return from_string<JointType>(to_string(type)).value_or(JointType::kFixed); }

std::string unit_of(JointType type) { return type == JointType::kPrismatic ? "m" : "rad"; }

void make_links(RobotBuild& build) {
  Link base;
  base.name = "@base";
  build.model.links.push_back(base);
  for (const UrdfLink& source : build.tree.links) {
    Link link;
    link.name = source.name;
    link.parent = source.parent + 1;
    link.inertial = source.inertial;
    if (source.parent < 0) {
      link.X_PJ = build.model.base.X_BM;
    } else {
      link.joint = source.joint.name;
      link.joint_type = type_of(source.joint.type);
      link.X_PJ = source.joint.X_PJ;
      link.axis = source.joint.axis;
    }
    build.model.links.push_back(std::move(link));
  }
}

class ArmReader {
 public:
  ArmReader(const Node& node, const std::string& key, RobotBuild& build)
      : build_(build), model_(build.model), in_(node, key), written_(as_object(build.resolved["arm"])) {}

  void read() {
    read_tip();
    read_locked();
    choose_joints();
    read_ready();
    hold_the_rest();
    warn_about_mass();
    in_.finish();
  }

 private:
  const UrdfJoint& joint_of(int link) const { return build_.tree.links[static_cast<std::size_t>(link) - 1].joint; }
  Link& link_at(int link) { return model_.links[static_cast<std::size_t>(link)]; }

  static std::string near_or_all(const std::string& word, const char* all, const std::vector<std::string>& names) {
    const std::string near = suggestion(word, names);
    return near.empty() ? all + joined(names) : near;
  }

  // Index of the link that a movable joint moves; an error that names the movable joints otherwise.
  int movable(const MapReader& in, const std::string& joint) const {
    std::vector<std::string> names;
    for (std::size_t i = 2; i < model_.links.size(); ++i) {
      if (model_.links[i].joint_type == JointType::kFixed) continue;
      if (model_.links[i].joint == joint) return static_cast<int>(i);
      names.push_back(model_.links[i].joint);
    }
    in.fail_key(joint, "the URDF has no movable joint of this name" + near_or_all(joint, "; it has: ", names));
  }

  void read_tip() {
    in_.require("tip", "the link that carries the end effector");
    std::string tip;
    in_.read("tip", tip);
    model_.tip = model_.find_link(tip);
    if (model_.tip < 1) {
      std::vector<std::string> names;
      for (const UrdfLink& link : build_.tree.links) names.push_back(link.name);
      in_.fail_at("tip",
                  "found '" + tip + "', which is no link of the URDF" + near_or_all(tip, "; its links: ", names));
    }
    written_["tip"] = tip;
    read_pose(in_, "tool", model_.X_TE, written_);
  }

  void read_locked() {
    MapReader in(in_, "locked");
    for (const auto& [name, value] : in.entries()) {
      const int link = movable(in, name);
      double held = 0.0;
      in.read(name, held);
      const UrdfJoint& joint = joint_of(link);
      in.check(!(joint.lower && joint.upper && *joint.lower <= *joint.upper) ||
                   (held >= *joint.lower && held <= *joint.upper),
               name, "found " + value.scalar + ", outside the joint's limits");
      locked_[link] = held;
      as_object(written_["locked"])[name] = held;
    }
    in.finish();
  }

  void choose_joints() {
    std::vector<int> chain;
    for (int i = model_.tip; i > 1; i = link_at(i).parent) chain.push_back(i);
    std::reverse(chain.begin(), chain.end());
    MapReader limits(in_, "limits");
    for (const int link : chain) {
      const UrdfJoint& joint = joint_of(link);
      if (joint.type == UrdfJointType::kFixed || locked_.count(link) != 0) continue;
      if (joint.type == UrdfJointType::kFloating || joint.type == UrdfJointType::kPlanar) {
        in_.fail(
            "the " + std::string(to_string(joint.type)) + " joint " + joint.name +
            " lies between the root and the tip, and only revolute, continuous and prismatic joints can be driven");
      }
      if (joint.mimic) {
        in_.fail("joint " + joint.name + ", between the root and the tip, mimics " + joint.mimic->joint +
                 " and cannot be driven on its own: hold it with " + in_.key_of("locked") + "." + joint.name);
      }
      add_joint(limits, link);
    }
    for (const auto& [name, value] : limits.entries()) {
      const int link = movable(limits, name);
      if (link_at(link).controlled >= 0) continue;
      limits.get(name);
      build_.warnings.push_back(limits.key_of(name) + ": has no effect, since the joint is not controlled");
    }
    limits.finish();
    if (!lacking_.empty()) fail(lacking_at_, lacking_key_, "the URDF gives " + joined(lacking_, {}, "; "));
    if (model_.joints.empty())
      in_.fail_at("tip", "no joint is left to control between the root and " + link_at(model_.tip).name);
    if (model_.num_joints() > kMaxJoints)
      in_.fail("more than " + std::to_string(kMaxJoints) + " joints to control; hold some with `locked`");
  }

  struct MissingLimit {
    const char* key;
    std::string unit;
  };

  // All that is missing is said at once, at the place of the first.
  void lacks(const ControlledJoint& joint, const std::vector<MissingLimit>& missing, const std::string& where,
             const Mark& at) {
    if (lacking_.empty()) {
      lacking_at_ = at;
      lacking_key_ = where;
    }
    const std::string first = missing.front().unit, last = missing.back().unit;
    lacking_.push_back(std::string(to_string(joint.type)) + " joint " + joint.name + " no " +
                       joined(missing, &MissingLimit::key) + ": give " + where + ": {" +
                       joined(missing, [](const MissingLimit& limit) { return limit.key + std::string(": ..."); }) +
                       "} in " + first + (last != first ? ", " + last : ""));
  }

  void add_joint(MapReader& limits, int link) {
    const UrdfJoint& source = joint_of(link);
    ControlledJoint joint;
    joint.name = source.name;
    joint.type = type_of(source.type);
    joint.link = link;
    JointLimits limit{source.lower,  source.upper, source.velocity.value_or(0.0) > 0.0 ? source.velocity : std::nullopt,
                      source.effort, {},           {}};
    const std::string where = limits.key_of(joint.name);
    const Node* given = limits.get(joint.name);
    if (given != nullptr) read_described(*given, where, limit);
    const Mark at = given != nullptr ? given->mark : in_.mark();
    // A continuous joint that is given limits is a revolute one from here on.
    if (joint.type == JointType::kContinuous && limit.lower && limit.upper) joint.type = JointType::kRevolute;
    const bool continuous = joint.type == JointType::kContinuous;
    if (continuous && (limit.lower || limit.upper))
      fail(at, where, "a continuous joint takes both lower and upper, or neither");
    const std::string unit = unit_of(joint.type);
    std::vector<MissingLimit> missing;
    if (!continuous && !limit.lower) missing.push_back({"lower", unit});
    if (!continuous && !limit.upper) missing.push_back({"upper", unit});
    if (!limit.velocity) missing.push_back({"velocity", unit + "/s"});
    if (!missing.empty()) return lacks(joint, missing, where, at);
    if (!continuous) {
      joint.lower = *limit.lower;
      joint.upper = *limit.upper;
      if (!(joint.lower < joint.upper))
        fail(at, where,
             "lower " + number_to_json(joint.lower).dump() + " is not below upper " +
                 number_to_json(joint.upper).dump() + "; correct it with " + where + ": {lower: ..., upper: ...}");
      link_at(link).joint_type = joint.type;
    }
    limit.effort = std::max(0.0, limit.effort.value_or(0.0));
    if (!(limit.effort > 0.0))
      build_.warnings.push_back("joint " + joint.name + ": no effort limit is known, so " + where +
                                ".effort is needed for physics with motors");
    joint.velocity = *limit.velocity;
    joint.effort = *limit.effort;
    joint.acceleration = limit.acceleration.value_or(joint.acceleration);
    joint.jerk = limit.jerk.value_or(joint.jerk);
    link_at(link).controlled = model_.num_joints();
    as_object(written_["limits"])[joint.name] = write_described(limit);
    model_.joints.push_back(std::move(joint));
  }

  void read_ready() {
    const std::string key = in_.key_of("ready");
    const Node* node = in_.get("ready");
    std::vector<double> values;
    if (node != nullptr) {
      values = read_numbers(*node, key, model_.num_joints());
    } else {
      for (const ControlledJoint& joint : model_.joints) values.push_back(std::clamp(0.0, joint.lower, joint.upper));
      build_.warnings.push_back(key + ": not given, so every joint is at 0 or its nearest limit");
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
      const ControlledJoint& joint = model_.joints[i];
      if (values[i] < joint.lower || values[i] > joint.upper)
        fail(node->items[i].mark, key + "[" + std::to_string(i) + "]",
             "found " + node->items[i].scalar + ", outside the limits of joint " + joint.name + ", " +
                 number_to_json(joint.lower).dump() + " to " + number_to_json(joint.upper).dump());
    }
    model_.ready = Eigen::Map<const VectorX>(values.data(), model_.num_joints());
    written_["ready"] = description::list_to_json(values);
  }

  // Returns the held value of a joint: its locked value, `ready` of a driven joint, what follows from the joint it
  // mimics, or 0 clamped into its limits.
  double held_value(int link, int depth) {
    const UrdfJoint& joint = joint_of(link);
    if (const auto found = locked_.find(link); found != locked_.end()) return found->second;
    if (link_at(link).controlled >= 0) return model_.ready[link_at(link).controlled];
    if (joint.mimic) {
      if (depth > 32) in_.fail("joint " + joint.name + " mimics itself in a circle");
      for (std::size_t i = 2; i < model_.links.size(); ++i) {
        if (model_.links[i].joint != joint.mimic->joint) continue;
        const int other = static_cast<int>(i);
        if (model_.links[i].controlled >= 0) {
          build_.warnings.push_back("joint " + joint.name + " mimics " + joint.mimic->joint +
                                    ", which is driven, but is held where it is at `ready`");
        }
        return joint.mimic->multiplier * held_value(other, depth + 1) + joint.mimic->offset;
      }
      in_.fail("joint " + joint.name + " mimics " + joint.mimic->joint + ", which the URDF does not have");
    }
    if (joint.lower && joint.upper && *joint.lower <= *joint.upper) return std::clamp(0.0, *joint.lower, *joint.upper);
    return 0.0;
  }

  void hold_the_rest() {
    std::vector<std::string> held, rigid;
    for (std::size_t i = 2; i < model_.links.size(); ++i) {
      const int link = static_cast<int>(i);
      const UrdfJointType type = joint_of(link).type;
      if (type == UrdfJointType::kFloating || type == UrdfJointType::kPlanar) rigid.push_back(model_.links[i].joint);
      if (model_.links[i].joint_type == JointType::kFixed || model_.links[i].controlled >= 0) continue;
      model_.links[i].held = held_value(link, 0);
      if (locked_.count(link) == 0) held.push_back(model_.links[i].joint);
    }
    if (!held.empty()) build_.notes.push_back("joints held, since they are not between root and tip: " + joined(held));
    if (!rigid.empty()) build_.warnings.push_back("floating or planar joints taken as fixed: " + joined(rigid));
  }

  // Physics needs mass between any two driven joints.
  void warn_about_mass() {
    std::vector<double> mass(model_.links.size(), 0.0);
    for (std::size_t i = model_.links.size(); i-- > 1;) {
      const Link& link = model_.links[i];
      mass[i] += link.inertial ? link.inertial->mass : 0.0;
      if (link.controlled < 0) {
        mass[static_cast<std::size_t>(link.parent)] += mass[i];
      } else if (!(mass[i] > 0.0)) {
        build_.warnings.push_back("the links moved by joint " + link.joint + " have no mass in the URDF");
      }
    }
  }

  RobotBuild& build_;
  RobotModel& model_;
  MapReader in_;
  Json& written_;
  std::map<int, double> locked_;      // by link
  std::vector<std::string> lacking_;  // limits, one text for each joint; with the place of the first
  std::string lacking_key_;
  Mark lacking_at_;
};

}  // namespace

void read_arm(MapReader& robot, RobotBuild& build) {
  make_links(build);
  ArmReader(robot.require("arm", "a map with `tip`"), robot.key_of("arm"), build).read();
}

}  // namespace moma::config
