#include "controller/draft/urdf_facts.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <utility>

namespace moma::draft {

UrdfFacts facts_of(UrdfTree tree) {
  UrdfFacts facts{std::move(tree), {}, {}};
  facts.children.resize(facts.tree.links.size());
  facts.X_RL.assign(facts.tree.links.size(), Isometry::Identity());
  for (int i = 1; i < facts.size(); ++i) {
    const int parent = facts.link(i).parent;
    facts.children[static_cast<std::size_t>(parent)].push_back(i);
    facts.X_RL[static_cast<std::size_t>(i)] = facts.X_R(parent) * facts.link(i).joint.X_PJ;
  }
  return facts;
}

bool drivable(const UrdfJoint& joint) {
  return !joint.mimic && (joint.type == UrdfJointType::kRevolute || joint.type == UrdfJointType::kContinuous ||
                          joint.type == UrdfJointType::kPrismatic);
}

bool named(std::string_view name, std::initializer_list<std::string_view> words) {
  std::string small(name);
  std::transform(small.begin(), small.end(), small.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::any_of(words.begin(), words.end(),
                     [&](std::string_view word) { return small.find(word) != std::string::npos; });
}

}  // namespace moma::draft
