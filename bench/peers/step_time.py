"""What a step of a controller of examples/peers costs, in processor time: 200 steps of a motion in world 1 of the cluttered family, by itself and without moma's program.

    PYTHONPATH=build/python .venv-peers/bin/python3 bench/peers/step_time.py mink_peer Mink frankie [PARAMETERS as JSON]

The world comes from configs/suites/peers.yaml or peers-panda.yaml by `moma world` (MOMA_PROGRAM). Prints the median in microseconds.
"""

import importlib
import json
import pathlib
import sys
import time
from types import SimpleNamespace

import common
import moma
import numpy as np
from moma.program import run

ROOT = pathlib.Path(__file__).resolve().parents[2]
STEPS = 200
sys.path.insert(0, str(ROOT / "examples/peers"))


def placed(item):
    """An object or the goal, as observed."""
    X = common.pose(item)
    return SimpleNamespace(position=X[:3, 3], rotation=X[:3, :3], twist=np.zeros(6), visible=True, position_covariance=None,
                           velocity_covariance=None)


def main(module, name, robot, parameters="{}"):
    families = {"frankie": {"objects": 10, "shapes": ["sphere", "box"]}, "panda": {"objects": 3, "shapes": ["sphere"]}}
    suite = ROOT / "configs/suites/peers.yaml"
    plain = {"robot": str(ROOT / f"configs/robots/{robot}.yaml"), "controllers": {"rrmc": str(ROOT / "configs/controllers/rrmc.yaml")},
             "worlds.families": {"clutter": families[robot]}}
    sets = [word for key, value in plain.items() for word in ("--set", f"{key}={value if isinstance(value, str) else json.dumps(value)}")]
    world = json.loads(run(["world", str(suite), "1", *sets, "--json"]))
    body = moma.Robot(ROOT / f"configs/robots/{robot}.yaml")
    body.control_period = common.PERIOD
    controller = getattr(importlib.import_module(module), name)(**json.loads(parameters))
    controller.reset(body, [SimpleNamespace(name=o["name"], kind=o["shape"], size=np.array(o["size"])) for o in world["objects"]])
    q, base = np.array(world["start"]["q"]), np.array(world["start"]["base"])
    objects, goal, took = [placed(item) for item in world["objects"]], placed(world["goal"]), []
    for k in range(STEPS):
        seen = SimpleNamespace(time=common.PERIOD * k, q=q, base=base, qdot=np.zeros(len(body.velocities)), goal=goal, objects=objects)
        begin = time.process_time()
        answer = controller.step(seen)
        took.append(time.process_time() - begin)
        velocity = answer["command"] if isinstance(answer, dict) else answer
        q, base = body.integrate(q, velocity, common.PERIOD, base)
    print(f"{name} {robot}: {1e6 * np.median(took):.0f} us")


if __name__ == "__main__":
    main(*sys.argv[1:])
