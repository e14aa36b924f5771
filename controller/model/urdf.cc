#include "controller/model/urdf.h"

#include <tinyxml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include "controller/model/text_check.h"
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

std::string name_of(const TiXmlElement& element) {
  const char* name = element.Attribute("name");
  return name != nullptr ? name : "";
}

/// Rotation about the fixed axes x, y and z, in this order, by way of the quaternion as urdfdom computes it.
Matrix3 rotation_of(const Vector3& rpy) {
  const Vector3 half = 0.5 * rpy;
  const double sx = std::sin(half.x()), sy = std::sin(half.y()), sz = std::sin(half.z());
  const double cx = std::cos(half.x()), cy = std::cos(half.y()), cz = std::cos(half.z());
  const double x = sx * cy * cz - cx * sy * sz, y = cx * sy * cz + sx * cy * sz;
  const double z = cx * cy * sz - sx * sy * cz, w = cx * cy * cz + sx * sy * sz;
  const double length = std::sqrt(x * x + y * y + z * z + w * w);
  return Eigen::Quaterniond(w / length, x / length, y / length, z / length).normalized().toRotationMatrix();
}

/// Reads elements. Faults are noted, one sentence each, and where they stand nothing is read.
class Reader {
 public:
  explicit Reader(const char* part) : part_(part) {}

  const std::vector<std::string>& faults() const { return faults_; }

  void check_robot(const TiXmlElement& robot) {
    content(robot, "robot", {{}, {"link", "joint"}, {"material", "transmission", "gazebo", "sensor", "ros2_control"}});
  }

  UrdfLink link(const TiXmlElement& element) {
    UrdfLink link;
    link.name = name_of(element);
    const std::string where = "link " + (link.name.empty() ? "without a name" : link.name);
    content(element, where,
            {{"inertial"},
             {"collision", "visual"},
             {"contact", "gravity", "kinematic", "self_filter", "surface", "collision_checking",
              "self_collision_checking", "sensor", "gazebo", "material"}});
    if (const TiXmlElement* inertial = element.FirstChildElement("inertial"))
      link.inertial = whole([&] { return this->inertial(*inertial, where + ", inertial"); });
    int number = 0;
    for (const TiXmlElement* part : children(element, part_)) {
      const std::string at = where + ", " + part_ + " " + std::to_string(++number);
      if (auto geometry = whole([&] { return this->geometry(*part, at); }))
        link.collision.push_back(std::move(*geometry));
    }
    return link;
  }

  UrdfJoint joint(const TiXmlElement& element) {
    UrdfJoint joint;
    joint.name = name_of(element);
    const std::string where = "joint " + (joint.name.empty() ? "without a name" : joint.name);
    content(element, where,
            {{"origin", "parent", "child", "axis", "limit", "mimic"},
             {},
             {"calibration", "dynamics", "safety_controller", "gazebo"}});
    attributes_of_child(element, where, "parent", {"link"});
    attributes_of_child(element, where, "child", {"link"});
    attributes_of_child(element, where, "axis", {"xyz"});
    attributes_of_child(element, where, "limit", {"lower", "upper", "velocity", "effort"},
                        {"acceleration", "deceleration", "jerk", "command_effort", "current", "gear_velocity"});
    attributes_of_child(element, where, "mimic", {"joint", "multiplier", "offset"});
    attributes_of_child(element, where, "origin", {"xyz", "rpy"});
    const char* type = element.Attribute("type");
    const auto known = from_string<UrdfJointType>(type != nullptr ? type : "");
    if (!known) throw UrdfError(where + ": unknown type; expected one of: " + list_of_words<UrdfJointType>());
    joint.type = *known;
    const std::size_t before = faults_.size();
    joint.X_PJ = origin(element, where);
    UrdfJoint driven = joint;
    const bool moves = joint.type != UrdfJointType::kFixed && joint.type != UrdfJointType::kFloating;
    const TiXmlElement* axis = element.FirstChildElement("axis");
    if (moves && axis != nullptr) driven.axis = vector(*axis, where, "xyz");
    if (const TiXmlElement* limit = element.FirstChildElement("limit")) read_limits(*limit, where, driven);
    if (const TiXmlElement* mimic = element.FirstChildElement("mimic")) driven.mimic = read_mimic(*mimic, where);
    if (faults_.size() != before) throw UrdfError(faults_.back());  // without a joint it is another robot
    if (!moves) return joint;
    const double length = driven.axis.norm();
    if (!(length > 1e-9) || !std::isfinite(length)) throw UrdfError(where + ": its axis has no direction");
    if (std::abs(length - 1.0) > 1e-12) driven.axis /= length;
    return driven;
  }

 private:
  void fault(const TiXmlElement& element, const std::string& where, const std::string& what) {
    faults_.push_back("line " + std::to_string(element.Row()) + ": " + where + ": " + what);
  }

  /// What `read` returns, unless it notes a fault.
  template <class Read>
  auto whole(const Read& read) -> std::optional<decltype(read())> {
    const std::size_t before = faults_.size();
    std::optional out(read());
    if (faults_.size() != before) out.reset();
    return out;
  }

  /// Of a name that may stand once, the first element is read.
  void content(const TiXmlElement& parent, const std::string& where, const Content& allowed) {
    Names seen;
    for (const TiXmlElement* child : children(parent)) {
      const std::string_view name = child->ValueStr();
      const bool once = holds(allowed.once, name);
      if (once && holds(seen, name)) {
        fault(*child, where, "a second <" + std::string(name) + ">; one is accepted");
      } else if (!once && !holds(allowed.often, name) && !holds(allowed.aside, name) && !of_other_programs(name)) {
        Names accepted = allowed.once;
        accepted.insert(accepted.end(), allowed.often.begin(), allowed.often.end());
        fault(*child, where, "<" + std::string(name) + "> is not understood; expected " + list_of(accepted));
      }
      seen.push_back(name);
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

  void attributes_of_child(const TiXmlElement& parent, const std::string& where, const char* child,
                           const Names& accepted, const Names& aside = {}) {
    if (const TiXmlElement* element = parent.FirstChildElement(child)) attributes(*element, where, accepted, aside);
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
    const char* at = text->data();
    const char* const end = at + text->size();
    const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
    while (good) {
      while (at != end && blank(*at)) ++at;
      if (at == end) break;
      if (*at == '+') ++at;
      double value = 0.0;
      const auto [stop, error] = std::from_chars(at, end, value);
      good = error == std::errc() && std::isfinite(value) && (stop == end || blank(*stop));
      at = stop;
      values.push_back(value);
    }
    if (good && values.size() == count) return values;
    fault(element, where, attribute + "=\"" + text->substr(0, 100) + "\" is not understood; expected " + expected);
    return {};
  }

  double number(const TiXmlElement& element, const std::string& where, const char* name) {
    const auto values = numbers(element, where, name, 1);
    return values ? values->front() : 0.0;
  }

  Vector3 vector(const TiXmlElement& element, const std::string& where, const char* name) {
    const auto values = numbers(element, where, name, 3);
    return values ? Vector3((*values)[0], (*values)[1], (*values)[2]) : Vector3(Vector3::Zero());
  }

  /// Sizes of a solid; factors of a mesh may be negative, which mirrors it.
  Vector3 sizes(const TiXmlElement& element, const std::string& where, const char* name, std::size_t count) {
    const auto values = numbers(element, where, name, count);
    if (!values) return Vector3::Ones();
    Vector3 sizes = Vector3::Zero();
    for (std::size_t i = 0; i < count; ++i) {
      const double value = sizes[static_cast<Eigen::Index>(i)] = (*values)[i];
      const double measure = std::string_view(name) == "scale" ? std::abs(value) : value;
      if (measure >= kLeastSize && measure <= kMostSize) continue;
      fault(element, where,
            element.ValueStr() + " " + name + "=\"" + element.Attribute(name) +
                "\": every size must be above 0, from 1e-9 to 1e9");
      break;
    }
    return sizes;
  }

  Isometry origin(const TiXmlElement& parent, const std::string& where) {
    Isometry X = Isometry::Identity();
    const TiXmlElement* origin = parent.FirstChildElement("origin");
    if (origin == nullptr) return X;
    if (origin->Attribute("xyz") != nullptr) X.translation() = vector(*origin, where, "xyz");
    if (origin->Attribute("rpy") != nullptr) X.linear() = rotation_of(vector(*origin, where, "rpy"));
    return X;
  }

  UrdfGeometry geometry(const TiXmlElement& part, const std::string& where) {
    UrdfGeometry out;
    // <surface>: friction and stiffness of Gazebo's contacts; the geometry alone collides.
    content(part, where, {{"origin", "geometry"}, {}, {"material", "verbose", "surface"}});
    attributes_of_child(part, where, "origin", {"xyz", "rpy"});
    out.X_LS = origin(part, where);
    const TiXmlElement* geometry = part.FirstChildElement("geometry");
    if (geometry == nullptr) {
      fault(part, where, "there is no <geometry>");
      return out;
    }
    const Names kinds{"box", "cylinder", "sphere", "mesh"};
    content(*geometry, where + ", geometry", {kinds, {}, {}});
    std::vector<const TiXmlElement*> shapes;
    for (const TiXmlElement* child : children(*geometry))
      if (holds(kinds, child->ValueStr()) && child == geometry->FirstChildElement(child->Value()))
        shapes.push_back(child);
    if (shapes.size() != 1) {
      fault(*geometry, where,
            shapes.empty() ? "<geometry> holds no shape; expected " + list_of(kinds)
                           : "<geometry> holds more than one shape");
      return out;
    }
    read_shape(*shapes.front(), where, out);
    return out;
  }

  void read_shape(const TiXmlElement& shape, const std::string& where, UrdfGeometry& out) {
    const std::string& kind = shape.ValueStr();
    if (kind == "box") {
      attributes(shape, where, {"size"});
      out.shape = {ShapeKind::kBox, sizes(shape, where, "size", 3), nullptr};
    } else if (kind == "sphere") {
      attributes(shape, where, {"radius"});
      out.shape = {ShapeKind::kSphere, sizes(shape, where, "radius", 1), nullptr};
    } else if (kind == "cylinder") {
      attributes(shape, where, {"radius", "length"});
      const double radius = sizes(shape, where, "radius", 1).x();
      out.shape = {ShapeKind::kCylinder, {radius, sizes(shape, where, "length", 1).x(), 0.0}, nullptr};
    } else {
      attributes(shape, where, {"filename", "scale"});
      const char* file = shape.Attribute("filename");
      out.mesh = file != nullptr ? file : "";
      if (out.mesh.empty()) fault(shape, where, "mesh filename is missing; expected a file");
      if (shape.Attribute("scale") != nullptr) out.scale = sizes(shape, where, "scale", 3);
    }
  }

  Inertial inertial(const TiXmlElement& element, const std::string& where) {
    content(element, where, {{"origin", "mass", "inertia"}, {}, {}});
    attributes_of_child(element, where, "origin", {"xyz", "rpy"});
    const Isometry X_LI = origin(element, where);
    Inertial out;
    out.com_L = X_LI.translation();
    if (const TiXmlElement* mass = element.FirstChildElement("mass")) {
      attributes(*mass, where, {"value"});
      out.mass = number(*mass, where, "value");
      if (out.mass < 0.0) fault(*mass, where, "the mass must not be negative");
    } else {
      fault(element, where, "there is no <mass>");
    }
    const TiXmlElement* inertia = element.FirstChildElement("inertia");
    if (inertia == nullptr) {
      fault(element, where, "there is no <inertia>");
      return out;
    }
    attributes(*inertia, where, {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}, {"iyx", "izx", "izy"});
    const auto moment = [&](const char* name) { return number(*inertia, where, name); };
    // The other half of a symmetric matrix, which some exporters write as well.
    const auto product = [&](const char* name, const char* mirror) {
      const double value = moment(name);
      if (inertia->Attribute(mirror) != nullptr && moment(mirror) != value)
        fault(*inertia, where, std::string(mirror) + " differs from " + name + ": an inertia is symmetric");
      return value;
    };
    const double ixy = product("ixy", "iyx"), ixz = product("ixz", "izx"), iyz = product("iyz", "izy");
    Matrix3 I;
    I << moment("ixx"), ixy, ixz, ixy, moment("iyy"), iyz, ixz, iyz, moment("izz");
    out.I_C = X_LI.linear() * I * X_LI.linear().transpose();
    if (!out.I_C.allFinite()) fault(*inertia, where, "its inertia is not finite");
    return out;
  }

  void read_limits(const TiXmlElement& limit, const std::string& where, UrdfJoint& joint) {
    const auto read = [&](const char* name) -> std::optional<double> {
      if (limit.Attribute(name) == nullptr) return std::nullopt;
      return number(limit, where, name);
    };
    const bool range = limit.Attribute("lower") != nullptr || limit.Attribute("upper") != nullptr;
    if (range && joint.type != UrdfJointType::kContinuous) {
      joint.lower = read("lower").value_or(0.0);
      joint.upper = read("upper").value_or(0.0);
    }
    joint.velocity = read("velocity");
    joint.effort = read("effort");
  }

  UrdfMimic read_mimic(const TiXmlElement& element, const std::string& where) {
    UrdfMimic mimic;
    const char* joint = element.Attribute("joint");
    if (joint == nullptr) throw UrdfError(where + ": mimic joint is missing; expected the name of a joint");
    mimic.joint = joint;
    if (element.Attribute("multiplier") != nullptr) mimic.multiplier = number(element, where, "multiplier");
    if (element.Attribute("offset") != nullptr) mimic.offset = number(element, where, "offset");
    return mimic;
  }

  const char* part_;  // name of the elements that are read as collision
  std::vector<std::string> faults_;
};

/// A joint with the names of the links that it joins.
struct Joining {
  UrdfJoint joint;
  std::string parent, child;
};

/// By name of the joint, which is the order of children.
std::map<std::string, Joining> read_joints(const TiXmlElement& robot, Reader& reader) {
  std::map<std::string, Joining> joints;
  for (const TiXmlElement* element : children(robot, "joint")) {
    Joining read{reader.joint(*element), "", ""};
    const std::string name = read.joint.name;
    for (const auto& [which, link] : {std::pair{"parent", &read.parent}, {"child", &read.child}}) {
      const TiXmlElement* of = element->FirstChildElement(which);
      const char* given = of != nullptr ? of->Attribute("link") : nullptr;
      if (given == nullptr) throw UrdfError("joint " + name + ": its " + which + " link is missing");
      *link = given;
    }
    if (name.empty()) throw UrdfError("a joint has no name");
    if (!joints.emplace(name, std::move(read)).second) throw UrdfError("joint " + name + " is there twice");
  }
  return joints;
}

std::map<std::string, UrdfLink> read_links(const TiXmlElement& robot, Reader& reader) {
  std::map<std::string, UrdfLink> links;
  std::size_t shapes = 0;
  for (const TiXmlElement* element : children(robot, "link")) {
    UrdfLink link = reader.link(*element);
    const std::string name = link.name;
    shapes += link.collision.size();
    if (name.empty()) throw UrdfError("a link has no name");
    if (name == "@base") throw UrdfError("a link is called @base, which is the mobile base's name");
    if (!links.emplace(name, std::move(link)).second) throw UrdfError("link " + name + " is there twice");
  }
  if (links.size() > kMaxUrdfLinks) throw UrdfError("more than " + std::to_string(kMaxUrdfLinks) + " links");
  if (shapes > kMaxUrdfShapes) throw UrdfError("more than " + std::to_string(kMaxUrdfShapes) + " collision elements");
  return links;
}

/// `link` is not below the first root: it is below another one, or on a loop.
[[noreturn]] void refuse_second_root(const std::map<std::string, const Joining*>& above, std::string link) {
  std::set<std::string> passed;
  for (auto up = above.find(link); up != above.end(); up = above.find(link)) {
    if (!passed.insert(link).second) throw UrdfError("link " + link + " hangs on itself, by joints that form a loop");
    link = up->second->parent;
  }
  throw UrdfError("link " + link + " hangs on no joint, and is not the only one: a robot has one root");
}

std::vector<UrdfLink> tree_of(std::map<std::string, UrdfLink> links, const std::map<std::string, Joining>& joints) {
  if (links.empty()) throw UrdfError("there is no link");
  std::map<std::string, const Joining*> above;               // of a link
  std::map<std::string, std::vector<const Joining*>> below;  // of a link
  for (const auto& [name, joining] : joints) {
    for (const std::string& link : {joining.parent, joining.child})
      if (links.count(link) == 0) throw UrdfError("joint " + name + ": there is no link " + link);
    if (!above.emplace(joining.child, &joining).second)
      throw UrdfError("link " + joining.child + " hangs on several joints");
    below[joining.parent].push_back(&joining);
  }
  struct Open {
    std::string link;
    int parent;
  };
  std::vector<Open> stack;
  for (const auto& [name, link] : links) {
    if (above.count(name) != 0) continue;
    stack.push_back({name, -1});
    break;
  }
  std::vector<UrdfLink> tree;
  while (!stack.empty()) {
    const Open open = stack.back();
    stack.pop_back();
    UrdfLink& link = tree.emplace_back(std::move(links.extract(open.link).mapped()));
    link.parent = open.parent;
    if (open.parent >= 0) link.joint = above.at(open.link)->joint;
    const int index = static_cast<int>(tree.size()) - 1;
    const std::vector<const Joining*>& children = below[open.link];
    for (auto child = children.rbegin(); child != children.rend(); ++child) stack.push_back({(*child)->child, index});
  }
  if (!links.empty()) refuse_second_root(above, links.begin()->first);
  return tree;
}

[[noreturn]] void refuse(const std::vector<std::string>& faults) {
  constexpr std::size_t kShown = 5;
  std::string text;
  for (std::size_t i = 0; i < std::min(faults.size(), kShown); ++i) text += (i > 0 ? "; " : "") + faults[i];
  if (faults.size() > kShown) text += "; and " + std::to_string(faults.size() - kShown) + " more";
  throw UrdfError(text + " (--lenient, or `lenient: true` in the robot file, leaves out what is not understood)");
}

/// To the parser numeric characters ("&#233;") are bytes of Latin-1 unless the file declares UTF-8.
void check_encoding(const std::string& text, const TiXmlDocument& document) {
  if (text.find("&#") == std::string::npos) return;
  TiXmlPrinter printer;
  document.Accept(&printer);
  if (not_text(printer.Str()) != std::string::npos)
    throw UrdfError(
        "characters by number, as &#233;, need <?xml version=\"1.0\" encoding=\"UTF-8\"?> as the first line");
}

/// The <robot> of a document that is made of the text.
TiXmlElement& parse(const std::string& text, TiXmlDocument& document) {
  if (const std::size_t at = not_text(text); at != std::string::npos)
    throw UrdfError("line " + std::to_string(line_of(text, at)) + ": " + not_text_message(text, at));
  if (xml_depth(text) > kMaxXmlDepth)
    throw UrdfError("elements are nested more than " + std::to_string(kMaxXmlDepth) + " deep");
  document.Parse(text.c_str());
  if (document.Error()) {
    throw UrdfError("not valid XML: " + std::string(document.ErrorDesc()) + " at row " +
                    std::to_string(document.ErrorRow()) + ", column " + std::to_string(document.ErrorCol()));
  }
  check_encoding(text, document);
  TiXmlElement* robot = document.FirstChildElement("robot");
  if (robot == nullptr) throw UrdfError("not a URDF: there is no <robot> element");
  if (const TiXmlElement* other = robot->NextSiblingElement(); other != nullptr)
    throw UrdfError("after </robot> stands <" + other->ValueStr() + "> at row " + std::to_string(other->Row()) +
                    ", which nothing reads: a URDF has one element, <robot>");
  return *robot;
}

/// `part`: the elements of links that are read as collision.
UrdfTree read(const TiXmlElement& robot, UrdfReading reading, const char* part) {
  Reader reader(part);
  reader.check_robot(robot);
  std::map<std::string, UrdfLink> links = read_links(robot, reader);
  const std::map<std::string, Joining> joints = read_joints(robot, reader);
  if (reading == UrdfReading::kStrict && !reader.faults().empty()) refuse(reader.faults());
  return {name_of(robot), tree_of(std::move(links), joints), reader.faults()};
}

}  // namespace

UrdfTree read_urdf(const std::string& text, UrdfReading reading) {
  try {
    TiXmlDocument document;
    return read(parse(text, document), reading, "collision");
  } catch (const UrdfError& e) {
    // Elements left by xacro do no harm, so this is only a hint.
    const bool xacro = text.find("<xacro:") != std::string::npos;
    throw UrdfError(e.what() + std::string(xacro ? " (the file has xacro elements: expand it with xacro first)" : ""));
  }
}

namespace {

using Colours = std::map<std::string, Vector3>;  // by material

std::optional<Vector3> own_colour(const TiXmlElement* material) {
  const TiXmlElement* colour = material != nullptr ? material->FirstChildElement("color") : nullptr;
  const char* text = colour != nullptr ? colour->Attribute("rgba") : nullptr;
  if (text == nullptr) return std::nullopt;
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  Vector3 rgb;
  if (!(in >> rgb.x() >> rgb.y() >> rgb.z()) || !rgb.allFinite()) return std::nullopt;
  return rgb.cwiseMax(0.0).cwiseMin(1.0);
}

void note(const TiXmlElement* material, Colours& colours) {
  if (material == nullptr) return;
  if (const std::optional<Vector3> colour = own_colour(material)) colours.emplace(name_of(*material), *colour);
}

Colours all_colours(const TiXmlElement& robot) {
  Colours colours;
  for (const TiXmlElement* of : children(robot, "material")) note(of, colours);
  for (const TiXmlElement* link : children(robot, "link"))
    for (const TiXmlElement* visual : children(*link, "visual")) note(visual->FirstChildElement("material"), colours);
  return colours;
}

std::optional<Vector3> colour_of(const TiXmlElement& visual, const Colours& colours) {
  const TiXmlElement* material = visual.FirstChildElement("material");
  if (material == nullptr) return std::nullopt;
  if (const std::optional<Vector3> own = own_colour(material)) return own;
  const auto named = colours.find(name_of(*material));
  if (named == colours.end()) return std::nullopt;
  return named->second;
}

}  // namespace

std::vector<UrdfVisual> read_urdf_visuals(const std::string& text) {
  read_urdf(text, UrdfReading::kLenient);  // refuses broken files
  TiXmlDocument document;
  const TiXmlElement& robot = parse(text, document);
  const Colours colours = all_colours(robot);
  std::map<std::string, std::vector<std::optional<Vector3>>> painted;
  for (const TiXmlElement* link : children(robot, "link"))
    for (const TiXmlElement* visual : children(*link, "visual"))
      painted[name_of(*link)].push_back(colour_of(*visual, colours));
  std::vector<UrdfVisual> visuals;
  for (const UrdfLink& link : read(robot, UrdfReading::kLenient, "visual").links) {
    const auto& paint = painted[link.name];
    const bool whole = paint.size() == link.collision.size();  // nothing was left out: each has its own
    for (std::size_t i = 0; i < link.collision.size(); ++i)
      visuals.push_back({link.name, link.collision[i], whole ? paint[i] : std::nullopt});
  }
  return visuals;
}

}  // namespace moma
