-- Every search for gains. Its parts follow by search, each in the order of its table.
SELECT id, suite, controller, objective, unit, budget_trials, started, ended, status, trials, trials_saved,
       evaluations_cut, held_out_suite, verdict, coalesce(notes, '[]') AS json_notes
FROM tune_search
ORDER BY id
