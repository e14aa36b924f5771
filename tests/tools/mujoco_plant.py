"""moma's commands in MuJoCo: the base's ramp, wheels and joints that follow, first contact with an object."""
import math
from dataclasses import dataclass

import mujoco
import numpy as np

from mjcf import BASE_DRIVES, STEP


@dataclass
class Arm:
    """The controlled joints, in moma's order."""

    names: list
    lower: np.ndarray
    upper: np.ndarray
    velocity: np.ndarray
    effort: np.ndarray

    def position(self, model):
        return [int(model.jnt_qposadr[model.joint(name).id]) for name in self.names]

    def dof(self, model):
        return [int(model.jnt_dofadr[model.joint(name).id]) for name in self.names]


def arm_of(robot):
    joints = {link["joint"]["name"]: link["joint"] for link in robot["links"] if "joint" in link}
    chosen = [joints[name] for name in robot["joints"]]
    return Arm(list(robot["joints"]),
               np.array([-np.inf if j["lower"] is None else j["lower"] for j in chosen]),
               np.array([np.inf if j["upper"] is None else j["upper"] for j in chosen]),
               np.array([j["velocity"] for j in chosen]), np.array([j["effort"] for j in chosen]))


def ramp(current, wanted, limits, h):
    """The base's command follows the wanted one within its linear and its angular acceleration: what it is after a
    step of h seconds, and its mean over the step. Lists, which are quicker than arrays of two or three."""
    if current == wanted:
        return current, current
    out, mean = [], []
    for part, most in ((slice(None, -1), limits[0]), (slice(-1, None), limits[1])):
        from_, to = current[part], wanted[part]
        length = math.dist(from_, to)
        time = min(length / most, h)
        if time == h:
            to = [c + (w - c) * (h * most / length) for c, w in zip(from_, to)]
        out += to
        mean += [w - (w - c) * (0.5 * time / h) for c, w in zip(from_, to)]
    return out, mean


class MujocoPlant:
    # A drive is a constraint to a moving value. MuJoCo damps its whole rate, not the rate of the error, and so lags by
    # 2 time constants (b / k with b = 2 / tc, k = 1 / tc^2): the value is ahead by that.
    LAG = 2 * 2 * STEP
    FASTEST = 20.0  # of a point of the robot to one of the object, far more than any [m/s]

    def __init__(self, model, robot, arm):
        self.model, self.robot, self.arm = model, robot, arm
        self.data = mujoco.MjData(model)
        self.data.qpos[arm.position(model)] = robot["ready"]
        self.dof = len(BASE_DRIVES.get(robot["base"]["type"], []))
        names = BASE_DRIVES.get(robot["base"]["type"], []) + arm.names
        self.drives = [model.equality(name).id for name in names]
        self.targets = model.eq_data[:, 0]
        self.aim = np.concatenate([np.zeros(self.dof), robot["ready"]])
        self.ramped = [0.0] * self.dof  # the base's command at the end of a step
        self.mean = [0.0] * self.dof    # and over the step
        self.heading = 0.0
        # MuJoCo makes no contact of two solids that nothing moves, as a bolted base and an object are to it.
        self.fixed = [model.geom(s["name"]).id for s in robot["shapes"] if s["rigid_with_base"] and self.dof == 0]
        self.shapes = [model.geom(shape["name"]).id for shape in robot["shapes"]]
        things = [i for i in range(model.ngeom) if model.geom(i).name == "object0"]
        self.thing = things[0] if things else -1
        mujoco.mj_forward(model, self.data)

    def rates(self, command):
        """Of every drive, for this velocity of the base and the joints."""
        base = self.mean
        if self.dof == 2:
            wheels = self.robot["support"]["wheels"]
            turn = 0.5 * base[1] * wheels["separation"]
            base = [(base[0] - turn) / wheels["radius"], (base[0] + turn) / wheels["radius"]]
        elif self.dof == 3:
            c, s = math.cos(self.heading), math.sin(self.heading)
            base = [c * base[0] - s * base[1], s * base[0] + c * base[1], base[2]]
        return np.array(base + command[self.dof:])

    def step(self, command, h):
        """`command` is a list."""
        if self.dof:
            self.ramped, self.mean = ramp(self.ramped, command[: self.dof], self.robot["base"]["max_acceleration"], h)
        if self.dof == 3:
            self.heading = self.aim[2] + 0.5 * h * self.mean[2]  # of the arc's middle
        rates = self.rates(command)
        self.targets[self.drives] = self.aim + self.LAG * rates
        self.aim += h * rates
        mujoco.mj_step(self.model, self.data)

    def q(self):
        return self.data.qpos[self.arm.position(self.model)]

    def base(self, near):
        """(x, y, phi), phi on the turn of `near`."""
        mujoco.mj_kinematics(self.model, self.data)
        body = self.model.body("@base").id
        R = self.data.xmat[body].reshape(3, 3)
        phi = np.arctan2(R[1, 0], R[0, 0])
        phi += 2 * np.pi * np.round((near - phi) / (2 * np.pi))
        return np.array([*self.data.xpos[body][:2], phi])

    def gap_of(self, geoms):
        return min((mujoco.mj_geomDistance(self.model, self.data, geom, self.thing, 1.0, None) for geom in geoms),
                   default=np.inf)

    def gap(self):
        """Least distance of a robot shape to the object; negative where they overlap."""
        mujoco.mj_kinematics(self.model, self.data)
        return self.gap_of(self.shapes)

    def touching(self):
        """Whether the robot and the object were in contact before the last step: that is what data holds."""
        contact = self.data.contact
        touched = self.thing in contact.geom and np.any((contact.geom == self.thing).any(axis=1) & (contact.dist < 0.0))
        return bool(touched) or self.gap_of(self.fixed) < 0.0

    def until_contact(self, commands, thing, period, h, other):
        """Time of first contact with the object or None; the gap at time `other` (infinite where that is None or
        later); the least gap at control steps."""
        moving = np.asarray(thing.get("velocity", (0, 0, 0)))
        gap_then = least = np.inf
        time = 0.0
        for command in commands.tolist():
            gap = self.gap()
            least = min(least, gap)
            near = gap < self.FASTEST * period
            for _ in range(round(period / h)):
                if "velocity" in thing:
                    self.data.mocap_pos[0] = np.asarray(thing["position"]) + moving * time
                self.step(command, h)
                if near and self.touching():
                    return time, gap_then, least
                time += h
                if other is not None and abs(time - other) < 0.5 * h:
                    gap_then = self.gap()
        return None, gap_then, least
