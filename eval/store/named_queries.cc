#include "eval/store/query.h"

namespace moma::store {

const std::vector<NamedQuery>& named_queries() {
  static const std::vector<NamedQuery> kQueries = {
      {"summary", "rates with Wilson's 95 % interval, and metrics, per controller, point, family and mode",
       "SELECT * FROM v_summary ORDER BY suite, robot, family, mode, controller, point"},
      {"list", "what the store holds: suites, controllers and points with their numbers of trials",
       R"(SELECT s.name AS suite, r.name AS robot, p.controller AS controller, p.label AS point, p.mode AS mode,
       coalesce(c.n, 0) AS trials, i.first_started, i.last_ended
FROM point AS p JOIN suite AS s ON s.id = p.suite_id JOIN robot AS r ON r.id = p.robot_id
LEFT JOIN (SELECT point_id, count(*) AS n FROM point_trial GROUP BY point_id) AS c ON c.point_id = p.id
LEFT JOIN (SELECT suite_id, min(started) AS first_started, max(coalesce(ended, started)) AS last_ended
           FROM invocation GROUP BY suite_id) AS i ON i.suite_id = s.id
ORDER BY p.id)"},
      {"failures", "how trials fail: outcomes with what touched what, most frequent first",
       // In the order of the keys on both sides, so that tables are read one page after the other; `reason` is that of
       // the example, as SQLite gives bare columns beside min().
       R"(SELECT s.name AS suite, p.controller AS controller, p.label AS point, f.family AS family, f.outcome AS outcome,
       f.link AS link, f.object AS object, f.n AS n, f.example AS example, f.reason AS reason
FROM (SELECT m.point_id, m.family, t.outcome, t.link,
             CASE WHEN t.object = 'floor' OR t.object LIKE 'self:%' THEN t.object
                  WHEN t.object IS NOT NULL THEN 'object' END AS object,
             count(*) AS n, min(t.trial) AS example, t.reason
      FROM trial AS t CROSS JOIN point_trial AS m INDEXED BY point_trial_by_key ON m.key = t.key
      WHERE t.outcome <> 'success' GROUP BY 1, 2, 3, 4, 5) AS f
JOIN point AS p ON p.id = f.point_id JOIN suite AS s ON s.id = p.suite_id
ORDER BY suite, controller, point, n DESC, family, outcome, link, object)"},
      {"pairs", "each pair of points on the same worlds: both succeed, only one does, neither does",
       // One bit a world, 60 in a number: pairs are points squared, and each pair of trials would be a row. Frozen
       // worlds may be alike, so that a world is told by its index too.
       R"(WITH placed AS (
  SELECT point_id, family, outcome, dense_rank() OVER (ORDER BY world_index, world_id) AS place FROM point_trial
), bits AS MATERIALIZED (
  SELECT point_id, family, place / 60 AS word, sum(1 << (place % 60)) AS met,
         sum((outcome = 'success') << (place % 60)) AS won
  FROM placed GROUP BY 1, 2, 3
), counted AS (
  SELECT pa.id AS a, pb.id AS b, ba.family, sum(bit_count(ba.met & bb.met)) AS n,
         sum(bit_count(ba.won & bb.won)) AS both, sum(bit_count(ba.won & bb.met & ~bb.won)) AS only_a,
         sum(bit_count(bb.won & ba.met & ~ba.won)) AS only_b
  FROM point AS pa
  JOIN point AS pb ON pb.suite_id = pa.suite_id AND pb.robot_id = pa.robot_id AND pb.mode = pa.mode AND pb.id > pa.id
  JOIN bits AS ba ON ba.point_id = pa.id
  JOIN bits AS bb ON bb.point_id = pb.id AND bb.family = ba.family AND bb.word = ba.word
  GROUP BY 1, 2, 3 HAVING n > 0)
SELECT s.name AS suite, f.family AS family, pa.mode AS mode, pa.controller AS controller_a, pa.label AS point_a,
       pb.controller AS controller_b, pb.label AS point_b, f.n AS n, f.both AS both, f.only_a AS only_a,
       f.only_b AS only_b, f.n - f.both - f.only_a - f.only_b AS neither
FROM counted AS f
JOIN point AS pa ON pa.id = f.a JOIN point AS pb ON pb.id = f.b JOIN suite AS s ON s.id = pa.suite_id
ORDER BY suite, family, mode, controller_a, point_a, controller_b, point_b)"},
      {"worst", "the twenty worst trials: unsuccessful ones by their distance to the goal, largest first",
       R"(WITH worst AS MATERIALIZED (
  SELECT key FROM trial AS t WHERE outcome <> 'success' AND EXISTS (SELECT 1 FROM point_trial AS m WHERE m.key = t.key)
  ORDER BY position_error_m IS NULL DESC, position_error_m DESC, key LIMIT 20)
SELECT t.trial, s.name AS suite, p.controller, p.label AS point, m.family, m.world_index AS world, t.outcome,
       t.position_error_m, t.orientation_error_rad, t.clearance_min_m, t.time_end_s, t.link, t.object
FROM worst AS x JOIN trial AS t ON t.key = x.key JOIN point_trial AS m ON m.key = t.key
JOIN point AS p ON p.id = m.point_id JOIN suite AS s ON s.id = p.suite_id
ORDER BY t.position_error_m IS NULL DESC, t.position_error_m DESC, t.trial, p.id LIMIT 20)"},
  };
  return kQueries;
}

}  // namespace moma::store
