-- The gains of one search: range, start, what was found, and the share of the objective's variance that each explains.
SELECT key, lower, upper, scale, start, found, importance FROM tune_variable WHERE search_id = ?1 ORDER BY variable
