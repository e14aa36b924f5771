#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>

#include "controller/config/node.h"

namespace moma::config {
namespace {

namespace fs = std::filesystem;

struct Source {
  std::string name;            // as shown in messages
  fs::path directory;          // what includes are relative to
  std::vector<fs::path> open;  // files being read, outermost first: cycles
};

Node load(const fs::path& file, std::vector<fs::path> open, const Mark* from);

Mark mark_of(const YAML::Node& yaml, const Source& source) {
  const YAML::Mark m = yaml.Mark();
  return {source.name, m.line + 1, m.column + 1};
}

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

Node convert(const YAML::Node& yaml, const Source& source, int depth) {
  Node node;
  node.mark = mark_of(yaml, source);
  if (depth > 64) fail(node.mark, "", "nested more than 64 levels deep");
  switch (yaml.Type()) {
    case YAML::NodeType::Undefined:
    case YAML::NodeType::Null:
      break;
    case YAML::NodeType::Scalar:
      node.kind = Node::Kind::kScalar;
      node.scalar = yaml.Scalar();
      node.quoted = yaml.Tag() == "!";
      break;
    case YAML::NodeType::Sequence:
      node.kind = Node::Kind::kSequence;
      for (const auto& item : yaml) node.items.push_back(convert(item, source, depth + 1));
      break;
    case YAML::NodeType::Map: {
      node.kind = Node::Kind::kMap;
      std::set<std::string> seen;
      for (const auto& entry : yaml) {
        if (!entry.first.IsScalar()) fail(mark_of(entry.first, source), "", "a key must be plain text");
        const std::string key = entry.first.Scalar();
        if (!seen.insert(key).second) fail(mark_of(entry.first, source), key, "the key is there twice");
        node.entries.emplace_back(key, convert(entry.second, source, depth + 1));
        node.entries.back().second.key_mark = mark_of(entry.first, source);
      }
      const Node* include = node.find("include");
      if (include != nullptr) {
        if (include->kind != Node::Kind::kScalar) fail(include->mark, "include", "expected the path of a YAML file");
        const Mark at = include->mark;
        Node base = load(source.directory / include->scalar, source.open, &at);
        if (base.kind != Node::Kind::kMap) fail(at, "include", base.mark.file + " does not hold a map of keys");
        std::erase_if(node.entries, [](const auto& e) { return e.first == "include"; });
        merge(base, node);
        base.mark = node.mark;
        return base;
      }
      break;
    }
  }
  return node;
}

Node parse(const std::string& text, const Source& source) {
  try {
    return convert(YAML::Load(text), source, 0);
  } catch (const YAML::Exception& e) {
    fail({source.name, e.mark.line + 1, e.mark.column + 1}, "", "not valid YAML: " + e.msg);
  }
}

Node load(const fs::path& file, std::vector<fs::path> open, const Mark* from) {
  const auto refuse = [&](const std::string& why) {
    const Mark here{file.string(), 0, 0};
    fail(from != nullptr ? *from : here, "", (from != nullptr ? file.string() + ": " : std::string()) + why);
  };
  std::error_code error;
  const fs::path canonical = fs::weakly_canonical(file, error);
  if (std::find(open.begin(), open.end(), canonical) != open.end()) refuse("the file includes itself");
  if (!fs::exists(file, error)) refuse("no such file");
  if (!fs::is_regular_file(file, error)) refuse("not a file");
  std::ifstream in(file, std::ios::binary);
  if (!in) refuse("cannot be read (permissions?)");
  std::stringstream text;
  text << in.rdbuf();
  open.push_back(canonical);
  return parse(text.str(), {file.string(), file.parent_path(), std::move(open)});
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

Node load_yaml(const fs::path& file) { return load(file, {}, nullptr); }

Node parse_yaml(const std::string& text, const std::string& name, const fs::path& directory) {
  return parse(text, {name, directory, {}});
}

void set_value(Node& root, std::string_view dotted_key, const std::string& text) {
  const std::string key(dotted_key);
  const Mark origin{"--set " + key + "=" + text, 0, 0};
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
  Node value = parse_yaml(text, origin.file);
  value.mark = origin;
  value.key_mark = origin;
  *node = std::move(value);
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

}  // namespace moma::config
