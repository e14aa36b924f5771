#include "world/scenario/distribution.h"

#include <algorithm>
#include <cmath>

#include "controller/describe/keys.h"

namespace moma {
namespace {

constexpr const char* kAccepted =
    "a number, {uniform: [low, high]}, {log_uniform: [low, high]}, {normal: [mean, sigma]} or {choice: [...]}";

}  // namespace

double Distribution::sample(Draws& draws) const {
  const std::vector<double>& v = form_.numbers;
  switch (form_.kind) {
    case Kind::kFixed:
      draws.bits();
      break;
    case Kind::kUniform:
      return draws.uniform(v[0], v[1]);
    case Kind::kLogUniform:
      return draws.log_uniform(v[0], v[1]);
    case Kind::kNormal:
      return std::clamp(draws.normal(v[0], v[1]), clip_low_, clip_high_);
    case Kind::kChoice:
      return v[draws.choice(v.size())];
  }
  return v[0];
}

int Distribution::sample_count(Draws& draws) const {
  if (form_.kind == Kind::kUniform) {
    const auto low = static_cast<int>(std::lround(form_.numbers[0]));
    const auto high = static_cast<int>(std::lround(form_.numbers[1]));
    return low + static_cast<int>(draws.choice(static_cast<std::size_t>(high - low) + 1));
  }
  return static_cast<int>(std::lround(sample(draws)));
}

Json Distribution::to_json() const {
  if (form_.kind == Kind::kFixed) return form_.numbers[0];
  return {{std::string(to_string(form_.kind)), form_.numbers}};
}

std::string Distribution::text() const {
  if (form_.kind == Kind::kFixed) return number_text(form_.numbers[0]);
  return "{" + std::string(to_string(form_.kind)) + ": " + description::list_text(form_.numbers, false) + "}";
}

Distribution Distribution::read(const config::Node& node, const std::string& key, const config::Range& range,
                                bool whole) {
  using config::fail;
  const auto check_whole = [&](const config::Node& at, const std::string& name, double value) {
    if (whole && value != std::floor(value)) fail(at.mark, name, "expected a whole number");
  };
  const auto make = [&](Kind kind, std::vector<double> numbers) {
    Distribution out(Form{kind, std::move(numbers)});
    out.clip_low_ = range.low;
    out.clip_high_ = range.high;
    return out;
  };
  if (node.kind == config::Node::Kind::kScalar) {
    const double value = config::read_number(node, key, range);
    check_whole(node, key, value);
    return make(Kind::kFixed, {value});
  }
  if (node.kind != config::Node::Kind::kMap || node.entries.size() != 1)
    fail(node.mark, key, std::string("expected ") + kAccepted);

  const auto& [name, ends] = node.entries.front();
  const std::string inner = key + "." + name;
  const Kind kind = from_string<Kind>(name).value_or(Kind::kFixed);
  if (kind == Kind::kFixed) fail(ends.key_place(), inner, std::string("unknown distribution; expected ") + kAccepted);
  const bool normal = kind == Kind::kNormal, choice = kind == Kind::kChoice;
  std::vector<double> v = config::read_numbers(ends, inner, choice ? -1 : 2, normal ? config::Range() : range);
  if (v.empty()) fail(ends.mark, inner, "expected at least one number");
  if (normal) {
    config::read_number(ends.items[0], inner + "[0]", range);
    if (v[1] < 0.0) fail(ends.items[1].mark, inner, "the standard deviation must not be negative");
    return make(kind, std::move(v));
  }
  if (!choice && v[0] > v[1]) fail(ends.mark, inner, "the first end must not exceed the second");
  for (const double value : v) check_whole(ends, inner, value);
  if (kind == Kind::kLogUniform && v[0] <= 0.0) fail(ends.mark, inner, "both ends must be above 0");
  return make(kind, std::move(v));
}

void read_value(const config::Node& node, const std::string& key, Distribution& value, const About& about) {
  value = Distribution::read(node, key, about.range);
}

void read_value(const config::Node& node, const std::string& key, Count& value, const About& about) {
  value.distribution = Distribution::read(node, key, about.range, true);
}

std::string accepted(Of<Distribution>, const About& about) {
  return accepted_number(about.range) + ", or a distribution of such";
}
std::string accepted(Of<Count>, const About& about) {
  const auto [low, high] = whole_range<int>(about.range);
  return accepted_whole_number(low, high) + ", or a distribution of such";
}

}  // namespace moma
