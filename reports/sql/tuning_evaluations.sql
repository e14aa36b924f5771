-- The candidates of one search in the order in which they were measured.
SELECT evaluation, phase, worlds, cut, valid, cost, merit, candidate AS json_candidate
FROM tune_evaluation WHERE search_id = ?1 ORDER BY evaluation
