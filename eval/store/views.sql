-- The views of the store. A store that is written to gets them anew where they differ; one that is only read is read
-- through temporary ones.
CREATE VIEW v_trials AS
SELECT t.trial AS trial, s.name AS suite, r.name AS robot, p.controller AS controller, p.label AS point,
       p.params AS params, w.family AS family, w.world_index AS world, p.mode AS mode, t.outcome AS outcome,
       {{trial view}},
       {{timing view}}
FROM point_trial AS m
JOIN point AS p ON p.id = m.point_id
JOIN suite AS s ON s.id = p.suite_id
JOIN robot AS r ON r.id = p.robot_id
JOIN trial AS t ON t.key = m.key
JOIN world AS w ON w.id = t.world_id
LEFT JOIN execution AS e ON e.key = t.key;

-- The goals of trials in worlds of several, one row for each that was reached, numbered from 1. `time_s` since the start,
-- `leg_s` since the goal before it.
CREATE VIEW v_goals AS
SELECT t.trial AS trial, s.name AS suite, p.controller AS controller, p.label AS point, m.family AS family,
       m.world_index AS world, m.outcome AS outcome, g.key + 1 AS goal,
       0.0 + json_extract(g.value, '$.time_s') AS time_s,
       0.0 + json_extract(g.value, '$.time_s')
         - CASE g.key WHEN 0 THEN 0.0 ELSE json_extract(t.goals, '$[' || (g.key - 1) || '].time_s') END AS leg_s,
       0.0 + json_extract(g.value, '$.clearance_m') AS clearance_m
FROM point_trial AS m
JOIN trial AS t ON t.key = m.key
JOIN point AS p ON p.id = m.point_id
JOIN suite AS s ON s.id = p.suite_id
JOIN json_each(t.goals) AS g;

-- Rates with Wilson's 95 % interval (z = 1.959963984540054); the median is over successful trials, means over the
-- trials that have the value. A trial that ended by an error did not succeed: else a controller could leave every
-- difficult world to errors. `errors` counts them within n; success_without_errors is the rate of the other trials. The
-- index point_trial_summary has all that is read.
CREATE VIEW v_summary AS
WITH counted AS (
  SELECT point_id, family, count(*) AS n, sum(outcome = 'error') AS errors,
         1.0 * count(*) AS m, 1.0 * sum(outcome = 'success') AS successes,
         1.0 * sum(outcome = 'collision') AS collisions, 3.8414588206941245 AS zz, count(time_to_goal_s) AS arrived,
         {{summary means}}
  FROM point_trial
  GROUP BY point_id, family
), ranked AS (
  SELECT point_id, family, time_to_goal_s,
         row_number() OVER (PARTITION BY point_id, family ORDER BY time_to_goal_s) AS place
  FROM point_trial
  WHERE time_to_goal_s IS NOT NULL
), medians AS (
  SELECT r.point_id, r.family, avg(r.time_to_goal_s) AS time_to_goal_median_s
  FROM ranked AS r
  JOIN counted AS c ON c.point_id = r.point_id AND c.family = r.family
  WHERE r.place IN ((c.arrived + 1) / 2, (c.arrived + 2) / 2)
  GROUP BY r.point_id, r.family
)
SELECT s.name AS suite, b.name AS robot, p.controller AS controller, p.label AS point, c.family AS family,
       p.mode AS mode, n, errors,
       successes / m AS success_rate,
       CASE WHEN successes = 0 THEN 0.0 ELSE
         (successes + zz / 2 - sqrt(zz * (successes * (m - successes) / m + zz / 4))) / (m + zz) END AS success_low,
       CASE WHEN successes = m THEN 1.0 ELSE
         (successes + zz / 2 + sqrt(zz * (successes * (m - successes) / m + zz / 4))) / (m + zz) END AS success_high,
       successes / nullif(n - errors, 0) AS success_without_errors,
       collisions / m AS collision_rate,
       CASE WHEN collisions = 0 THEN 0.0 ELSE
         (collisions + zz / 2 - sqrt(zz * (collisions * (m - collisions) / m + zz / 4))) / (m + zz) END
         AS collision_low,
       CASE WHEN collisions = m THEN 1.0 ELSE
         (collisions + zz / 2 + sqrt(zz * (collisions * (m - collisions) / m + zz / 4))) / (m + zz) END
         AS collision_high,
       d.time_to_goal_median_s AS time_to_goal_median_s, {{summary view}}
FROM counted AS c
JOIN point AS p ON p.id = c.point_id
JOIN suite AS s ON s.id = p.suite_id
JOIN robot AS b ON b.id = p.robot_id
LEFT JOIN medians AS d ON d.point_id = c.point_id AND d.family = c.family;

-- Two points of one suite on the same world; each pair of points once, the one that was defined first as `a`.
CREATE VIEW v_pairs AS
SELECT s.name AS suite, r.name AS robot, w.family AS family, w.world_index AS world, pa.mode AS mode,
       pa.controller AS controller_a, pa.label AS point_a, pb.controller AS controller_b, pb.label AS point_b,
       ta.trial AS trial_a, tb.trial AS trial_b, ta.outcome AS outcome_a, tb.outcome AS outcome_b,
       ta.outcome = 'success' AS success_a, tb.outcome = 'success' AS success_b,
       ta.time_to_goal_s AS time_to_goal_a_s, tb.time_to_goal_s AS time_to_goal_b_s
FROM point_trial AS ma
JOIN point AS pa ON pa.id = ma.point_id
JOIN point AS pb ON pb.suite_id = pa.suite_id AND pb.id > pa.id AND pb.mode = pa.mode AND pb.robot_id = pa.robot_id
JOIN point_trial AS mb ON mb.point_id = pb.id AND mb.world_index = ma.world_index
JOIN trial AS ta ON ta.key = ma.key
JOIN trial AS tb ON tb.key = mb.key AND tb.world_id = ta.world_id
JOIN world AS w ON w.id = ta.world_id
JOIN suite AS s ON s.id = pa.suite_id
JOIN robot AS r ON r.id = pa.robot_id;

-- Values of the suites' own metrics, one row per trial of a suite and metric.
CREATE VIEW v_metrics AS
SELECT t.trial AS trial, s.name AS suite, p.controller AS controller, p.label AS point, m.family AS family,
       m.world_index AS world, m.outcome AS outcome, d.name AS metric, x.value AS value
FROM metric AS d
JOIN metric_value AS x ON x.metric_id = d.id
JOIN trial AS t ON t.key = x.key
JOIN point_trial AS m ON m.key = x.key
JOIN point AS p ON p.id = m.point_id
JOIN suite AS s ON s.id = p.suite_id;

-- Means of the suites' own metrics over the trials that have the value, as v_summary has those of moma's.
CREATE VIEW v_metric_summary AS
SELECT s.name AS suite, r.name AS robot, p.controller AS controller, p.label AS point, m.family AS family,
       p.mode AS mode, d.name AS metric, count(x.value) AS n, avg(x.value) AS mean
FROM metric AS d
JOIN metric_value AS x ON x.metric_id = d.id
JOIN point_trial AS m ON m.key = x.key
JOIN point AS p ON p.id = m.point_id
JOIN suite AS s ON s.id = p.suite_id
JOIN robot AS r ON r.id = p.robot_id
GROUP BY p.id, m.family, d.id;
