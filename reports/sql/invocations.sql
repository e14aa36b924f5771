-- Every call of the program that wrote into the store, the latest first.
SELECT s.name AS suite, i.started, i.ended, i.status, i.arguments AS json_arguments, i.moma_version, i.git_commit,
       i.git_dirty, i.build_type, i.compiler, i.compiler_flags, i.libraries AS json_libraries, i.host, i.os, i.cpu,
       i.cpu_count, i.threads, i.machine_class, i.trials_planned, i.trials_present, i.trials_done, json_extract(u.resolved, '$.notes') AS notes,
       -- NULL in stores without this column: the name is then the one of the row beside.
       coalesce((SELECT risk FROM invocation AS x WHERE x.id = i.id), 'null') AS json_risk
FROM invocation AS i
CROSS JOIN (SELECT NULL AS risk)
JOIN suite AS s ON s.id = i.suite_id
JOIN resolved_suite AS u ON u.id = i.resolved_suite_id
ORDER BY i.id DESC
