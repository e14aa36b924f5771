-- The tables of the store, version 4; its views are in views.sql. docs/reference/store.md describes them all. Units are in the
-- names of columns. Columns stand where they are described (eval/trial/row.h, eval/store/rows.h,
-- eval/store/search_tables.h and others); definition.cc puts them in here, in place of what stands in double braces.
-- Content tables (robot, controller, resolved_suite, world) are addressed by the hash of their text, so that the
-- same thing is kept once whatever run brought it, and stores of several machines can be joined.

-- A robot as read: names, limits, URDF text, hull vertices; enough to build it again without any other file.
CREATE TABLE robot (
  id INTEGER PRIMARY KEY,
  {{columns of robot}}
) STRICT;

-- A controller's parameters, defaults included.
CREATE TABLE controller (
  id INTEGER PRIMARY KEY,
  {{columns of controller}}
) STRICT;

-- Whole resolved suites as they were run.
CREATE TABLE resolved_suite (
  id INTEGER PRIMARY KEY,
  {{columns of resolved_suite}}
) STRICT;

-- A suite's setting: everything that its controllers share (robot, worlds, simulation, rules). The same name with
-- another setting is another row, shown as NAME@2, NAME@3 ...: rates over different settings are never pooled.
CREATE TABLE suite (
  id INTEGER PRIMARY KEY,
  {{columns of suite}}
  UNIQUE (file_name, setting_hash)
) STRICT;

-- One column of an evaluation: a controller of a suite, at one sweep point.
CREATE TABLE point (
  id INTEGER PRIMARY KEY,
  {{columns of point}}
  UNIQUE (suite_id, controller_name, label, content_hash),
  UNIQUE (suite_id, controller, label)
) STRICT;

-- Worlds as plain numbers.
CREATE TABLE world (
  id INTEGER PRIMARY KEY,
  {{columns of world}}
) STRICT;

-- One call of the program that wrote into this store.
CREATE TABLE invocation (
  id INTEGER PRIMARY KEY,
  {{columns of invocation}}
) STRICT;

-- Results. Deterministic columns only: any number of threads, any machine of one class gives the same bits.
-- NULL: the metric does not exist for this trial.
CREATE TABLE trial (
  key BLOB PRIMARY KEY CHECK (length(key) = 16),            -- hash of everything that decides the row
  trial TEXT NOT NULL GENERATED ALWAYS AS (lower(substr(hex(key), 1, 16))) VIRTUAL,
  world_id INTEGER NOT NULL REFERENCES world (id),
  {{columns of trial}}
) STRICT, WITHOUT ROWID;
CREATE INDEX trial_by_name ON trial (trial);
CREATE INDEX trial_by_world ON trial (world_id);

-- How a trial came to be: never part of a comparison.
CREATE TABLE execution (
  key BLOB PRIMARY KEY REFERENCES trial (key),
  invocation_id INTEGER NOT NULL REFERENCES invocation (id),
  {{columns of execution}}
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
  {{summary columns}},
  PRIMARY KEY (point_id, world_index)
) STRICT, WITHOUT ROWID;
CREATE INDEX point_trial_by_key ON point_trial (key, family);
{{summary index}}
CREATE INDEX point_trial_by_time ON point_trial (point_id, time_to_goal_s);

-- Time series, one sample per control step, compressed; layout in docs/reference/store.md.
CREATE TABLE samples (
  key BLOB PRIMARY KEY REFERENCES trial (key),
  {{columns of samples}}
) STRICT;

-- Metrics that suites define themselves: an SQL expression over a trial's samples.
CREATE TABLE metric (
  id INTEGER PRIMARY KEY,
  {{columns of metric}}
  UNIQUE (file_name, expression)
) STRICT;

CREATE TABLE metric_value (
  metric_id INTEGER NOT NULL REFERENCES metric (id),
  key BLOB NOT NULL REFERENCES trial (key),
  {{columns of metric_value}}
  PRIMARY KEY (metric_id, key)
) STRICT, WITHOUT ROWID;
CREATE INDEX metric_value_by_key ON metric_value (key);

-- Gain tuning (moma tune): one search over gains, identified by everything that decides its path, so that it can be
-- resumed. Its trials are in table `trial` under their keys, without a point; the verdict's trials belong to a suite
-- of their own, NAME-held-out.
CREATE TABLE tune_search (
  id INTEGER PRIMARY KEY,
  {{columns of tune_search}}
) STRICT;

CREATE TABLE tune_variable (
  search_id INTEGER NOT NULL REFERENCES tune_search (id),
  variable INTEGER NOT NULL,                                -- from 0, as in candidates
  {{columns of tune_variable}}
  PRIMARY KEY (search_id, variable)
) STRICT, WITHOUT ROWID;

-- Every candidate measured, in order; what a resumed search is replayed from.
CREATE TABLE tune_evaluation (
  search_id INTEGER NOT NULL REFERENCES tune_search (id),
  {{columns of tune_evaluation}}
  PRIMARY KEY (search_id, evaluation)
) STRICT;

-- The best few, measured on further worlds; place 0 was chosen.
CREATE TABLE tune_finalist (
  search_id INTEGER NOT NULL REFERENCES tune_search (id),
  place INTEGER NOT NULL,
  {{columns of tune_finalist}}
  PRIMARY KEY (search_id, place)
) STRICT, WITHOUT ROWID;

-- Change of the objective around the found values: one gain moved alone (other NULL), or two together, where
-- `change` is what the joint move adds to the sum of the single ones.
CREATE TABLE tune_sensitivity (
  search_id INTEGER NOT NULL REFERENCES tune_search (id),
  entry INTEGER NOT NULL,
  {{columns of tune_sensitivity}}
  PRIMARY KEY (search_id, entry)
) STRICT, WITHOUT ROWID;

-- The found gains against another controller on worlds that took no part in the search.
CREATE TABLE tune_comparison (
  search_id INTEGER NOT NULL REFERENCES tune_search (id),
  entry INTEGER NOT NULL,
  {{columns of tune_comparison}}
  PRIMARY KEY (search_id, entry)
) STRICT, WITHOUT ROWID;
