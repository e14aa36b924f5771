-- The worst ?1 trials among those whose samples are stored, in worlds before ?2: one of each kind of failure first, then the next of each.
-- Worst: the deepest collision, else the greatest error at the end. A slow success of each point comes after the
-- failures of its round.
WITH candidates AS (
  SELECT m.key, t.trial, min(m.point_id) AS point_id, t.world_id, t.outcome, t.link,
         CASE t.outcome WHEN 'success' THEN t.time_to_goal_s WHEN 'collision' THEN coalesce(t.collision_depth_m, 0)
                        ELSE coalesce(t.position_error_m, 0) + coalesce(t.orientation_error_rad, 0) END AS badness
  FROM samples AS x
  JOIN point_trial AS m ON m.key = x.key AND m.world_index < ?2
  JOIN trial AS t ON t.key = x.key
  GROUP BY m.key
), placed AS (
  SELECT *, row_number() OVER (PARTITION BY point_id, outcome, link ORDER BY badness DESC, trial) AS place
  FROM candidates
)
SELECT c.trial, p.robot_id AS robot, w.json AS json_world, x.layout, x.n, x.columns, x.data
FROM placed AS c
JOIN point AS p ON p.id = c.point_id
JOIN world AS w ON w.id = c.world_id
JOIN samples AS x ON x.key = c.key
ORDER BY c.place, c.outcome = 'success', c.outcome, c.point_id, c.link, c.trial
LIMIT ?1
