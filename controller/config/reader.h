#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controller/config/node.h"
#include "controller/describe/describe.h"
#include "controller/describe/enumeration.h"

namespace moma::config {

using moma::Range;

/// Typed access to one value. `key` is its full dotted name for messages.
double read_number(const Node& node, const std::string& key, const Range& range = {});
long long read_integer(const Node& node, const std::string& key, long long low, long long high);
bool read_bool(const Node& node, const std::string& key);
std::string read_string(const Node& node, const std::string& key);
/// `count` < 0: any length.
std::vector<double> read_numbers(const Node& node, const std::string& key, int count, const Range& range = {});

/// Calls visit(item, its full key) for each item of a list: "shapes[0]", "shapes[1]" ... If the node is no list the
/// message says that `what` was expected: "a list of shapes".
template <class Visit>
void for_items(const Node& list, const std::string& key, std::string_view what, Visit visit);

/// Names the value for messages: "'text'", "a list of 3", "a map", "nothing".
std::string found_text(const Node& node);
/// A text that is none of `names`: lists them and says which is near.
[[noreturn]] void fail_choice(const Node& found, const std::string& key, const std::vector<std::string>& names);

/// One of the words that stand beside the enumeration, where any are given one of the `allowed`; the error lists them.
template <Worded Enum>
Enum read_word(const Node& node, const std::string& key, std::span<const Enum> allowed = {});

/// Strict reader of one map: every key must be read exactly by name; finish() makes any other key an error that
/// names the nearest known one. Missing optional keys leave the target as it is. Null counts as missing.
class MapReader {
 public:
  /// Throws unless `node` is a map (or null, read as an empty map).
  MapReader(const Node& node, std::string key);
  /// The map under a key of another one; an empty map at its place if the key is absent.
  MapReader(MapReader& outer, std::string_view name);

  const std::string& key() const { return key_; }
  const Mark& mark() const { return mark_; }
  std::string key_of(std::string_view name) const;
  const std::vector<std::pair<std::string, Node>>& entries() const { return node_->entries; }

  /// Marks `name` as known; nullptr where absent or null.
  const Node* get(std::string_view name);
  /// The same as get(), but an absent value is an error that says `what`.
  const Node& require(std::string_view name, std::string_view what);

  void read(std::string_view name, double& value, const Range& range = {});
  void read(std::string_view name, int& value, int low, int high);
  void read(std::string_view name, unsigned long long& value);
  void read(std::string_view name, bool& value);
  void read(std::string_view name, std::string& value);
  /// The same as read_word().
  template <Worded Enum>
  void read_enum(std::string_view name, Enum& value, std::span<const Enum> allowed = {});

  /// Throws ConfigError at this map (or at the named key, where it was given).
  [[noreturn]] void fail(const std::string& message) const;
  [[noreturn]] void fail_at(std::string_view name, const std::string& message) const;
  /// The same as fail_at(), for a wrong key instead of a wrong value.
  [[noreturn]] void fail_key(std::string_view name, const std::string& message) const;
  void check(bool ok, std::string_view name, const std::string& message) const;

  /// Call once everything is read.
  void finish() const;

 private:
  const Node* node_;
  Mark mark_;
  std::string key_;
  std::vector<std::string> known_;
};

void require_list(const Node& node, const std::string& key, std::string_view what);

template <class Visit>
void for_items(const Node& list, const std::string& key, std::string_view what, Visit visit) {
  require_list(list, key, what);
  for (std::size_t i = 0; i < list.items.size(); ++i) visit(list.items[i], key + "[" + std::to_string(i) + "]");
}

template <Worded Enum>
Enum read_word(const Node& node, const std::string& key, std::span<const Enum> allowed) {
  const std::optional<Enum> named =
      node.kind == Node::Kind::kScalar ? from_string<Enum>(node.scalar) : std::optional<Enum>();
  if (named.has_value() && (allowed.empty() || std::find(allowed.begin(), allowed.end(), *named) != allowed.end()))
    return *named;
  constexpr auto all = words(Of<Enum>{});
  std::vector<std::string> names(all.begin(), all.end());
  if (!allowed.empty()) names.clear();
  for (const Enum value : allowed) names.emplace_back(to_string(value));
  fail_choice(node, key, names);
}

template <Worded Enum>
void MapReader::read_enum(std::string_view name, Enum& value, std::span<const Enum> allowed) {
  if (const Node* node = get(name)) value = read_word<Enum>(*node, key_of(name), allowed);
}

}  // namespace moma::config
