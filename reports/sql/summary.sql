-- The shared view, in the order in which the points were defined.
SELECT v.*
FROM v_summary AS v
JOIN suite AS s ON s.name = v.suite
JOIN point AS p ON p.suite_id = s.id AND p.controller = v.controller AND p.label = v.point
ORDER BY s.id, v.family, p.id
