-- v_summary over all families of a point together. Wilson's 95 % interval, z = 1.959963984540054.
WITH counted AS (
  SELECT point_id, count(*) AS n, sum(outcome = 'error') AS errors, 1.0 * count(*) AS m,
         1.0 * sum(outcome = 'success') AS successes,
         1.0 * sum(outcome = 'collision') AS collisions, 3.8414588206941245 AS zz, count(time_to_goal_s) AS arrived,
         avg(manip_mean) AS manip_mean, avg(clearance_min_m) AS clearance_min_m,
         avg(command_change_mean) AS command_change_mean
  FROM point_trial
  GROUP BY point_id
), ranked AS (
  SELECT point_id, time_to_goal_s, row_number() OVER (PARTITION BY point_id ORDER BY time_to_goal_s) AS place
  FROM point_trial
  WHERE time_to_goal_s IS NOT NULL
), medians AS (
  SELECT r.point_id, avg(r.time_to_goal_s) AS time_to_goal_median_s
  FROM ranked AS r JOIN counted AS c ON c.point_id = r.point_id
  WHERE r.place IN ((c.arrived + 1) / 2, (c.arrived + 2) / 2)
  GROUP BY r.point_id
)
SELECT s.name AS suite, b.name AS robot, p.controller, p.label AS point, NULL AS family, p.mode, c.n, c.errors,
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
       d.time_to_goal_median_s, c.manip_mean, c.clearance_min_m, c.command_change_mean
FROM counted AS c
JOIN point AS p ON p.id = c.point_id
JOIN suite AS s ON s.id = p.suite_id
JOIN robot AS b ON b.id = p.robot_id
LEFT JOIN medians AS d ON d.point_id = c.point_id
ORDER BY s.id, p.id
