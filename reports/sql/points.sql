-- What was evaluated: one row per point, with everything that its trials share.
SELECT s.name AS suite, r.name AS robot, p.controller AS controller, p.label AS point, p.mode AS mode,
       substr(lower(hex(r.hash)), 1, 12) AS robot_content, p.params AS json_params, c.resolved AS json_parameters, p.worlds AS json_worlds,
       coalesce(json_extract(u.resolved, '$.points[' || p.resolved_position || '].disturbances'),
                json_extract(u.resolved, '$.disturbances'), '{}') AS json_disturbances,
       coalesce(json_extract(r.resolved, '$.left_out'), '[]') AS json_left_out,
       p.control_period_s, p.physics_step_s, p.time_limit_s, p.success_position_m, p.success_orientation_rad,
       p.success_dwell_s, p.simulation_version
FROM point AS p
JOIN suite AS s ON s.id = p.suite_id
JOIN robot AS r ON r.id = p.robot_id
JOIN controller AS c ON c.id = p.controller_id
JOIN resolved_suite AS u ON u.id = p.resolved_suite_id
ORDER BY s.id, p.id
