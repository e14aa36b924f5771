#include "controller/model/urdf.h"

#include <console_bridge/console.h>
#include <tinyxml.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <new>
#include <set>
#include <sstream>
#include <utility>

#include "controller/model/text_check.h"
#include "controller/model/xml_check.h"

namespace moma {
namespace {

// Captures urdfdom's messages for the error's text. Its handler is global, hence the lock.
class MessageCapture : public console_bridge::OutputHandler {
 public:
  MessageCapture() : lock_(mutex()) { console_bridge::useOutputHandler(this); }
  ~MessageCapture() override { console_bridge::restorePreviousOutputHandler(); }
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR) text_ += (text_.empty() ? "" : "; ") + text;
  }
  const std::string& text() const { return text_; }

 private:
  static std::mutex& mutex() {
    static std::mutex m;
    return m;
  }
  std::lock_guard<std::mutex> lock_;
  std::string text_;
};

using MissingLimits = std::map<std::string, std::set<std::string>>;  // joint -> lower, upper, velocity, effort

// urdfdom refuses joints without limits, which may come from the robot file: zeros are inserted and noted.
MissingLimits complete_limits(TiXmlElement& robot) {
  MissingLimits missing;
  for (TiXmlElement* joint : children(robot, "joint")) {
    const char* name = joint->Attribute("name");
    const char* type = joint->Attribute("type");
    if (name == nullptr || type == nullptr) continue;  // urdfdom reports it
    TiXmlElement* limit = joint->FirstChildElement("limit");
    if (limit == nullptr) {
      TiXmlElement empty("limit");
      limit = joint->InsertEndChild(empty)->ToElement();
    }
    std::set<std::string>& none = missing[name];
    if (limit->Attribute("lower") == nullptr && limit->Attribute("upper") == nullptr) none.insert({"lower", "upper"});
    for (const char* key : {"velocity", "effort"}) {
      if (limit->Attribute(key) != nullptr) continue;
      none.insert(key);
      limit->SetAttribute(key, "0");
    }
  }
  return missing;
}

void remove_all(TiXmlElement& parent, const char* name) {
  for (TiXmlElement* child : children(parent, name)) parent.RemoveChild(child);
}

// Links own their children: urdfdom would never free a loop among them.
void refuse_loops(const TiXmlElement& robot) {
  std::map<std::string, std::set<std::string>> parents;  // of each link on a joint
  for (const TiXmlElement* joint : children(robot, "joint")) {
    const TiXmlElement* parent = joint->FirstChildElement("parent");
    const TiXmlElement* child = joint->FirstChildElement("child");
    const char* from = parent != nullptr ? parent->Attribute("link") : nullptr;
    const char* to = child != nullptr ? child->Attribute("link") : nullptr;
    if (from != nullptr && to != nullptr) parents[to].insert(from);
  }
  if (parents.size() > kMaxUrdfLinks) throw UrdfError("more than " + std::to_string(kMaxUrdfLinks) + " links");
  // Removes links without parents, then links whose parents were removed: the rest hangs on a loop.
  const auto gone = [&](const auto& entry) {
    return std::none_of(entry.second.begin(), entry.second.end(),
                        [&](const std::string& parent) { return parents.count(parent) != 0; });
  };
  while (std::erase_if(parents, gone) > 0) {
  }
  if (parents.empty()) return;
  std::string link = parents.begin()->first;
  for (std::set<std::string> passed; passed.insert(link).second;)
    for (const std::string& parent : parents.at(link))
      if (parents.count(parent) != 0) link = parent;
  throw UrdfError("link " + link + " hangs on itself, by joints that form a loop");
}

struct Amended {
  std::string text;
  bool named = true;
  MissingLimits missing;
  std::vector<std::string> left_out;
};

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

Amended amend(const std::string& text, UrdfReading reading) {
  if (const std::size_t at = not_text(text); at != std::string::npos)
    throw UrdfError("line " + std::to_string(line_of(text, at)) + ": " + not_text_message(text, at));
  if (xml_depth(text) > kMaxXmlDepth)
    throw UrdfError("elements are nested more than " + std::to_string(kMaxXmlDepth) + " deep");
  TiXmlDocument document;
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
  for (const char* name : {"material", "transmission", "gazebo", "sensor"}) remove_all(*robot, name);
  for (TiXmlElement* link : children(*robot, "link")) remove_all(*link, "visual");
  Amended amended;
  amended.left_out = remove_invalid_parts(*robot);
  if (reading == UrdfReading::kStrict && !amended.left_out.empty()) refuse(amended.left_out);
  if (robot->Attribute("name") == nullptr) {
    amended.named = false;
    robot->SetAttribute("name", "robot");  // urdfdom requires one
  }
  refuse_loops(*robot);
  amended.missing = complete_limits(*robot);
  TiXmlPrinter printer;
  document.Accept(&printer);
  amended.text = printer.Str();
  return amended;
}

Vector3 vector_of(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

Isometry isometry_of(const urdf::Pose& pose, const std::string& where) {
  const Eigen::Quaterniond quaternion(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z);
  const Isometry X = pose_of(quaternion.normalized().toRotationMatrix(), vector_of(pose.position));
  if (!X.matrix().allFinite()) throw UrdfError(where + ": its origin is not made of finite numbers");
  return X;
}

UrdfJointType type_of(const urdf::Joint& joint) {
  static const std::map<int, UrdfJointType> kTypes{
      {urdf::Joint::FIXED, UrdfJointType::kFixed},           {urdf::Joint::REVOLUTE, UrdfJointType::kRevolute},
      {urdf::Joint::CONTINUOUS, UrdfJointType::kContinuous}, {urdf::Joint::PRISMATIC, UrdfJointType::kPrismatic},
      {urdf::Joint::FLOATING, UrdfJointType::kFloating},     {urdf::Joint::PLANAR, UrdfJointType::kPlanar}};
  const auto found = kTypes.find(joint.type);
  if (found == kTypes.end()) throw UrdfError("joint " + joint.name + ": unknown type");
  return found->second;
}

UrdfJoint joint_of(const urdf::Joint& source, const std::set<std::string>& missing) {
  const std::string where = "joint " + source.name;
  UrdfJoint joint;
  joint.name = source.name;
  joint.type = type_of(source);
  joint.X_PJ = isometry_of(source.parent_to_joint_origin_transform, where);
  if (joint.type == UrdfJointType::kFixed || joint.type == UrdfJointType::kFloating) return joint;
  joint.axis = vector_of(source.axis);
  const double length = joint.axis.norm();
  if (!(length > 1e-9) || !std::isfinite(length)) throw UrdfError(where + ": its axis has no direction");
  if (std::abs(length - 1.0) > 1e-12) joint.axis /= length;
  const auto limit = [&](const char* key, double value) -> std::optional<double> {
    if (missing.count(key) != 0) return std::nullopt;
    if (!std::isfinite(value)) throw UrdfError(where + ": limit " + key + " is not a finite number");
    return value;
  };
  if (source.limits) {
    if (joint.type != UrdfJointType::kContinuous) {
      joint.lower = limit("lower", source.limits->lower);
      joint.upper = limit("upper", source.limits->upper);
    }
    joint.velocity = limit("velocity", source.limits->velocity);
    joint.effort = limit("effort", source.limits->effort);
  }
  if (source.mimic) joint.mimic = UrdfMimic{source.mimic->joint_name, source.mimic->multiplier, source.mimic->offset};
  return joint;
}

std::optional<Inertial> inertial_of(const urdf::Link& link) {
  if (!link.inertial) return std::nullopt;
  const urdf::Inertial& source = *link.inertial;
  const std::string where = "link " + link.name + ", inertial";
  const Isometry X_LI = isometry_of(source.origin, where);
  Matrix3 I;
  I << source.ixx, source.ixy, source.ixz, source.ixy, source.iyy, source.iyz, source.ixz, source.iyz, source.izz;
  Inertial inertial;
  inertial.mass = source.mass;
  inertial.com_L = X_LI.translation();
  inertial.I_C = X_LI.linear() * I * X_LI.linear().transpose();
  if (!std::isfinite(inertial.mass) || inertial.mass < 0.0 || !inertial.I_C.allFinite())
    throw UrdfError(where + ": mass and inertia must be finite, and the mass not negative");
  return inertial;
}

UrdfGeometry geometry_of(const urdf::Collision& source, const std::string& where) {
  UrdfGeometry geometry;
  geometry.X_LS = isometry_of(source.origin, where);
  Shape& shape = geometry.shape;
  switch (source.geometry->type) {
    case urdf::Geometry::SPHERE:
      shape = {ShapeKind::kSphere, {static_cast<const urdf::Sphere&>(*source.geometry).radius, 0.0, 0.0}, nullptr};
      break;
    case urdf::Geometry::BOX:
      shape = {ShapeKind::kBox, vector_of(static_cast<const urdf::Box&>(*source.geometry).dim), nullptr};
      break;
    case urdf::Geometry::CYLINDER: {
      const auto& cylinder = static_cast<const urdf::Cylinder&>(*source.geometry);
      shape = {ShapeKind::kCylinder, {cylinder.radius, cylinder.length, 0.0}, nullptr};
      break;
    }
    case urdf::Geometry::MESH: {
      const auto& mesh = static_cast<const urdf::Mesh&>(*source.geometry);
      geometry.mesh = mesh.filename;
      geometry.scale = vector_of(mesh.scale);
      break;
    }
  }
  const Vector3 extent = geometry.mesh.empty() ? shape.size : geometry.scale.cwiseAbs();
  const int sizes = geometry.mesh.empty() ? num_sizes(shape.kind) : 3;
  if (!extent.allFinite() || !(extent.head(sizes).minCoeff() > 0.0))
    throw UrdfError(where + ": every size must be above 0");
  return geometry;
}

UrdfLink link_of(const urdf::Link& source) {
  UrdfLink link;
  link.name = source.name;
  link.inertial = inertial_of(source);
  for (const auto& collision : source.collision_array)
    if (collision && collision->geometry)
      link.collision.push_back(geometry_of(*collision, "link " + link.name + ", collision"));
  return link;
}

void check_size(const urdf::ModelInterface& model) {
  std::size_t shapes = 0;
  for (const auto& [name, link] : model.links_) shapes += link->collision_array.size();
  if (model.links_.size() > kMaxUrdfLinks) throw UrdfError("more than " + std::to_string(kMaxUrdfLinks) + " links");
  if (shapes > kMaxUrdfShapes) throw UrdfError("more than " + std::to_string(kMaxUrdfShapes) + " collision elements");
}

UrdfTree parse(const std::string& text, UrdfReading reading) {
  Amended amended = amend(text, reading);
  urdf::ModelInterfaceSharedPtr model;
  std::string said;
  // urdfdom takes memory that ran out for a number that it cannot read: once more tells one from the other.
  for (int attempt = 0; attempt < 2 && (!model || !said.empty()); ++attempt) {
    MessageCapture capture;
    try {
      model = urdf::parseURDF(amended.text);
      said = capture.text();
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& e) {
      model = nullptr;
      said = e.what() + (capture.text().empty() ? std::string() : "; " + capture.text());
    }
  }
  if (!model) throw UrdfError(said.empty() ? "not a valid URDF" : said);
  // Elements that urdfdom dropped with a message although the checks above passed them.
  if (!said.empty()) amended.left_out.push_back(said);
  if (reading == UrdfReading::kStrict && !amended.left_out.empty()) refuse(amended.left_out);
  check_size(*model);
  if (!model->getRoot()) throw UrdfError("there is no root link");

  UrdfTree tree;
  if (amended.named) tree.name = model->getName();
  tree.left_out = std::move(amended.left_out);
  std::set<std::string> seen;
  struct Open {
    urdf::LinkConstSharedPtr link;
    int parent;
  };
  std::vector<Open> stack{{model->getRoot(), -1}};
  while (!stack.empty()) {
    const Open open = stack.back();
    stack.pop_back();
    if (!seen.insert(open.link->name).second) throw UrdfError("link " + open.link->name + " hangs on several joints");
    UrdfLink link = link_of(*open.link);
    link.parent = open.parent;
    if (open.parent >= 0) {
      const urdf::Joint& joint = *open.link->parent_joint;
      link.joint = joint_of(joint, amended.missing.at(joint.name));
    }
    tree.links.push_back(std::move(link));
    const int index = static_cast<int>(tree.links.size()) - 1;
    for (auto child = open.link->child_links.rbegin(); child != open.link->child_links.rend(); ++child)
      stack.push_back({*child, index});
  }
  for (const auto& [name, link] : model->links_)
    if (name == "@base")
      throw UrdfError("a link is called @base, which is the mobile base's name");
    else if (seen.count(name) == 0)
      throw UrdfError("link " + name + " is not connected to the root " + tree.links[0].name);
  return tree;
}

using Colours = std::map<std::string, Vector3>;  // by material

std::string name_of(const TiXmlElement& element) {
  const char* name = element.Attribute("name");
  return name != nullptr ? name : "";
}

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

UrdfTree read_urdf(const std::string& text, UrdfReading reading) {
  try {
    return parse(text, reading);
  } catch (const UrdfError& e) {
    // Elements left by xacro do no harm, so this is only a hint.
    const bool xacro = text.find("<xacro:") != std::string::npos;
    throw UrdfError(e.what() + std::string(xacro ? " (the file has xacro elements: expand it with xacro first)" : ""));
  }
}

std::vector<UrdfVisual> read_urdf_visuals(const std::string& text) {
  read_urdf(text, UrdfReading::kLenient);  // refuses broken files and files too deep for the parser
  TiXmlDocument document;
  document.Parse(text.c_str());
  TiXmlElement& robot = *document.FirstChildElement("robot");
  const Colours colours = all_colours(robot);

  // Visuals have the form of collision elements: they are renamed, read and checked as such.
  std::map<std::string, std::vector<std::optional<Vector3>>> painted;
  for (TiXmlElement* link : children(robot, "link")) {
    remove_all(*link, "collision");
    for (TiXmlElement* visual : children(*link, "visual")) {
      painted[name_of(*link)].push_back(colour_of(*visual, colours));
      visual->SetValue("collision");
    }
  }
  TiXmlPrinter printer;
  document.Accept(&printer);
  std::vector<UrdfVisual> visuals;
  for (const UrdfLink& link : read_urdf(printer.Str(), UrdfReading::kLenient).links) {
    const auto& paint = painted[link.name];
    const bool whole = paint.size() == link.collision.size();  // nothing was left out: each has its own
    for (std::size_t i = 0; i < link.collision.size(); ++i)
      visuals.push_back({link.name, link.collision[i], whole ? paint[i] : std::nullopt});
  }
  return visuals;
}

}  // namespace moma
