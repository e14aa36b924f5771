#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "controller/config/json.h"
#include "controller/config/reader.h"
#include "controller/describe/describe.h"
#include "controller/describe/enumeration.h"
#include "world/draws.h"

namespace moma {

/// A number of a family's parameters: fixed, or drawn for each world. In files a plain number, or one of {uniform:
/// [low, high]}, {log_uniform: [low, high]}, {normal: [mean, sigma]}, {choice: [a, b, ...]}. Draws of a normal are
/// clipped to the key's range. A value of described structs.
class Distribution {
 public:
  enum class Kind { kFixed, kUniform, kLogUniform, kNormal, kChoice };

  /// The numbers of a kind: the value, the ends of the interval, mean and standard deviation, or the values.
  struct Form {
    Kind kind;
    std::vector<double> numbers;
    bool operator==(const Form&) const = default;
  };
  struct Fixed : Form {
    explicit Fixed(double value) : Form{Kind::kFixed, {value}} {}
  };
  struct Uniform : Form {
    Uniform(double low, double high) : Form{Kind::kUniform, {low, high}} {}
  };
  struct Normal : Form {
    Normal(double mean, double sigma) : Form{Kind::kNormal, {mean, sigma}} {}
  };

  explicit Distribution(Form form) : form_(std::move(form)) {}

  /// Consumes exactly one draw.
  double sample(Draws& draws) const;
  /// Draws a whole number: all from low to high of a uniform are equally likely; other distributions are rounded.
  int sample_count(Draws& draws) const;
  /// Returns the input of read().
  Json to_json() const;
  /// Returns the same as YAML.
  std::string text() const;

  /// Reads a distribution. Every value, or end of an interval, must be in `range`, and whole if `whole` is set. Throws
  /// config::ConfigError.
  static Distribution read(const config::Node& node, const std::string& key, const config::Range& range,
                           bool whole = false);

  bool operator==(const Distribution& other) const { return form_ == other.form_; }

 private:
  Form form_;
  double clip_low_ = -std::numeric_limits<double>::max();
  double clip_high_ = std::numeric_limits<double>::max();
};
constexpr auto words(Of<Distribution::Kind>) {
  return std::to_array<std::string_view>({"fixed", "uniform", "log_uniform", "normal", "choice"});
}

/// A whole number of objects, from a distribution of whole numbers.
struct Count {
  explicit Count(Distribution::Form form) : distribution(std::move(form)) {}

  Distribution distribution;

  /// Consumes exactly one draw.
  int sample(Draws& draws) const { return distribution.sample_count(draws); }
  bool operator==(const Count&) const = default;
};

// The functions that readers, writers and tables of described structs need for this value.
void read_value(const config::Node& node, const std::string& key, Distribution& value, const About& about);
void read_value(const config::Node& node, const std::string& key, Count& value, const About& about);
inline Json write_value(const Distribution& value, const About&) { return value.to_json(); }
inline Json write_value(const Count& value, const About&) { return value.distribution.to_json(); }
std::string accepted(Of<Distribution>, const About& about);
std::string accepted(Of<Count>, const About& about);
inline std::string text_of(const Distribution& value) { return value.text(); }
inline std::string text_of(const Count& value) { return value.distribution.text(); }

}  // namespace moma
