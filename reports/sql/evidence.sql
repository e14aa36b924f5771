-- Samples of failed trials in worlds before ?1, ?2 at most, that tell what their reasons do not: where a robot was that did
-- not arrive though nothing was near and no joint at its limit, its base being unable to drive sideways; and how long
-- an object had been known that was hit, where the controller does not see all of them from the start.
WITH points AS (
  SELECT p.id, p.control_period_s,
         coalesce(json_extract(u.resolved, '$.points[' || p.resolved_position || '].disturbances'),
                  json_extract(u.resolved, '$.disturbances'), '{}') AS disturbances
  FROM point AS p
  JOIN resolved_suite AS u ON u.id = p.resolved_suite_id
), asked AS (
  SELECT m.key, m.world_id, m.world_index, p.control_period_s, p.disturbances,
         CASE WHEN m.outcome = 'collision' THEN 'known' ELSE 'bearing' END AS kind
  FROM points AS p
  JOIN point_trial AS m ON m.point_id = p.id AND m.world_index < ?1
  WHERE CASE m.outcome WHEN 'collision' THEN coalesce(json_extract(p.disturbances, '$.objects.range'),
                                                      json_extract(p.disturbances, '$.objects.detection')) IS NOT NULL
                       ELSE m.outcome IN ('stuck', 'timeout') END
)
SELECT t.trial, a.kind, w.json AS json_world, a.disturbances, a.control_period_s, t.object, t.collision_time_s, x.layout,
       x.n, x.columns, x.data
FROM asked AS a
JOIN trial AS t ON t.key = a.key
JOIN samples AS x ON x.key = a.key
JOIN world AS w ON w.id = a.world_id
WHERE CASE a.kind WHEN 'known' THEN t.object NOT LIKE 'self:%'
                  ELSE coalesce(t.reason, '') NOT LIKE '% is % m from %' AND coalesce(t.reason, '') NOT LIKE '% from its limit%'
                       -- Two velocities beside the joints': ahead and the turn.
                       AND 2 = (SELECT sum(c.value GLOB 'command*') - sum(c.value GLOB 'q[0-9]*') FROM json_each(x.columns) AS c) END
ORDER BY a.world_index, a.key
LIMIT ?2
