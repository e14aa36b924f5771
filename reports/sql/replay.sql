-- One trial by its whole name, with its world, robot and samples (NULL where none are stored).
SELECT t.trial, p.robot_id AS robot, w.json AS json_world, x.layout, x.n, x.columns, x.data
FROM trial AS t
JOIN point_trial AS m ON m.key = t.key
JOIN point AS p ON p.id = m.point_id
JOIN world AS w ON w.id = t.world_id
LEFT JOIN samples AS x ON x.key = t.key
WHERE t.trial = ?1
ORDER BY p.id
LIMIT 1
