"""moma's own controller, step by step."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from typing import Any, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .robot import Robot

Floats = NDArray[np.float64]


def _zeros(size: int) -> Any:
    return field(default_factory=lambda: np.zeros(size))


@dataclass
class Pose:
    """A frame that moves, in world axes; twist is [angular; linear]."""

    position: ArrayLike = _zeros(3)
    rotation: ArrayLike = field(default_factory=lambda: np.eye(3))
    twist: ArrayLike = _zeros(6)


@dataclass
class SensedObject(Pose):
    """An object as it is sensed now; covariances (3 x 3) where a tracker states any."""

    visible: bool = True
    position_covariance: ArrayLike | None = None
    velocity_covariance: ArrayLike | None = None


@dataclass
class Observation:
    """What a controller may know at one step; objects in the order of reset().

    qdot is measured, never made up: from it the controller learns how late drives and sensors are. Who measures none gives the
    differences of what is measured, over the control period. time [s] tells missed steps, by any clock that goes on evenly;
    where it stays the same, steps are taken to be regular.
    """

    q: ArrayLike
    qdot: ArrayLike
    goal: Pose
    base: ArrayLike = _zeros(3)
    time: float = 0.0
    objects: Sequence[SensedObject] = ()


@dataclass(frozen=True)
class Step:
    """A command and how it came about; a Python controller's step() may return it as it is."""

    command: Floats  #: velocities, in the order of robot.velocities
    status: str  #: of the problem as it was posed: "solved", "infeasible", "max_iterations", "invalid_input"
    fallback: str  #: what replaced it: "none", "no_acceleration", "relaxed", "brake"
    slack: Floats
    error: Floats  #: [rotation vector; position] from E to the goal
    manipulability: float
    least_distance: float
    rows: int
    active_rows: int
    iterations: int


class Controller:
    """moma's controller of a file, or of what stands in one, for a robot. The commands of one and the same sequence of calls
    are those that a trial of the program has, bit for bit.

    Observations are Observation, or what a Python controller of a suite gets (docs/how-to/python-controller.md).
    """

    def __init__(
        self,
        robot: Robot,
        parameters: str | os.PathLike[str] | Mapping[str, Any],
        control_period: float = 0.02,
    ):
        self.robot = robot
        if isinstance(parameters, Mapping):
            self._core = _core.Controller(robot._core, json.dumps(parameters), control_period)
        else:
            self._core = _core.Controller.load(robot._core, os.fspath(parameters), control_period)
        self.control_period: float = control_period
        self.warnings: tuple[str, ...] = tuple(self._core.warnings)

    @property
    def parameters(self) -> dict[str, Any]:
        """All of them, defaults included."""
        return json.loads(self._core.parameters)

    def reset(self, objects: Sequence[Any] = ()) -> None:
        """A motion begins among objects: dicts with "name", "kind" and "size" (a convex one's "vertices" and "triangles"), or
        what a Python controller of a suite gets."""
        self._core.reset(json.dumps([_shape(item) for item in objects]))

    def step(self, seen: Any) -> Step:
        return Step(*self._core.step(self._numbers(seen)))

    def solve(self, seen: Any) -> dict[str, Any]:
        """Everything that `moma solve` prints of the step that would come next; the controller does not go on by it."""
        return json.loads(self._core.solve(self._numbers(seen)))

    def explain(self, seen: Any) -> str:
        """The same in words."""
        return self._core.explain(self._numbers(seen))

    def _numbers(self, seen: Any) -> Floats:
        # An observation of a suite's controller holds just these numbers already.
        whole = getattr(seen, "_values", None)
        if isinstance(whole, np.ndarray):
            return whole
        parts = [
            _part("time", seen.time, 1),
            _part("base", seen.base, 3),
            *_frame("goal", seen.goal),
            _part("q", seen.q, len(self.robot.joints)),
            _part("qdot", seen.qdot, len(self.robot.velocities)),
        ]
        for i, item in enumerate(seen.objects):
            name = f"objects[{i}]"
            parts.extend(_frame(name, item))
            position, velocity = item.position_covariance, item.velocity_covariance
            tracked = position is not None or velocity is not None
            parts.append(np.array([float(item.visible), float(tracked)]))
            for key, matrix in (("position_covariance", position), ("velocity_covariance", velocity)):
                parts.append(np.zeros(9) if matrix is None else _part(f"{name}.{key}", matrix, 9))
        return np.concatenate(parts)


def _part(name: str, value: Any, size: int) -> Floats:
    found = None if value is None else np.asarray(value, dtype=np.float64)
    if found is None or found.size != size:
        what = "None" if found is None else f"{found.size} numbers"
        raise ValueError(f"{name}: found {what}, expected {size} number{'s' if size > 1 else ''}")
    return found.reshape(-1)


def _frame(name: str, pose: Any) -> tuple[Floats, Floats, Floats]:
    rotation = pose.rotation
    if np.size(rotation) == 4:
        raise ValueError(f"{name}.rotation: found 4 numbers, which a quaternion has; expected a 3 x 3 matrix")
    return (
        _part(f"{name}.position", pose.position, 3),
        _part(f"{name}.rotation", rotation, 9),
        _part(f"{name}.twist", pose.twist, 6),
    )


def _shape(item: Any) -> dict[str, Any]:
    def value(key: str) -> Any:
        return item.get(key, ()) if isinstance(item, Mapping) else getattr(item, key, ())

    return {
        "name": value("name") or "",
        "kind": value("kind"),
        "size": [float(v) for v in value("size")],
        "vertices": [[float(v) for v in vertex] for vertex in value("vertices")],
        "triangles": [[int(v) for v in triangle] for triangle in value("triangles")],
    }
