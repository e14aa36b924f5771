"""What stands between the plant and its controller: a suite's `disturbances`, written anew from docs/reference/disturbances.md.

Draws are NumPy's, so that errors have the sizes of moma's and other values.
"""

from collections import deque

import moma
import mujoco
import numpy as np


class Settings:
    """Of a suite's disturbances, by dotted keys; unused() are those that nothing here asked for."""

    def __init__(self, disturbances):
        self.values, self.used = {}, set()
        self.flatten("", disturbances)

    def flatten(self, before, values):
        for key, value in values.items():
            self.flatten(f"{before}{key}.", value) if isinstance(value, dict) else self.values.update({before + key: value})

    def __call__(self, key, default=0.0):
        self.used.add(key)
        return self.values.get(key, default)

    def unused(self):
        return sorted(self.values.keys() - self.used)


class Late:
    """Values of control periods, `seconds` later; `before` until the first is due, or the first itself."""

    def __init__(self, seconds, period, before=None):
        steps = int(np.ceil(seconds / period - 1e-9))
        self.line = deque([before] * steps if before is not None else [], maxlen=steps + 1)

    def __call__(self, value):
        self.line.append(value)
        return self.line[0]


def frame(base):
    c, s = np.cos(base[2]), np.sin(base[2])
    return np.array([[c, -s, 0, base[0]], [s, c, 0, base[1]], [0, 0, 1, 0], [0, 0, 0, 1]])


def turned(rotation_vector, R):
    angle, quaternion, turn = np.linalg.norm(rotation_vector), np.empty(4), np.empty(9)
    mujoco.mju_axisAngle2Quat(quaternion, rotation_vector / max(angle, 1e-12), angle)
    mujoco.mju_quat2Mat(turn, quaternion)
    return turn.reshape(3, 3) @ R


class Tracked:
    """The pose of an object or the goal, as a sensor on the base sees it."""

    def __init__(self, kind, settings, draw, X_W):
        self.X_W, self.draw = X_W, draw
        self.noise = [settings(f"{kind}.noise.position"), settings(f"{kind}.noise.rotation")]
        self.bias = draw.normal(size=(2, 3)) * [[settings(f"{kind}.bias.position")], [settings(f"{kind}.bias.rotation")]]
        self.on_base = settings(f"{kind}.frame", "world") == "base"

    def measure(self, true_base, seen_base):
        X = frame(seen_base) @ np.linalg.inv(frame(true_base)) @ self.X_W if self.on_base else self.X_W
        move, turn = self.bias + self.draw.normal(size=(2, 3)) * np.reshape(self.noise, (2, 1))
        return X[:3, 3] + move, turned(turn, X[:3, :3])


class Sensors:
    def __init__(self, settings, draw, plant, world, period):
        self.s, self.draw, self.plant, self.period = settings, draw, plant, period
        X = {item["name"]: pose_of(item) for item in world.objects}
        self.objects = {name: Tracked("objects", settings, draw, X_W) for name, X_W in X.items()}
        self.goal = Tracked("goal", settings, draw, pose_of(world["goal"]))
        for kind in ("objects", "goal"):  # everything rests, and is known to where the suite says so
            settings(f"{kind}.resting_is_known"), settings(f"{kind}.velocity_noise.linear"), settings(f"{kind}.velocity_noise.angular")
        self.joint_bias = draw.normal(0, settings("joints.bias"), len(plant.q_at))
        odometry = [settings(f"base.odometry.{key}") for key in ("distance", "turn", "heading")]
        self.way_error, self.turn_error, self.heading_error = draw.normal(size=3) * odometry
        self.walk = [settings("base.odometry.walk.position"), settings("base.odometry.walk.rotation")]
        self.last = self.reckoned = None
        self.in_view = dict.fromkeys(X, 0.0)  # [s]
        self.late = {kind: Late(settings(f"{kind}.delay"), period) for kind in ("joints", "base", "objects", "goal")}

    def observe(self, time):
        s, draw, plant = self.s, self.draw, self.plant
        base, n = plant.base(), len(plant.q_at)
        seen = self.reckon(base) + draw.normal(size=3) * [*[s("base.noise.position")] * 2, s("base.noise.rotation")]
        speed = plant.velocities()
        speed[:2] += draw.normal(size=2) * [s("base.velocity_noise.linear"), s("base.velocity_noise.angular")]
        speed[2:] += draw.normal(0, s("joints.velocity_noise"), n)
        q, rates = self.late["joints"]((plant.q() + self.joint_bias + draw.normal(0, s("joints.noise"), n), speed[2:]))
        base_seen, base_speed = self.late["base"]((seen, speed[:2]))
        self.look(time)
        things = self.late["objects"]([
            moma.SensedObject(*item.measure(base, seen)) if self.found(name) else moma.SensedObject(visible=False)
            for name, item in self.objects.items()])
        goal = self.late["goal"](moma.Pose(*self.goal.measure(base, seen)))
        return moma.Observation(q, np.concatenate([base_speed, rates]), goal, base=base_seen, time=time, objects=things)

    def reckon(self, base):
        """Dead reckoning, wrong by a part of each way and turn and by a random walk."""
        if self.last is None:
            self.last, self.reckoned = base, base.copy()
        turn = base[2] - self.last[2]
        middle = self.last[2] + turn / 2
        ahead, left = (base[:2] - self.last[:2]) @ [[np.cos(middle), -np.sin(middle)], [np.sin(middle), np.cos(middle)]]
        way, self.last = np.hypot(ahead, left), base
        walk = self.draw.normal(size=3) * np.sqrt(way) * [*[self.walk[0]] * 2, self.walk[1]]
        moved = (1 + self.way_error) * np.array([ahead, left]) + walk[:2]
        turn = (1 + self.turn_error) * turn + self.heading_error * way + walk[2]
        self.reckoned = self.reckoned + [*frame([0, 0, self.reckoned[2] + turn / 2])[:2, :2] @ moved, turn]
        return self.reckoned

    def found(self, name):
        return self.in_view[name] > self.s("objects.detection") or not self.looks

    def look(self, time):
        """How long each object has been in view of the camera; what was found stays known."""
        reach, opening = self.s("objects.range", np.inf), self.s("objects.field_of_view", 2 * np.pi)
        hides, at_start = self.s("objects.occlusion", False), self.s("objects.known_at_start", False)
        axis = self.s("objects.axis", [1, 0, 0])
        self.looks = np.isfinite(reach) or hides or opening < 2 * np.pi
        for name, seconds in self.in_view.items() if self.looks else ():
            if not self.found(name):
                sees = self.plant.sees(name, reach, axis, opening, hides)
                self.in_view[name] = 0.0 if not sees else np.inf if at_start and time == 0.0 else seconds + self.period


class Drives:
    """From the controller's command to the plant's: late, scaled, with a first-order lag."""

    def __init__(self, settings, draw, joints, period):
        parts = (("base", 2), ("joints", joints))
        self.late = [Late(settings(f"actuators.{part}.delay"), period, np.zeros(n)) for part, n in parts]
        gains = [settings(f"actuators.base.gain_error.{key}") for key in ("linear", "angular")]
        self.gain = 1 + draw.normal(size=2 + joints) * [*gains, *[settings("actuators.joints.gain_error")] * joints]
        lags = np.concatenate([np.full(n, settings(f"actuators.{part}.lag")) for part, n in parts])
        self.keep = np.where(lags > 0, np.exp(-period / np.maximum(lags, 1e-9)), 0.0)
        self.moving = np.zeros(2 + joints)

    def __call__(self, command):
        wanted = self.gain * np.concatenate([self.late[0](command[:2]), self.late[1](command[2:])])
        self.moving = wanted + self.keep * (self.moving - wanted)
        return self.moving


def pose_of(item):
    X, rotation = np.eye(4), np.empty(9)
    mujoco.mju_quat2Mat(rotation, item["quaternion"])
    X[:3, 3], X[:3, :3] = item["position"], rotation.reshape(3, 3)
    return X
