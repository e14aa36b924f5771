"""What the peers share: scenes as files, the timing of steps, the loop of a kinematic trial.

A peer is a module with `make(scene)`, which returns `step(base, q) -> (velocity, position error, orientation error)`:
base (x, y, phi), joints q; velocity of the base (v, omega; nothing where it is fixed), then of the joints. `run(make)`
does the rest; `step.look() -> (least distance to an object, least to the robot itself, manipulability)` is about the state
that step() was asked about last, infinite where the peer has no such distance; contact is a distance of 0 or less:

    PEER.py SCENE.json --steps SECONDS     control steps on the scene's states, over and over
    PEER.py SCENE.json --trials N          kinematic trials from the starts of the scene's first N worlds

and prints one line of JSON. A scene (bench/speed.py writes it) holds the robot as moma resolved it (`model`), the
objects and the goal of world 0, states of a motion in it (`states`), and more worlds (`worlds`).
"""
import argparse
import json
import resource
import sys
import time

import numpy as np

PERIOD = 0.02  # of control [s]
SUCCESS = {"position": 0.02, "orientation": 0.05, "steps": 10}


def rotation(quaternion):
    """Of (w, x, y, z)."""
    w, x, y, z = quaternion
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def pose(item):
    """4 x 4, of what has a position and a quaternion or a rotation."""
    X = np.eye(4)
    X[:3, :3] = rotation(item["quaternion"]) if "quaternion" in item else np.reshape(item["rotation"], (3, 3))
    X[:3, 3] = item["position"]
    return X


def planar(base):
    c, s = np.cos(base[2]), np.sin(base[2])
    return np.array([[c, -s, 0, base[0]], [s, c, 0, base[1]], [0, 0, 1, 0], [0, 0, 0, 1]])


def angle(R):
    return float(np.arccos(np.clip((np.trace(R) - 1) / 2, -1, 1)))


def advance(base, q, velocity, dt):
    """Along the arc that the differential drive takes; exact."""
    base = np.array(base, dtype=float)
    if len(velocity) > len(q):
        v, w = velocity[:2]
        middle = base[2] + 0.5 * w * dt
        chord = v * dt * np.sinc(0.5 * w * dt / np.pi)
        base += [chord * np.cos(middle), chord * np.sin(middle), w * dt]
    return base, q + dt * velocity[len(velocity) - len(q):]


def time_steps(make, scene, seconds):
    step = make(scene)
    states = [(np.array(s["base"]), np.array(s["q"])) for s in scene["states"]]
    step(*states[0])
    startup = time.process_time()
    took = []
    begin = now = time.process_time()
    while now - begin < seconds or len(took) < 20:
        step(*states[len(took) % len(states)])
        then, now = now, time.process_time()
        took.append(now - then)
    p50, p999, worst = (1e6 * np.quantile(took, p) for p in (0.5, 0.999, 1.0))
    return {"us": 1e6 * (now - begin) / len(took), "cpu_p50": p50, "cpu_p999": p999, "cpu_worst": worst,
            "startup_s": startup, "steps": len(took)}


def trial(step, world, limit):
    """Outcome, control steps, processor time of what is looked at besides control: contacts once a control step, least
    distances, manipulability, the way of the base and the changes of commands. moma does more of it, and more often.
    A contact is noted and ends nothing: what is timed is a control step, and setting up a peer takes long."""
    base, q, inside = np.array(world["start"]["base"]), np.array(world["start"]["q"]), 0
    objects = itself = np.inf
    looked, manipulabilities, bases, joints, commands = 0.0, [], [], [], []
    outcome = "timeout"
    for _ in range(round(limit / PERIOD)):
        velocity, position, orientation = step(base, q)
        begin = time.process_time()
        to_objects, to_itself, manipulability = step.look()
        objects, itself = min(objects, to_objects), min(itself, to_itself)
        manipulabilities.append(manipulability)
        bases.append(base)
        joints.append(q)
        commands.append(velocity)
        looked += time.process_time() - begin
        there = position < SUCCESS["position"] and orientation < SUCCESS["orientation"]
        inside = inside + 1 if there else 0
        if inside > SUCCESS["steps"]:
            outcome = "success"
            break
        base, q = advance(base, q, velocity, PERIOD)
    begin = time.process_time()
    row = {"outcome": "collision" if min(objects, itself) <= 0.0 else outcome, "clearance": objects, "clearance_self": itself, "manip": float(np.mean(manipulabilities)),
           "path_base": float(np.linalg.norm(np.diff([b[:2] for b in bases], axis=0), axis=1).sum()),
           "change": float(np.abs(np.diff(commands, axis=0)).max(axis=1).mean()) if len(commands) > 1 else 0.0,
           "jerk": float(np.sqrt(np.mean(np.diff(joints, n=3, axis=0) ** 2))) if len(joints) > 3 else 0.0}
    return row, len(commands), looked + time.process_time() - begin


def trials(make, scene, count, limit=30.0):
    begin, rows, steps, looked = time.process_time(), [], 0, 0.0
    for world in scene["worlds"][:count]:
        row, length, seconds = trial(make({**scene, **world}), world, limit)
        rows.append(row)
        steps += length
        looked += seconds
    spent = time.process_time() - begin
    outcomes = [row["outcome"] for row in rows]
    return {"trials": count, "successes": outcomes.count("success"), "collisions": outcomes.count("collision"),
            "control_steps": steps, "cpu_s": spent, "look_s": looked}


def run(make, version):
    parser = argparse.ArgumentParser()
    parser.add_argument("scene")
    parser.add_argument("--steps", type=float, help="seconds of processor time")
    parser.add_argument("--trials", type=int)
    options = parser.parse_args()
    with open(options.scene, encoding="utf-8") as file:
        scene = json.load(file)
    result = time_steps(make, scene, options.steps) if options.steps else trials(make, scene, options.trials)
    result["rss_mib"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    json.dump({**result, "version": version}, sys.stdout)
    print()
