#include "eval/run/named_point.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <string_view>

#include "eval/store/error.h"
#include "eval/store/query.h"

namespace moma::run {
namespace {

using store::sql_literal;

constexpr std::string_view kBest = "@best";

std::string text_of(const store::Cell& cell) {
  const auto* text = std::get_if<std::string>(&cell);
  return text == nullptr ? "" : *text;
}

/// Returns the params of a point that are no gains.
std::string conditions_of(const std::string& params) {
  nlohmann::json json = nlohmann::json::parse(params, nullptr, false);
  if (!json.is_object()) return params;
  for (auto at = json.begin(); at != json.end();)
    at = at.key().starts_with("controller.") || at.key().starts_with("controllers.") ? json.erase(at) : std::next(at);
  return json.dump();
}

constexpr const char* kPoints =
    "SELECT p.id, s.id AS suite, s.name, p.controller, p.label, p.params FROM point AS p JOIN suite AS s ON s.id = "
    "p.suite_id ";

std::string of_suite(const std::string& suite) { return suite.empty() ? "" : "WHERE s.name = " + sql_literal(suite); }

NamedPoint point_of(const std::vector<store::Cell>& row) {
  return {std::get<std::int64_t>(row[0]),
          std::get<std::int64_t>(row[1]),
          text_of(row[2]),
          text_of(row[3]),
          text_of(row[4]),
          conditions_of(text_of(row[5])),
          ""};
}

std::vector<NamedPoint> read_points(const fs::path& file, const std::string& suite) {
  std::vector<NamedPoint> all;
  for (const auto& row : store::query(file, fmt::format("{}{} ORDER BY s.id, p.id", kPoints, of_suite(suite))).rows)
    all.push_back(point_of(row));
  return all;
}

[[noreturn]] void refuse(const fs::path& file, const std::string& name, const std::string& suite) {
  constexpr std::size_t kMost = 20;
  std::vector<std::string> names;
  for (const NamedPoint& point : read_points(file, suite))
    if (std::ranges::find(names, point.name()) == names.end()) names.push_back(point.name());
  const std::size_t more = names.size() > kMost ? names.size() - kMost : 0;
  names.resize(names.size() - more);
  throw store::not_found(
      file, fmt::format("has no point '{}'{}; it has: {}{}", name, suite.empty() ? "" : " in suite " + suite,
                        fmt::join(names, ", "),
                        more > 0 ? fmt::format(" and {} more (moma query {} @list)", more, file.string()) : ""));
}

/// The best point of each suite by kBestCriterion, the first of equal ones.
std::vector<NamedPoint> best_points(const fs::path& file, const std::string& name, const std::string& suite) {
  std::string controller = name.substr(0, name.size() - kBest.size());
  if (controller.ends_with(':')) controller.pop_back();
  // Quotients of whole numbers that are equal are equal as doubles, too.
  const store::QueryResult found = store::query(
      file, fmt::format("SELECT a.*, n, 100.0 * successes / n, 100.0 * collisions / n, time FROM ({}{}) AS a "
                        "JOIN (SELECT point_id, count(*) AS n, sum(outcome = 'success') AS successes, "
                        "sum(outcome = 'collision') AS collisions, avg(time_to_goal_s) AS time, "
                        "avg(command_change_mean) AS change FROM point_trial GROUP BY point_id) ON point_id = a.id "
                        "ORDER BY suite, 1.0 * successes / n DESC, 1.0 * collisions / n, time NULLS LAST, "
                        "change NULLS LAST, a.id",
                        kPoints, of_suite(suite)));
  std::vector<NamedPoint> points;
  for (const auto& row : found.rows) {
    NamedPoint point = point_of(row);
    const bool later = !points.empty() && points.back().suite_id == point.suite_id;
    if (later || (!controller.empty() && point.controller != controller)) continue;
    point.why = fmt::format("success {:.1f} %, collision {:.1f} % of {}", *store::number_in(row[7]),
                            *store::number_in(row[8]), std::get<std::int64_t>(row[6]));
    if (const auto time = store::number_in(row[9])) point.why += fmt::format(", mean time to goal {:.2f} s", *time);
    points.push_back(std::move(point));
  }
  if (points.empty()) refuse(file, name, suite);
  return points;
}

// Returns the digits of a world's index after the last slash of `name`; "" if there are none.
std::string_view world_in(std::string_view name) {
  const std::size_t slash = name.rfind('/');
  const std::string_view digits = slash == std::string_view::npos ? std::string_view() : name.substr(slash + 1);
  const bool number =
      digits.size() < 19 && std::ranges::all_of(digits, [](unsigned char c) { return std::isdigit(c) != 0; });
  return number ? digits : std::string_view();
}

}  // namespace

std::vector<NamedPoint> named_points(const fs::path& file, const std::string& name, const std::string& suite) {
  if (name.ends_with(kBest)) return best_points(file, name, suite);
  std::vector<NamedPoint> points = read_points(file, suite);
  std::erase_if(points, [&](const NamedPoint& point) { return point.name() != name; });
  if (points.empty()) refuse(file, name, suite);
  return points;
}

std::vector<NamedPoint> points_of_controller(const fs::path& file, const std::string& controller,
                                             const std::string& suite) {
  std::vector<NamedPoint> points = read_points(file, suite);
  std::erase_if(points, [&](const NamedPoint& point) { return point.controller != controller; });
  const bool swept = std::ranges::none_of(points, [](const NamedPoint& p) { return p.label.empty(); });
  return swept ? points : std::vector<NamedPoint>{};
}

NamedPoint named_point(const fs::path& file, const std::string& name, const std::string& suite) {
  std::vector<NamedPoint> points = named_points(file, name, suite);
  if (points.size() == 1) return std::move(points.front());
  std::vector<std::string> suites;
  for (const NamedPoint& point : points) suites.push_back(point.suite);
  throw store::not_found(
      file, fmt::format("several suites have a point '{}': choose one by --suite: {}", name, fmt::join(suites, ", ")));
}

std::string named_trial(const fs::path& file, const std::string& name) {
  const std::string_view world = world_in(name);
  const std::string of = world.empty() ? name : name.substr(0, name.size() - world.size() - 1);
  if (world.empty() && !of.ends_with(kBest)) {
    const std::vector<NamedPoint> all = read_points(file, "");
    if (std::ranges::none_of(all, [&](const NamedPoint& point) { return point.name() == of; })) return name;
  }
  const NamedPoint point = named_point(file, of);
  const store::QueryResult found = store::query(
      file, fmt::format("SELECT lower(hex(m.key)) FROM point_trial AS m JOIN trial AS t ON t.key = m.key WHERE "
                        "m.point_id = {}{} ORDER BY m.outcome = 'success', t.position_error_m IS NULL DESC, "
                        "iif(m.outcome = 'success', m.time_to_goal_s, t.position_error_m) DESC, m.key LIMIT 1",
                        point.id, world.empty() ? "" : fmt::format(" AND m.world_index = {}", world)));
  if (found.rows.empty())
    throw store::not_found(
        file, fmt::format("{} has no trial{}", point.name(), world.empty() ? "" : fmt::format(" in world {}", world)));
  return text_of(found.rows.front().front());
}

}  // namespace moma::run
