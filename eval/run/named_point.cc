#include "eval/run/named_point.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>

#include "eval/store/error.h"
#include "eval/store/query.h"

namespace moma::run {
namespace {

using store::sql_literal;

constexpr std::string_view kBest = "@best";

constexpr double kNone = std::numeric_limits<double>::infinity();  // of a mean over no trials

std::string text_of(const store::Cell& cell) {
  const auto* text = std::get_if<std::string>(&cell);
  return text == nullptr ? "" : *text;
}

/// A point with the quantities of kBestCriterion.
struct RatedPoint {
  NamedPoint point;
  std::int64_t n = 0, successes = 0, collisions = 0;
  double time = kNone, change = kNone;

  bool better_than(const RatedPoint& other) const {
    // Compares shares of different numbers of trials, without rounding.
    const std::int64_t success = successes * other.n - other.successes * n;
    if (success != 0) return success > 0;
    const std::int64_t collision = collisions * other.n - other.collisions * n;
    if (collision != 0) return collision < 0;
    return time != other.time ? time < other.time : change < other.change;
  }
};

/// Returns the params of a point that are no gains.
std::string conditions_of(const std::string& params) {
  nlohmann::json json = nlohmann::json::parse(params, nullptr, false);
  if (!json.is_object()) return params;
  for (auto at = json.begin(); at != json.end();)
    at = at.key().starts_with("controller.") || at.key().starts_with("controllers.") ? json.erase(at) : std::next(at);
  return json.dump();
}

std::vector<RatedPoint> read_points(const std::filesystem::path& file, const std::string& suite, bool rates) {
  const char* const counts =
      rates ? "(SELECT point_id, count(*) AS n, sum(outcome = 'success') AS successes, "
              "sum(outcome = 'collision') AS collisions, avg(time_to_goal_s) AS time, "
              "avg(command_change_mean) AS change FROM point_trial GROUP BY point_id)"
            : "(SELECT NULL AS point_id, 0 AS n, 0 AS successes, 0 AS collisions, NULL AS time, NULL AS change)";
  const store::QueryResult found = store::query(
      file,
      fmt::format("SELECT p.id, s.id, s.name, p.controller, p.label, coalesce(c.n, 0), coalesce(c.successes, 0), "
                  "coalesce(c.collisions, 0), c.time, c.change, p.params FROM point AS p JOIN suite AS s ON s.id = "
                  "p.suite_id LEFT JOIN {} AS c ON c.point_id = p.id {} ORDER BY s.id, p.id",
                  counts, suite.empty() ? "" : "WHERE s.name = " + sql_literal(suite)));
  std::vector<RatedPoint> all;
  for (const auto& row : found.rows) {
    RatedPoint c;
    c.point = {std::get<std::int64_t>(row[0]),
               std::get<std::int64_t>(row[1]),
               text_of(row[2]),
               text_of(row[3]),
               text_of(row[4]),
               conditions_of(text_of(row[10])),
               ""};
    c.n = std::get<std::int64_t>(row[5]);
    c.successes = std::get<std::int64_t>(row[6]);
    c.collisions = std::get<std::int64_t>(row[7]);
    c.time = store::number_in(row[8]).value_or(kNone);
    c.change = store::number_in(row[9]).value_or(kNone);
    all.push_back(std::move(c));
  }
  return all;
}

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& name, const std::string& suite,
                         const std::vector<RatedPoint>& all) {
  constexpr std::size_t kMost = 20;
  std::vector<std::string> names;
  for (const RatedPoint& c : all)
    if (std::find(names.begin(), names.end(), c.point.name()) == names.end()) names.push_back(c.point.name());
  const std::size_t more = names.size() > kMost ? names.size() - kMost : 0;
  names.resize(names.size() - more);
  throw store::not_found(
      file, fmt::format("has no point '{}'{}; it has: {}{}", name, suite.empty() ? "" : " in suite " + suite,
                        fmt::join(names, ", "),
                        more > 0 ? fmt::format(" and {} more (moma query {} @list)", more, file.string()) : ""));
}

std::string why(const RatedPoint& c) {
  const auto percent = [&](std::int64_t k) { return 100.0 * static_cast<double>(k) / static_cast<double>(c.n); };
  std::string text =
      fmt::format("success {:.1f} %, collision {:.1f} % of {}", percent(c.successes), percent(c.collisions), c.n);
  if (c.time < kNone) text += fmt::format(", mean time to goal {:.2f} s", c.time);
  return text;
}

std::vector<NamedPoint> best_points(const std::filesystem::path& file, const std::string& name,
                                    const std::string& suite) {
  std::string controller = name.substr(0, name.size() - kBest.size());
  if (controller.ends_with(':')) controller.pop_back();
  const std::vector<RatedPoint> all = read_points(file, suite, true);
  std::map<std::int64_t, const RatedPoint*> best;  // by suite; the first of equal ones
  for (const RatedPoint& c : all) {
    if (c.n == 0 || (!controller.empty() && c.point.controller != controller)) continue;
    const RatedPoint*& of_suite = best[c.point.suite_id];
    if (of_suite == nullptr || c.better_than(*of_suite)) of_suite = &c;
  }
  if (best.empty()) refuse(file, name, suite, all);
  std::vector<NamedPoint> points;
  for (const auto& [id, c] : best) {
    points.push_back(c->point);
    points.back().why = why(*c);
  }
  return points;
}

// Returns the digits of a world's index after the last slash of `name`; "" if there are none.
std::string_view world_in(std::string_view name) {
  const std::size_t slash = name.rfind('/');
  const std::string_view digits = slash == std::string_view::npos ? std::string_view() : name.substr(slash + 1);
  const bool number = digits.size() < 19 &&
                      std::all_of(digits.begin(), digits.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
  return number ? digits : std::string_view();
}

}  // namespace

std::vector<NamedPoint> named_points(const std::filesystem::path& file, const std::string& name,
                                     const std::string& suite) {
  if (name.ends_with(kBest)) return best_points(file, name, suite);
  const std::vector<RatedPoint> all = read_points(file, suite, false);
  std::vector<NamedPoint> points;
  for (const RatedPoint& c : all)
    if (c.point.name() == name) points.push_back(c.point);
  if (points.empty()) refuse(file, name, suite, all);
  return points;
}

std::vector<NamedPoint> points_of_controller(const std::filesystem::path& file, const std::string& controller,
                                             const std::string& suite) {
  std::vector<NamedPoint> points;
  for (const RatedPoint& c : read_points(file, suite, false)) {
    if (c.point.controller != controller) continue;
    if (c.point.label.empty()) return {};
    points.push_back(c.point);
  }
  return points;
}

NamedPoint named_point(const std::filesystem::path& file, const std::string& name, const std::string& suite) {
  std::vector<NamedPoint> points = named_points(file, name, suite);
  if (points.size() == 1) return std::move(points.front());
  std::vector<std::string> suites;
  for (const NamedPoint& point : points) suites.push_back(point.suite);
  throw store::not_found(
      file, fmt::format("several suites have a point '{}': choose one by --suite: {}", name, fmt::join(suites, ", ")));
}

std::string named_trial(const std::filesystem::path& file, const std::string& name) {
  const std::string_view world = world_in(name);
  const std::string of = world.empty() ? name : name.substr(0, name.size() - world.size() - 1);
  if (world.empty() && !of.ends_with(kBest)) {
    const std::vector<RatedPoint> all = read_points(file, "", false);
    if (std::none_of(all.begin(), all.end(), [&](const RatedPoint& c) { return c.point.name() == of; })) return name;
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
