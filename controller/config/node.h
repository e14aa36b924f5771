#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controller/config/paths.h"

namespace moma::config {

/// Bad input: what() is complete, "FILE:LINE:COLUMN: KEY: what was found and what would be accepted".
class ConfigError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A key that is unknown, missing, or whose value is refused whatever the others are; other errors may lie in how
/// values go together.
class KeyError : public ConfigError {
 public:
  using ConfigError::ConfigError;
};

/// Place of a value in a file; line and column start at 1, 0 for a --set option.
struct Mark {
  std::string file;
  int line = 0;
  int column = 0;
};

/// A YAML (or JSON, its subset) value with the place it came from. The only code that knows yaml-cpp is node.cc.
struct Node {
  // Declared here and defaulted out of line: clang instantiates what a vector of an incomplete type needs otherwise.
  Node();
  Node(const Node&);
  Node(Node&&) noexcept;
  Node& operator=(const Node&);
  Node& operator=(Node&&) noexcept;
  ~Node();

  enum class Kind { kNull, kScalar, kSequence, kMap };
  Kind kind = Kind::kNull;
  std::string scalar;
  bool quoted = false;                                ///< a quoted scalar is text, never a number
  std::vector<Node> items;                            ///< kSequence
  std::vector<std::pair<std::string, Node>> entries;  ///< kMap, in file order, keys unique
  Mark mark;
  Mark key_mark;  ///< of a value in a map that was read from text

  /// Place of this value's key or, without one, of the value.
  const Mark& key_place() const noexcept { return key_mark.file.empty() ? mark : key_mark; }

  const Node* find(std::string_view key) const noexcept;
  Node* find(std::string_view key) noexcept;
};

/// Reads a file, resolving `include: PATH` in any map (relative to the including file; the map's other keys
/// override the included ones, maps merged key by key). Throws ConfigError: unreadable, syntax, duplicate keys, cycles.
Node load_yaml(const fs::path& file);
/// The same from text; `name` stands for the file in messages, `directory` is what paths are relative to.
Node parse_yaml(const std::string& text, const std::string& name, const fs::path& directory = {});

/// Replaces or creates the value at a dotted path ("simulation.mode"); `text` is parsed as YAML.
void set_value(Node& root, std::string_view dotted_key, const std::string& text);
/// The same with a value that is read already; maps that are made on the way are placed where it is.
void set_value(Node& root, std::string_view dotted_key, Node value);

[[noreturn]] void fail(const Mark& mark, const std::string& key, const std::string& message);
/// The same as fail(), with a KeyError.
[[noreturn]] void refuse(const Mark& mark, const std::string& key, const std::string& message);

/// The folder that a path written at `mark` is relative to: its file's; for options the working folder.
fs::path directory_of(const Mark& mark);

/// "FILE:LINE:COLUMN: KEY: message", without what is not known of it.
std::string placed(const Mark& mark, const std::string& key, const std::string& message);

/// The nearest of `known` to `word` by edit distance, or "" where none is near.
std::string nearest(std::string_view word, const std::vector<std::string>& known);

/// " (did you mean WORD?)", or "" where none of `known` is near to `word`.
std::string suggestion(std::string_view word, const std::vector<std::string>& known);

}  // namespace moma::config
