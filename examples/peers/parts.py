"""What the peers need of the robot that moma describes to them: its solids, the pairs of them that can meet, where its arm is
mounted. Poses are 4 x 4."""

import numpy as np


def pose(item):
    """Of what has a position and a rotation, column by column as in moma's files, or by angles (roll, pitch, yaw)."""
    X = np.eye(4)
    if "rotation" in item:
        X[:3, :3] = np.reshape(item["rotation"], (3, 3)).T
    elif "rpy" in item:
        (cr, cp, cy), (sr, sp, sy) = np.cos(item["rpy"]), np.sin(item["rpy"])
        X[:3, :3] = [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    X[:3, 3] = item.get("position", np.zeros(3))
    return X


def frame(seen):
    """Of an object or the goal, as observed."""
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = seen.rotation, seen.position
    return X


def solids(robot):
    """(link, kind, size, pose in the link) of each; the base's link is None."""
    base = robot.description["base"]
    found = [(None, base["footprint"])] if "footprint" in base else []
    found += [(None, box) for box in wheels(base)]
    found += [(item["link"], item) for item in robot.description["collision"]["shapes"]]
    return [(None if link == "@base" else link, item["shape"], item["size"], pose(item)) for link, item in found]


def wheels(base):
    """The boxes that moma makes of a differential drive's wheels where their width is given: left, right."""
    driven = base.get("wheels", {})
    if base["type"] != "differential" or "width" not in driven:
        return []
    size = [2 * driven["radius"], driven["width"], 2 * driven["radius"]]
    return [{"shape": "box", "size": size, "position": [0, side * driven["separation"], driven["radius"]]} for side in (0.5, -0.5)]


def pairs(robot):
    """Numbers of solids of the robot that can meet each other."""
    return [(first, second) for first, second, row in robot.description["collision"]["pairs"] if row]


def mount(robot):
    """Of the arm's root on the base."""
    return pose(robot.description["base"].get("mount", {}))


def mobile(robot):
    if robot.base not in ("fixed", "differential"):
        raise ValueError(f"a base that is {robot.base} is not modelled here")
    return robot.base == "differential"
