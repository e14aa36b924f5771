#include "eval/store/query.h"

namespace moma::store {

const std::vector<NamedQuery>& named_queries() {
  static const std::vector<NamedQuery> kQueries = {
      {"summary", "rates with Wilson's 95 % interval, and metrics, per controller, point, family and mode",
       "SELECT * FROM v_summary ORDER BY suite, robot, family, mode, controller, point",
       R"(SELECT suite, controller, point, family, mode, n,
       printf('%5.1f  [%5.1f, %5.1f]', 100 * success_rate, 100 * success_low, 100 * success_high) AS "success % [95 %]",
       printf('%4.1f  [%4.1f, %4.1f]', 100 * collision_rate, 100 * collision_low, 100 * collision_high)
         AS "collision % [95 %]",
       iif(time_to_goal_median_s IS NULL, NULL, printf('%.2f', time_to_goal_median_s)) AS "time to goal s",
       iif(manip_mean IS NULL, NULL, printf('%.4f', manip_mean)) AS manip,
       iif(clearance_min_m IS NULL, NULL, printf('%.3f', clearance_min_m)) AS "clearance m",
       iif(command_change_mean IS NULL, NULL, printf('%.3f', command_change_mean)) AS "change"
FROM (SELECT * FROM v_summary ORDER BY suite, robot, family, mode, controller, point))"},
      {"list", "what the store holds: suites, controllers and points with their numbers of trials",
       R"(SELECT s.name AS suite, r.name AS robot, p.controller AS controller, p.label AS point, p.mode AS mode,
       count(m.key) AS trials, min(i.started) AS first_started, max(coalesce(i.ended, i.started)) AS last_ended
FROM point AS p JOIN suite AS s ON s.id = p.suite_id JOIN robot AS r ON r.id = p.robot_id
LEFT JOIN point_trial AS m ON m.point_id = p.id
LEFT JOIN execution AS e ON e.key = m.key LEFT JOIN invocation AS i ON i.id = e.invocation_id
GROUP BY p.id ORDER BY p.id)",
       ""},
      {"failures", "how trials fail: outcomes with what touched what, most frequent first",
       R"(SELECT suite, controller, point, family, outcome, link, object_kind AS object, count(*) AS n,
       min(trial) AS example, reason_example AS reason
FROM (SELECT *, CASE WHEN object = 'floor' OR object LIKE 'self:%' THEN object WHEN object IS NOT NULL THEN 'object' END
                  AS object_kind,
             first_value(reason) OVER (PARTITION BY suite, controller, point, family, outcome, link ORDER BY trial)
                  AS reason_example
      FROM v_trials WHERE outcome <> 'success')
GROUP BY suite, controller, point, family, outcome, link, object_kind
ORDER BY suite, controller, point, n DESC, family, outcome, link, object_kind)",
       ""},
      {"pairs", "each pair of points on the same worlds: both succeed, only one does, neither does",
       R"(SELECT suite, family, mode, controller_a, point_a, controller_b, point_b, count(*) AS n,
       sum(success_a AND success_b) AS both, sum(success_a AND NOT success_b) AS only_a,
       sum(success_b AND NOT success_a) AS only_b, sum(NOT success_a AND NOT success_b) AS neither
FROM v_pairs GROUP BY suite, robot, family, mode, controller_a, point_a, controller_b, point_b
ORDER BY suite, family, mode, controller_a, point_a, controller_b, point_b)",
       ""},
      {"worst", "the twenty worst trials: unsuccessful ones by their distance to the goal, largest first",
       R"(SELECT trial, suite, controller, point, family, world, outcome, position_error_m, orientation_error_rad,
       clearance_min_m, time_end_s, link, object
FROM v_trials WHERE outcome <> 'success'
ORDER BY position_error_m IS NULL DESC, position_error_m DESC, trial LIMIT 20)",
       ""},
  };
  return kQueries;
}

}  // namespace moma::store
