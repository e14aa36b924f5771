-- Every trial of every point, flat, with its world's difficulty, its deadline misses, and a
-- name for its world that is the same in every store.
SELECT v.*, w.goal_distance_m, w.objects, w.witness_clearance_m, w.blocked_fraction, w.narrowest_gap_m,
       e.deadline_misses, substr(lower(hex(w.hash)), 1, 12) AS world_key
FROM v_trials AS v
JOIN suite AS s ON s.name = v.suite
JOIN point AS p ON p.suite_id = s.id AND p.controller = v.controller AND p.label = v.point
CROSS JOIN trial AS t ON t.trial = v.trial                            -- in this order, by the indices of names and keys:
CROSS JOIN point_trial AS m ON m.key = t.key AND +m.point_id = p.id   -- else each trial would search its whole point
JOIN world AS w ON w.id = t.world_id
LEFT JOIN execution AS e ON e.key = t.key
ORDER BY p.id, m.world_index
