#include <tinyxml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controller/model/xml_check.h"

namespace moma {
namespace {

using Names = std::vector<std::string_view>;

constexpr double kLeastSize = 1e-9;  // [m], or a factor
constexpr double kMostSize = 1e9;

bool holds(const Names& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string list_of(const Names& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? " or " : ", ";
    text += names[i];
  }
  return text;
}

// Elements of other programs: <drake:...>, but never elements left by xacro, which may have been a part of the robot.
bool of_other_programs(std::string_view name) {
  return name.find(':') != std::string_view::npos && !name.starts_with("xacro:");
}

// Allowed contents of an element: `once` at most once, `often` any number of times, `aside` for other programs.
struct Content {
  Names once;
  Names often;
  Names aside;
};

class Checker {
 public:
  std::vector<std::string> check_robot(TiXmlElement& robot) {
    content(robot, "robot", {{}, {"link", "joint"}, {"material", "transmission", "gazebo", "sensor", "ros2_control"}});
    for (TiXmlElement* link : children(robot, "link")) check_link(*link);
    for (TiXmlElement* joint : children(robot, "joint")) check_joint(*joint);
    return std::move(faults_);
  }

 private:
  void fault(const TiXmlElement& element, const std::string& where, const std::string& what) {
    faults_.push_back("line " + std::to_string(element.Row()) + ": " + where + ": " + what);
  }

  // Removes the contents of `parent` that `allowed` does not name.
  void content(TiXmlElement& parent, const std::string& where, const Content& allowed) {
    Names seen;
    for (TiXmlElement* child : children(parent)) {
      const std::string_view name = child->ValueStr();
      const bool once = holds(allowed.once, name);
      if (once && holds(seen, name)) {
        fault(*child, where, "a second <" + std::string(name) + ">; one is accepted");
        parent.RemoveChild(child);
      } else if (!once && !holds(allowed.often, name) && !holds(allowed.aside, name) && !of_other_programs(name)) {
        Names accepted = allowed.once;
        accepted.insert(accepted.end(), allowed.often.begin(), allowed.often.end());
        fault(*child, where, "<" + std::string(name) + "> is not understood; expected " + list_of(accepted));
        parent.RemoveChild(child);
      } else {
        seen.push_back(name);
      }
    }
  }

  void attributes(const TiXmlElement& element, const std::string& where, const Names& accepted,
                  const Names& aside = {}) {
    for (const TiXmlAttribute* a = element.FirstAttribute(); a != nullptr; a = a->Next()) {
      const std::string_view name = a->NameTStr();
      if (holds(accepted, name) || holds(aside, name) || of_other_programs(name)) continue;
      fault(element, where,
            "the attribute '" + std::string(name) + "' of <" + element.ValueStr() + "> is not understood; expected " +
                list_of(accepted));
    }
  }

  // `count` finite numbers between blanks.
  std::optional<std::vector<double>> numbers(const TiXmlElement& element, const std::string& where, const char* name,
                                             std::size_t count) {
    const std::string* text = element.Attribute(std::string(name));
    const std::string attribute = element.ValueStr() + " " + name;
    const std::string expected = count == 1 ? "a number" : std::to_string(count) + " numbers with blanks between them";
    if (text == nullptr) {
      fault(element, where, attribute + " is missing; expected " + expected);
      return {};
    }
    std::vector<double> values;
    bool good = true;
    std::string_view left = *text;
    for (std::string_view word = next_word(left); good && !word.empty(); word = next_word(left)) {
      if (word.front() == '+') word.remove_prefix(1);
      double& value = values.emplace_back(0.0);
      const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
      good = error == std::errc() && std::isfinite(value) && stop == word.data() + word.size();
    }
    if (good && values.size() == count) return values;
    fault(element, where, attribute + "=\"" + text->substr(0, 100) + "\" is not understood; expected " + expected);
    return {};
  }

  void size(const TiXmlElement& element, const std::string& where, const char* name, std::size_t count) {
    const auto values = numbers(element, where, name, count);
    if (!values) return;
    for (const double value : *values) {
      const double measure = std::string_view(name) == "scale" ? std::abs(value) : value;  // meshes may be mirrored
      if (measure >= kLeastSize && measure <= kMostSize) continue;
      fault(element, where,
            element.ValueStr() + " " + name + "=\"" + element.Attribute(name) +
                "\": every size must be above 0, from 1e-9 to 1e9");
      return;
    }
  }

  void check_origin(TiXmlElement& parent, const std::string& where) {
    const TiXmlElement* origin = parent.FirstChildElement("origin");
    if (origin == nullptr) return;
    attributes(*origin, where, {"xyz", "rpy"});
    for (const char* name : {"xyz", "rpy"})
      if (origin->Attribute(name) != nullptr) numbers(*origin, where, name, 3);
  }

  void check_geometry(TiXmlElement& collision, const std::string& where) {
    TiXmlElement* geometry = collision.FirstChildElement("geometry");
    if (geometry == nullptr) return fault(collision, where, "there is no <geometry>");
    const Names kinds{"box", "cylinder", "sphere", "mesh"};
    content(*geometry, where + ", geometry", {kinds, {}, {}});
    std::vector<const TiXmlElement*> shapes;
    for (const TiXmlElement* child : children(*geometry))
      if (holds(kinds, child->ValueStr())) shapes.push_back(child);
    if (shapes.size() > 1) return fault(*geometry, where, "<geometry> holds more than one shape");
    if (shapes.empty()) return fault(*geometry, where, "<geometry> holds no shape; expected " + list_of(kinds));
    const TiXmlElement* shape = shapes.front();
    static const std::map<std::string_view, Names> kSizes{
        {"box", {"size"}}, {"sphere", {"radius"}}, {"cylinder", {"radius", "length"}}};
    if (const auto sizes = kSizes.find(shape->ValueStr()); sizes != kSizes.end()) {
      attributes(*shape, where, sizes->second);
      for (const std::string_view name : sizes->second) size(*shape, where, name.data(), name == "size" ? 3 : 1);
    } else {
      attributes(*shape, where, {"filename", "scale"});
      const char* file = shape->Attribute("filename");
      if (file == nullptr || *file == '\0') fault(*shape, where, "mesh filename is missing; expected a file");
      if (shape->Attribute("scale") != nullptr) size(*shape, where, "scale", 3);
    }
  }

  void check_inertial(TiXmlElement& inertial, const std::string& where) {
    content(inertial, where, {{"origin", "mass", "inertia"}, {}, {}});
    check_origin(inertial, where);
    if (const TiXmlElement* mass = inertial.FirstChildElement("mass")) {
      attributes(*mass, where, {"value"});
      const auto value = numbers(*mass, where, "value", 1);
      if (value && value->front() < 0.0) fault(*mass, where, "the mass must not be negative");
    } else {
      fault(inertial, where, "there is no <mass>");
    }
    if (const TiXmlElement* inertia = inertial.FirstChildElement("inertia")) {
      const Names moments{"ixx", "ixy", "ixz", "iyy", "iyz", "izz"};
      attributes(*inertia, where, moments, {"iyx", "izx", "izy"});
      for (const std::string_view name : moments) numbers(*inertia, where, name.data(), 1);
      // The other half of a symmetric matrix, which some exporters write as well.
      for (const auto& [mirror, name] : {std::pair{"iyx", "ixy"}, {"izx", "ixz"}, {"izy", "iyz"}}) {
        if (inertia->Attribute(mirror) == nullptr) continue;
        const auto value = numbers(*inertia, where, name, 1), again = numbers(*inertia, where, mirror, 1);
        if (value && again && *value != *again)
          fault(*inertia, where, std::string(mirror) + " differs from " + name + ": an inertia is symmetric");
      }
    } else {
      fault(inertial, where, "there is no <inertia>");
    }
  }

  void check_link(TiXmlElement& link) {
    const char* name = link.Attribute("name");
    const std::string where = std::string("link ") + (name != nullptr ? name : "without a name");
    content(link, where,
            {{"inertial"},
             {"collision", "visual"},
             {"contact", "gravity", "kinematic", "self_filter", "surface", "collision_checking",
              "self_collision_checking", "sensor", "gazebo", "material"}});
    if (TiXmlElement* inertial = link.FirstChildElement("inertial")) {
      const std::size_t before = faults_.size();
      check_inertial(*inertial, where + ", inertial");
      if (faults_.size() != before) link.RemoveChild(inertial);
    }
    int number = 0;
    for (TiXmlElement* collision : children(link, "collision")) {
      const std::string at = where + ", collision " + std::to_string(++number);
      const std::size_t before = faults_.size();
      // <surface>: friction and stiffness of Gazebo's contacts; the geometry alone collides.
      content(*collision, at, {{"origin", "geometry"}, {}, {"material", "verbose", "surface"}});
      check_origin(*collision, at);
      check_geometry(*collision, at);
      if (faults_.size() != before) link.RemoveChild(collision);
    }
  }

  void check_joint(TiXmlElement& joint) {
    const char* name = joint.Attribute("name");
    const std::string where = std::string("joint ") + (name != nullptr ? name : "without a name");
    content(joint, where,
            {{"origin", "parent", "child", "axis", "limit", "mimic"},
             {},
             {"calibration", "dynamics", "safety_controller", "gazebo"}});
    const auto check = [&](const char* child, const Names& accepted, const Names& aside = {}) {
      if (const TiXmlElement* element = joint.FirstChildElement(child)) attributes(*element, where, accepted, aside);
    };
    check("origin", {"xyz", "rpy"});
    check("parent", {"link"});
    check("child", {"link"});
    check("axis", {"xyz"});
    check("limit", {"lower", "upper", "velocity", "effort"},
          {"acceleration", "deceleration", "jerk", "command_effort", "current", "gear_velocity"});
    check("mimic", {"joint", "multiplier", "offset"});
  }

  std::vector<std::string> faults_;
};

}  // namespace

std::vector<std::string> remove_invalid_parts(TiXmlElement& robot) { return Checker().check_robot(robot); }

}  // namespace moma
