#include "controller/model/urdf_visual.h"

#include <tinyxml.h>

#include <algorithm>
#include <map>
#include <sstream>

namespace moma {
namespace {

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
  for (auto* of = robot.FirstChildElement("material"); of != nullptr; of = of->NextSiblingElement("material"))
    note(of, colours);
  for (auto* link = robot.FirstChildElement("link"); link != nullptr; link = link->NextSiblingElement("link"))
    for (auto* visual = link->FirstChildElement("visual"); visual != nullptr;
         visual = visual->NextSiblingElement("visual"))
      note(visual->FirstChildElement("material"), colours);
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
  read_urdf(text, UrdfReading::kLenient);  // refuses broken files and files too deep for the parser
  TiXmlDocument document;
  document.Parse(text.c_str());
  TiXmlElement& robot = *document.FirstChildElement("robot");
  const Colours colours = all_colours(robot);

  // Visuals have the form of collision elements: they are renamed, read and checked as such.
  std::map<std::string, std::vector<std::optional<Vector3>>> painted;
  for (auto* link = robot.FirstChildElement("link"); link != nullptr; link = link->NextSiblingElement("link")) {
    while (TiXmlElement* collision = link->FirstChildElement("collision")) link->RemoveChild(collision);
    while (TiXmlElement* visual = link->FirstChildElement("visual")) {
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
