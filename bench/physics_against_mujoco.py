#!/usr/bin/env python3
"""CPU time of a physics step: the ODE plant beside MuJoCo, on the same scenes, in one run.

    bench/physics_against_mujoco.py [--program build/tests/physics_probe] [--seconds 10] [--rounds 5]

Same robot, commands, objects, pairs of solids that are looked at, and step (2 ms). A round measures every scene in
both engines one after the other; the table has the medians of the rounds, with the least and the greatest. MuJoCo
twice: with the solver's settings that tests/world/mujoco_test.py compares by, and as it comes.
"""
import argparse
import os
import sys
import time

os.environ["MUJOCO_GL"] = "disable"
import numpy as np  # noqa: E402

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
sys.path.insert(0, os.path.join(ROOT, "tests", "tools"))
import mujoco  # noqa: E402
from mjcf import BASE_DRIVES, STEP, Probe, mjcf  # noqa: E402
from mujoco_plant import MujocoPlant, arm_of, ramp  # noqa: E402

PERIOD = 0.02
SCENES = [("panda", 0), ("panda", 30), ("frankie", 0), ("frankie", 10), ("frankie", 30), ("lift_ur5", 30)]


def ring(count, rng):
    """Solids around the robot, out of its way."""
    out = []
    for i in range(count):
        angle, distance = rng.uniform(0, 2 * np.pi), rng.uniform(1.8, 3.5)
        kind = ["sphere", "box", "capsule"][i % 3]
        size = rng.uniform(0.05, 0.2, 3)
        size[1:] = {"sphere": [0, 0], "capsule": [size[1], 0], "box": size[1:]}[kind]
        quaternion = rng.normal(size=4)
        out.append({"kind": kind, "size": size.tolist(),
                    "quaternion": (quaternion / np.linalg.norm(quaternion)).tolist(),
                    "position": [distance * np.cos(angle), distance * np.sin(angle), rng.uniform(0.2, 1.2)]})
    return out


def wave(robot, seconds):
    """The base to and fro, every joint a little."""
    dof = len(BASE_DRIVES.get(robot["base"]["type"], []))
    k = np.arange(round(seconds / PERIOD))[:, None]
    i = np.arange(dof + len(robot["joints"]))[None, :]
    return 0.1 * np.sin(i + 1.0) * np.sin(0.1 * k)


def mujoco_cost(model, robot, commands):
    plant = MujocoPlant(model, robot, arm_of(robot))
    steps = round(PERIOD / STEP)
    spent = 0.0
    for command in commands:
        # The drives move once a control period: the time of setting them from Python is not MuJoCo's.
        if plant.dof:
            plant.ramped, plant.mean = ramp(plant.ramped, command[: plant.dof], robot["base"]["max_acceleration"], PERIOD)
        rates = plant.rates(command)
        plant.aim += PERIOD * rates
        model.eq_data[plant.drives, 0] = plant.aim
        before = time.thread_time()
        mujoco.mj_step(model, plant.data, steps)
        spent += time.thread_time() - before
    return 1e6 * spent / (len(commands) * steps)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--program", default=os.path.join(ROOT, "build/tests/physics_probe"))
    parser.add_argument("--seconds", type=float, default=10.0, help="simulated, of each scene and round")
    parser.add_argument("--rounds", type=int, default=5)
    arguments = parser.parse_args()
    probe = Probe(arguments.program)
    results = {scene: {"ODE": [], "MuJoCo": [], "MuJoCo as it comes": []} for scene in SCENES}
    for _ in range(arguments.rounds):
        for name, count in SCENES:
            request = {"robot": os.path.join(ROOT, f"configs/robots/{name}.yaml")}
            robot = probe.ask("model", **request)
            objects = ring(count, np.random.default_rng(7))
            commands = wave(robot, arguments.seconds)
            found = results[name, count]
            found["ODE"].append(probe.ask("cost", **request, step=STEP, objects=objects,
                                          commands=commands.tolist())["us_per_step"])
            for label, defaults in (("MuJoCo", False), ("MuJoCo as it comes", True)):
                model = mujoco.MjModel.from_xml_string(
                    mjcf(robot, objects=objects, own_contacts=True, defaults=defaults))
                found[label].append(mujoco_cost(model, robot, commands))
    probe.close()
    print(f"us of CPU per physics step of 2 ms; median of {arguments.rounds} rounds (least to greatest); "
          f"MuJoCo {mujoco.__version__}")
    for (name, count), found in results.items():
        cells = [f"{label} {np.median(v):6.1f} ({min(v):.1f} to {max(v):.1f})" for label, v in found.items()]
        print(f"{name:10} {count:3} objects: " + "   ".join(cells))


if __name__ == "__main__":
    sys.exit(main())
