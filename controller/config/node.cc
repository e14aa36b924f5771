#include <algorithm>
#include <stdexcept>

#include "controller/config/budget.h"
#include "controller/config/node.h"
#include "controller/config/suggestion.h"
#include "controller/config/text_file.h"
#include "controller/config/yaml.h"

namespace moma::config {
namespace {

namespace fs = std::filesystem;

struct Source {
  fs::path directory;          // what includes are relative to
  std::vector<fs::path> open;  // files being read, outermost first: cycles
  int depth = 0;               // levels around it
};

Node load(const fs::path& file, Source source, const Mark* from, YamlUse& use);

// Keys of `over` win; maps are merged key by key, anything else is replaced whole.
void merge(Node& base, const Node& over) {
  for (const auto& [key, value] : over.entries) {
    Node* old = base.find(key);
    if (old == nullptr) {
      base.entries.emplace_back(key, value);
    } else if (old->kind == Node::Kind::kMap && value.kind == Node::Kind::kMap) {
      merge(*old, value);
    } else {
      *old = value;
    }
  }
}

// Reads what `node` and all in it include; `source.depth` is its own.
void include(Node& node, const Source& source, YamlUse& use) {
  Source inner = source;
  ++inner.depth;
  for (Node& item : node.items) include(item, inner, use);
  for (auto& [key, value] : node.entries) include(value, inner, use);
  const Node* path = node.find("include");
  if (path == nullptr) return;
  if (path->kind != Node::Kind::kScalar) fail(path->mark, "include", "expected the path of a YAML file");
  const Mark at = path->mark;
  Node base = load(source.directory / path->scalar, source, &at, use);
  if (base.kind != Node::Kind::kMap) fail(at, "include", base.mark.file + " does not hold a map of keys");
  std::erase_if(node.entries, [](const auto& e) { return e.first == "include"; });
  merge(base, node);
  base.mark = node.mark;
  base.key_mark = node.key_mark;
  node = std::move(base);
}

Node parse(const std::string& text, const std::string& name, const Source& source, YamlUse& use) {
  Node node = read_document(text, name, source.depth, use);
  include(node, source, use);
  return node;
}

// `from`: the `include` that asks for it, nullptr for the first file.
Node load(const fs::path& file, Source source, const Mark* from, YamlUse& use) {
  const auto refuse = [&](const std::string& why) {
    const Mark here{file.string(), 0, 0};
    fail(from != nullptr ? *from : here, "", (from != nullptr ? file.string() + ": " : std::string()) + why);
  };
  std::error_code error;
  const fs::path canonical = fs::weakly_canonical(file, error);
  if (std::find(source.open.begin(), source.open.end(), canonical) != source.open.end())
    refuse("the file includes itself");
  if (source.open.size() > kMaxIncludeDepth)
    refuse("more than " + std::to_string(kMaxIncludeDepth) + " files include one another in a row");
  if (from != nullptr && ++use.files > kMaxIncludes)
    refuse("more than " + std::to_string(kMaxIncludes) + " files are included");
  source.open.push_back(canonical);
  source.directory = file.parent_path();
  std::string text;
  try {
    text = read_text_file(file);
  } catch (const std::runtime_error& e) {
    refuse(e.what());
  }
  return parse(text, file.string(), source, use);
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t up = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = up;
    }
  }
  return row.back();
}

}  // namespace

Node::Node() = default;
Node::Node(const Node&) = default;
Node::Node(Node&&) noexcept = default;
Node& Node::operator=(const Node&) = default;
Node& Node::operator=(Node&&) noexcept = default;
Node::~Node() = default;

const Node* Node::find(std::string_view key) const noexcept {
  for (const auto& [name, value] : entries)
    if (name == key) return &value;
  return nullptr;
}

Node* Node::find(std::string_view key) noexcept { return const_cast<Node*>(static_cast<const Node*>(this)->find(key)); }

Node load_yaml(const fs::path& file) {
  YamlUse use;
  return load(file, {}, nullptr, use);
}

Node parse_yaml(const std::string& text, const std::string& name, const fs::path& directory) {
  YamlUse use;
  return parse(text, name, {directory, {}, 0}, use);
}

void set_value(Node& root, std::string_view dotted_key, const std::string& text) {
  const Mark origin{"--set " + shortened(std::string(dotted_key)) + "=" + shortened(text), 0, 0};
  Node value = parse_yaml(text, origin.file);
  value.mark = value.key_mark = origin;
  set_value(root, dotted_key, std::move(value));
}

void set_value(Node& root, std::string_view dotted_key, Node value) {
  const std::string key(dotted_key);
  const Mark origin = value.mark;
  if (std::count(key.begin(), key.end(), '.') >= kMaxNesting)
    fail(origin, "", "a key of more than " + std::to_string(kMaxNesting) + " parts");
  Node* node = &root;
  std::size_t start = 0;
  while (true) {
    const std::size_t dot = key.find('.', start);
    const std::string part = key.substr(start, dot == std::string::npos ? dot : dot - start);
    if (part.empty()) fail(origin, key, "expected key.key=value");
    if (node->kind != Node::Kind::kMap) {
      *node = Node{};
      node->kind = Node::Kind::kMap;
      node->mark = origin;
    }
    Node* next = node->find(part);
    if (next == nullptr) {
      node->entries.emplace_back(part, Node{});
      next = &node->entries.back().second;
      next->mark = origin;
      next->key_mark = origin;
    }
    node = next;
    if (dot == std::string::npos) break;
    start = dot + 1;
  }
  *node = std::move(value);
}

std::filesystem::path directory_of(const Mark& mark) {
  return mark.file.starts_with("--set ") ? std::filesystem::path() : std::filesystem::path(mark.file).parent_path();
}

void fail(const Mark& mark, const std::string& key, const std::string& message) {
  throw ConfigError(placed(mark, key, message));
}

void refuse(const Mark& mark, const std::string& key, const std::string& message) {
  throw KeyError(placed(mark, key, message));
}

std::string placed(const Mark& mark, const std::string& key, const std::string& message) {
  std::string where = mark.file;
  if (mark.line > 0) where += ":" + std::to_string(mark.line) + ":" + std::to_string(mark.column);
  if (!where.empty()) where += ": ";
  if (!key.empty()) where += key + ": ";
  return where + message;
}

std::string nearest(std::string_view word, const std::vector<std::string>& known) {
  std::string best;
  if (word.size() > kMaxKeyBytes) return best;
  std::size_t least = std::max<std::size_t>(2, word.size() / 2) + 1;
  for (const std::string& candidate : known) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < least) {
      least = distance;
      best = candidate;
    }
  }
  return best;
}

std::string suggestion(std::string_view word, const std::vector<std::string>& known) {
  const std::string near = nearest(word, known);
  return near.empty() ? "" : " (did you mean " + near + "?)";
}

}  // namespace moma::config
