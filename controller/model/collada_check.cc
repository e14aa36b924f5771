#include "controller/model/collada_check.h"

#include <tinyxml.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "controller/model/collada_geometry.h"
#include "controller/model/xml_depth.h"

namespace moma {
namespace {

constexpr std::size_t kMaxNodes = 100'000;

struct SceneNode {
  std::vector<int> children;           // nested nodes
  std::vector<std::string> instances;  // ids of nodes that it instantiates
  int state = 0;                       // 0 unseen, 1 open, 2 known
  int height = 0;
  std::size_t count = 0;
};

class Scenes {
 public:
  std::string fault_of(const TiXmlElement& root) {
    walk(root, -1);
    for (std::size_t i = 0; i < nodes_.size() && fault_.empty(); ++i) measure(static_cast<int>(i), 0);
    return fault_;
  }

 private:
  SceneNode& node(int i) { return nodes_[static_cast<std::size_t>(i)]; }

  // The text is nested no deeper than kMaxXmlDepth.
  void walk(const TiXmlElement& element, int parent) {
    for (const TiXmlElement* child = element.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      const std::string_view name = child->ValueStr();
      int inside = parent;
      if (name == "node") {
        inside = static_cast<int>(nodes_.size());
        nodes_.emplace_back();
        if (parent >= 0) node(parent).children.push_back(inside);
        if (const char* id = child->Attribute("id")) by_id_[id].push_back(inside);
      } else if (name == "instance_node" && parent >= 0) {
        const char* url = child->Attribute("url");
        if (url != nullptr) node(parent).instances.emplace_back(*url == '#' ? url + 1 : url);
      }
      walk(*child, inside);
    }
  }

  void measure(int i, int depth) {
    if (node(i).state == 2 || !fault_.empty()) return;
    if (node(i).state == 1) {
      fault_ = "a node contains itself (instance_node)";
      return;
    }
    if (depth > kMaxXmlDepth) return too_deep();
    node(i).state = 1;
    std::vector<int> inner = node(i).children;
    for (const std::string& id : node(i).instances)
      if (const auto found = by_id_.find(id); found != by_id_.end())
        inner.insert(inner.end(), found->second.begin(), found->second.end());
    node(i).count = 1;
    for (const int child : inner) {
      measure(child, depth + 1);
      if (!fault_.empty()) return;
      node(i).height = std::max(node(i).height, node(child).height + 1);
      node(i).count += node(child).count;
      if (node(i).height > kMaxXmlDepth) return too_deep();
      if (node(i).count > kMaxNodes) {
        fault_ = "more than " + std::to_string(kMaxNodes) + " nodes, those of instance_node counted each time";
        return;
      }
    }
    node(i).state = 2;
  }

  void too_deep() { fault_ = "nodes are nested more than " + std::to_string(kMaxXmlDepth) + " deep"; }

  std::vector<SceneNode> nodes_;
  std::map<std::string, std::vector<int>> by_id_;
  std::string fault_;
};

// `<asset><unit meter="...">`, or null.
const char* unit_text(const TiXmlElement& root) {
  const TiXmlElement* asset = root.FirstChildElement("asset");
  const TiXmlElement* unit = asset == nullptr ? nullptr : asset->FirstChildElement("unit");
  return unit == nullptr ? nullptr : unit->Attribute("meter");
}

// No robot's units are outside this range.
constexpr double kLeastUnit = 1e-9, kMostUnit = 1e9;

// 0 if the text is no length.
double unit_of(const char* text) {
  if (text == nullptr) return 1.0;
  char* end = nullptr;
  const double unit = std::strtod(text, &end);
  while (*end == ' ') ++end;
  return end != text && *end == '\0' && unit >= kLeastUnit && unit <= kMostUnit ? unit : 0.0;
}

}  // namespace

ColladaCheck check_collada(const std::string& text) {
  const auto fault = [](std::string what) { return ColladaCheck{std::move(what), 1.0}; };
  if (xml_depth(text) > kMaxXmlDepth)
    return fault("elements are nested more than " + std::to_string(kMaxXmlDepth) + " deep");
  TiXmlDocument document;
  document.Parse(text.c_str());
  if (document.Error()) return fault("not valid XML: " + std::string(document.ErrorDesc()));
  const TiXmlElement* root = document.RootElement();
  if (root == nullptr) return fault("no XML element");
  const char* const said = unit_text(*root);
  const double unit = unit_of(said);
  if (!(unit > 0.0)) return fault("<unit meter=\"" + std::string(said).substr(0, 40) + "\"> is no length");
  std::string scenes = Scenes().fault_of(*root);
  return {scenes.empty() ? geometry_fault(*root, text.size()) : std::move(scenes), unit};
}

}  // namespace moma
