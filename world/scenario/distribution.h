#pragma once

#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "controller/config/reader.h"
#include "controller/describe/describe.h"
#include "world/draws.h"

namespace moma {

/// A number of a family's parameters: fixed, or drawn for each world. In files a plain number, or one of {uniform:
/// [low, high]}, {log_uniform: [low, high]}, {normal: [mean, sigma]}, {choice: [a, b, ...]}. Draws of a normal are
/// clipped to the key's range. A value of described structs.
class Distribution {
 public:
  struct Fixed {
    double value;
    bool operator==(const Fixed&) const = default;
  };
  struct Uniform {
    double low, high;
    bool operator==(const Uniform&) const = default;
  };
  struct LogUniform {
    double low, high;
    bool operator==(const LogUniform&) const = default;
  };
  struct Normal {
    double mean, sigma;
    bool operator==(const Normal&) const = default;
  };
  struct Choice {
    std::vector<double> values;
    bool operator==(const Choice&) const = default;
  };
  using Kind = std::variant<Fixed, Uniform, LogUniform, Normal, Choice>;

  explicit Distribution(Kind kind) : kind_(std::move(kind)) {}

  const Kind& kind() const { return kind_; }
  /// Consumes exactly one draw.
  double sample(Draws& draws) const;
  /// Draws a whole number: all from low to high of a uniform are equally likely; other distributions are rounded.
  int sample_count(Draws& draws) const;
  /// Returns the input of read().
  nlohmann::ordered_json to_json() const;

  /// Reads a distribution. Every value, or end of an interval, must be in `range`, and whole if `whole` is set. Throws
  /// config::ConfigError.
  static Distribution read(const config::Node& node, const std::string& key, const config::Range& range,
                           bool whole = false);

 private:
  Kind kind_;
  double clip_low_ = -std::numeric_limits<double>::max();
  double clip_high_ = std::numeric_limits<double>::max();
};

bool operator==(const Distribution& a, const Distribution& b);

/// A whole number of objects, from a distribution of whole numbers.
struct Count {
  explicit Count(Distribution::Kind kind) : distribution(std::move(kind)) {}

  Distribution distribution;

  /// Consumes exactly one draw.
  int sample(Draws& draws) const { return distribution.sample_count(draws); }
  bool operator==(const Count&) const = default;
};

// The functions that readers, writers and tables of described structs need for this value.
void read_value(const config::Node& node, const std::string& key, Distribution& value, const About& about);
void read_value(const config::Node& node, const std::string& key, Count& value, const About& about);
nlohmann::ordered_json write_value(const Distribution& value, const About& about);
nlohmann::ordered_json write_value(const Count& value, const About& about);
std::string accepted(Of<Distribution>, const About& about);
std::string accepted(Of<Count>, const About& about);
std::string text_of(const Distribution& value);
std::string text_of(const Count& value);

}  // namespace moma
