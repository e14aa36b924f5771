#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "controller/config/reader.h"
#include "world/draws.h"

namespace moma {

/// A number of a family's parameters: fixed, or drawn anew for each world. In files a plain number, or one of
/// {uniform: [low, high]}, {log_uniform: [low, high]}, {normal: [mean, sigma]}, {choice: [a, b, ...]}.
/// Draws of a normal are clipped to the key's range.
class Distribution {
 public:
  struct Fixed {
    double value;
  };
  struct Uniform {
    double low, high;
  };
  struct LogUniform {
    double low, high;
  };
  struct Normal {
    double mean, sigma;
  };
  struct Choice {
    std::vector<double> values;
  };
  using Kind = std::variant<Fixed, Uniform, LogUniform, Normal, Choice>;

  explicit Distribution(Kind kind) : kind_(std::move(kind)) {}

  const Kind& kind() const { return kind_; }
  /// Takes exactly one draw.
  double sample(Draws& draws) const;
  /// A whole number: every one from low to high of a uniform is equally likely, anything else is rounded.
  int sample_count(Draws& draws) const;
  /// Exactly what read() takes.
  nlohmann::ordered_json to_json() const;

  /// Every value, or end of an interval, must lie in `range`, and be whole where `whole` is set.
  /// Throws config::ConfigError.
  static Distribution read(const config::Node& node, const std::string& key, const config::Range& range,
                           bool whole = false);

 private:
  Kind kind_;
  double clip_low_ = -std::numeric_limits<double>::max();
  double clip_high_ = std::numeric_limits<double>::max();
};

/// Reads the key `name` where it is present.
void read(config::MapReader& in, std::string_view name, Distribution& value,
          const config::Range& range = config::Range::any());
void read_count(config::MapReader& in, std::string_view name, Distribution& value, int low, int high);

}  // namespace moma
