// Changes that keep a text YAML: for targets whose readers refuse at the first byte what is none. libFuzzer calls the
// mutator instead of its own; half of the changes are still its own.
#include "tests/fuzz/structure.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <iterator>
#include <set>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "controller/config/json_node.h"
#include "tests/fuzz/draws.h"
#include "tests/fuzz/target.h"

namespace moma::fuzz {
namespace {

using config::Node;

constexpr auto kScalars = std::to_array<std::string_view>({"0",
                                                           "-0",
                                                           "1",
                                                           "-1",
                                                           "2",
                                                           "0.5",
                                                           "-0.3",
                                                           "100",
                                                           "1e3",
                                                           "-1e3",
                                                           "1e6",
                                                           "-1e6",
                                                           "1e9",
                                                           "1e12",
                                                           "-1e12",
                                                           "1e20",
                                                           "1e155",
                                                           "-1e155",
                                                           "1e308",
                                                           "5e-324",
                                                           "1e-300",
                                                           "1e-12",
                                                           "1e-7",
                                                           "0.02",
                                                           ".inf",
                                                           "-.inf",
                                                           ".nan",
                                                           "true",
                                                           "false",
                                                           "null",
                                                           "''",
                                                           "word",
                                                           "3.141592653589793",
                                                           "9007199254740993",
                                                           "18446744073709551615",
                                                           "-9223372036854775808",
                                                           "inverse_error"});

/// Last parts of all keys that the reference has, so that the page need not be repeated here.
const std::vector<std::string>& known_keys() {
  static const std::vector<std::string> keys = [] {
    std::set<std::string> found{"include", "enabled", "name"};
    std::ifstream page("docs/reference/keys.md");
    if (!page) throw std::runtime_error("docs/reference/keys.md is not there: fuzzers start at the source");
    for (std::string line; std::getline(page, line);) {
      if (!line.starts_with("| `")) continue;
      const std::string key = line.substr(3, line.find('`', 3) - 3);
      for (std::size_t at = 0; at < key.size();) {
        const std::size_t end = std::min(key.find('.', at), key.size());
        found.insert(key.substr(at, end - at));
        at = end + 1;
      }
    }
    return std::vector<std::string>(found.begin(), found.end());
  }();
  return keys;
}

/// What was changed before is JSON, which is read in a tenth of the time.
Node read(const std::string& text) {
  if (text.starts_with('{')) {
    try {
      return config::node_from_json(config::parse_json(text, "fuzz.json"), "fuzz.json");
    } catch (const config::ConfigError&) {  // YAML may begin like this
    }
  }
  return config::parse_yaml(text, "fuzz.yaml");
}

void collect(Node& node, std::vector<Node*>& all) {
  all.push_back(&node);
  for (Node& item : node.items) collect(item, all);
  for (auto& [key, value] : node.entries) collect(value, all);
}

Node scalar(std::string_view text) {
  Node node;
  node.kind = Node::Kind::kScalar;
  node.scalar = text;
  return node;
}

void change(Node& root, Draws& draws) {
  std::vector<Node*> all;
  collect(root, all);
  Node& node = *all[draws.below(all.size())];
  switch (draws.below(8)) {
    case 0:
    case 1:
    case 2: {  // a number for a number, most of the time
      std::vector<Node*> scalars;
      std::copy_if(all.begin(), all.end(), std::back_inserter(scalars),
                   [](const Node* one) { return one->kind == Node::Kind::kScalar; });
      Node& place = scalars.empty() ? node : *scalars[draws.below(scalars.size())];
      place = scalar(kScalars[draws.below(kScalars.size())]);
      return;
    }
    case 3: {  // one value in the place of another
      const Node copy = *all[draws.below(all.size())];
      node = copy;
      return;
    }
    case 4:
      if (!node.items.empty())
        node.items.erase(node.items.begin() + static_cast<std::ptrdiff_t>(draws.below(node.items.size())));
      if (!node.entries.empty())
        node.entries.erase(node.entries.begin() + static_cast<std::ptrdiff_t>(draws.below(node.entries.size())));
      return;
    case 5:
      if (!node.items.empty()) node.items.push_back(Node(node.items[draws.below(node.items.size())]));
      return;
    case 6:
      if (!node.entries.empty())
        node.entries[draws.below(node.entries.size())].first = known_keys()[draws.below(known_keys().size())];
      return;
    default: {
      if (node.kind != Node::Kind::kMap) return;
      Node value =
          draws.below(2) == 0 ? scalar(kScalars[draws.below(kScalars.size())]) : Node(*all[draws.below(all.size())]);
      node.entries.emplace_back(known_keys()[draws.below(known_keys().size())], std::move(value));
    }
  }
}

}  // namespace

std::string changed_structure(const std::string& text, std::uint64_t seed) {
  try {
    Node root = read(text);
    Draws draws{seed};
    for (std::size_t n = 1 + draws.below(3); n > 0; --n) change(root, draws);
    return config::node_to_json(root).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  } catch (const config::ConfigError&) {
    return {};
  }
}

}  // namespace moma::fuzz

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer's name
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  if (seed % 2 == 0) {
    const std::string text = moma::fuzz::changed_structure(moma::fuzz::text_of(data, size), seed);
    if (!text.empty() && text.size() <= most) {
      std::memcpy(data, text.data(), text.size());
      return text.size();
    }
  }
  return LLVMFuzzerMutate(data, size, most);
}
