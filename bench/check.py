#!/usr/bin/env python3
"""Whether one build of moma is slower than another: both do the same trials, in turns, on one thread.

    bench/check.py BASE NEW [--rounds 11] [--slower 0.05]

BASE and NEW are programs. What is compared is processor time per control step, so that neither other work on the machine nor
trials that end otherwise count. Of each kind of trial: the median over the rounds of NEW's time divided by BASE's in
the same round, and the interval that holds the true median with at least 95 % (order statistics: nothing is assumed about the
noise). Exit code 1 where a whole interval lies above 1 + slower; 0 else; 2 for bad input.
"""
import argparse
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
SUITE = ROOT / "bench/peers/scenes.yaml"
# Mode, controller, trials: about a second each.
WORK = {
    "kinematic, holistic": ("kinematic", "holistic", 24),
    "dynamic, holistic": ("dynamic", "holistic", 8),
    "dynamic, moma": ("dynamic", "moma", 4),
}


class Refused(Exception):
    pass


def interval(values, confidence=0.95):
    """Of the median, by order statistics: the tightest pair of equal ranks from both ends that holds it with `confidence`;
    the extremes where there are too few values for any."""
    values, n = sorted(values), len(values)
    rank, outside = 0, 0.0
    while rank < (n - 1) // 2:
        outside += 2 * math.comb(n, rank) / 2**n
        if outside > 1 - confidence:
            break
        rank += 1
    rank = max(0, rank - 1)
    return values[rank], values[n - 1 - rank]


def verdict(base, new, slower):
    """(median ratio, interval, word) of the rounds' times."""
    ratios = [n / b for b, n in zip(base, new, strict=True)]
    low, high = interval(ratios)
    word = "SLOWER" if low > 1 + slower else "faster" if high < 1 else "not shown to be slower"
    return statistics.median(ratios), (low, high), word


def step_time(program, mode, controller, trials, folder):
    """us of processor time per control step, whole process."""
    store = pathlib.Path(folder) / "check.db"
    for file in pathlib.Path(folder).glob("check.db*"):
        file.unlink()
    command = [program, "run", SUITE, "-o", store, "-q", "--threads", "1", "--trials", trials, "--set", "samples=none", "--set",
               f"simulation.mode={mode}", "--set", f"controllers={{c: {ROOT}/configs/controllers/{controller}.yaml}}"]
    with tempfile.TemporaryFile() as err:
        process = subprocess.Popen([str(word) for word in command], stdout=subprocess.DEVNULL, stderr=err)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            err.seek(0)
            raise Refused(f"{program} run: exit code {process.returncode}: {err.read().decode().strip()}")
    answer = subprocess.run([str(program), "query", str(store), "SELECT sum(steps) AS steps FROM v_trials", "-f", "json"],
                            capture_output=True, text=True, check=True)
    return 1e6 * (usage.ru_utime + usage.ru_stime) / json.loads(answer.stdout)[0]["steps"]


def measure(programs, rounds, folder):
    times = {name: {label: [] for label in programs} for name in WORK}
    for round_number in range(rounds):
        for name, work in WORK.items():
            order = list(programs) if round_number % 2 == 0 else list(reversed(programs))
            for label in order:
                times[name][label].append(step_time(programs[label], *work, folder))
        print(f"round {round_number + 1} of {rounds}", file=sys.stderr)
    return times


def arguments(words):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("base", type=pathlib.Path)
    parser.add_argument("new", type=pathlib.Path)
    parser.add_argument("--rounds", type=int, default=11, help="at least 6, fewer of which hold no median with 95 %%")
    parser.add_argument("--slower", type=float, default=0.05, help="part that is borne (0.05)")
    options = parser.parse_args(words)
    if options.rounds < 6:
        parser.error("--rounds: at least 6")
    if not options.slower >= 0:
        parser.error("--slower: at least 0")
    for program in (options.base, options.new):
        if not os.access(program, os.X_OK) or program.is_dir():
            parser.error(f"{program} is no program")
    return options


def main(words=None):
    options = arguments(words)
    with tempfile.TemporaryDirectory() as folder:
        try:
            times = measure({"base": options.base.resolve(), "new": options.new.resolve()}, options.rounds, folder)
        except Refused as refused:
            print(refused, file=sys.stderr)
            return 2
    failed = False
    print(f"{'trials':<22} {'base us':>9} {'new us':>9} {'ratio':>7}  95 % of the median")
    for name, found in times.items():
        ratio, (low, high), word = verdict(found["base"], found["new"], options.slower)
        failed = failed or word == "SLOWER"
        base, new = (statistics.median(found[label]) for label in ("base", "new"))
        print(f"{name:<22} {base:9.1f} {new:9.1f} {ratio:7.3f}  [{low:.3f}, {high:.3f}] {word}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
