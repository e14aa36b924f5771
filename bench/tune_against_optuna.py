#!/usr/bin/env python3
"""moma tune against Optuna's TPE: same suite, gains, ranges, objective and budget of trials, several seeds each.

Both are judged on the same held-out worlds. Needs `pip install optuna` (any environment) and a built moma:

    python3 bench/tune_against_optuna.py --moma build/moma --trials 12000 --seeds 1 2 3 4 5

Optuna evaluates each candidate by `moma run` on all worlds of the search, as a user would; its store is the same
kind of file, so that the objective is one SQL expression over v_trials. With --racing, moma tune runs twice more: without
cutting candidates short on the same budget, and cutting them short on 70 % of it. Prints a Markdown table.
"""
import argparse
import math
import os
import pathlib
import re
import sqlite3
import subprocess
import sys
import tempfile
import time

# The objective of both: a success is worth 60 s, a collision costs 60 s, and command change as in the default one.
OBJECTIVE = ("{minimize: {success: -60, collision: 60, time_to_goal_s: {weight: 1, when_null: 0}, "
             "command_change_mean: {weight: 50, when_null: 1}}}")
SQL = """SELECT count(*), avg(-60.0 * (outcome = 'success') + 60.0 * (outcome = 'collision')
                + coalesce(time_to_goal_s, 0) + 50 * coalesce(command_change_mean, 1))
         FROM v_trials WHERE suite = 'optuna' AND controller = ?"""


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--moma", default="build/moma")
    parser.add_argument("--suite", default="configs/suites/tune-frankie.yaml")
    parser.add_argument("--controller", default="holistic")
    parser.add_argument("--trials", type=int, default=12000, help="budget of each search")
    parser.add_argument("--worlds", type=int, default=100, help="per candidate")
    parser.add_argument("--held-out", type=int, default=1000)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3, 4, 5])
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--racing", action="store_true", help="show what cutting short saves")
    return parser.parse_args()


def moma(options, *words):
    done = subprocess.run([options.moma, *words, "--threads", str(options.threads)], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(words)}\n{done.stderr}")
    return done.stdout


def variables(db):
    """Key, bounds, scale, start and found value of each gain, from a search's store."""
    with sqlite3.connect(db) as store:
        return store.execute("SELECT key, lower, upper, scale, start, found FROM tune_variable ORDER BY variable").fetchall()


def tune(options, db, seed, trials, *words):
    begin = time.monotonic()
    moma(options, "tune", options.suite, "-o", str(db), "--gains", str(db.with_suffix(".yaml")), "--no-verdict", "-q",
         "--set", f"tune.seed={seed}", "--set", f"tune.budget.trials={trials}",
         "--set", f"tune.worlds={options.worlds}", "--set", f"tune.objective={OBJECTIVE}",
         "--set", "tune.constraints=null", "--set", "tune.sensitivity=none", *words)
    seconds = time.monotonic() - begin
    return {key: found for key, *_, found in variables(db)}, seconds


def settings(gains):
    return [word for key, value in gains.items() for word in ("--set", f"{key}={value!r}")]


def optuna_search(options, folder, seed, space):
    import optuna
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    db = folder / f"optuna-{seed}.db"

    def objective(trial):
        gains = {key: float(f"{trial.suggest_float(key, low, high, log=scale == 'log'):.6g}")
                 for key, low, high, scale, _, _ in space}
        moma(options, "run", options.suite, "-o", str(db), "-q", "--trials", str(options.worlds), "--set", "name=optuna",
             *settings(gains))
        name = options.controller if trial.number == 0 else f"{options.controller}@{trial.number + 1}"
        with sqlite3.connect(db) as store:
            n, cost = store.execute(SQL, (name,)).fetchone()
        if n != options.worlds:
            raise optuna.TrialPruned(f"{name}: {n} trials")   # the same gains again: nothing new
        return cost

    begin = time.monotonic()
    study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=seed, multivariate=True))
    study.enqueue_trial({key: start for key, _, _, _, start, _ in space})
    study.optimize(objective, n_trials=options.trials // options.worlds)
    gains = {key: float(f"{value:.6g}") for key, value in study.best_params.items()}
    return gains, time.monotonic() - begin


def held_out(options, folder, name, gains):
    db = folder / "held-out.db"
    moma(options, "run", options.suite, "-o", str(db), "-q", "--trials", str(options.held_out), "--seed", "1007",
         "--set", f"name={name}", *settings(gains))
    with sqlite3.connect(db) as store:
        return store.execute("SELECT family, n, success_rate, success_low, success_high, collision_rate, command_change_mean "
                             "FROM v_summary WHERE suite = ? ORDER BY family", (name,)).fetchall()


def main():
    options = arguments()
    rows = []
    with tempfile.TemporaryDirectory() as path:
        folder = pathlib.Path(path)
        for seed in options.seeds:
            db = folder / f"tune-{seed}.db"
            searches = {"moma tune": lambda: tune(options, db, seed, options.trials),
                        "Optuna TPE": lambda: optuna_search(options, folder, seed, variables(db))}
            if options.racing:
                searches["moma tune, 70 % of the trials"] = lambda: tune(
                    options, folder / f"less-{seed}.db", seed, options.trials * 7 // 10)
                searches["moma tune, racing: none"] = lambda: tune(
                    options, folder / f"whole-{seed}.db", seed, options.trials, "--set", "tune.racing=none")
            for name, search in searches.items():
                found, seconds = search()
                rows.append((name, seed, seconds, held_out(options, folder, re.sub(r"\W+", "-", f"{name} {seed}"), found)))
                print(f"{name}, seed {seed}: {seconds:.0f} s, {rows[-1][3]}", file=sys.stderr)
    families = [row[0] for row in rows[0][3]]
    print("| search | seed | wall time s | " + " | ".join(f"{f}: success %, collisions %, change" for f in families) + " |")
    print("| --- " * (3 + len(families)) + "|")
    for search, seed, seconds, result in sorted(rows, key=lambda row: (row[0], row[1])):
        cells = [f"{100 * s:.1f} [{100 * low:.1f}, {100 * high:.1f}], {100 * c:.1f}, {change:.3f}"
                 for _, _, s, low, high, c, change in result]
        print(f"| {search} | {seed} | {seconds:.0f} | " + " | ".join(cells) + " |")
    for search in searches:
        means = [sum(r[3][i][2] for r in rows if r[0] == search) / len(options.seeds) for i in range(len(families))]
        spread = [math.sqrt(sum((r[3][i][2] - m) ** 2 for r in rows if r[0] == search) / max(1, len(options.seeds) - 1))
                  for i, m in enumerate(means)]
        print(f"{search}: " + ", ".join(f"{f} {100 * m:.1f} % (sd {100 * s:.1f})" for f, m, s in zip(families, means, spread)))


if __name__ == "__main__":
    main()
