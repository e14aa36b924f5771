#!/usr/bin/env python3
"""moma's speed beside that of its peers (bench/peers), in one run: what scripts/bench.sh calls.

    bench/speed.py --build build --peers .venv-bench-peers --toolbox .venv-bench-toolbox [--rounds 5] [--parts steps,trials,tail,scaling]

A round measures everything once, one after another, each round beginning elsewhere, all on one thread; a peer's control steps
stand between moma's, whose mean they are compared with. Figures are processor
time of the process (getrusage), so that what else the machine does counts little. Every single one is kept in
results/speed.json; bench/speed_page.py writes docs/studies/speed.md from that.
"""
import argparse
import json
import os
import pathlib
import platform
import resource
import subprocess
import sys
import tempfile
import time

import speed_scenes as scenes
from speed_scenes import ROOT, SUITE

PEERS = ROOT / "bench/peers"
ONE_THREAD = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS")}
MOMA_STEPS = 20000
MOMA_TRIALS = 100  # kinematic: so many that a process' start is a hundredth of it, which the peers' times leave out
CORES_TRIALS = 60


class Failed(Exception):
    pass


def load():
    """Cores that others keep busy, looked at for a second in which nothing of this runs. The system's load averages would
    count what was measured just before."""
    def busy():
        user, nice, system, _, _, *interrupts = map(int, open("/proc/stat").readline().split()[1:9])
        return user + nice + system + sum(interrupts)
    before = busy()
    time.sleep(1.0)
    return (busy() - before) / os.sysconf("SC_CLK_TCK")


def spent(command):
    """What a process printed and took: user and system time, greatest memory."""
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        process = subprocess.Popen([str(word) for word in command], stdout=out, stderr=err, cwd=ROOT,
                                   env={**os.environ, **ONE_THREAD, "PYTHONDONTWRITEBYTECODE": "1"})
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        err.seek(0)
        text = out.read().decode()
        if process.returncode != 0:
            raise Failed(err.read().decode().strip().splitlines()[-1:] or ["no word"])
    return text, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def last_json(command):
    return json.loads(spent(command)[0].strip().splitlines()[-1])


class Bench:
    def __init__(self, options, folder):
        self.moma = options.build / "moma"
        self.control = options.build / "moma_bench_control"
        self.python = {"toolbox": options.toolbox / "bin/python"}
        self.usual_python = options.peers / "bin/python"
        self.seconds, self.folder = options.seconds, folder
        probe = options.build / "tests/physics_probe"
        self.scenes = {name: scenes.make(name, self.moma, probe, folder, 10) for name in scenes.SCENES}

    def peer(self, module, scene, *words):
        python = self.python.get(module, self.usual_python)
        if not python.exists():
            raise Failed([f"{python} is missing"])
        return last_json([python, PEERS / f"{module}.py", *([self.scenes[scene]] if scene else []), *words])

    def beside(self, module, scene):
        """A peer's steps between moma's: the machine's pace changes within seconds."""
        before = self.moma_steps(scene, steps=MOMA_STEPS // 2)["us"]
        result = self.peer(module, scene, "--steps", self.seconds)
        return {**result, "moma_us": 0.5 * (before + self.moma_steps(scene, steps=MOMA_STEPS // 2)["us"])}

    def moma_steps(self, scene, controller=None, steps=MOMA_STEPS):
        file = self.folder / f"{scene}-{controller}.yaml"
        self.resolved(file, scene, controller)
        return last_json([self.control, file, steps])

    @staticmethod
    def resolved(file, scene, controller):
        """The scene's suite as a file of its own, for programs without --set."""
        words = scenes.settings(scene, controller=controller)[1::2]
        values = dict(word.split("=", 1) for word in words)
        family = values["worlds.families"]
        file.write_text(f"name: speed\nrobot: {values['robot']}\ncontrollers: {values['controllers']}\n"
                        f"worlds: {{seed: 7, families: {family}}}\nsimulation: {{mode: kinematic}}\ntrials: 1\n",
                        encoding="utf-8")

    def run(self, scene, mode, controller, count, *words, threads=1):
        return spent([self.moma, "run", SUITE, "-o", self.folder / "trials.db", "-q", "--trials", count, "--threads", threads,
                      "--set", "samples=none", *scenes.settings(scene, mode, controller), *words])

    def moma_again(self, *work):
        """Processor time of a run that finds every trial of the last one stored."""
        return self.run(*work)[1]

    def steps_of_trials(self):
        """Of the last run's, in the order in which they were begun."""
        rows = scenes.output(self.moma, "query", self.folder / "trials.db", "SELECT steps FROM v_trials ORDER BY world", "-f", "json")
        return [row["steps"] for row in json.loads(rows)]

    def moma_trials(self, scene, mode, controller, count, *words, threads=1):
        store = self.folder / "trials.db"
        for file in self.folder.glob("trials.db*"):
            file.unlink()
        begin = time.monotonic()
        _, cpu, memory = self.run(scene, mode, controller, count, *words, threads=threads)
        wall = time.monotonic() - begin
        row = json.loads(scenes.output(self.moma, "query", store, "SELECT count(*) AS trials, sum(steps) AS steps, "
                                       "sum(outcome = 'success') AS successes, sum(outcome = 'collision') AS collisions "
                                       "FROM v_trials", "-f", "json"))[0]
        return {"trials": row["trials"], "successes": row["successes"], "collisions": row["collisions"],
                "control_steps": row["steps"], "cpu_s": cpu, "wall_s": wall, "rss_mib": memory,
                "store_mib": store.stat().st_size / 2**20}


def rounds(bench, options, kept):
    work = {}
    if "steps" in options.parts:
        for scene, (_, usual, _) in scenes.SCENES.items():
            work[f"steps/{scene}/moma"] = lambda s=scene: bench.moma_steps(s)
            if usual == "holistic":
                work[f"steps/{scene}/moma, preset moma"] = lambda s=scene: bench.moma_steps(s, "moma", MOMA_STEPS // 10)
            for peer in ("toolbox", "mink_steps", "pink_steps", "proxqp_steps"):
                work[f"steps/{scene}/{peer}"] = lambda s=scene, p=peer: bench.beside(p, s)
        work["search//optuna_asks"] = lambda: bench.peer("optuna_asks", None)
    if "trials" in options.parts:
        for scene in ("frankie-0", "frankie-10"):
            work[f"kinematic/{scene}/moma"] = lambda s=scene: bench.moma_trials(s, "kinematic", "holistic", MOMA_TRIALS)
            for peer, count in (("toolbox", 1), ("mink_steps", 5), ("pink_steps", 1), ("proxqp_steps", 1)):
                work[f"kinematic/{scene}/{peer}"] = lambda s=scene, p=peer, n=count: bench.peer(p, s, "--trials", n)
            for controller in ("holistic", "moma"):
                name = "moma" if controller == "holistic" else "moma, preset moma"
                work[f"dynamic/{scene}/{name}"] = lambda s=scene, c=controller: bench.moma_trials(s, "dynamic", c, 5)
            work[f"dynamic/{scene}/mujoco_mink_trials"] = lambda s=scene: bench.peer("mujoco_mink_trials", s, "--trials", 5)
            work[f"dynamic/{scene}/mujoco_mink_trials, defaults"] = lambda s=scene: bench.peer(
                "mujoco_mink_trials", s, "--trials", 5, "--defaults")
    names, left_out = list(work), set()
    for round_number in range(options.rounds):
        first = round_number * 7 % max(1, len(names))
        for name in names[first:] + names[:first]:
            if name in left_out:
                continue
            try:
                result = work[name]()
            except Failed as failure:
                left_out.add(name)
                kept["left_out"][name] = str(failure.args[0])
                print(f"{name}: left out: {failure.args[0]}", file=sys.stderr)
                continue
            kept["rounds"].setdefault(name, []).append({"round": round_number, **result})
            save(kept, options.output)
            value = result.get("us") or 1e6 * result["cpu_s"] / result["control_steps"]
            print(f"round {round_number + 1}: {name}: {value:.1f} us", file=sys.stderr)


def tail(bench, options, kept):
    """The longest of many steps, as the machine is and with as many busy processes beside it as it has cores."""
    for label, busy in (("as it is", 0), ("loaded", os.cpu_count())):
        if busy and load() > 0.5 * busy:
            continue  # it is loaded as it is
        spinning = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(busy)]
        try:
            kept["tail"][label] = {"load": load(), **bench.moma_steps("frankie-10", steps=options.tail_steps)}
        finally:
            for process in spinning:
                process.kill()
                process.wait()


def scaling(bench, options, kept):
    """Cost and memory of a trial against the number of trials: short kinematic ones of a closed form."""
    for count in (100, 1000, 10000, 100000):
        if count <= options.most_trials:
            kept["scaling"].append(bench.moma_trials("frankie-0", "kinematic", "rrmc", count,
                                                     "--set", "simulation.time_limit=0.4"))


def span(weights, threads):
    """Time that threads need who take the next piece of work when they have done one."""
    busy = [0.0] * threads
    for weight in weights:
        first = busy.index(min(busy))
        busy[first] += weight
    return max(busy)


def cores(bench, kept):
    """Two threads against one: by wall time where nothing else runs. On a busy machine wall time tells nothing: there by what
    keeps two threads from taking half the time, each measured: what trials cost more side by side (processor time), what one
    thread does alone (a run that finds every trial stored) and how long one waits for the other at the end (control steps)."""
    work = ("frankie-10", "dynamic", "holistic", CORES_TRIALS)
    others = load()
    kept["cores"] = {"quiet": others <= 0.1 and (os.cpu_count() or 1) >= 2, "trials": CORES_TRIALS, "load": others,
                     "rounds": []}
    for _ in range(3):
        found = {threads: bench.moma_trials(*work, threads=threads) for threads in (1, 2)}
        steps = bench.steps_of_trials()
        alone = bench.moma_again(*work)
        kept["cores"]["rounds"].append({
            "wall": [found[1]["wall_s"], found[2]["wall_s"]], "cpu": [found[1]["cpu_s"], found[2]["cpu_s"]],
            "alone": alone, "share": span(steps, 2) / sum(steps)})


def save(kept, file):
    """Again and again: what was measured stays if the run is broken off."""
    file.parent.mkdir(exist_ok=True)
    file.write_text(json.dumps(kept, indent=1), encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build")
    parser.add_argument("--peers", type=pathlib.Path, default=ROOT / ".venv-bench-peers")
    parser.add_argument("--toolbox", type=pathlib.Path, default=ROOT / ".venv-bench-toolbox")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=0.5, help="of processor time for a peer's steps in a round")
    parser.add_argument("--tail-steps", type=int, default=1000000)
    parser.add_argument("--most-trials", type=int, default=100000)
    parser.add_argument("--parts", default="steps,trials,tail,scaling,cores")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=ROOT / "results/speed.json")
    options = parser.parse_args()
    options.parts = set(options.parts.split(","))
    # What an earlier run measured of other parts stays.
    kept = json.loads(options.output.read_text()) if options.output.exists() else {}
    kept.setdefault("rounds", {})
    kept.setdefault("left_out", {})
    kept["rounds"] = {name: values for name, values in kept["rounds"].items()
                      if ("steps" if name.split("/")[0] in ("steps", "search") else "trials") not in options.parts}
    empty = {"tail": {}, "scaling": [], "cores": {}}
    kept = {**empty, **kept}
    cpu = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "")
    kept["machine"] = {"cpu": cpu, "cores": os.cpu_count(), "system": platform.platform(terse=True),
                       "date": time.strftime("%Y-%m-%d")}
    others = load()
    kept["loads"] = {**kept.get("loads", {}), **{part: others for part in options.parts}}
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(options, pathlib.Path(folder))
        kept["moma"] = scenes.output(bench.moma, "-V").strip()
        parts = {"rounds": lambda: rounds(bench, options, kept), "tail": lambda: tail(bench, options, kept),
                 "scaling": lambda: scaling(bench, options, kept), "cores": lambda: cores(bench, kept)}
        for name, measure in parts.items():
            if name in options.parts or (name == "rounds" and options.parts & {"steps", "trials"}):
                if name in empty:
                    kept[name] = empty[name]
                measure()
                save(kept, options.output)
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"{usage.ru_utime + usage.ru_stime:.0f} s of processor time", file=sys.stderr)


if __name__ == "__main__":
    main()
