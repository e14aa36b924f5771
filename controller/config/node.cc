#include "controller/config/node.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <optional>
#include <sstream>
#include <unordered_map>
#include <unordered_set>

#include "controller/config/text_file.h"
#include "controller/model/text_check.h"

namespace moma::config {
namespace {

/// Used part of the budget, shared by a file and all that it includes.
struct YamlUse {
  std::size_t values = 0;
  std::size_t aliases = 0;
  std::size_t files = 0;
};

struct Extent {
  std::size_t values = 1;
  int levels = 0;
};

Extent extent_of(const Node& node) {
  Extent extent;
  const auto add = [&extent](const Node& inner) {
    const Extent of = extent_of(inner);
    extent.values += of.values;
    extent.levels = std::max(extent.levels, of.levels + 1);
  };
  for (const Node& item : node.items) add(item);
  for (const auto& [key, value] : node.entries) add(value);
  return extent;
}

// Builds the tree while the text is read, so that no budget is exceeded by more than one value: the library's own tree
// would be whole, and its aliases expanded by whoever walks it, before anything could be counted.
class Builder : public YAML::EventHandler {
 public:
  Builder(const std::string& name, int depth, YamlUse& use) : name_(name), depth_(depth), use_(use) {
    root_.mark.file = name;
  }

  Node take_root() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (documents_++ > 0) fail(place(mark), "", "a second document starts here; a file holds one");
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { add(scalar(mark), anchor); }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    if (++use_.aliases > kMaxAliases) over(mark, std::to_string(kMaxAliases) + " aliases");
    const auto found = anchors_.find(anchor);
    if (found == anchors_.end()) fail(place(mark), "", "the alias is inside of what it stands for");
    const Extent extent = extent_of(found->second);
    count(mark, extent.values);
    if (level() + extent.levels > kMaxNesting) too_deep(mark);
    attach(Node(found->second));
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    Node node = scalar(mark);
    // The library's \N and \_ are bytes of Latin-1.
    if (const std::size_t at = not_text(value); at != std::string::npos)
      fail(node.mark, "", not_text_message(value, at) + "; it is from one of the escapes \\N, \\_ and \\0");
    node.kind = Node::Kind::kScalar;
    node.scalar = value;
    node.quoted = tag == "!";
    add(std::move(node), anchor);
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value /*style*/) override {
    open(mark, Node::Kind::kSequence, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value /*style*/) override {
    open(mark, Node::Kind::kMap, anchor);
  }
  void OnMapEnd() override { close(); }

 private:
  struct Open {
    Node node;
    YAML::anchor_t anchor = 0;
    std::optional<Node> key;
    std::unordered_set<std::string> seen;
  };

  Mark place(const YAML::Mark& mark) const { return {name_, mark.line + 1, mark.column + 1}; }
  int level() const { return depth_ + static_cast<int>(open_.size()); }

  [[noreturn]] void over(const YAML::Mark& mark, const std::string& limit) const {
    fail(place(mark), "", "more than " + limit + ", the limit for a file with all that it includes");
  }
  [[noreturn]] void too_deep(const YAML::Mark& mark) const {
    fail(place(mark), "", "nested more than " + std::to_string(kMaxNesting) + " levels deep");
  }

  void count(const YAML::Mark& mark, std::size_t values) const {
    use_.values += values;
    if (use_.values > kMaxValues) over(mark, std::to_string(kMaxValues) + " values");
  }

  Node scalar(const YAML::Mark& mark) const {
    count(mark, 1);
    if (level() > kMaxNesting) too_deep(mark);
    Node node;
    node.mark = place(mark);
    return node;
  }

  void open(const YAML::Mark& mark, Node::Kind kind, YAML::anchor_t anchor) {
    Open opened;
    opened.node = scalar(mark);
    opened.node.kind = kind;
    opened.anchor = anchor;
    open_.push_back(std::move(opened));
  }

  void close() {
    Open closed = std::move(open_.back());
    open_.pop_back();
    add(std::move(closed.node), closed.anchor);
  }

  void add(Node node, YAML::anchor_t anchor) {
    if (anchor != 0) {
      use_.values += extent_of(node).values;  // the copy kept for aliases
      if (use_.values > kMaxValues)
        fail(node.mark, "", "more than " + std::to_string(kMaxValues) + " values, those of anchors counted twice");
      anchors_.insert_or_assign(anchor, node);
    }
    attach(std::move(node));
  }

  void attach(Node node) {
    if (open_.empty()) {
      root_ = std::move(node);
      return;
    }
    Open& in = open_.back();
    if (std::max(in.node.items.size(), in.node.entries.size()) >= kMaxListLength)
      fail(node.mark, "", "more than " + std::to_string(kMaxListLength) + " entries, the limit for one list or map");
    if (in.node.kind == Node::Kind::kSequence) {
      in.node.items.push_back(std::move(node));
    } else if (!in.key) {
      check_key(node, in);
      in.key = std::move(node);
    } else {
      node.key_mark = in.key->mark;
      in.node.entries.emplace_back(std::move(in.key->scalar), std::move(node));
      in.key.reset();
    }
  }

  static void check_key(const Node& key, Open& in) {
    if (key.kind != Node::Kind::kScalar) fail(key.mark, "", "a key must be plain text");
    if (key.scalar.size() > kMaxKeyBytes) {
      fail(key.mark, "",
           "a key of " + std::to_string(key.scalar.size()) + " bytes; at most " + std::to_string(kMaxKeyBytes) +
               " are accepted");
    }
    if (!in.seen.insert(key.scalar).second) fail(key.mark, key.scalar, "the key is there twice");
  }

  const std::string& name_;
  int depth_;
  YamlUse& use_;
  Node root_;
  int documents_ = 0;
  std::vector<Open> open_;
  std::unordered_map<YAML::anchor_t, Node> anchors_;
};

/// The parser's message, where it leads to the mistake.
std::string words_of(const YAML::Exception& e, const std::string& text) {
  std::size_t begin = 0;
  for (int line = 0; line < e.mark.line && begin != std::string::npos; ++line) {
    const std::size_t end = text.find('\n', begin);
    begin = end == std::string::npos ? end : end + 1;
  }
  const std::size_t first = begin == std::string::npos ? begin : text.find_first_not_of(" \t", begin);
  if (first != std::string::npos && text.substr(begin, first - begin).find('\t') != std::string::npos)
    return "a tab indents this line; YAML takes spaces alone";
  if (e.msg == YAML::ErrorMsg::MAP_VALUE || e.msg == YAML::ErrorMsg::MAP_KEY)
    return "KEY: VALUE has no place here; is this line indented as its neighbours are, and is there one key a line?";
  return e.msg;
}

/// The one document of a YAML text, aliases copied in, `include` left as it is. `depth`: levels that enclose it.
/// Throws ConfigError: syntax, a second document, keys twice or not text, an alias inside of what it names, and
/// whatever text_file.h limits.
Node read_document(const std::string& text, const std::string& name, int depth, YamlUse& use) {
  if (text.size() > kMaxTextBytes)
    fail({name, 0, 0}, "", "more than " + std::to_string(kMaxTextBytes >> 20U) + " MiB of text");
  if (const std::size_t at = not_text(text); at != std::string::npos) {
    const std::size_t begin = at == 0 ? 0 : text.rfind('\n', at - 1) + 1;  // npos + 1 is 0: the first line
    fail({name, static_cast<int>(line_of(text, at)), static_cast<int>(at - begin) + 1}, "", not_text_message(text, at));
  }
  if (const std::size_t at = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
      at != std::string::npos && text[at] == '<' && text.compare(at, 2, "<<") != 0)
    fail({name, static_cast<int>(line_of(text, at)), 0}, "",
         "begins like XML, which a URDF is; expected YAML (a URDF goes into a robot file: moma robot URDF drafts one)");
  Builder builder(name, depth, use);
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& e) {
    fail({name, e.mark.line + 1, e.mark.column + 1}, "", "not valid YAML: " + words_of(e, text));
  }
  return builder.take_root();
}

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

fs::path directory_of(const Mark& mark) {
  return mark.file.starts_with("--set ") ? fs::path() : fs::path(mark.file).parent_path();
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
