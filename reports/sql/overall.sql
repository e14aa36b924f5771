-- v_summary over all families of a point together. Wilson's 95 % interval, z = 1.959963984540054.
WITH ranked AS (
  SELECT *, row_number() OVER (PARTITION BY suite, robot, controller, point, mode
                               ORDER BY time_to_goal_s IS NULL, time_to_goal_s) AS place,
         count(time_to_goal_s) OVER (PARTITION BY suite, robot, controller, point, mode) AS arrived
  FROM v_trials
), counted AS (
  SELECT suite, robot, controller, point, mode, count(*) AS n, 1.0 * count(*) AS m,
         1.0 * sum(outcome = 'success') AS successes, 1.0 * sum(outcome = 'collision') AS collisions,
         3.8414588206941245 AS zz,
         avg(CASE WHEN place IN ((arrived + 1) / 2, (arrived + 2) / 2) THEN time_to_goal_s END)
           AS time_to_goal_median_s,
         avg(manip_mean) AS manip_mean, avg(clearance_min_m) AS clearance_min_m,
         avg(command_change_mean) AS command_change_mean
  FROM ranked
  GROUP BY suite, robot, controller, point, mode
)
SELECT c.suite, c.robot, c.controller, c.point, NULL AS family, c.mode, c.n,
       successes / m AS success_rate,
       CASE WHEN successes = 0 THEN 0.0 ELSE
         (successes + zz / 2 - sqrt(zz * (successes * (m - successes) / m + zz / 4))) / (m + zz) END AS success_low,
       CASE WHEN successes = m THEN 1.0 ELSE
         (successes + zz / 2 + sqrt(zz * (successes * (m - successes) / m + zz / 4))) / (m + zz) END AS success_high,
       collisions / m AS collision_rate,
       CASE WHEN collisions = 0 THEN 0.0 ELSE
         (collisions + zz / 2 - sqrt(zz * (collisions * (m - collisions) / m + zz / 4))) / (m + zz) END
         AS collision_low,
       CASE WHEN collisions = m THEN 1.0 ELSE
         (collisions + zz / 2 + sqrt(zz * (collisions * (m - collisions) / m + zz / 4))) / (m + zz) END
         AS collision_high,
       time_to_goal_median_s, manip_mean, clearance_min_m, command_change_mean
FROM counted AS c
JOIN suite AS s ON s.name = c.suite
JOIN point AS p ON p.suite_id = s.id AND p.controller = c.controller AND p.label = c.point
ORDER BY s.id, p.id
