-- A success in the world in which the trial ?1 failed, of another point of its suite, robot and mode; one with samples
-- before one without, then the first point's.
SELECT t.trial, q.robot_id AS robot, w.json AS json_world, x.layout, x.n, x.columns, x.data
FROM trial AS f
JOIN point_trial AS m ON m.key = f.key
JOIN point AS p ON p.id = m.point_id
JOIN point AS q ON q.suite_id = p.suite_id AND q.robot_id = p.robot_id AND q.mode = p.mode AND q.id <> p.id
JOIN point_trial AS n ON n.point_id = q.id AND n.world_index = m.world_index AND n.world_id = m.world_id
                     AND n.outcome = 'success'
JOIN trial AS t ON t.key = n.key
JOIN world AS w ON w.id = t.world_id
LEFT JOIN samples AS x ON x.key = t.key
WHERE f.trial = ?1 AND f.outcome <> 'success'
ORDER BY x.key IS NULL, q.id
LIMIT 1
