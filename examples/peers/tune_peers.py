"""Tunes each controller of configs/suites/peers.yaml and peers-panda.yaml with the same budget and by the same search, then runs it with
what was found, as NAME-tuned, in the suite's worlds. Stores and gains are in FOLDER; it goes on from what is there.

    python3 examples/peers/tune_peers.py FOLDER [peers|peers-panda NAME...]
"""

import pathlib
import sys

import moma

ROOT = pathlib.Path(__file__).resolve().parents[2]
LOG = {"scale": "log"}
OWN = {
    "servo.position": {"range": [0.5, 4], **LOG},
    "servo.orientation": {"range": [0.5, 4], **LOG},
    "lambda_q": {"range": [0.001, 0.1], **LOG},
    "collision.gain": {"range": [0.3, 4], **LOG},
}
MINK = {
    "parameters.gain": {"range": [0.01, 1], **LOG, "start": 0.1},
    "parameters.avoidance": {"range": [0.03, 0.9], **LOG, "start": 0.2},
    "parameters.stop": {"range": [0.005, 0.06], **LOG, "start": 0.02},
    "parameters.influence": {"range": [0.05, 0.4], **LOG, "start": 0.2},
}
PINK = {
    "parameters.gain": {"range": [0.01, 1], **LOG, "start": 0.1},
    "parameters.orientation_cost": {"range": [2, 50], **LOG, "start": 10},
    "parameters.avoidance": {"range": [1, 40], **LOG, "start": 10},
    "parameters.stop": {"range": [0.005, 0.06], **LOG, "start": 0.02},
}
TOOLBOX = {
    "parameters.gain": {"range": [0.4, 4], **LOG, "start": 1.5},
    "parameters.turn": {"range": [0.5, 2], **LOG, "start": 1.3},
    "parameters.effort": {"range": [0.001, 0.1], **LOG, "start": 0.01},
    "parameters.avoidance": {"range": [0.3, 4], **LOG, "start": 1},
}
TUNED = {
    "peers": {"mink": MINK, "toolbox-avoid": TOOLBOX, "holistic": OWN, "pink": PINK},
    "peers-panda": {"mink": MINK, "toolbox-neo": TOOLBOX, "neo": OWN, "pink": PINK},
}
# Twelve candidates in eight worlds, four of each family, that take no part in the evaluation.
SEARCH = {"algorithm": "BOBYQA", "budget": {"trials": 96}, "worlds": {"first": 10_000, "count": 8}, "held_out": {"count": 200, "seed": 2027},
          "confirm": "none", "sensitivity": "none", "racing": "none"}


def main(folder, only=None, *names):
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for suite, controllers in TUNED.items():
        if only not in (None, suite):
            continue
        file = ROOT / f"configs/suites/{suite}.yaml"
        for name, variables in controllers.items():
            if names and name not in names:
                continue
            tuned = moma.tune(file, tune={**SEARCH, "controller": name, "variables": {f"controller.{k}": v for k, v in variables.items()}},
                              store=folder / f"{suite}-{name}.db", gains=folder / f"{suite}-{name}.yaml", threads=1, verdict=False,
                              changes={"simulation.time_limit": 15}, progress=False)
            print(suite, name, tuned.controller, flush=True)
            moma.evaluate(file, store=folder / f"{suite}.db", threads=1, keep_going=True, progress=False,
                          changes={"controllers": {f"{name}-tuned": str(tuned.gains.absolute())}})


if __name__ == "__main__":
    main(*sys.argv[1:])
