"""How long controllers take to the goal, beside what distance and speeds ask for.

    python3 bench/time_to_goal.py STORE CONTROLLER [OTHER] [--moma PROGRAM]

For each point of CONTROLLER in a store of `moma run`, on the worlds that it reaches (and OTHER does, where it is named): median time to
goal, and its ratio to two bounds from the goal's distance e and angle at the start, with the controller's own servo (speed v and
gain k, of position and of rotation; the longer of the two counts) and the suite's tolerances:

    speed   (e - tolerance)/v                          at the greatest speed from the first to the last moment
    servo   (e - v/k)/v + ln(v/(k tolerance))/k        the same, slowing down as the servo does

Neither knows of objects, of accelerations or of limits. A path is not bound by the servo, and may be quicker. PROGRAM (build/moma)
is asked once for each point where the robot's hand is at the start of a trial.
"""
import argparse
import json
import math
import pathlib
import sqlite3
import statistics
import subprocess


def quaternion_product(a, b):
    w, x, y, z = a
    p, q, r, s = b
    return (w * p - x * q - y * r - z * s, w * q + x * p + y * s - z * r, w * r - x * s + y * p + z * q, w * s + x * r - y * q + z * p)


def conjugate(q):
    return (q[0], -q[1], -q[2], -q[3])


def about_z(angle):
    return (math.cos(angle / 2), 0.0, 0.0, math.sin(angle / 2))


def exponential(v):
    angle = math.hypot(*v)
    if angle == 0.0:
        return (1.0, 0.0, 0.0, 0.0)
    s = math.sin(angle / 2) / angle
    return (math.cos(angle / 2), s * v[0], s * v[1], s * v[2])


def hand_at_start(run):
    """Orientation of E in the base's frame, from the first error of a replayed trial: R_WG = exp(e_R) R_WE."""
    error = exponential(run["samples"][0]["error"][:3])
    goal = run["world"]["goal"]["quaternion"]
    hand = quaternion_product(conjugate(error), goal)
    return quaternion_product(conjugate(about_z(run["world"]["start"]["base"][2])), hand)


def angle_to_goal(hand_B, world):
    hand = quaternion_product(about_z(world["start"]["base"][2]), hand_B)
    turn = quaternion_product(world["goal"]["quaternion"], conjugate(hand))
    return 2.0 * math.atan2(math.hypot(*turn[1:]), abs(turn[0]))


def servo_time(e, v, k, tolerance):
    if e <= tolerance:
        return 0.0
    end = max(v / k, tolerance)
    start = min(e, end)
    return max(e - end, 0.0) / v + (math.log(start / tolerance) / k if start > tolerance else 0.0)


def bounds(distance, angle, servo, success):
    parts = ((distance, servo["max_linear"], servo["position"], success["position"]),
             (angle, servo["max_angular"], servo["orientation"], success["orientation"]))
    return (max(max(e - tolerance, 0.0) / v for e, v, _, tolerance in parts), max(servo_time(*part) for part in parts))


def reached(db, controller, world_of):
    rows = db.execute("SELECT robot, point, family, trial, time_to_goal_s FROM v_trials WHERE controller = ? AND outcome = 'success'",
                      (controller,))
    return {(robot, point, family, world_of[trial]): (trial, time) for robot, point, family, trial, time in rows}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("store")
    parser.add_argument("controller")
    parser.add_argument("other", nargs="?", help="only worlds that this one reaches, too")
    parser.add_argument("--moma", default=pathlib.Path(__file__).parent.parent / "build/moma", help="the program")
    args = parser.parse_args()
    db = sqlite3.connect(args.store)
    worlds = {row: (json.loads(text), distance) for row, text, distance in db.execute("SELECT id, json, goal_distance_m FROM world")}
    world_of = {key.hex()[:16]: world for key, world in db.execute("SELECT key, world_id FROM trial")}
    ours = reached(db, args.controller, world_of)
    others = reached(db, args.other, world_of) if args.other else ours
    groups = {}
    for key in ours.keys() & others.keys():
        groups.setdefault(key[:3], []).append(key)
    for (robot, point, family), keys in sorted(groups.items()):
        first = json.loads(subprocess.check_output([args.moma, "replay", args.store, ours[keys[0]][0], "--json"]))
        hand = hand_at_start(first)
        least, ratios = ([], []), ([], [])
        for key in keys:
            world, distance = worlds[key[3]]
            for i, bound in enumerate(bounds(distance, angle_to_goal(hand, world), first["controller"]["servo"], first["success"])):
                least[i].append(bound)
                ratios[i].append(ours[key][1] / bound if bound > 0.0 else 1.0)
        time = statistics.median(ours[key][1] for key in keys)
        beside = f", {args.other} {statistics.median(others[key][1] for key in keys):.2f} s" if args.other else ""
        print(f"{robot} {point} {family}: {len(keys)} worlds, {args.controller} {time:.2f} s{beside}")
        for name, bound, ratio in zip(("speed", "servo"), least, ratios):
            quarters = statistics.quantiles(ratio, n=4) if len(ratio) > 1 else ratio * 3
            print(f"  {name}: {statistics.median(bound):.2f} s, medians' ratio {time / statistics.median(bound):.2f}; of single worlds "
                  + ", ".join(f"{quarter:.2f}" for quarter in quarters) + " (quartiles)")


if __name__ == "__main__":
    main()
