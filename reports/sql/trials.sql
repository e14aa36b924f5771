-- The trials of every point in its worlds before ?1, flat, with the world's difficulty in the columns that the store
-- describes, the deadline misses, and a name for the world that is the same in every store.
SELECT v.*, {{difficulty}},
       e.deadline_misses, substr(lower(hex(w.hash)), 1, 12) AS world_key
FROM point AS p -- in this order and, by the pluses, by the indices of worlds, keys and names: else each trial would
                -- search its whole point
CROSS JOIN suite AS s ON s.id = p.suite_id
CROSS JOIN point_trial AS m ON m.point_id = p.id AND m.world_index < ?1
CROSS JOIN trial AS t ON t.key = m.key
CROSS JOIN v_trials AS v ON v.trial = t.trial AND +v.suite = s.name AND +v.controller = p.controller
                        AND +v.point = p.label
JOIN world AS w ON w.id = t.world_id
LEFT JOIN execution AS e ON e.key = t.key
ORDER BY p.id, m.world_index
