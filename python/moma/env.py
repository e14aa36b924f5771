"""Trials for Gymnasium: the program's own trial, stepped from outside. Needs gymnasium (pip install "moma[gym]")."""

from __future__ import annotations

import json
import os
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Callable, Mapping, NamedTuple, Sequence

try:
    import gymnasium
    from gymnasium import spaces
except ImportError as error:
    raise ImportError('moma.Env needs gymnasium: pip install "moma[gym]"') from error
import numpy as np
from numpy.typing import NDArray

from . import _core, _runner
from .robot import Robot
from .suite import Suite
from .world import World

Floats = NDArray[np.float64]

OUTCOMES: tuple[str, ...] = tuple(_core.OUTCOMES)
RUNNING, SUCCESS, TIMEOUT = -1, OUTCOMES.index("success"), OUTCOMES.index("timeout")
SLOT = 22  # numbers of an object in an observation
LOOKED_AT = 64  # worlds in which objects are counted where nobody says how many there are


class Signals(NamedTuple):
    """What is measured of the truth at a state; numbers of an Env, arrays of a VectorEnv. NaN where there is none."""

    outcome: Any  #: -1 while the trial goes on, else its place in moma.OUTCOMES
    time: Any  #: [s]
    position_error: Any  #: [m]
    orientation_error: Any  #: [rad]
    manipulability: Any  #: of the arm's translation
    clearance: Any  #: least distance to an object so far [m]


Reward = Callable[[Signals, Signals], Any]


def progress(before: Signals, after: Signals) -> Any:
    """The reward unless told otherwise: metres that the goal came nearer, and 1 for success, -1 for any other end but running
    out of time."""
    nearer = np.nan_to_num(np.asarray(before.position_error) - np.asarray(after.position_error))
    outcome = np.asarray(after.outcome)
    failed = (outcome != RUNNING) & (outcome != SUCCESS) & (outcome != TIMEOUT)
    return nearer + (outcome == SUCCESS) - 1.0 * failed


class _Trials:
    """What Env and VectorEnv share: trials of a suite, their spaces, and how numbers become observations."""

    def __init__(
        self,
        suite: Suite | str | os.PathLike[str] | Mapping[str, Any],
        count: int,
        changes: Mapping[str, Any] | None,
        point: int,
        worlds: Sequence[int] | None,
        objects: int | None,
        sensed: bool,
    ):
        chosen = suite if isinstance(suite, Suite) else Suite(suite)
        loaded = chosen.changed(changes or {}).load()
        self.worlds = np.arange(loaded.trials) if worlds is None else np.array(worlds, dtype=np.int64)
        if self.worlds.ndim != 1 or self.worlds.size == 0 or self.worlds.min() < 0:
            raise ValueError(f"worlds: found {worlds!r}, expected numbers of worlds from 0 on")
        if objects is None:
            objects = self._most_objects(loaded, point, sensed)
        self.core = _core.Trials(loaded, point, count, objects, not sensed)
        self.robot = Robot(self.core.robot)
        self.control_period: float = self.core.control_period
        self.robot.control_period = self.control_period
        self.slots = objects
        layout = self.robot._layouts["observation"]
        *parts, last = layout
        self.parts: dict[str, tuple[int, tuple[int, ...]]] = {m["name"]: (m["at"], (m["count"],)) for m in parts}
        self.parts["error"] = (last["at"], (6,))
        self.parts["objects"] = (last["at"] + 6, (objects, SLOT))
        at = last["at"] + 6 + objects * SLOT
        self._observation = _runner.record("Observation", layout)
        assert at == self.core.width
        every = {name: spaces.Box(-np.inf, np.inf, shape, np.float64) for name, (_, shape) in self.parts.items()}
        if objects == 0:
            del every["objects"]
        self.observations = spaces.Dict(every)
        limits = self.robot.velocity_limits
        self.actions = spaces.Box(-limits, limits, dtype=np.float64)

    def _most_objects(self, loaded: Any, point: int, sensed: bool) -> int:
        trial = _core.Trials(loaded, point, 1, 10_000, not sensed)
        seen, signals = np.empty((1, trial.width)), np.empty((1, len(Signals._fields)))
        idle = np.zeros((1, len(trial.robot.velocities)))
        most = 0
        for world in self.worlds[:LOOKED_AT]:
            trial.step(0, 1, idle, np.array([world], dtype=np.int64), seen, signals)
            most = max(most, len(json.loads(trial.objects(0))))
        return most

    def arrays(self, count: int) -> tuple[Floats, Floats]:
        return np.empty((count, self.core.width)), np.empty((count, len(Signals._fields)))

    def observation(self, numbers: Floats) -> dict[str, Floats]:
        """Views of one row, or of all."""
        found = {}
        for name, (at, shape) in self.parts.items():
            if name not in self.observations.spaces:
                continue
            part = numbers[..., at : at + int(np.prod(shape))]
            found[name] = part.reshape(*numbers.shape[:-1], *shape)
        return found

    def seen(self, i: int) -> Any:
        """What a controller of a suite gets in this state."""
        return self._observation(self.core.numbers(i))

    def shapes(self, i: int) -> list[Any]:
        """And is told of at its reset."""
        return [_runner.Shape(shape) for shape in json.loads(self.core.objects(i))]


class Env(gymnasium.Env):
    """One trial after the other of a suite (a file, a dict, or a Suite), in worlds drawn from `worlds` (numbers; the suite's
    `trials` unless told otherwise). Robot, rules, simulation and disturbances are those of the suite's point number `point`;
    its controllers take no part. Same world, same commands: the same bits as by `moma run`.

    An action is a velocity for each of robot.velocities [m/s, rad/s], base first, or whatever step() of a suite's Python
    controller may return, a moma.Step too. An observation is a dict of arrays: time, base (x, y, phi), q, qdot, goal (position,
    rotation by rows, twist, stop, free), error ([rotation vector; position] from E to the goal) and, where there are any, objects: a row
    for each with position, rotation, twist, edges of its bounding box and 1; zeros where nothing is visible. `objects` is how
    many rows there are; by default as many as the first 64 worlds need, and a world with more is a ValueError.

    What is observed is what the suite's sensors see, or with sensed=False the truth. `reward(before, after)` is told the Signals of
    both states (default: moma.env.progress). A trial that runs out of time is truncated, any other end terminates; info then
    has "outcome", "reason" and "trial", the row that a store would have.

    reset(options={"world": 17}) begins in that world, a World, or what stands in a world's file.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(
        self,
        suite: Suite | str | os.PathLike[str] | Mapping[str, Any],
        *,
        changes: Mapping[str, Any] | None = None,
        point: int = 0,
        worlds: Sequence[int] | None = None,
        objects: int | None = None,
        sensed: bool = True,
        reward: Reward = progress,
    ):
        self._trials = _Trials(suite, 1, changes, point, worlds, objects, sensed)
        self.robot: Robot = self._trials.robot
        self.control_period: float = self._trials.control_period
        self.observation_space = self._trials.observations
        self.action_space = self._trials.actions
        self._reward = reward
        self._answers = _runner.Answers(self.robot, self.robot._layouts["details"])
        self._idle = np.zeros((1, len(self.robot.velocities)))
        self._now: Signals | None = None
        self._shapes: list[Any] | None = None

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[dict[str, Floats], dict[str, Any]]:
        super().reset(seed=seed)
        world = (options or {}).get("world")
        if world is None:
            world = self.np_random.choice(self._trials.worlds)
        seen, signals = self._trials.arrays(1)
        if isinstance(world, (int, np.integer)):
            which = np.array([world], dtype=np.int64)
            if world < 0:
                raise ValueError(f"world: found {world}, expected a number from 0 on")
            self._trials.core.step(0, 1, self._idle, which, seen, signals)
        else:
            self._trials.core.begin(0, json.dumps(dict(World(world))))
            self._trials.core.look(0, seen, signals)
        self._shapes = None
        self._now = Signals(*signals[0].tolist())
        return self._trials.observation(seen[0]), self._info()

    def step(self, action: Any) -> tuple[dict[str, Floats], float, bool, bool, dict[str, Any]]:
        if self._now is None:
            raise RuntimeError("no trial has begun: call reset()")
        if self._now.outcome != RUNNING:
            raise RuntimeError(f"the trial has ended by {OUTCOMES[int(self._now.outcome)]}: call reset()")
        answer = np.frombuffer(self._answers.encode(action), "<f8", -1, _runner.HEADER.size)
        seen, signals = self._trials.arrays(1)
        going_on = np.array([-1], dtype=np.int64)
        self._trials.core.step(0, 1, answer.reshape(1, -1), going_on, seen, signals)
        before, self._now = self._now, Signals(*signals[0].tolist())
        reward = float(self._reward(before, self._now))
        truncated = self._now.outcome == TIMEOUT
        terminated = self._now.outcome != RUNNING and not truncated
        return self._trials.observation(seen[0]), reward, terminated, truncated, self._info()

    @property
    def seen(self) -> Any:
        """The same state as a Python controller of a suite is shown it (docs/how-to/python-controller.md); moma.Controller
        takes it as well."""
        return self._trials.seen(0)

    @property
    def objects(self) -> list[Any]:
        """What such a controller is told of at its reset()."""
        if self._shapes is None:
            self._shapes = self._trials.shapes(0)
        return self._shapes

    @property
    def world(self) -> World:
        """In which the trial is."""
        return World(json.loads(self._trials.core.world(0)))

    def trace(self) -> dict[str, Any]:
        """Of a trial that has ended, with one sample for each control step: what `moma replay --json` prints."""
        return json.loads(self._trials.core.trace(0))

    def _info(self) -> dict[str, Any]:
        assert self._now is not None
        info: dict[str, Any] = {name: None if np.isnan(value) else value for name, value in self._now._asdict().items()}
        del info["outcome"]
        if self._now.outcome != RUNNING:
            row = json.loads(self._trials.core.row(0))
            info.update(outcome=row["outcome"], reason=row["reason"], trial=row)
        return info


class VectorEnv(gymnasium.vector.VectorEnv):
    """`num_envs` trials of Env side by side, by `threads` threads that Python's interpreter lock does not hold up. The same
    commands give the same bits for any number of threads. A trial that has ended begins anew, in another world, with the next
    step, whose action it does not see (Gymnasium's AutoresetMode.NEXT_STEP). Actions are (num_envs, velocities);
    observations Env's, with num_envs in front."""

    metadata: dict[str, Any] = {"render_modes": [], "autoreset_mode": gymnasium.vector.AutoresetMode.NEXT_STEP}

    def __init__(
        self,
        suite: Suite | str | os.PathLike[str] | Mapping[str, Any],
        num_envs: int = 1,
        *,
        threads: int | None = None,
        changes: Mapping[str, Any] | None = None,
        point: int = 0,
        worlds: Sequence[int] | None = None,
        objects: int | None = None,
        sensed: bool = True,
        reward: Reward = progress,
    ):
        if num_envs < 1:
            raise ValueError(f"num_envs: found {num_envs}, expected at least 1")
        self.num_envs = num_envs
        self._trials = _Trials(suite, num_envs, changes, point, worlds, objects, sensed)
        self.robot: Robot = self._trials.robot
        self.control_period: float = self._trials.control_period
        self.single_observation_space = self._trials.observations
        self.single_action_space = self._trials.actions
        self.observation_space = gymnasium.vector.utils.batch_space(self.single_observation_space, num_envs)
        self.action_space = gymnasium.vector.utils.batch_space(self.single_action_space, num_envs)
        self._reward = reward
        self._now: Signals | None = None
        self._begun: list[int] = []
        count = min(threads or os.cpu_count() or 1, num_envs)
        edges = np.linspace(0, num_envs, count + 1).astype(int).tolist()
        # A trial stays with its thread: ODE has data for each.
        self._parts = [(a, b, ThreadPoolExecutor(1)) for a, b in zip(edges, edges[1:])] if count > 1 else []

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[dict[str, Floats], dict[str, Any]]:
        super().reset(seed=seed)
        worlds = (options or {}).get("worlds")
        worlds = self._draw(self.num_envs) if worlds is None else np.array(worlds, dtype=np.int64)
        if worlds.shape != (self.num_envs,) or worlds.min() < 0:
            raise ValueError(f"worlds: found {worlds.tolist()}, expected {self.num_envs} numbers from 0 on")
        seen = self._run(np.zeros((self.num_envs, len(self.robot.velocities))), worlds)
        return self._trials.observation(seen), self._infos()

    def step(self, actions: Any) -> tuple[dict[str, Floats], Floats, NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        if self._now is None:
            raise RuntimeError("no trial has begun: call reset()")
        ended = self._now.outcome != RUNNING
        worlds = np.full(self.num_envs, -1, dtype=np.int64)
        worlds[ended] = self._draw(int(ended.sum()))
        before = self._now
        seen = self._run(np.ascontiguousarray(actions, dtype=np.float64), worlds)
        now = self._now
        rewards = np.where(ended, 0.0, self._reward(before, now))
        truncated = now.outcome == TIMEOUT
        terminated = (now.outcome != RUNNING) & ~truncated
        return self._trials.observation(seen), rewards, terminated, truncated, self._infos()

    def seen(self, i: int) -> Any:
        """What a Python controller of a suite is shown in the state of trial `i`."""
        return self._trials.seen(i)

    def objects(self, i: int) -> list[Any]:
        """What such a controller is told of at the reset() of trial `i`."""
        return self._trials.shapes(i)

    def begun(self) -> list[int]:
        """The trials that the last step (or reset) began: their controllers want a reset()."""
        return list(self._begun)

    def close_extras(self, **kwargs: Any) -> None:
        for _, _, thread in self._parts:
            thread.shutdown()

    def _draw(self, count: int) -> NDArray[np.int64]:
        return self.np_random.choice(self._trials.worlds, count).astype(np.int64)

    def _run(self, actions: Floats, worlds: NDArray[np.int64]) -> Floats:
        seen, signals = self._trials.arrays(self.num_envs)
        step = self._trials.core.step
        if self._parts:
            for part in [thread.submit(step, a, b, actions, worlds, seen, signals) for a, b, thread in self._parts]:
                part.result()
        else:
            step(0, self.num_envs, actions, worlds, seen, signals)
        self._now = Signals(*np.ascontiguousarray(signals.T))
        self._begun = np.flatnonzero(worlds >= 0).tolist()
        return seen

    def _infos(self) -> dict[str, Any]:
        assert self._now is not None
        infos: dict[str, Any] = {}
        everywhere = np.ones(self.num_envs, dtype=bool)
        for name, values in self._now._asdict().items():
            if name != "outcome":
                infos[name], infos["_" + name] = values, everywhere
        ended = self._now.outcome != RUNNING
        if ended.any():
            rows = np.full(self.num_envs, None, dtype=object)
            for i in np.flatnonzero(ended):
                rows[i] = json.loads(self._trials.core.row(int(i)))
            for name, key in (("outcome", "outcome"), ("reason", "reason"), ("trial", None)):
                picked = [row if row is None or key is None else row[key] for row in rows]
                infos[name] = np.empty(self.num_envs, dtype=object)
                infos[name][:] = picked
                infos["_" + name] = ended
        return infos


def configs() -> str:
    """The folder of the robots, controllers and suites that came with the package."""
    return os.path.join(os.path.dirname(os.path.abspath(__file__)), "share", "moma", "configs")


def _registered(robot: str, family: str) -> dict[str, Any]:
    return {
        "name": f"{robot}-{family}",
        "robot": os.path.join(configs(), "robots", robot + ".yaml"),
        "controllers": {"outside": os.path.join(configs(), "controllers", "rrmc.yaml")},
        "worlds": {"seed": 1, "families": {family: {"objects": 10} if family == "clutter" else {}}},
        "simulation": {"mode": "kinematic", "time_limit": 20},
        "trials": 10_000,
    }


def register_envs() -> None:
    """moma/frankie-open-v0, moma/frankie-clutter-v0, moma/panda-open-v0 and moma/panda-clutter-v0, for gymnasium.make() and
    make_vec(). Kinematic, 20 s, ten objects in clutter; changes={...} as for Env."""
    for robot in ("frankie", "panda"):
        for family in ("open", "clutter"):
            name = f"moma/{robot}-{family}-v0"
            if name in gymnasium.registry:
                continue
            gymnasium.register(
                name,
                entry_point="moma.env:Env",
                vector_entry_point="moma.env:VectorEnv",
                kwargs={"suite": _registered(robot, family), "objects": 10 if family == "clutter" else 0},
            )
