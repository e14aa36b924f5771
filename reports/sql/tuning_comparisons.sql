-- The found gains of one search against other controllers on worlds that took no part in it.
SELECT family, other, metric, n, found, found_low, found_high, theirs, theirs_low, theirs_high, difference,
       difference_low, difference_high, p, verdict
FROM tune_comparison WHERE search_id = ?1 ORDER BY entry
