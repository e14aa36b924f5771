"""Robotics Toolbox for Python, with its own models of Panda and Frankie: the steps of its examples neo.py (`Neo`, an arm that stands)
and holistic_mm_non_holonomic.py (`Holistic`, an arm on a differential drive), each with the gains of the example. `Holistic` has
neo.py's rows for objects where `avoid` says so: the published example has none."""

import math

import numpy as np
import qpsolvers
import roboticstoolbox as rtb
import spatialgeometry
import spatialmath

from parts import frame, mobile

REACH = 0.76  # [m] half of the largest solid's diagonal (of Frankie's base, 0.455 m) and the 0.3 m in which rows act


def solid(item):
    if item.shape == "sphere":
        shape = spatialgeometry.Sphere(item.size[0])
    elif item.shape == "box":
        shape = spatialgeometry.Cuboid(item.size)
    else:
        raise ValueError(f"the toolbox is given no {item.shape}")
    shape.v = np.zeros(6)
    return shape, np.linalg.norm(item.size) / min(len(item.size), 2)  # and the radius of a sphere around it


class Holistic:
    dof = 2

    def __init__(self, gain=1.5, turn=1.3, effort=0.01, facing=0.5, stop=0.1, influence=0.9, avoid=False, avoidance=1.0, fast=True):
        self.gain, self.turn, self.effort, self.facing = gain, turn, effort, facing
        self.damper, self.avoid, self.avoidance, self.fast = (stop, influence), avoid, avoidance, fast

    def reset(self, robot, objects):
        if mobile(robot) != (self.dof > 0):
            raise ValueError(f"{type(self).__name__} is not for a base that is {robot.base}")
        self.robot = rtb.models.Frankie() if self.dof else rtb.models.Panda()
        self.solids = [solid(item) for item in objects] if self.avoid else []

    def rows(self, q, seen):
        """Velocity dampers of joints and objects, beside n + 6 variables."""
        n = self.robot.n
        A, b = np.zeros((n + 6, n + 6)), np.zeros(n + 6)
        A[:n, :n], b[:n] = self.robot.joint_velocity_damper(*self.damper, n)
        if self.solids:  # the robot's own follow it, as they do in each step of the toolbox's simulator
            self.robot._update_link_tf(q)
            self.robot._propogate_scene_tree()
            centres = np.array([part._wT[:3, 3] for link in self.robot.links for part in link.collision])
        for (shape, radius), item in zip(self.solids, seen.objects):
            if np.linalg.norm(centres - item.position, axis=1).min() > REACH + radius:
                continue  # it would have no row
            shape.T = spatialmath.SE3(frame(item), check=False).A
            shape._propogate_scene_tree()
            links = self.robot.link_dict  # of Frankie from the base on, without its hand
            ends = {"end": links["panda_link8"]} if self.dof else {"start": links["panda_link1"], "end": links["panda_hand"]}
            more, bound = self.robot.link_collision_damper(shape, q, 0.3, 0.05, self.avoidance, **ends)
            if more is not None and bound is not None:
                A = np.r_[A, np.c_[more[:, :n], np.zeros((len(more), 6))]]
                b = np.r_[b, bound]
        return A, b

    def step(self, seen):
        robot, n, dof = self.robot, self.robot.n, self.dof
        q = np.r_[np.zeros(dof), seen.q]
        if dof:
            robot._T = spatialmath.SE3.Rt(spatialmath.SO3.Rz(seen.base[2]), [seen.base[0], seen.base[1], 0]).A
        robot.q = q
        X_WE, goal = robot.fkine(q).A, frame(seen.goal)
        error = np.sum(np.abs((np.linalg.inv(X_WE) @ goal)[:3, 3]))
        Q = np.eye(n + 6)
        Q[:n, :n] *= self.effort
        Q[:dof, :dof] /= error
        Q[n:, n:] /= error
        twist, _ = rtb.p_servo(X_WE, goal, self.gain)
        twist[3:] *= self.turn
        start = robot.links[4] if dof else None
        c = np.r_[np.zeros(dof), -robot.jacobm(q, start=start).reshape(n - dof), np.zeros(6)]
        if dof:
            X_BE = robot.fkine(q, include_base=False).A
            c[0] = -self.facing * math.atan2(X_BE[1, 3], X_BE[0, 3])
        most = np.r_[robot.qdlim[:n], 10 * np.ones(6)]
        A, b = self.rows(q, seen)
        x = qpsolvers.solve_qp(Q, c, A, b, np.c_[robot.jacobe(q), np.eye(6)], twist.reshape(6), lb=-most, ub=most,
                               solver="quadprog")
        if x is None:
            return {"command": np.zeros(len(seen.qdot)), "status": "infeasible", "fallback": "brake"}
        velocity = x[:n]
        if dof and self.fast:  # the example drives at a speed that grows near the goal
            velocity = velocity * (0.7 / error if error > 0.5 else 1.4)
        return np.r_[velocity[1], velocity[0], velocity[2:]] if dof else velocity  # its base turns first


class Neo(Holistic):
    dof = 0

    def __init__(self, gain=0.5, turn=1.0, effort=0.01, stop=0.05, influence=0.9, avoid=True, avoidance=1.0):
        super().__init__(gain, turn, effort, 0.0, stop, influence, avoid, avoidance, False)
