#pragma once

#include <filesystem>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controller/config/node.h"

namespace moma::config {

/// Closed by default; infinities allowed only where the range includes them explicitly.
struct Range {
  double low = -std::numeric_limits<double>::max();
  double high = std::numeric_limits<double>::max();
  bool open_low = false;
  bool open_high = false;
  static Range positive() { return {0.0, std::numeric_limits<double>::max(), true, false}; }
  static Range positive_or_inf() { return {0.0, std::numeric_limits<double>::infinity(), true, false}; }
  static Range non_negative() { return {0.0, std::numeric_limits<double>::max(), false, false}; }
  static Range non_negative_or_inf() { return {0.0, std::numeric_limits<double>::infinity(), false, false}; }
  static Range any() { return {}; }
};

/// Typed access to one value. `key` is its full dotted name for messages.
double read_number(const Node& node, const std::string& key, const Range& range = {});
long long read_integer(const Node& node, const std::string& key, long long low, long long high);
bool read_bool(const Node& node, const std::string& key);
std::string read_string(const Node& node, const std::string& key);
/// `count` < 0: any length.
std::vector<double> read_numbers(const Node& node, const std::string& key, int count, const Range& range = {});

/// Strict reader of one map: every key must be read exactly by name; finish() makes any other key an error that
/// names the nearest known one. Missing optional keys leave the target as it is. Null counts as missing.
class MapReader {
 public:
  /// Throws unless `node` is a map (or null, read as an empty map).
  MapReader(const Node& node, std::string key);

  const std::string& key() const { return key_; }
  const Mark& mark() const { return node_->mark; }
  std::string key_of(std::string_view name) const;

  /// Marks `name` as known; nullptr where absent or null.
  const Node* get(std::string_view name);
  /// As get(), but absent is an error that says what is wanted.
  const Node& require(std::string_view name, std::string_view what);

  void read(std::string_view name, double& value, const Range& range = {});
  void read(std::string_view name, int& value, int low, int high);
  void read(std::string_view name, unsigned long long& value);
  void read(std::string_view name, bool& value);
  void read(std::string_view name, std::string& value);
  /// Sets `value` by name; the error lists all names.
  template <typename Enum>
  void read_enum(std::string_view name, Enum& value, std::initializer_list<std::pair<const char*, Enum>> names);

  /// Throws ConfigError at this map (or at the named key, where it was given).
  [[noreturn]] void fail(const std::string& message) const;
  [[noreturn]] void fail_at(std::string_view name, const std::string& message) const;
  /// As fail_at(), where the key itself is wrong and not its value.
  [[noreturn]] void fail_key(std::string_view name, const std::string& message) const;
  void check(bool ok, std::string_view name, const std::string& message) const;

  /// Call once everything is read.
  void finish() const;

 private:
  [[noreturn]] void fail_choice(std::string_view name, const Node& found, const std::vector<std::string>& names) const;
  const Node* node_;
  std::string key_;
  std::vector<std::string> known_;
};

template <typename Enum>
void MapReader::read_enum(std::string_view name, Enum& value,
                          std::initializer_list<std::pair<const char*, Enum>> names) {
  const Node* node = get(name);
  if (node == nullptr) return;
  std::vector<std::string> all;
  for (const auto& [text, option] : names) {
    if (node->kind == Node::Kind::kScalar && node->scalar == text) {
      value = option;
      return;
    }
    all.emplace_back(text);
  }
  fail_choice(name, *node, all);
}

}  // namespace moma::config
