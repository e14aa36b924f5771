"""A robot: kinematics, manipulability, distances."""

from __future__ import annotations

import json
import os
from typing import Any, Mapping, NamedTuple, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core

Floats = NDArray[np.float64]


class Distance(NamedTuple):
    """Signed distance between a shape of the robot and an object, the floor or another shape; the normal points along
    growing distance as `first` moves."""

    kind: str  #: "object", "floor" or "self"
    first: str
    second: str
    d: float
    n_W: Floats
    p_first_W: Floats
    p_second_W: Floats


class Robot:
    """A robot from its file, or from what stands in one (a dict; also the `description` that a Python controller gets).

    Functions of configurations take q as (joints,) or (N, joints), and base (x, y, phi) as (3,) or (N, 3): a base that
    is left out stands at the origin. Results have the leading N where q or base has it.
    """

    def __init__(self, source: str | os.PathLike[str] | Mapping[str, Any]):
        if isinstance(source, _core.Robot):  # of an Env
            self._core = source
        elif isinstance(source, Mapping):
            self._core = _core.Robot.read(json.dumps(source))
        else:
            self._core = _core.Robot.load(os.fspath(source))
        self.name: str = self._core.name
        self.base: str = self._core.base
        self.joints: tuple[str, ...] = tuple(self._core.joints)
        self.velocities: tuple[str, ...] = tuple(self._core.velocities)
        self.links: tuple[str, ...] = tuple(self._core.links)
        self.lower: Floats = np.array(self._core.lower)
        self.upper: Floats = np.array(self._core.upper)
        self.ready: Floats = self._core.ready
        self.velocity_limits: Floats = self._core.velocity_limits
        self.warnings: tuple[str, ...] = tuple(self._core.warnings)
        self.notes: tuple[str, ...] = tuple(self._core.notes)
        # Where the numbers of observations, steps and their details stand for this robot.
        self._layouts: dict[str, Any] = json.loads(_core.layouts(len(self.joints), len(self.velocities)))

    def __repr__(self) -> str:
        return f"<moma.Robot {self.name}: {self.base} base, {len(self.joints)} joints>"

    @property
    def description(self) -> dict[str, Any]:
        """Everything that decides the robot, the URDF's text included: Robot(robot.description) is the same robot."""
        return json.loads(self._core.resolved)

    def fk(self, q: ArrayLike, base: ArrayLike | None = None, link: str | None = None) -> Floats:
        """Pose (4 x 4) of E in W, or of a link."""
        rows, bases, single = self._configurations(q, base)
        poses = self._core.fk(bases, rows, link or "").reshape(-1, 4, 4)
        return poses[0] if single else poses

    def jacobian(self, q: ArrayLike, base: ArrayLike | None = None) -> Floats:
        """J_WE_W (6 x velocities): [angular; linear] at E in world axes, columns in the order of `velocities`."""
        rows, bases, single = self._configurations(q, base)
        jacobians = self._core.jacobian(bases, rows).reshape(len(rows), 6, -1)
        return jacobians[0] if single else jacobians

    def manipulability(self, q: ArrayLike, rows: str = "translation") -> Floats | float:
        """Yoshikawa's sqrt(det(J J^T)) of the arm, of its "translation", "rotation" or "all" rows."""
        values, _, single = self._configurations(q, None)
        found = self._core.manipulability(values, rows)
        return float(found[0]) if single else found

    def manipulability_gradient(self, q: ArrayLike, rows: str = "translation") -> Floats:
        """Its derivative by each joint; zero at a singularity."""
        values, _, single = self._configurations(q, None)
        found = self._core.manipulability_gradient(values, rows)
        return found[0] if single else found

    def integrate(
        self, q: ArrayLike, velocity: ArrayLike, seconds: float, base: ArrayLike | None = None
    ) -> tuple[Floats, Floats]:
        """(q, base) after a constant velocity: joints linearly, the base along its exact arc."""
        rows, bases, single = self._configurations(q, base)
        rates = np.asarray(velocity, dtype=np.float64)
        if rates.ndim == 2 and len(rows) == 1:
            rows, bases = (np.broadcast_to(part, (len(rates), part.shape[1])) for part in (rows, bases))
        single = single and rates.ndim == 1
        rates = np.broadcast_to(rates, (len(rows), rates.shape[-1]))
        moved, turned = self._core.integrate(*(np.ascontiguousarray(part) for part in (bases, rows, rates)), seconds)
        return (turned[0], moved[0]) if single else (turned, moved)

    def distances(
        self,
        q: ArrayLike,
        base: ArrayLike | None = None,
        objects: Sequence[Mapping[str, Any]] = (),
        *,
        within: float = 1.0,
        floor: float = -1.0,
        self_pairs: float = -1.0,
    ) -> list[Distance]:
        """Pairs closer than `within` [m] of an object, `floor` of the floor, `self_pairs` of each other (negative: not
        looked at), nearest first. Objects are as in a case file: {"shape": "sphere", "size": [0.1], "position": [1, 0, 0.5]}."""
        text = json.dumps([dict(item) for item in objects])
        place = np.zeros(3) if base is None else _vector(base)
        found = self._core.distances(place, _vector(q), text, within, floor, self_pairs)
        return sorted((Distance(*pair) for pair in found), key=lambda pair: pair.d)

    def clearance(
        self, q: ArrayLike, base: ArrayLike | None = None, objects: Sequence[Mapping[str, Any]] = ()
    ) -> Floats | float:
        """Least signed distance to any of the objects, whose form is that of distances(); infinite without."""
        rows, bases, single = self._configurations(q, base)
        found = self._core.clearance(bases, rows, json.dumps([dict(item) for item in objects]))
        return float(found[0]) if single else found

    def _configurations(self, q: ArrayLike, base: ArrayLike | None) -> tuple[Floats, Floats, bool]:
        rows = np.asarray(q, dtype=np.float64)
        bases = np.zeros(3) if base is None else np.asarray(base, dtype=np.float64)
        if rows.ndim not in (1, 2) or bases.ndim not in (1, 2):
            raise ValueError(f"q has {rows.ndim} and base {bases.ndim} dimensions; both have 1, or 2 for several")
        single = rows.ndim == 1 and bases.ndim == 1
        rows, bases = np.atleast_2d(rows), np.atleast_2d(bases)
        count = max(len(rows), len(bases))
        # A single one stands beside all of the other.
        rows, bases = (np.repeat(part, count, axis=0) if len(part) == 1 else part for part in (rows, bases))
        return np.ascontiguousarray(rows), np.ascontiguousarray(bases), single


def _vector(values: ArrayLike) -> Floats:
    return np.ascontiguousarray(values, dtype=np.float64).reshape(-1)
