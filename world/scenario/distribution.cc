#include "world/scenario/distribution.h"

#include <algorithm>
#include <cmath>

#include "controller/describe/accepted.h"

namespace moma {
namespace {

constexpr const char* kAccepted =
    "a number, {uniform: [low, high]}, {log_uniform: [low, high]}, {normal: [mean, sigma]} or {choice: [...]}";

template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};
template <class... Ts>
Overloaded(Ts...) -> Overloaded<Ts...>;

}  // namespace

double Distribution::sample(Draws& draws) const {
  return std::visit(
      Overloaded{[&](const Fixed& d) {
                   draws.bits();
                   return d.value;
                 },
                 [&](const Uniform& d) { return draws.uniform(d.low, d.high); },
                 [&](const LogUniform& d) { return draws.log_uniform(d.low, d.high); },
                 [&](const Normal& d) { return std::clamp(draws.normal(d.mean, d.sigma), clip_low_, clip_high_); },
                 [&](const Choice& d) { return d.values[draws.choice(d.values.size())]; }},
      kind_);
}

int Distribution::sample_count(Draws& draws) const {
  if (const auto* d = std::get_if<Uniform>(&kind_)) {
    const auto low = static_cast<int>(std::lround(d->low));
    const auto high = static_cast<int>(std::lround(d->high));
    return low + static_cast<int>(draws.choice(static_cast<std::size_t>(high - low) + 1));
  }
  return static_cast<int>(std::lround(sample(draws)));
}

nlohmann::ordered_json Distribution::to_json() const {
  using Json = nlohmann::ordered_json;
  return std::visit(Overloaded{[](const Fixed& d) { return Json(d.value); },
                               [](const Uniform& d) {
                                 return Json{{"uniform", Json::array({d.low, d.high})}};
                               },
                               [](const LogUniform& d) {
                                 return Json{{"log_uniform", Json::array({d.low, d.high})}};
                               },
                               [](const Normal& d) {
                                 return Json{{"normal", Json::array({d.mean, d.sigma})}};
                               },
                               [](const Choice& d) {
                                 return Json{{"choice", d.values}};
                               }},
                    kind_);
}

Distribution Distribution::read(const config::Node& node, const std::string& key, const config::Range& range,
                                bool whole) {
  using config::fail;
  const auto check_whole = [&](const config::Node& at, const std::string& name, double value) {
    if (whole && value != std::floor(value)) fail(at.mark, name, "expected a whole number");
  };
  const auto make = [&](Kind kind) {
    Distribution out(std::move(kind));
    out.clip_low_ = range.low;
    out.clip_high_ = range.high;
    return out;
  };
  if (node.kind == config::Node::Kind::kScalar) {
    const double value = config::read_number(node, key, range);
    check_whole(node, key, value);
    return make(Fixed{value});
  }
  if (node.kind != config::Node::Kind::kMap || node.entries.size() != 1)
    fail(node.mark, key, std::string("expected ") + kAccepted);

  const auto& [name, ends] = node.entries.front();
  const std::string inner = key + "." + name;
  if (name == "choice") {
    Choice choice{config::read_numbers(ends, inner, -1, range)};
    if (choice.values.empty()) fail(ends.mark, inner, "expected at least one number");
    for (const double value : choice.values) check_whole(ends, inner, value);
    return make(std::move(choice));
  }
  if (name == "normal") {
    const std::vector<double> v = config::read_numbers(ends, inner, 2);
    config::read_number(ends.items[0], inner + "[0]", range);
    if (v[1] < 0.0) fail(ends.items[1].mark, inner, "the standard deviation must not be negative");
    return make(Normal{v[0], v[1]});
  }
  if (name == "uniform" || name == "log_uniform") {
    const std::vector<double> v = config::read_numbers(ends, inner, 2, range);
    if (v[0] > v[1]) fail(ends.mark, inner, "the first end must not exceed the second");
    for (const double value : v) check_whole(ends, inner, value);
    if (name == "uniform") return make(Uniform{v[0], v[1]});
    if (v[0] <= 0.0) fail(ends.mark, inner, "both ends must be above 0");
    return make(LogUniform{v[0], v[1]});
  }
  fail(ends.key_place(), inner, std::string("unknown distribution; expected ") + kAccepted);
}

bool operator==(const Distribution& a, const Distribution& b) { return a.kind() == b.kind(); }

void read_value(const config::Node& node, const std::string& key, Distribution& value, const About& about) {
  value = Distribution::read(node, key, about.range);
}

void read_value(const config::Node& node, const std::string& key, Count& value, const About& about) {
  value.distribution = Distribution::read(node, key, about.range, true);
}

nlohmann::ordered_json write_value(const Distribution& value, const About&) { return value.to_json(); }
nlohmann::ordered_json write_value(const Count& value, const About&) { return value.distribution.to_json(); }

std::string accepted(Of<Distribution>, const About& about) {
  return accepted_number(about.range) + ", or a distribution of such";
}
std::string accepted(Of<Count>, const About& about) {
  const auto [low, high] = whole_range<int>(about.range);
  return accepted_whole_number(low, high) + ", or a distribution of such";
}

std::string text_of(const Distribution& value) {
  const auto list = [](const std::vector<double>& numbers) {
    std::string text;
    for (const double number : numbers) text += (text.empty() ? "[" : ", ") + number_text(number);
    return text + "]";
  };
  return std::visit(Overloaded{[](const Distribution::Fixed& d) { return number_text(d.value); },
                               [&](const Distribution::Uniform& d) {
                                 return "{uniform: " + list({d.low, d.high}) + "}";
                               },
                               [&](const Distribution::LogUniform& d) {
                                 return "{log_uniform: " + list({d.low, d.high}) + "}";
                               },
                               [&](const Distribution::Normal& d) {
                                 return "{normal: " + list({d.mean, d.sigma}) + "}";
                               },
                               [&](const Distribution::Choice& d) { return "{choice: " + list(d.values) + "}"; }},
                    value.kind());
}

std::string text_of(const Count& value) { return text_of(value.distribution); }

}  // namespace moma
