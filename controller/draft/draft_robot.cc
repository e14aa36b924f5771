#include "controller/draft/draft_robot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "controller/config/node.h"
#include "controller/config/robot_build.h"
#include "controller/config/text_file.h"
#include "controller/config/yaml_text.h"
#include "controller/draft/guess.h"
#include "controller/draft/posture.h"
#include "controller/model/floor_reach.h"
#include "controller/model/kinematics.h"
#include "controller/model/statics.h"

namespace moma::draft {
namespace {

// Defaults for missing limits of a URDF: slow enough for any robot.
constexpr double kJointSpeed = 1.0, kSliderSpeed = 0.1;                         // [rad/s], [m/s]
constexpr double kBaseSpeed = 0.5, kMostBaseSpeed = 2.0, kMostTurnSpeed = 2.0;  // [m/s], [m/s], [rad/s]

double rounded(double value, double step) {
  const double result = std::round(value / step) * step;
  return result == 0.0 ? 0.0 : result;
}

// The largest multiple of `step` that is not above `value`.
double rounded_down(double value, double step) { return std::floor(value / step * (1.0 + 1e-9)) * step; }

std::string number(double value) { return fmt::format("{:.5g}", value); }

std::string list(const Vector3& v) { return fmt::format("[{}, {}, {}]", number(v.x()), number(v.y()), number(v.z())); }

// Expanded files often contain the commands as comments.
std::string without_comments(const std::string& xml) {
  std::string text;
  std::size_t from = 0;
  for (std::size_t begin; (begin = xml.find("<!--", from)) != std::string::npos;) {
    text += xml.substr(from, begin - from);
    const std::size_t end = xml.find("-->", begin);
    if (end == std::string::npos) return text;
    from = end + 3;
  }
  return text + xml.substr(from);
}

/// YAML, line by line, with a count of the doubtful lines.
class Lines {
 public:
  void add(int level, const std::string& line, std::string comment = "", bool doubtful = false) {
    if (doubtful) comment = "check: " + comment;
    checks_ += doubtful ? 1 : 0;
    const char* const between = line.empty() ? "# " : "  # ";
    text_ += std::string(2U * static_cast<std::size_t>(level), ' ') + line;
    text_ += (comment.empty() ? "" : between + comment) + "\n";
  }
  void doubt(int level, const std::string& line, const std::string& what) { add(level, line, what, true); }
  const std::string& text() const { return text_; }
  int checks() const { return checks_; }

 private:
  std::string text_;
  int checks_ = 0;
};

class Drafter {
 public:
  explicit Drafter(const DraftOptions& options) : options_(options), meshes_(options.meshes) {}

  Draft draft() {
    read();
    fold_other_arms();
    std::shared_ptr<const RobotModel> model = begin();
    if (stand_on_floor(model)) {
      fold_other_arms();  // there is more room below now
      model = begin();
    }
    Posture posture = find_posture(*model);
    if (lift(model, posture.q)) posture = find_posture(*begin());
    write_ready(posture);
    propose_efforts(model);
    if (arm_has_geometry())
      lines_.add(0, "collision: {from: urdf, self: auto}");
    else
      lines_.doubt(0, "collision: {shapes: [], from: urdf, self: auto}",
                   "the URDF has no collision geometry for the arm, so that nothing it does is a collision; "
                   "--fit-shapes makes shapes of its visual meshes");
    config::LoadedRobot robot = load(lines_.text());
    if (!posture.clear)
      robot.warnings.push_back(
          "arm.ready: in every posture that was tried something touches the robot itself or the floor: "
          "is the base, its mount or a shape wrong?");
    return {lines_.text(), robot.warnings, robot.notes, lines_.checks(), std::move(meshes_)};
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw config::ConfigError(fmt::format("{}: {}", options_.urdf.string(), message));
  }

  void read() {
    std::string text;
    try {
      text = config::read_text_file(options_.urdf);
    } catch (const std::runtime_error& e) {
      fail(e.what());
    }
    if (options_.urdf.extension() == ".xacro" || without_comments(text).find("<xacro:") != std::string::npos) {
      const fs::path expanded = fs::path(options_.urdf).replace_extension();
      fail(fmt::format("is xacro, which has to be expanded first: xacro {} > {}", options_.urdf.string(),
                       expanded.extension() == ".urdf" ? expanded.string() : expanded.string() + ".urdf"));
    }
    try {
      urdf_ =
          facts_of(text, options_.lenient ? UrdfReading::kLenient : UrdfReading::kStrict, options_.urdf.parent_path());
    } catch (const UrdfError& e) {
      fail(e.what());
    }
    base_ = guess_base(urdf_);
    arm_ = guess_arm(urdf_, base_.joints);
    if (arm_.joints.empty()) fail("has no joint that an arm could be driven by");
  }

  void write_head() {
    std::error_code error;
    const auto from_here = [&](const fs::path& path) {
      const fs::path relative = fs::relative(path, options_.folder.empty() ? fs::path(".") : options_.folder, error);
      return config::yaml_scalar((error || relative.empty() ? fs::absolute(path) : relative).generic_string());
    };
    lines_.add(0, "",
               fmt::format("A first robot file, by `moma robot {}`. What the URDF does not say is marked \"check\".",
                           options_.urdf.filename().string()));
    if (urdf_.tree.name.empty()) lines_.add(0, "name: " + config::yaml_scalar(options_.urdf.stem().string()));
    lines_.add(0, "urdf: " + from_here(options_.urdf));
    if (!urdf_.packages.named.empty()) lines_.add(0, "packages:");
    for (const auto& [name, folder] : urdf_.packages.named) {
      const bool renamed = std::find(urdf_.renamed.begin(), urdf_.renamed.end(), name) != urdf_.renamed.end();
      lines_.add(1, config::yaml_scalar(name) + ": " + from_here(folder),
                 renamed ? "a folder of another name has its meshes" : "", renamed);
    }
    if (options_.lenient) lines_.doubt(0, "lenient: true", "what is left out of the URDF cannot collide");
  }

  void write_base() {
    const bool mobile = base_.type != BaseType::kFixed;
    lines_.add(0, "base:");
    const std::string certain = mobile ? "by " + base_.reason : "no wheels were found";
    lines_.add(1, "type: " + std::string(to_string(base_.type)), base_.doubtful ? base_.reason : certain,
               base_.doubtful);
    const Vector3 p = base_.X_BR.translation().unaryExpr([](double value) { return rounded(value, 1e-4); });
    const double turn = std::atan2(base_.X_BR.linear()(1, 0), base_.X_BR.linear()(0, 0));
    if (!p.isZero() || turn != 0.0) {
      const std::string rpy = turn == 0.0 ? "" : fmt::format(", rpy: [0, 0, {}]", turn);
      const std::string why =
          mobile ? "the URDF's root over the floor, from the point between the wheels"
                 : "the URDF's root over the floor: its lowest shape stands there, or it needs that much room";
      lines_.add(1, fmt::format("mount: {{position: {}{}}}", list(p), rpy),
                 why + (turn == 0.0 ? "" : "; wheels turn about the root's x, so that y or -y is ahead"), turn != 0.0);
    }
    if (!mobile) return;
    const Wheels wheels = base_.wheels.value_or(Wheels{0.0, 0.0, 0.0, 0.0});
    const bool known = base_.wheels && wheels.max_speed > 0.0;
    // Rounded down, of the radius as it is written: the wheels reach the speed.
    const double reached = wheels.max_speed * rounded(wheels.radius, 1e-4);
    const double linear = known ? std::min(kMostBaseSpeed, rounded_down(reached, 0.01)) : kBaseSpeed;
    const double lever = 0.5 * (wheels.separation + wheels.wheelbase);
    const double angular = rounded(lever > 0.0 ? std::min(kMostTurnSpeed, linear / lever) : kMostTurnSpeed / 2.0, 0.01);
    const std::string source = known ? "the URDF's wheel speed times the radius, at most 2" : "the URDF does not say";
    lines_.doubt(1, "max_linear: " + number(linear), "m/s; " + source);
    lines_.doubt(1, "max_angular: " + number(angular), "rad/s; " + source);
    lines_.doubt(1, "max_acceleration: [1, 2]", "m/s^2, rad/s^2: what the drive's ramp gives");
    if (!base_.wheels) {
      lines_.doubt(1, "", "wheels: {radius: m, separation: m, max_speed: rad/s}, which physics needs");
      return;
    }
    const double speed = known ? wheels.max_speed : rounded(2.0 * linear / wheels.radius, 0.1);
    std::string text = fmt::format("wheels: {{radius: {}, separation: {}", number(rounded(wheels.radius, 1e-4)),
                                   number(rounded(wheels.separation, 1e-4)));
    if (base_.type == BaseType::kOmnidirectional) text += ", wheelbase: " + number(rounded(wheels.wheelbase, 1e-4));
    text += fmt::format(", max_speed: {}}}", number(speed));
    const bool certain_wheels = known && base_.round;
    const std::string sizes = base_.round ? "m, m as the URDF has them" : "m; no shape of the wheels is round";
    lines_.add(1, text,
               certain_wheels ? "m, m, rad/s; as the URDF has them"
                              : sizes + (known ? "" : "; rad/s is twice what max_linear needs"),
               !certain_wheels);
  }

  // Adds the limits without which read_arm() refuses the file.
  void write_limits(const std::vector<int>& joints) {
    bool begun = false;
    for (const int link : joints) {
      const UrdfJoint& joint = urdf_.link(link).joint;
      const bool slides = joint.type == UrdfJointType::kPrismatic;
      std::vector<std::string> given;
      const bool range = joint.lower && joint.upper && *joint.lower < *joint.upper;
      if (joint.type != UrdfJointType::kContinuous && !range) {
        const double reach = slides ? 0.1 : rounded(std::numbers::pi, 0.01);
        given.push_back(fmt::format("lower: {}, upper: {}", number(slides ? 0.0 : -reach), number(reach)));
      }
      if (joint.type == UrdfJointType::kContinuous && (joint.lower.has_value() != joint.upper.has_value()))
        given.push_back("lower: -3.14, upper: 3.14");
      if (!(joint.velocity.value_or(0.0) > 0.0))
        given.push_back("velocity: " + number(slides ? kSliderSpeed : kJointSpeed));
      if (given.empty()) continue;
      if (!begun) lines_.add(1, "limits:");
      begun = true;
      lines_.doubt(2, fmt::format("{}: {{{}}}", config::yaml_scalar(joint.name), fmt::join(given, ", ")),
                   "the URDF does not say");
    }
  }

  void write_arm() {
    lines_.add(0, "arm:");
    lines_.add(1, "tip: " + config::yaml_scalar(urdf_.link(arm_.tip).name),
               arm_.others.empty() ? fmt::format("at the end of {} driven joints", arm_.joints.size())
                                   : joined(arm_.others) + " would be as long",
               !arm_.others.empty());
    if (!arm_.p_TE.isZero())
      lines_.doubt(1,
                   fmt::format("tool: {{position: {}}}",
                               list(arm_.p_TE.unaryExpr([](double value) { return rounded(value, 1e-3); }))),
                   "between the fingertips, where the URDF has no frame");
    if (!held_.empty())
      lines_.doubt(1, "locked:", "the arm that is not used is held out of the way");
    else if (!base_.virtual_joints.empty())
      lines_.add(1, "locked:");
    for (const std::string& joint : base_.virtual_joints)
      lines_.add(2, config::yaml_scalar(joint) + ": 0", "moma moves the base itself");
    for (const HeldJoint& joint : held_) {
      lines_.add(2, fmt::format("{}: {}", config::yaml_scalar(joint.name), number(joint.q)),
                 joint.clear ? "" : "no posture was found in which this arm touches nothing", !joint.clear);
    }
    write_limits(arm_.joints);
  }

  // One of two arms works; the other is held out of the way.
  void fold_other_arms() {
    held_.clear();
    for (const std::string& tip : arm_.others) {
      std::vector<int> own;
      std::vector<std::string> shared;
      int link = 0;
      while (urdf_.link(link).name != tip) ++link;
      for (; link > 0; link = urdf_.link(link).parent) {
        if (!drivable(urdf_.link(link).joint) || base_.joints[static_cast<std::size_t>(link)]) continue;
        if (std::find(arm_.joints.begin(), arm_.joints.end(), link) == arm_.joints.end())
          own.push_back(link);
        else
          shared.push_back(urdf_.link(link).joint.name);
      }
      if (own.empty()) continue;
      std::reverse(own.begin(), own.end());
      lines_ = {};
      write_head();
      write_base();
      lines_.add(0, "arm:");
      lines_.add(1, "tip: " + config::yaml_scalar(tip));
      shared.insert(shared.end(), base_.virtual_joints.begin(), base_.virtual_joints.end());
      if (!shared.empty()) lines_.add(1, "locked:");
      for (const std::string& joint : shared)
        lines_.add(2, fmt::format("{}: {}", config::yaml_scalar(joint), number(resting_value(joint))));
      write_limits(own);
      const auto model = load(lines_.text() + shapes()).model;
      const Posture posture = find_posture(*model, PostureFor::kFolded);
      for (int i = 0; i < model->num_joints(); ++i)
        held_.push_back({model->joint(i).name, posture.q[i], posture.clear});
    }
  }

  // Value of a held joint without a value of its own: 0, or the nearest limit.
  double resting_value(const std::string& name) const {
    for (const UrdfLink& link : urdf_.tree.links) {
      const UrdfJoint& joint = link.joint;
      if (joint.name == name && joint.type != UrdfJointType::kContinuous && joint.lower && joint.upper &&
          *joint.lower <= *joint.upper)
        return std::clamp(0.0, *joint.lower, *joint.upper);
    }
    return 0.0;
  }

  config::LoadedRobot load(const std::string& text) {
    // Paths are relative to the place of a value.
    const fs::path place = options_.folder / ("a draft over " + options_.urdf.filename().string());
    return config::read_robot(config::parse_yaml(text, place.string(), options_.folder), "", meshes_);
  }

  std::string shapes() const {
    return options_.collision.empty() ? "collision: {shapes: [], from: urdf, self: []}\n" : options_.collision;
  }

  // True if any link that the arm's joints move has collision geometry.
  bool arm_has_geometry() const {
    for (int i = 1; i < urdf_.size(); ++i) {
      if (urdf_.link(i).collision.empty()) continue;
      for (int up = i; up > 0; up = urdf_.link(up).parent)
        if (std::find(arm_.joints.begin(), arm_.joints.end(), up) != arm_.joints.end()) return true;
    }
    return false;
  }

  // Writes the part before `ready`; returns the robot at this stage, without self-collision.
  std::shared_ptr<const RobotModel> begin() {
    lines_ = {};
    write_head();
    write_base();
    write_arm();
    return load(lines_.text() + shapes()).model;
  }

  // Lowest point at q of the shapes that joints lift, or of the others; `most` without such shapes.
  static double lowest(const std::shared_ptr<const RobotModel>& model, const VectorX& q, bool standing, double most) {
    const std::vector<bool> lifted = floor_reach(*model).lifted;
    Kinematics kinematics(model);
    kinematics.update(Vector3::Zero(), q);
    for (std::size_t i = 0; i < model->shapes.size(); ++i)
      if (lifted[i] != standing)
        most = std::min(most, lowest_point(model->shapes[i].shape, kinematics.X_WS(model->shapes[i])));
    return most;
  }

  // Lifts the root if it is not at the foot of the shapes with constant height. True if it did.
  bool stand_on_floor(const std::shared_ptr<const RobotModel>& model) {
    if (base_.type != BaseType::kFixed) return false;
    constexpr double kSunk = 0.01;  // hulls are slightly larger than their contents [m]
    const double foot = lowest(model, model->ready, true, 0.0);
    if (foot > -kSunk) return false;
    base_.X_BR.translation().z() = -foot;
    return true;
  }

  // Worlds need room below an arm; a fixed arm without any gets a plinth.
  bool lift(const std::shared_ptr<const RobotModel>& model, const VectorX& q) {
    if (base_.type != BaseType::kFixed) return false;
    constexpr double kRoom = 0.05;  // [m]
    const double arm = lowest(model, q, false, kRoom);
    if (arm >= kRoom) return false;
    base_.X_BR.translation().z() += std::ceil((kRoom - arm) * 100.0) / 100.0;
    return true;
  }

  void write_ready(const Posture& posture) {
    const std::string line = fmt::format("ready: [{}]", joined(posture.q, number));
    lines_.add(1, line,
               !posture.clear ? "no posture was found in which nothing touches"
               : !posture.held
                   ? "no posture was found that the joints' efforts can hold"
                   : fmt::format("manipulability {:.2g}, clear of itself, can be held", posture.manipulability),
               !posture.clear || !posture.held);
  }

  // A drive that cannot hold its arm in much of its range usually has springs, which URDFs do not describe.
  void propose_efforts(const std::shared_ptr<const RobotModel>& model) {
    constexpr double kMuch = 0.25, kSpare = 1.2;
    for (const JointLoad& load : joint_loads(model)) {
      if (load.beyond < kMuch) continue;
      const ControlledJoint& joint = model->joint(load.joint);
      lines_.doubt(
          1, "",  // a line that may have to be enabled
          fmt::format("limits: {{{}: {{effort: {}}}}} if springs or weights help the motor; the URDF's {} {} "
                      "are too few for the arm's weight in {:.0f} % of the range",
                      config::yaml_scalar(joint.name), number(std::ceil(kSpare * load.largest)), number(load.limit),
                      joint.type == JointType::kPrismatic ? "N" : "Nm", 100.0 * load.beyond));
    }
  }

  struct HeldJoint {
    std::string name;
    double q = 0.0;
    bool clear = true;
  };

  const DraftOptions& options_;
  std::vector<HeldJoint> held_;
  UrdfFacts urdf_;
  BaseGuess base_;
  ArmGuess arm_;
  Lines lines_;
  config::MeshSolids meshes_;
};

}  // namespace

Draft draft_robot(const DraftOptions& options) { return Drafter(options).draft(); }

bool is_urdf(const fs::path& file) {
  const std::string extension = file.extension().string();
  if (extension == ".urdf" || extension == ".xacro") return true;
  if (extension == ".yaml" || extension == ".yml" || extension == ".json") return false;
  try {
    const std::string text = config::read_text_file(file);
    const auto first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
    return first != std::string::npos && text[first] == '<';
  } catch (const std::exception&) {
    return false;  // the file's reader reports the error
  }
}

}  // namespace moma::draft
