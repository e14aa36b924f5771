"""Rows for objects of the Robotics Toolbox (link_collision_damper, as neo.py asks for them) beside finite differences of the distances that they are of.

    .venv-toolbox/bin/python3 bench/peers/toolbox_rows.py

A Panda and a sphere near it, 20 postures (seed 1). A row is to say how fast its distance shrinks by each joint. Prints how many entries above 0.05 m/rad differ by more than half of
what they are to be, and how many have the other sign; and the same of rows with direction and Jacobian (at the nearest point) in the same axes, those of the world.
"""

import numpy as np
import roboticstoolbox as rtb
import spatialgeometry
import spatialmath

RANGE, STEP = 0.3, 1e-3


def distances(robot, solids, shape, q, reach):
    robot.q = q
    robot._update_link_tf(q)
    robot._propogate_scene_tree()
    return [solid.closest_point(shape, reach)[0] for solid in solids]


def main():
    robot, rng = rtb.models.Panda(), np.random.default_rng(1)
    links = robot.link_dict
    ends = {"start": links["panda_link1"], "end": links["panda_hand"]}
    owners = [(link, solid) for link in robot.get_path(**ends)[0] for solid in link.collision]
    solids = [solid for _, solid in owners]
    entries, far, turned = 0, np.zeros(2, int), np.zeros(2, int)
    for _ in range(20):
        q = np.array(robot.qr) + rng.uniform(-0.5, 0.5, robot.n)
        shape = spatialgeometry.Sphere(0.05)
        shape.v = np.zeros(6)
        place = np.eye(4)
        place[:3, 3] = robot.fkine(q).t + rng.uniform(-0.25, 0.25, 3)
        shape.T = place
        shape._propogate_scene_tree()
        near = [d is not None for d in distances(robot, solids, shape, q, RANGE)]
        rows, _ = robot.link_collision_damper(shape, q, RANGE, 0.05, 1.0, **ends)
        rates = np.zeros((len(solids), robot.n))
        for j in range(robot.n):
            step = STEP * np.eye(robot.n)[j]
            before, after = (np.array(distances(robot, solids, shape, q + sign * step, 10.0)) for sign in (-1, 1))
            rates[:, j] = (before - after) / (2 * STEP)
        distances(robot, solids, shape, q, RANGE)
        for row, rate, (link, solid) in zip(rows[:, : robot.n], rates[near], [pair for pair, there in zip(owners, near) if there]):
            d, here, there = solid.closest_point(shape, RANGE)
            pose = robot.fkine(q, end=link).A
            tool = np.eye(4)
            tool[:3, 3] = pose[:3, :3].T @ (here - pose[:3, 3])
            J = robot.jacob0(q, end=link, tool=spatialmath.SE3(tool, check=False))[:3]
            own = np.zeros(robot.n)
            own[: J.shape[1]] = (there - here) / d @ J
            big = np.abs(rate) > 0.05
            entries += big.sum()
            for k, found in enumerate((row, own)):
                far[k] += (np.abs(found - rate) > 0.5 * np.abs(rate))[big].sum()
                turned[k] += (found * rate < 0)[big].sum()
    for k, name in enumerate(("the toolbox's", "in the same axes")):
        print(f"{name}: of {entries} entries {far[k]} differ by more than half, {turned[k]} have the other sign")


if __name__ == "__main__":
    main()
