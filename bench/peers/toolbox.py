"""Robotics Toolbox for Python: the step of its examples, holistic_mm_non_holonomic.py for a mobile arm and neo.py for a
fixed one, with the toolbox's own Frankie and Panda, and neo.py's rows for objects in both. Spheres and boxes only."""
import math
from importlib.metadata import version

import numpy as np
import qpsolvers
import roboticstoolbox as rtb
import spatialgeometry
import spatialmath

from common import angle, planar, pose, run


def shape(item):
    X = spatialmath.SE3(pose(item), check=False)
    solid = spatialgeometry.Sphere(item["size"][0], pose=X) if item["shape"] == "sphere" else \
        spatialgeometry.Cuboid(item["size"], pose=X)
    solid.v = np.zeros(6)
    solid._propogate_scene_tree()
    return solid


def make(scene):
    mobile = scene["model"]["base"]["type"] != "fixed"
    robot = rtb.models.Frankie() if mobile else rtb.models.Panda()
    n, dof = robot.n, 2 if mobile else 0
    goal = pose(scene["goal"])
    objects = [shape(item) for item in scene["objects"]]
    first, last = robot.link_dict["panda_link1"], robot.link_dict["panda_link8"]
    arm = robot.links[4] if mobile else None

    asked = []

    def step(base, q):
        if mobile:
            robot._T = planar(base)
            q = np.r_[0.0, 0.0, q]
        robot.q = q
        asked[:] = [q]
        if objects:  # what Swift does at each of its steps
            robot._update_link_tf(q)
            robot._propogate_scene_tree()
        X_WE = robot.fkine(q).A
        X_EG = np.linalg.inv(X_WE) @ goal
        error = np.sum(np.abs(X_EG[:3, 3]))
        Q = np.eye(n + 6)
        Q[:n, :n] *= 0.01
        Q[:dof, :dof] /= error
        Q[n:, n:] = np.eye(6) / error
        nu, _ = rtb.p_servo(X_WE, goal, 1.5 if mobile else 1.0)
        if mobile:
            nu[3:] *= 1.3
        Ain, bin = np.zeros((n + 6, n + 6)), np.zeros(n + 6)
        Ain[:n, :n], bin[:n] = robot.joint_velocity_damper(0.1, 0.9, n)
        for solid in objects:
            A, b = robot.link_collision_damper(solid, q, 0.3, 0.05, 1.0, start=first, end=last)
            if A is not None and b is not None:
                # The row of a link has as many columns as there are joints up to it; the base's are missing in it.
                rows = np.zeros((A.shape[0], n + 6))
                rows[:, :A.shape[1]] = A
                Ain, bin = np.r_[Ain, rows], np.r_[bin, b]
        c = np.r_[np.zeros(dof), -robot.jacobm(q, start=arm).reshape(n - dof), np.zeros(6)]
        if mobile:
            X_BE = robot.fkine(q, include_base=False).A
            c[0] = -0.5 * math.atan2(X_BE[1, 3], X_BE[0, 3])
        most = np.r_[robot.qdlim[:n], 10 * np.ones(6)]
        x = qpsolvers.solve_qp(Q, c, Ain, bin, np.c_[robot.jacobe(q), np.eye(6)], nu.reshape(6), lb=-most, ub=most,
                               solver="quadprog")
        velocity = np.zeros(n) if x is None else x[:n]
        if mobile:
            velocity = np.r_[velocity[1], velocity[0], velocity[2:]]  # its base turns first
        return velocity, np.linalg.norm(X_EG[:3, 3]), angle(X_EG[:3, :3])

    def look():
        """The toolbox has distances to solids, within a range, and none of the robot's links to each other."""
        q = asked[0]
        near = [robot.closest_point(q, solid, 10.0, skip=True)[0] for solid in objects]
        return (min((d for d in near if d is not None), default=np.inf), np.inf,
                robot.manipulability(q, start=arm, axes="trans"))

    step.look = look
    return step


if __name__ == "__main__":
    run(make, f"roboticstoolbox {version('roboticstoolbox-python')}, quadprog {version('quadprog')}")
