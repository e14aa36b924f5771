-- One trial by its whole name, as the page has it.
SELECT * FROM v_trials WHERE trial = ?1 LIMIT 1
