#include "eval/suite/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/random/sobol.hpp>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <set>
#include <string_view>

#include "controller/config/read_described.h"
#include "controller/describe/enumeration.h"
#include "world/draws.h"

namespace moma {
namespace {

using config::MapReader;
using config::Node;

constexpr std::size_t kMaxSweepValues = 2'000'000;  // points times axes

struct Axis {
  std::string key;
  std::vector<Node> values;  // values listed, or spread over a grid
  double low = 0.0;          // otherwise a range
  double high = 0.0;
  bool log = false;
  config::Mark mark;
};

double between(const Axis& axis, double u) {
  if (u <= 0.0) return axis.low;
  if (u >= 1.0) return axis.high;
  // The direct formula may overflow between finite ends; these parts cannot.
  if (axis.log) {
    const double ratio = axis.high / axis.low;
    const double value = std::isfinite(ratio) ? axis.low * std::pow(ratio, u)
                                              : std::exp((1.0 - u) * std::log(axis.low) + u * std::log(axis.high));
    return std::clamp(value, axis.low, axis.high);
  }
  const double length = axis.high - axis.low;
  return std::isfinite(length) ? axis.low + u * length : (1.0 - u) * axis.low + u * axis.high;
}

double rounded(double value, int digits) { return std::strtod(fmt::format("{:.{}g}", value, digits).c_str(), nullptr); }

// Returns numbers as they run and appear: with six significant digits, or with as many as keep each within a thousandth
// of its distance to the next and all distinct; the ends of an axis as written. The numbers are as evenly spread as
// `count` of them can be, in any order.
std::vector<Node> number_nodes(const Axis& axis, const std::vector<double>& values, std::size_t count) {
  const double steps = std::max<double>(1.0, static_cast<double>(count) - 1.0);
  const auto spacing = [&](double value) {
    if (!axis.log) return (axis.high / steps) - (axis.low / steps);
    return std::abs(value) * std::expm1((std::log(axis.high) - std::log(axis.low)) / steps);
  };
  const std::size_t distinct = std::set<double>(values.begin(), values.end()).size();
  const auto good = [&](int digits) {
    std::set<double> seen;
    for (const double value : values) {
      const double near = rounded(value, digits);
      const bool end = value == axis.low || value == axis.high;
      if (!end && !(std::abs(near - value) <= 1e-3 * spacing(value))) return false;
      seen.insert(end ? value : near);
    }
    return seen.size() == distinct;
  };
  int digits = 6;
  while (digits < 17 && !good(digits)) ++digits;
  std::vector<Node> nodes;
  for (const double value : values) {
    Node& node = nodes.emplace_back();
    node.kind = Node::Kind::kScalar;
    const bool end = value == axis.low || value == axis.high;
    node.scalar = end ? fmt::format("{}", value) : fmt::format("{:.{}g}", value, digits);
    if (end && rounded(value, digits) == value) node.scalar = fmt::format("{:.{}g}", value, digits);
    node.mark = axis.mark;
  }
  return nodes;
}

// Returns the axis's values at each u in [0, 1).
std::vector<Node> values_at(const Axis& axis, const std::vector<double>& us) {
  if (axis.values.empty()) {
    std::vector<double> values;
    for (const double u : us) values.push_back(between(axis, u));
    return number_nodes(axis, values, us.size());
  }
  std::vector<Node> nodes;
  for (const double u : us) {
    const auto index = static_cast<std::size_t>(u * static_cast<double>(axis.values.size()));
    nodes.push_back(axis.values[std::min(index, axis.values.size() - 1)]);
  }
  return nodes;
}

Axis read_axis(const Node& node, const std::string& sweep_key, const std::string& key, bool grid) {
  const std::string where = sweep_key + ".axes." + key;
  Axis axis;
  axis.key = key;
  axis.mark = node.mark;
  if (node.kind == Node::Kind::kSequence) {
    if (node.items.empty()) config::fail(node.mark, where, "found an empty list, expected at least one value");
    axis.values = node.items;
    return axis;
  }
  if (node.kind != Node::Kind::kMap) {
    config::fail(node.mark, where,
                 "expected a list of values, {linear: [low, high], n: 5} or {log: [low, high], n: 5}");
  }
  MapReader in(node, where);
  const Node* linear = in.get("linear");
  const Node* log = in.get("log");
  if ((linear == nullptr) == (log == nullptr)) in.fail("expected one of the keys linear and log: [low, high]");
  axis.log = log != nullptr;
  const char* kind = axis.log ? "log" : "linear";
  const std::vector<double> ends = config::read_numbers(axis.log ? *log : *linear, where + "." + kind, 2,
                                                        axis.log ? config::Range::positive() : config::Range::any());
  axis.low = ends[0];
  axis.high = ends[1];
  in.check(axis.low < axis.high, kind, fmt::format("found [{}, {}], expected low < high", axis.low, axis.high));
  int n = 0;
  in.read("n", n, 2, 10000);
  in.finish();
  in.check(grid || n == 0, "n", "an axis of this design has no n of its own; give `n` beside `axes`");
  in.check(!grid || n > 0, "n", "missing; expected the number of values on this axis, 2 or more");
  std::vector<double> values;
  for (int i = 0; i < n; ++i) values.push_back(i == n - 1 ? axis.high : between(axis, i / static_cast<double>(n - 1)));
  if (std::set<double>(values.begin(), values.end()).size() != values.size())
    in.fail_at("n", fmt::format("there are no {} different numbers between {} and {}", n, axis.low, axis.high));
  if (n > 0) axis.values = number_nodes(axis, values, values.size());
  return axis;
}

std::vector<Assignment> grid_points(const std::vector<Axis>& axes, const Node& node, const std::string& key) {
  std::size_t count = 1;
  for (const Axis& axis : axes) {
    count *= axis.values.size();
    if (count > kMaxSweepPoints) {
      config::fail(node.mark, key, fmt::format("the grid has more than {} points", kMaxSweepPoints));
    }
  }
  std::vector<Assignment> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t rest = i;
    points[i].resize(axes.size());
    for (std::size_t a = axes.size(); a-- > 0;) {
      points[i][a] = {axes[a].key, axes[a].values[rest % axes[a].values.size()]};
      rest /= axes[a].values.size();
    }
  }
  return points;
}

std::vector<Assignment> listed_points(const Node& list, const std::string& key) {
  constexpr const char* kPoints = "a list of points, each a map {KEY: VALUE, ...}";
  std::vector<Assignment> points;
  config::for_items(list, key, kPoints, [&](const Node& item, const std::string& at) {
    if (item.kind != Node::Kind::kMap || item.entries.empty())
      config::fail(item.mark, at, "expected a map {KEY: VALUE, ...}");
    points.emplace_back(item.entries.begin(), item.entries.end());
  });
  if (points.empty()) config::fail(list.mark, key, std::string("expected ") + kPoints);
  return points;
}

enum class Design { kGrid, kLatinHypercube, kSobol, kList };
constexpr auto words(Of<Design>) {
  return std::to_array<std::string_view>({"grid", "latin_hypercube", "sobol", "list"});
}

/// Members of a sweep that are no swept keys.
struct Spread {
  Design design = Design::kGrid;
  std::optional<int> n;
  std::uint64_t seed = 1;
};

constexpr void describe(auto& v, Of<Spread>) {
  v.member("design", &Spread::design, {.text = "arrangement of points; list with `points`"});
  v.member("n", &Spread::n,
           in_range({1, kMaxSweepPoints}, "",
                    "number of points, of latin_hypercube and sobol; a grid has one on each axis"));
  v.member("seed", &Spread::seed, {.text = "seed of latin_hypercube"});
}

}  // namespace

std::string short_key(const std::string& key) {
  if (key.starts_with("controller.")) return key.substr(11);
  if (key.starts_with("controllers.")) {
    const std::size_t dot = key.find('.', 12);
    if (dot != std::string::npos) return key.substr(dot + 1);
  }
  return key;
}

std::vector<Key> sweep_keys(const std::string& prefix) {
  std::vector<Key> keys = keys_of(Spread{}, prefix);
  keys.push_back({prefix + ".axes", "", "a map {KEY: AXIS}: a list of values, or {linear or log: [low, high], n: 5}",
                  "", "keys of the suite and the values that they take"});
  keys.push_back({prefix + ".points", "", "a list of maps {KEY: VALUE}", "", "points one by one, instead of axes"});
  return keys;
}

std::vector<Assignment> read_sweep(const Node& node, const std::string& key) {
  MapReader in(node, key);
  const Node* list = in.get("points");
  const Node* axes_node = in.get("axes");
  Spread spread;
  if (list != nullptr) spread.design = Design::kList;
  config::read_members(in, spread);
  in.finish();
  const Design design = spread.design;
  const int n = spread.n.value_or(0);
  const bool sampled = design == Design::kLatinHypercube || design == Design::kSobol;
  in.check(sampled || n == 0, "n", "belongs to latin_hypercube and sobol; a grid has an n on each axis");
  in.check(!sampled || n > 0, "n", "missing; expected the number of points");
  if (design == Design::kList) {
    if (axes_node != nullptr) in.fail_at("axes", "belongs to a grid, latin_hypercube or sobol; a list has `points`");
    if (list == nullptr) in.fail_at("points", "missing; expected a list of points, each a map {KEY: VALUE, ...}");
    return listed_points(*list, in.key_of("points"));
  }
  if (list != nullptr) in.fail_at("points", "belongs to `design: list`");
  if (axes_node == nullptr || axes_node->kind != Node::Kind::kMap || axes_node->entries.empty())
    in.fail_at("axes", "missing; expected a map {KEY: [values] or {linear: [low, high], n: 5}, ...}");

  std::vector<Axis> axes;
  for (const auto& [name, value] : axes_node->entries)
    axes.push_back(read_axis(value, key, name, design == Design::kGrid));
  if (design == Design::kGrid) return grid_points(axes, node, key);
  if (static_cast<std::size_t>(n) * axes.size() > kMaxSweepValues) {
    in.fail_at("n", fmt::format("{} points on {} axes are more than {} values", n, axes.size(), kMaxSweepValues));
  }

  const auto count = static_cast<std::size_t>(n);
  const std::vector<std::vector<double>> unit =
      design == Design::kSobol ? sobol(count, axes.size()) : latin_hypercube(spread.seed, count, axes.size());
  std::vector<Assignment> points(count);
  for (std::size_t a = 0; a < axes.size(); ++a) {
    std::vector<double> us;
    for (const std::vector<double>& u : unit) us.push_back(u[a]);
    std::vector<Node> values = values_at(axes[a], us);
    for (std::size_t i = 0; i < count; ++i) points[i].emplace_back(axes[a].key, std::move(values[i]));
  }
  return points;
}

std::vector<std::vector<double>> latin_hypercube(std::uint64_t seed, std::size_t n, std::size_t dimensions) {
  std::vector<std::vector<double>> points(n, std::vector<double>(dimensions));
  std::vector<std::size_t> order(n);
  for (std::size_t axis = 0; axis < dimensions; ++axis) {
    Draws draws(seed, axis, Stream::kDesign);
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t i = n; i > 1; --i) std::swap(order[i - 1], order[draws.choice(i)]);  // Fisher-Yates
    for (std::size_t i = 0; i < n; ++i)
      points[i][axis] = (static_cast<double>(order[i]) + draws.uniform()) / static_cast<double>(n);
  }
  return points;
}

std::vector<std::vector<double>> sobol(std::size_t n, std::size_t dimensions) {
  boost::random::sobol engine(dimensions);
  std::vector<std::vector<double>> points(n, std::vector<double>(dimensions));
  for (auto& point : points)
    for (double& u : point) u = static_cast<double>(engine() >> 11) * 0x1p-53;
  return points;
}

}  // namespace moma
