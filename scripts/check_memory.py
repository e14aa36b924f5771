#!/usr/bin/env python3
"""Lets single allocations of moma's commands fail, at random, and says what did not end as it should.

  scripts/check_memory.py SECONDS [SEED]      needs build/ (scripts/setup.sh all)

A command that runs out of memory ends by a message and exit code 2 (3 where a part of its work is kept), or does what it
always does: then what it printed or wrote is compared. Each line but the last is a fault, its allocation counted from the
program's start (tests/support/fail_nth.c).
"""

import hashlib
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CONFIGS = ROOT / "configs"
SUITE = f"""robot: {CONFIGS}/robots/frankie.yaml
controllers: {{moma: {CONFIGS}/controllers/moma.yaml, neo: {CONFIGS}/controllers/neo.yaml}}
worlds: {{seed: 1, families: {{open: {{}}, clutter: {{}}}}}}
simulation: {{mode: dynamic, time_limit: 0.1}}
success: {{dwell: 0.02}}
trials: 1
"""
RUN = "samples: all\nmetrics: {fastest: max(abs(command0))}\n" + (
    f"sweep: {{points: [{{disturbances: none}}, {{disturbances: {CONFIGS}/disturbances/realistic.yaml}}]}}\n")
TUNE = """samples: none
tune:
  controller: neo
  variables: {controller.k_epsilon: {range: [0.1, 5], scale: log, start: 1}}
  objective: {maximize: manip_mean}
  budget: {trials: 10}
  worlds: 2
  confirm: {candidates: 1, worlds: 1}
  sensitivity: none
  held_out: {count: 2}
"""
# What is in a store, but for times and what its runs were told.
STORED = " UNION ALL ".join(f"SELECT count(*) FROM {table}" for table in
                            ("trial", "samples", "point_trial", "metric_value", "execution", "invocation"))
SERIES = "SELECT count(*), sum(s.t) FROM v_trials AS t, samples(t.trial) AS s"

# Arguments, and what is compared: "words" that were printed, a "store" or a "folder" that was written, or "" for neither:
# times are in it.
COMMANDS = {
    "run": (["run", "run.yaml", "-o", "out.db", "-q", "--threads", "1"], "store", "out.db"),
    "run, kinematic": (["run", "run.yaml", "-o", "out.db", "-q", "--threads", "1", "--set", "simulation.mode=kinematic"],
                       "store", "out.db"),
    "run, some there": (["run", "run.yaml", "-o", "more.db", "-q", "--threads", "1", "--set", "trials=2"], "store", "more.db"),
    "merge": (["merge", "out.db", "a.db", "b.db"], "store", "out.db"),
    "tune": (["tune", "tune.yaml", "-o", "out.db", "--gains", "out.yaml", "-q"], "", "out.db"),
    "verify": (["verify", "a.db"], "words", ""),
    "query": (["query", "a.db", "@summary", "-f", "csv"], "words", ""),
    "query samples": (["query", "a.db", SERIES, "-f", "json"], "words", ""),
    "compare": (["compare", "a.db", "moma:disturbances=none", "neo:disturbances=none", "--json"], "words", ""),
    "replay": (["replay", "a.db", "TRIAL"], "words", ""),
    "report": (["report", "a.db", "b.db", "-o", "out.html"], "", "out.html"),
    "robot": (["robot", f"{CONFIGS}/robots/lift_ur5.yaml", "--json"], "words", ""),
    "draft": (["robot", f"{CONFIGS}/robots/panda.urdf"], "words", ""),
    "solve": (["solve", f"{ROOT}/tests/data/qp_cases/cases/frankie_100.json"], "words", ""),
    "world": (["world", "run.yaml", "0"], "words", ""),
    "check": (["check", f"{CONFIGS}/suites/safe-ablation.yaml"], "", ""),
    "keys": (["keys"], "words", ""),
}


class Commands:
    def __init__(self, folder):
        self.folder = folder
        (folder / "run.yaml").write_text(SUITE + RUN)
        (folder / "tune.yaml").write_text(SUITE + TUNE)
        self.moma("run", "run.yaml", "-o", "a.db", "-q")
        self.moma("run", "run.yaml", "-o", "b.db", "-q", "--set", "worlds.seed=2")
        self.trial = self.moma("query", "a.db", "SELECT trial FROM v_trials LIMIT 1", "-f", "csv").split()[-1]

    def moma(self, *arguments):
        return subprocess.run([ROOT / "build/moma", *arguments], cwd=self.folder, capture_output=True, text=True,
                              check=True).stdout

    def fail(self, name, at, on=False):
        """The command with this allocation failing (0: none), `on`: and all later ones."""
        arguments, _, made = COMMANDS[name]
        if made:
            subprocess.run(f"rm -rf {made}*", shell=True, cwd=self.folder, check=True)
        if made == "more.db":
            shutil.copy(self.folder / "a.db", self.folder / made)
        environment = dict(os.environ, LD_PRELOAD=ROOT / "build/tests/fail_nth.so", MOMA_FAIL_CALL="malloc",
                           MOMA_FAIL_AT=str(at), MOMA_FAIL_ON=str(int(on)), MOMA_FAIL_LOG=self.folder / "calls")
        words = [self.trial if word == "TRIAL" else word for word in arguments]
        return subprocess.run([ROOT / "build/moma", *words], cwd=self.folder, env=environment, capture_output=True,
                              text=True, timeout=300)

    def result(self, name, done):
        _, kind, made = COMMANDS[name]
        if kind == "words":
            return done.stdout
        if kind == "store":
            return self.moma("query", made, STORED, "-f", "csv") + self.moma("verify", "--hash", made).split()[-1]
        if kind == "folder":
            files = sorted((self.folder / made).iterdir())
            return [(file.name, hashlib.sha256(file.read_bytes()).hexdigest()) for file in files]
        return None


def main(seconds, seed):
    draws = random.Random(seed)
    tried = faults = 0
    with tempfile.TemporaryDirectory(dir="/dev/shm" if os.path.isdir("/dev/shm") else None) as folder:
        commands = Commands(Path(folder))
        whole = {}
        for name in COMMANDS:
            done = commands.fail(name, 0)
            assert done.returncode == 0, f"{name}: {done.stderr}"
            whole[name] = int((Path(folder) / "calls").read_text()), commands.result(name, done)
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            name = draws.choice(list(COMMANDS))
            at, on = draws.randint(1, whole[name][0]), draws.random() < 0.1
            tried += 1
            try:
                done = commands.fail(name, at, on)
            except subprocess.TimeoutExpired:
                fault = "HANGS"
            else:
                if done.returncode not in (0, 2, 3) or "internal error" in done.stderr or "terminate" in done.stderr:
                    fault = f"ENDS with {done.returncode}: {done.stderr[-300:]}"
                elif done.returncode != 0 and "moma: " not in done.stderr:
                    fault = "SAYS nothing"
                elif done.returncode == 0 and commands.result(name, done) != whole[name][1]:
                    fault = "DIFFERS from what it does with enough memory"
                else:
                    continue
            faults += 1
            print(f"{name}, allocation {at}{' and all later ones' if on else ''}: {fault}", flush=True)
    print(f"{tried} failing allocations of {len(COMMANDS)} commands: {faults} faults (seed {seed})")
    return 1 if faults else 0


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    sys.exit(main(float(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) == 3 else 1))
