-- Change of the objective of one search when one gain is moved away from what was found.
SELECT variable, value, change, error, valid FROM tune_sensitivity
WHERE search_id = ?1 AND other IS NULL ORDER BY variable, value
