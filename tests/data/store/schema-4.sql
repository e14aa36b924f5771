-- The tables of the store, version 4; its views are in views.sql. docs/store.md describes them all. Units are in the names of columns.
-- Content tables (robot, controller, resolved_suite, world) are addressed by the hash of their text, so that the
-- same thing is kept once whatever run brought it, and stores of several machines can be joined.

-- A robot as read: names, limits, URDF text, hull vertices; enough to build it again without any other file.
CREATE TABLE robot (
  id INTEGER PRIMARY KEY,
  hash BLOB NOT NULL UNIQUE CHECK (length(hash) = 16),      -- XXH3-128 of `resolved`
  name TEXT NOT NULL,
  resolved TEXT NOT NULL CHECK (json_valid(resolved))
) STRICT;

-- A controller's parameters, defaults included.
CREATE TABLE controller (
  id INTEGER PRIMARY KEY,
  hash BLOB NOT NULL UNIQUE CHECK (length(hash) = 16),
  resolved TEXT NOT NULL CHECK (json_valid(resolved))
) STRICT;

-- Whole resolved suites as they were run.
CREATE TABLE resolved_suite (
  id INTEGER PRIMARY KEY,
  hash BLOB NOT NULL UNIQUE CHECK (length(hash) = 16),
  resolved TEXT NOT NULL CHECK (json_valid(resolved))
) STRICT;

-- A suite's setting: everything that its controllers share (robot, worlds, simulation, rules). The same name with
-- another setting is another row, shown as NAME@2, NAME@3 ...: rates over different settings are never pooled.
CREATE TABLE suite (
  id INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE,                                -- as shown
  file_name TEXT NOT NULL,                                  -- as in the suite file
  setting_hash BLOB NOT NULL CHECK (length(setting_hash) = 16),
  UNIQUE (file_name, setting_hash)
) STRICT;

-- One column of an evaluation: a controller of a suite, at one sweep point.
CREATE TABLE point (
  id INTEGER PRIMARY KEY,
  suite_id INTEGER NOT NULL REFERENCES suite (id),
  controller TEXT NOT NULL,                                 -- as shown: changed parameters make NAME@2 ...
  controller_name TEXT NOT NULL,                            -- as in the suite file
  label TEXT NOT NULL,                                      -- '' without a sweep
  params TEXT NOT NULL CHECK (json_valid(params)),          -- the swept keys and their values
  content_hash BLOB NOT NULL CHECK (length(content_hash) = 16),
  robot_id INTEGER NOT NULL REFERENCES robot (id),
  controller_id INTEGER NOT NULL REFERENCES controller (id),
  mode TEXT NOT NULL CHECK (mode IN ('kinematic', 'dynamic')),
  control_period_s REAL NOT NULL,
  physics_step_s REAL NOT NULL,
  time_limit_s REAL NOT NULL,
  success_position_m REAL NOT NULL,
  success_orientation_rad REAL NOT NULL,
  success_dwell_s REAL NOT NULL,
  stuck_time_s REAL NOT NULL,
  stuck_motion REAL NOT NULL,                               -- m or rad
  infeasible_time_s REAL NOT NULL,
  worlds TEXT NOT NULL CHECK (json_valid(worlds)),          -- the worlds section, resolved
  simulation_version INTEGER NOT NULL,
  resolved_suite_id INTEGER NOT NULL REFERENCES resolved_suite (id),   -- where to build this point from again
  resolved_position INTEGER NOT NULL,                       -- its place among that suite's points, from 0
  UNIQUE (suite_id, controller_name, label, content_hash),
  UNIQUE (suite_id, controller, label)
) STRICT;

-- Worlds as plain numbers.
CREATE TABLE world (
  id INTEGER PRIMARY KEY,
  hash BLOB NOT NULL UNIQUE CHECK (length(hash) = 16),      -- XXH3-128 of `json`
  world_index INTEGER NOT NULL,
  seed TEXT NOT NULL,                                       -- unsigned 64 bit: more than INTEGER holds
  family TEXT NOT NULL,
  goal_distance_m REAL,
  objects INTEGER NOT NULL,
  witness_clearance_m REAL,
  blocked_fraction REAL,
  narrowest_gap_m REAL,
  json TEXT NOT NULL CHECK (json_valid(json))
) STRICT;

-- One call of the program that wrote into this store.
CREATE TABLE invocation (
  id INTEGER PRIMARY KEY,
  suite_id INTEGER NOT NULL REFERENCES suite (id),
  resolved_suite_id INTEGER NOT NULL REFERENCES resolved_suite (id),
  started TEXT NOT NULL,                                    -- UTC, ISO 8601
  ended TEXT,                                               -- NULL: still running, or killed
  status TEXT NOT NULL CHECK (status IN ('running', 'finished', 'stopped', 'failed')),
  arguments TEXT NOT NULL CHECK (json_valid(arguments)),    -- the command line, a list
  moma_version TEXT NOT NULL,
  git_commit TEXT,                                          -- NULL: not built from a git checkout
  git_dirty INTEGER CHECK (git_dirty IN (0, 1)),
  build_type TEXT NOT NULL,
  compiler TEXT NOT NULL,
  compiler_flags TEXT NOT NULL,
  libraries TEXT NOT NULL CHECK (json_valid(libraries)),    -- name: version
  host TEXT NOT NULL,
  os TEXT NOT NULL,
  cpu TEXT NOT NULL,
  cpu_count INTEGER NOT NULL,
  threads INTEGER NOT NULL,
  machine_class TEXT NOT NULL,                              -- equal classes must give equal bits
  trials_planned INTEGER NOT NULL,
  trials_present INTEGER NOT NULL,                          -- found already stored
  trials_done INTEGER NOT NULL
) STRICT;

-- Results. Deterministic columns only: any number of threads, any machine of one class gives the same bits.
-- NULL: the metric does not exist for this trial.
CREATE TABLE trial (
  key BLOB PRIMARY KEY CHECK (length(key) = 16),            -- hash of everything that decides the row
  trial TEXT NOT NULL GENERATED ALWAYS AS (lower(substr(hex(key), 1, 16))) VIRTUAL,
  world_id INTEGER NOT NULL REFERENCES world (id),
  outcome TEXT NOT NULL CHECK (outcome IN ('success', 'collision', 'timeout', 'stuck', 'joint_limit', 'tipped',
                                           'infeasible', 'diverged', 'error')),
  reason TEXT,
  link TEXT,
  object TEXT,
  time_end_s REAL NOT NULL,
  time_to_goal_s REAL,
  position_error_m REAL,
  orientation_error_rad REAL,
  path_ee_m REAL,
  path_base_m REAL,
  manip_mean REAL,
  manip_min REAL,
  manip_final REAL,
  manip_all_mean REAL,
  manip_all_min REAL,
  manip_all_final REAL,
  clearance_min_m REAL,
  clearance_self_min_m REAL,
  limit_margin_min REAL,
  collision_count INTEGER NOT NULL,
  collision_time_s REAL,
  collision_depth_m REAL,
  jerk_ee_rms REAL,
  jerk_joint_rms REAL,
  command_change_mean REAL,
  energy_j REAL,
  slack_mean REAL,
  slack_max REAL,
  active_rows_mean REAL,
  qp_infeasible INTEGER NOT NULL,
  fallback_no_acceleration INTEGER NOT NULL,
  fallback_relaxed INTEGER NOT NULL,
  fallback_brake INTEGER NOT NULL,
  slip_max_m_s REAL,
  tracking_error_rms REAL,
  lcp_messages INTEGER NOT NULL,
  steps INTEGER NOT NULL,
  detector_checks INTEGER NOT NULL DEFAULT 0,
  detector_disagreements INTEGER NOT NULL DEFAULT 0,
  detector_deepest_m REAL
) STRICT, WITHOUT ROWID;
CREATE INDEX trial_by_name ON trial (trial);
CREATE INDEX trial_by_world ON trial (world_id);

-- How a trial came to be: never part of a comparison.
CREATE TABLE execution (
  key BLOB PRIMARY KEY REFERENCES trial (key),
  invocation_id INTEGER NOT NULL REFERENCES invocation (id),
  t_solve_median_us REAL,
  t_solve_p99_us REAL,
  t_solve_max_us REAL,
  t_step_median_us REAL,
  t_step_p99_us REAL,
  t_step_max_us REAL,
  t_trial_us REAL,
  deadline_misses INTEGER NOT NULL                          -- steps longer than the control period
) STRICT, WITHOUT ROWID;
CREATE INDEX execution_by_invocation ON execution (invocation_id);

-- Which trials belong to which point. A trial is shared by all points with the same content. What summaries ask for
-- is kept here a second time (rows of `trial` never change), in the order in which they ask: of a million trials,
-- v_summary then reads 100 MB one after the other instead of a million rows of `trial` here and there.
CREATE TABLE point_trial (
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
CREATE INDEX point_trial_by_key ON point_trial (key, family);
CREATE INDEX point_trial_summary ON point_trial (point_id, family, time_to_goal_s, outcome, manip_mean,
                                                 clearance_min_m, command_change_mean);
CREATE INDEX point_trial_by_time ON point_trial (point_id, time_to_goal_s);

-- Time series, one sample per control step, compressed; layout in docs/store.md.
CREATE TABLE samples (
  key BLOB PRIMARY KEY REFERENCES trial (key),
  layout INTEGER NOT NULL,
  n INTEGER NOT NULL,                                       -- samples
  columns TEXT NOT NULL CHECK (json_valid(columns)),        -- names, in order
  data BLOB NOT NULL
) STRICT;

-- Metrics that suites define themselves: an SQL expression over a trial's samples.
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

-- Gain tuning (moma tune): one search over gains, identified by everything that decides its path, so that it can be
-- resumed. Its trials are in table `trial` under their keys, without a point; the verdict's trials belong to a suite
-- of their own, NAME-held-out.
CREATE TABLE tune_search (
  id INTEGER PRIMARY KEY,
  hash BLOB NOT NULL UNIQUE CHECK (length(hash) = 16),      -- XXH3-128 of `identity`
  suite TEXT NOT NULL,
  controller TEXT NOT NULL,
  identity TEXT NOT NULL CHECK (json_valid(identity)),
  objective TEXT NOT NULL,                                  -- in words
  unit TEXT NOT NULL,
  budget_trials INTEGER NOT NULL,
  started TEXT NOT NULL,                                    -- UTC, ISO 8601
  ended TEXT,
  status TEXT NOT NULL CHECK (status IN ('running', 'finished', 'stopped')),
  trials INTEGER,                                           -- measured by search and confirmation
  trials_saved INTEGER,                                     -- by cutting candidates short
  evaluations_cut INTEGER,
  held_out_suite TEXT,                                      -- as shown in v_trials
  verdict TEXT CHECK (verdict IN ('better', 'no difference shown', 'worse')),
  runs TEXT CHECK (runs IS NULL OR json_valid(runs)),       -- NLopt's runs: algorithm, trials, why it ended
  notes TEXT CHECK (notes IS NULL OR json_valid(notes))
) STRICT;

CREATE TABLE tune_variable (
  search_id INTEGER NOT NULL REFERENCES tune_search (id),
  variable INTEGER NOT NULL,                                -- from 0, as in candidates
  key TEXT NOT NULL,
  lower REAL NOT NULL,
  upper REAL NOT NULL,
  scale TEXT NOT NULL CHECK (scale IN ('linear', 'log', 'integer')),
  start REAL NOT NULL,
  found REAL,
  importance REAL,                                          -- share of the variance over the search
  PRIMARY KEY (search_id, variable)
) STRICT, WITHOUT ROWID;

-- Every candidate measured, in order; what a resumed search is replayed from.
CREATE TABLE tune_evaluation (
  search_id INTEGER NOT NULL REFERENCES tune_search (id),
  evaluation INTEGER NOT NULL,                              -- from 0
  phase TEXT NOT NULL CHECK (phase IN ('start', 'global', 'local', 'confirm', 'neighbour', 'sensitivity')),
  run INTEGER NOT NULL,
  candidate TEXT NOT NULL CHECK (json_valid(candidate)),    -- values in the order of tune_variable
  first_world INTEGER NOT NULL,                             -- worlds known before, of the search's order
  worlds INTEGER NOT NULL,                                  -- known after
  cut INTEGER NOT NULL CHECK (cut IN (0, 1)),
  valid INTEGER NOT NULL CHECK (valid IN (0, 1)),
  cost REAL NOT NULL,
  merit REAL NOT NULL,                                      -- cost and penalty; an estimate where cut
  constraints TEXT NOT NULL CHECK (json_valid(constraints)),
  measured BLOB NOT NULL,                                   -- doubles, little endian: cost and constraints per world
  PRIMARY KEY (search_id, evaluation)
) STRICT;

-- The best few, measured on further worlds; place 0 was chosen.
CREATE TABLE tune_finalist (
  search_id INTEGER NOT NULL REFERENCES tune_search (id),
  place INTEGER NOT NULL,
  candidate TEXT NOT NULL CHECK (json_valid(candidate)),
  search_merit REAL NOT NULL,
  merit REAL NOT NULL,
  neighbours REAL NOT NULL,                                 -- mean merit around it
  robust REAL NOT NULL,
  worlds INTEGER NOT NULL,
  PRIMARY KEY (search_id, place)
) STRICT, WITHOUT ROWID;

-- Change of the objective around the found values: one gain moved alone (other NULL), or two together, where
-- `change` is what the joint move adds to the sum of the single ones.
CREATE TABLE tune_sensitivity (
  search_id INTEGER NOT NULL REFERENCES tune_search (id),
  entry INTEGER NOT NULL,
  variable INTEGER NOT NULL,
  other INTEGER,
  value REAL,                                               -- the gain's; NULL for pairs
  change REAL NOT NULL,
  error REAL NOT NULL,                                      -- standard error
  valid INTEGER NOT NULL CHECK (valid IN (0, 1)),
  PRIMARY KEY (search_id, entry)
) STRICT, WITHOUT ROWID;

-- The found gains against another controller on worlds that took no part in the search.
CREATE TABLE tune_comparison (
  search_id INTEGER NOT NULL REFERENCES tune_search (id),
  entry INTEGER NOT NULL,
  family TEXT NOT NULL,                                     -- 'all': every family together
  other TEXT NOT NULL,                                      -- the controller compared with
  metric TEXT NOT NULL,
  n INTEGER NOT NULL,                                       -- worlds compared
  found REAL,                                               -- rate or mean
  found_low REAL,
  found_high REAL,
  theirs REAL,
  theirs_low REAL,
  theirs_high REAL,
  difference REAL,                                          -- found - theirs, paired
  difference_low REAL,
  difference_high REAL,
  p REAL,                                                   -- exact McNemar with Holm's correction; NULL for means
  verdict TEXT NOT NULL CHECK (verdict IN ('better', 'no difference shown', 'worse')),
  PRIMARY KEY (search_id, entry)
) STRICT, WITHOUT ROWID;
-- The views of the store. They are made anew whenever a store is migrated.
DROP VIEW IF EXISTS v_trials;
DROP VIEW IF EXISTS v_summary;
DROP VIEW IF EXISTS v_pairs;
DROP VIEW IF EXISTS v_metrics;
DROP VIEW IF EXISTS v_metric_summary;

CREATE VIEW v_trials AS
SELECT t.trial AS trial, s.name AS suite, r.name AS robot, p.controller AS controller, p.label AS point,
       p.params AS params, w.family AS family, w.world_index AS world, p.mode AS mode, t.outcome AS outcome,
       t.reason AS reason, t.link AS link, t.object AS object, t.time_end_s AS time_end_s,
       t.time_to_goal_s AS time_to_goal_s, t.position_error_m AS position_error_m,
       t.orientation_error_rad AS orientation_error_rad, t.path_ee_m AS path_ee_m, t.path_base_m AS path_base_m,
       t.manip_mean AS manip_mean, t.manip_min AS manip_min, t.manip_final AS manip_final,
       t.manip_all_mean AS manip_all_mean, t.manip_all_min AS manip_all_min, t.manip_all_final AS manip_all_final,
       t.clearance_min_m AS clearance_min_m, t.clearance_self_min_m AS clearance_self_min_m,
       t.limit_margin_min AS limit_margin_min, t.collision_count AS collision_count,
       t.collision_time_s AS collision_time_s, t.collision_depth_m AS collision_depth_m,
       t.jerk_ee_rms AS jerk_ee_rms, t.jerk_joint_rms AS jerk_joint_rms,
       t.command_change_mean AS command_change_mean, t.energy_j AS energy_j, t.slack_mean AS slack_mean,
       t.slack_max AS slack_max, t.active_rows_mean AS active_rows_mean, t.qp_infeasible AS qp_infeasible,
       t.fallback_no_acceleration AS fallback_no_acceleration, t.fallback_relaxed AS fallback_relaxed,
       t.fallback_brake AS fallback_brake, t.slip_max_m_s AS slip_max_m_s,
       t.tracking_error_rms AS tracking_error_rms, t.lcp_messages AS lcp_messages, t.steps AS steps,
       t.detector_checks AS detector_checks, t.detector_disagreements AS detector_disagreements,
       t.detector_deepest_m AS detector_deepest_m,
       e.t_solve_median_us AS t_solve_median_us, e.t_solve_p99_us AS t_solve_p99_us,
       e.t_solve_max_us AS t_solve_max_us, e.t_step_median_us AS t_step_median_us,
       e.t_step_p99_us AS t_step_p99_us, e.t_step_max_us AS t_step_max_us, e.t_trial_us AS t_trial_us
FROM point_trial AS m
JOIN point AS p ON p.id = m.point_id
JOIN suite AS s ON s.id = p.suite_id
JOIN robot AS r ON r.id = p.robot_id
JOIN trial AS t ON t.key = m.key
JOIN world AS w ON w.id = t.world_id
LEFT JOIN execution AS e ON e.key = t.key;

-- Rates with Wilson's 95 % interval (z = 1.959963984540054); the median is over successful trials, means over the
-- trials that have the value. Trials that ended by an error tell nothing of the controller: they are counted apart, in
-- `errors`, and are no part of n, rates and means. The index point_trial_summary has all that is read.
CREATE VIEW v_summary AS
WITH counted AS (
  SELECT point_id, family, sum(outcome <> 'error') AS n, sum(outcome = 'error') AS errors,
         1.0 * sum(outcome <> 'error') AS m, 1.0 * sum(outcome = 'success') AS successes,
         1.0 * sum(outcome = 'collision') AS collisions, 3.8414588206941245 AS zz, count(time_to_goal_s) AS arrived,
         avg(manip_mean) FILTER (WHERE outcome <> 'error') AS manip_mean, avg(clearance_min_m) FILTER (WHERE outcome <> 'error') AS clearance_min_m, avg(command_change_mean) FILTER (WHERE outcome <> 'error') AS command_change_mean
  FROM point_trial
  GROUP BY point_id, family
), ranked AS (
  SELECT point_id, family, time_to_goal_s,
         row_number() OVER (PARTITION BY point_id, family ORDER BY time_to_goal_s) AS place
  FROM point_trial
  WHERE time_to_goal_s IS NOT NULL
), medians AS (
  SELECT r.point_id, r.family, avg(r.time_to_goal_s) AS time_to_goal_median_s
  FROM ranked AS r
  JOIN counted AS c ON c.point_id = r.point_id AND c.family = r.family
  WHERE r.place IN ((c.arrived + 1) / 2, (c.arrived + 2) / 2)
  GROUP BY r.point_id, r.family
)
SELECT s.name AS suite, b.name AS robot, p.controller AS controller, p.label AS point, c.family AS family,
       p.mode AS mode, n, errors,
       successes / m AS success_rate,
       CASE WHEN m = 0 THEN NULL WHEN successes = 0 THEN 0.0 ELSE
         (successes + zz / 2 - sqrt(zz * (successes * (m - successes) / m + zz / 4))) / (m + zz) END AS success_low,
       CASE WHEN m = 0 THEN NULL WHEN successes = m THEN 1.0 ELSE
         (successes + zz / 2 + sqrt(zz * (successes * (m - successes) / m + zz / 4))) / (m + zz) END AS success_high,
       collisions / m AS collision_rate,
       CASE WHEN m = 0 THEN NULL WHEN collisions = 0 THEN 0.0 ELSE
         (collisions + zz / 2 - sqrt(zz * (collisions * (m - collisions) / m + zz / 4))) / (m + zz) END
         AS collision_low,
       CASE WHEN m = 0 THEN NULL WHEN collisions = m THEN 1.0 ELSE
         (collisions + zz / 2 + sqrt(zz * (collisions * (m - collisions) / m + zz / 4))) / (m + zz) END
         AS collision_high,
       d.time_to_goal_median_s AS time_to_goal_median_s, c.manip_mean AS manip_mean, c.clearance_min_m AS clearance_min_m, c.command_change_mean AS command_change_mean
FROM counted AS c
JOIN point AS p ON p.id = c.point_id
JOIN suite AS s ON s.id = p.suite_id
JOIN robot AS b ON b.id = p.robot_id
LEFT JOIN medians AS d ON d.point_id = c.point_id AND d.family = c.family;

-- Two points of one suite on the same world; each pair of points once, the one that was defined first as `a`. Whether a
-- trial that ended by an error would have succeeded is not known: NULL.
CREATE VIEW v_pairs AS
SELECT s.name AS suite, r.name AS robot, w.family AS family, w.world_index AS world, pa.mode AS mode,
       pa.controller AS controller_a, pa.label AS point_a, pb.controller AS controller_b, pb.label AS point_b,
       ta.trial AS trial_a, tb.trial AS trial_b, ta.outcome AS outcome_a, tb.outcome AS outcome_b,
       iif(ta.outcome = 'error', NULL, ta.outcome = 'success') AS success_a,
       iif(tb.outcome = 'error', NULL, tb.outcome = 'success') AS success_b,
       ta.time_to_goal_s AS time_to_goal_a_s, tb.time_to_goal_s AS time_to_goal_b_s
FROM point_trial AS ma
JOIN point AS pa ON pa.id = ma.point_id
JOIN point AS pb ON pb.suite_id = pa.suite_id AND pb.id > pa.id AND pb.mode = pa.mode AND pb.robot_id = pa.robot_id
JOIN point_trial AS mb ON mb.point_id = pb.id AND mb.world_index = ma.world_index
JOIN trial AS ta ON ta.key = ma.key
JOIN trial AS tb ON tb.key = mb.key AND tb.world_id = ta.world_id
JOIN world AS w ON w.id = ta.world_id
JOIN suite AS s ON s.id = pa.suite_id
JOIN robot AS r ON r.id = pa.robot_id;

-- Values of the suites' own metrics, one row per trial of a suite and metric.
CREATE VIEW v_metrics AS
SELECT t.trial AS trial, s.name AS suite, p.controller AS controller, p.label AS point, m.family AS family,
       m.world_index AS world, m.outcome AS outcome, d.name AS metric, x.value AS value
FROM metric AS d
JOIN metric_value AS x ON x.metric_id = d.id
JOIN trial AS t ON t.key = x.key
JOIN point_trial AS m ON m.key = x.key
JOIN point AS p ON p.id = m.point_id
JOIN suite AS s ON s.id = p.suite_id;

-- Means of the suites' own metrics over the trials that have the value and did not end by an error, as v_summary has
-- those of moma's.
CREATE VIEW v_metric_summary AS
SELECT s.name AS suite, r.name AS robot, p.controller AS controller, p.label AS point, m.family AS family,
       p.mode AS mode, d.name AS metric, count(x.value) AS n, avg(x.value) AS mean
FROM metric AS d
JOIN metric_value AS x ON x.metric_id = d.id
JOIN point_trial AS m ON m.key = x.key
JOIN point AS p ON p.id = m.point_id
JOIN suite AS s ON s.id = p.suite_id
JOIN robot AS r ON r.id = p.robot_id
WHERE m.outcome <> 'error'
GROUP BY p.id, m.family, d.id;
