#!/usr/bin/env python3
"""The trials of a suite in MuJoCo: moma's controllers as a robot's own program would call them, beside the same trials in ODE.

    build/moma run examples/mujoco/transfer.yaml
    PYTHONPATH=build/python MOMA_PROGRAM=build/moma .venv/bin/python3 examples/mujoco/trials.py examples/mujoco/transfer.yaml results/transfer.db

usage: trials.py SUITE [STORE] [--worlds FROM:TO] [--only WORD] [-o FILE.jsonl]

Computes the trials that FILE lacks, of the points whose controller or label has WORD in it, and adds a line for each. With the
STORE that `moma run SUITE` wrote it prints a table, outcome by outcome. docs/studies/transfer.md has what comes of it.
"""

import argparse
import json
import pathlib
import time

import moma
import numpy as np
from plant import Plant
from sensors import Drives, Sensors, Settings


class Point:
    """A controller of the suite with the values of one of its sweep's points."""

    def __init__(self, suite, index):
        whole = json.loads(suite.load().resolved)
        point = whole.get("points", [{}] * (index + 1))[index]
        self.controller, self.label = suite.points[index]
        self.parameters = point.get("controller_params", whole["controllers"][self.controller])
        for section in ("simulation", "success", "stuck"):
            setattr(self, section, point.get(section, whole.get(section, {})))
        self.disturbances = Settings(point.get("disturbances", whole.get("disturbances", {})))
        self.robot = moma.Robot(whole["robot"])


def trial(point, world):
    """(outcome, time, reason) of one trial. Outcomes are moma's; `stuck` is a robot that has not moved for as long."""
    settings, draw = point.disturbances, np.random.default_rng([20, world["index"]])
    period = point.simulation["control_period"]
    ramps = {settings(f"actuators.base.ramps.{way}", 1.0) for way in ("speed_up", "slow_down")}
    payload, floor, friction = (max(0.0, draw.normal(settings(key, usual), settings(spread))) for key, spread, usual in (
        ("payload.mass", "payload.spread", 0.0), ("floor.friction", "floor.spread", 1.0),
        ("actuators.joints.friction.effort", "actuators.joints.friction.spread", 0.0)))
    plant = Plant(point.robot, world, payload=payload, floor_friction=floor, base_ramp=min(ramps), joint_friction=friction,
                  eye=settings("objects.sensor", [0, 0, 0.5]))
    sensors = Sensors(settings, draw, plant, world, period)
    drives, missed = Drives(settings, draw, len(point.robot.joints), period), settings("control.missed")
    controller = moma.Controller(point.robot, point.parameters, period)
    controller.reset([{"name": item["name"], "shape": item["shape"], "size": item["size"]} for item in world.objects])
    goal, inside, still, touching = sensors.goal.X_W, 0, 0, None
    lower, upper = point.robot.lower - 1e-3, point.robot.upper + 1e-3
    steps = round(point.simulation["time_limit"] / period)
    for k in range(steps + 1):
        now, tool = k * period, plant.tool()
        away = np.linalg.norm(goal[:3, 3] - tool[:3, 3])
        turn = np.arccos(np.clip((np.trace(goal[:3, :3] @ tool[:3, :3].T) - 1) / 2, -1, 1))
        if touching:
            return "collision", now, " and ".join(touching)
        inside = inside + 1 if away <= point.success["position"] and turn <= point.success["orientation"] else 0
        if inside > round(point.success["dwell"] / period):
            return "success", now - point.success["dwell"], ""
        if np.any(plant.q() < lower) or np.any(plant.q() > upper):
            return "joint_limit", now, ""
        still = still + 1 if np.abs(plant.velocities()).max() < 1e-3 else 0
        if still * period > 2 * point.stuck.get("time", 1.0):
            return "stuck", now, f"{away:.3f} m and {turn:.3f} rad from the goal"
        seen = sensors.observe(now)
        if k == 0 or not (missed and draw.random() < missed):
            command = controller.step(seen).command
        touching = plant.advance(drives(command), period)
    return "timeout", now, f"{away:.3f} m and {turn:.3f} rad from the goal"


def kind(outcome):
    return outcome if outcome in ("success", "collision") else "neither"


def table(store, rows):
    """Markdown: what the two engines say of the same worlds."""
    found = moma.Store(store).sql("SELECT controller, point, world, outcome, coalesce(reason, '') AS reason FROM v_trials")
    ode = {(row.controller, row.point, row.world): row for row in found.itertuples()}
    points, differ = {}, []
    for row in rows:
        if (other := ode.get((row["controller"], row["point"], row["world"]))) is not None:
            points.setdefault((row["controller"], row["point"]), []).append((row, other))
    print("| controller | point | worlds | success ODE | MuJoCo | collision ODE | MuJoCo | same outcome |")
    print("| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |")
    for (controller, label), pairs in points.items():
        counts = [sum(outcome == word for outcome in side) for word in ("success", "collision")
                  for side in ([o.outcome for _, o in pairs], [m["outcome"] for m, _ in pairs])]
        other = [(m, o) for m, o in pairs if kind(m["outcome"]) != kind(o.outcome)]
        print(f"| `{controller}` | {label} | {len(pairs)} | {' | '.join(map(str, counts))} | {len(pairs) - len(other)} |")
        differ += [f"- `{controller}` {label}, world {m['world']}: {o.outcome} in ODE{': ' * bool(o.reason)}{o.reason}; "
                   f"{m['outcome']} in MuJoCo after {m['time']:.2f} s{': ' * bool(m['reason'])}{m['reason']}" for m, o in other]
    print("", *differ, sep="\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("suite")
    parser.add_argument("store", nargs="?")
    parser.add_argument("--worlds", default="0:120")
    parser.add_argument("--only", default="")
    parser.add_argument("-o", "--output", type=pathlib.Path)
    options = parser.parse_args()
    suite = moma.Suite(options.suite)
    output = options.output or pathlib.Path("results") / f"{suite.name}.jsonl"
    rows = [json.loads(line) for line in output.read_text().splitlines()] if output.exists() else []
    known = {(row["controller"], row["point"], row["world"]) for row in rows}
    begin, end = map(int, options.worlds.split(":"))
    with output.open("a", encoding="utf-8") as file:
        for index, (name, label) in enumerate(suite.points):
            if options.only not in f"{name} {label}":
                continue
            point = Point(suite, index)
            for world in range(begin, end):
                if (name, label, world) not in known:
                    started, place = time.process_time(), suite.world(world, index)
                    outcome, seconds, reason = trial(point, place)
                    if place.objects and (unknown := point.disturbances.unused()):
                        raise SystemExit(f"not known here: disturbances.{', disturbances.'.join(unknown)}")
                    rows.append({"controller": name, "point": label, "world": world, "outcome": outcome, "time": round(seconds, 3),
                                 "reason": reason, "cpu_s": round(time.process_time() - started, 2)})
                    print(json.dumps(rows[-1]), file=file, flush=True)
    if options.store:
        table(options.store, rows)


if __name__ == "__main__":
    main()
