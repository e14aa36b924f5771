-- From version 1 to 2: what summaries ask for is kept in point_trial; metrics of suites. Views go
-- first, since they name the table that is replaced.
DROP VIEW v_trials;
DROP VIEW v_summary;
DROP VIEW v_pairs;
CREATE TABLE point_trial_new (
  point_id INTEGER NOT NULL REFERENCES point (id),
  world_index INTEGER NOT NULL,
  key BLOB NOT NULL REFERENCES trial (key),
  world_id INTEGER NOT NULL REFERENCES world (id),
  family TEXT NOT NULL,
  outcome TEXT NOT NULL,
  time_to_goal_s REAL,
  manip_mean REAL,
  clearance_min_m REAL,
  command_change_mean REAL,
  PRIMARY KEY (point_id, world_index)
) STRICT, WITHOUT ROWID;
INSERT INTO point_trial_new
SELECT m.point_id, m.world_index, m.key, t.world_id, w.family, t.outcome, t.time_to_goal_s, t.manip_mean,
       t.clearance_min_m, t.command_change_mean
FROM point_trial AS m JOIN trial AS t ON t.key = m.key JOIN world AS w ON w.id = t.world_id
ORDER BY m.point_id, m.world_index;
DROP TABLE point_trial;
ALTER TABLE point_trial_new RENAME TO point_trial;
CREATE INDEX point_trial_by_key ON point_trial (key, family);
CREATE INDEX point_trial_summary ON point_trial (point_id, family, time_to_goal_s, outcome, manip_mean,
                                                 clearance_min_m, command_change_mean);
CREATE INDEX point_trial_by_time ON point_trial (point_id, time_to_goal_s);
CREATE TABLE metric (
  id INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE,                                -- as shown: another expression makes NAME@2 ...
  file_name TEXT NOT NULL,                                  -- as in the suite file
  expression TEXT NOT NULL,
  UNIQUE (file_name, expression)
) STRICT;

CREATE TABLE metric_value (
  metric_id INTEGER NOT NULL REFERENCES metric (id),
  key BLOB NOT NULL REFERENCES trial (key),
  value REAL,                                               -- NULL: the trial has no such value
  PRIMARY KEY (metric_id, key)
) STRICT, WITHOUT ROWID;
CREATE INDEX metric_value_by_key ON metric_value (key);
