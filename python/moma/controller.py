"""moma's own controller, step by step."""

from __future__ import annotations

import json
import os
from dataclasses import field, make_dataclass
from typing import Any, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from . import _core, _runner
from .case import _core_arguments
from .robot import Robot

Floats = NDArray[np.float64]


def _defined(name: str, members: list[dict[str, Any]], doc: str) -> Any:
    """A class for what is handed over, with these members of moma's own description; what has no default there comes first."""
    required, others = [], []
    for member in members:
        key = member["name"]
        if "list" in member:
            others.append((key, Sequence, field(default_factory=list)))
        elif "given" in member:
            others.append((key, Any, None))
        elif "otherwise" not in member:
            required.append((key, Any))
        elif member["shape"]:
            value = np.reshape(member["otherwise"], member["shape"])
            others.append((key, Any, field(default_factory=value.copy)))
        else:
            kind = bool if "truth" in member else float
            others.append((key, kind, kind(member["otherwise"][0])))
    made = make_dataclass(name, required + others, eq=False, namespace={"__module__": __name__})
    lines = [": ".join([m["name"]] + [m[key] for key in ("unit", "text") if key in m]) for m in members]
    made.__doc__ = "\n".join([doc, "", *lines])
    return made


_LAYOUTS = json.loads(_core.layouts(0, 0))
_PARTS = {member["name"]: member.get("members") for member in _LAYOUTS["observation"]}

Pose: Any = _defined(
    "Pose",
    _PARTS["goal"],
    "A frame that moves, in world axes. rotation is a 3 x 3 matrix, or a unit quaternion [w, x, y, z].",
)
"""A frame that moves."""

SensedObject: Any = _defined("SensedObject", _PARTS["objects"], "An object as it is sensed now: as a Pose, and more.")
"""An object as it is sensed now."""

Observation: Any = _defined(
    "Observation",
    _LAYOUTS["observation"],
    """What a controller may know at one step.

    qdot is measured, never made up: from it the controller learns how late drives and sensors are. Who measures none gives the
    differences of what is measured, over the control period. time [s] tells missed steps, by any clock that goes on evenly;
    where it stays the same, steps are taken to be regular.""",
)
"""What a controller may know at one step."""


class Step(_runner.record("Step", _LAYOUTS["step"])):  # type: ignore[misc]
    """A command and how it came about; a Python controller's step() may return it as it is."""

    #: The Observation that the step acted on: with `prediction`, what there will be when its command takes effect.
    predicted: Any = None


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
        self._core = _core.Controller(robot._core, *_core_arguments(parameters), control_period)
        self._layouts = robot._layouts
        self._step = _runner.record("Step", self._layouts["step"], Step)
        self._seen = _runner.record("Observation", self._layouts["observation"])
        self.control_period: float = control_period
        self.warnings: tuple[str, ...] = tuple(self._core.warnings)

    @property
    def parameters(self) -> dict[str, Any]:
        """All of them, defaults included."""
        return json.loads(self._core.parameters)

    def reset(self, objects: Sequence[Any] = ()) -> None:
        """A motion begins among objects: dicts with "name", "shape" and "size" (a convex one's "vertices" and "triangles"), as
        World.objects has them, or what a Python controller of a suite gets."""
        self._core.reset(json.dumps(list(objects), default=_plain))

    def step(self, seen: Any) -> Any:
        """The next command, a Step."""
        step = self._step(self._core.step(self._numbers(seen)))
        step.predicted = self._seen(self._core.predicted())
        return step

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
        known = self._core.num_objects
        if len(seen.objects) != known:
            raise ValueError(f"objects: found {len(seen.objects)}, expected {known}, those of reset()")
        objects = self._layouts["observation"][-1]
        numbers = np.zeros(objects["at"] + known * objects["count"])
        _pack(self._layouts["observation"], seen, "", numbers)
        return numbers


def _pack(members: list[dict[str, Any]], record: Any, where: str, numbers: Floats) -> None:
    for member in members:
        name, value = where + member["name"], getattr(record, member["name"])
        at, count = member["at"], member["count"]
        if "list" in member:
            for i, item in enumerate(value):
                _pack(member["members"], item, f"{name}[{i}].", numbers[at + i * count :])
        elif "members" in member:
            _pack(member["members"], value, name + ".", numbers[at:])
        elif value is not None or "given" not in member:
            numbers[at : at + count] = _part(name, value, member)
            if "given" in member:
                numbers[member["given"]] = 1.0


def _part(name: str, value: Any, member: dict[str, Any]) -> Floats:
    found = None if value is None else np.asarray(value, dtype=np.float64)
    if found is not None and found.size == 4 and "rotation" in member:
        return _rotation(name, found.reshape(-1))
    count = member["count"]
    if found is None or found.size != count:
        what = "None" if found is None else f"{found.size} numbers"
        also = ", or the 4 of a quaternion [w, x, y, z]" if "rotation" in member else ""
        raise ValueError(f"{name}: found {what}, expected {count} number{'s' if count > 1 else ''}{also}")
    if "rotation" in member and np.isfinite(found).all():
        matrix = found.reshape(3, 3)
        if np.abs(matrix @ matrix.T - np.eye(3)).max() > 1e-3 or np.linalg.det(matrix) < 0.0:
            raise ValueError(f"{name}: found a matrix that is no rotation: its columns are no right-handed unit axes")
    return found.reshape(-1)


def _rotation(name: str, quaternion: Floats) -> Floats:
    length = float(np.linalg.norm(quaternion))
    if not abs(length - 1.0) <= 1e-3:
        raise ValueError(f"{name}: found 4 numbers of length {length:g}, expected a unit quaternion [w, x, y, z]")
    w, v = quaternion[0] / length, quaternion[1:] / length
    cross = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
    return (np.eye(3) + 2.0 * (w * cross + cross @ cross)).reshape(-1)


def _plain(value: Any) -> Any:
    """Arrays as lists; what a Python controller is told of as a dict."""
    if hasattr(value, "tolist"):
        return value.tolist()
    return dict(value) if isinstance(value, Mapping) else vars(value)
