"""moma from Python: its robots and controllers in the process, its evaluations by the program `moma`.

>>> robot = moma.Robot("configs/robots/frankie.yaml")
>>> robot.jacobian(robot.ready)                                    # 6 x 9, [angular; linear] at E
>>> store = moma.evaluate("configs/suites/demo.yaml", {"mine": Mine}, trials=20)
>>> store.summary()

Units, frames, names and orders are those of docs/reference/conventions.md; arrays are NumPy's. docs/how-to/python-package.md.
"""

import importlib
import sys
from typing import TYPE_CHECKING, Any

from ._core import OUTCOMES, ConfigError
from .case import explain, solve
from .controller import Controller, Observation, Pose, SensedObject, Step
from .program import ProgramError, program
from .robot import Distance, Robot
from .store import Store
from .suite import Suite, evaluate
from .tune import Tuned, tune
from .world import World, save_worlds

if TYPE_CHECKING:
    from .env import Env, VectorEnv, register_envs

__all__ = [
    "ConfigError",
    "Controller",
    "Distance",
    "Env",
    "OUTCOMES",
    "Observation",
    "Pose",
    "ProgramError",
    "Robot",
    "SensedObject",
    "Step",
    "Store",
    "Suite",
    "Tuned",
    "VectorEnv",
    "World",
    "evaluate",
    "explain",
    "program",
    "register_envs",
    "save_worlds",
    "solve",
    "tune",
]


def __getattr__(name: str) -> Any:
    # What needs gymnasium is loaded when it is asked for.
    if name in ("Env", "VectorEnv", "register_envs"):
        return getattr(importlib.import_module(".env", __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


if sys.modules.get("gymnasium") is not None:  # also by gymnasium.make("moma:...")
    importlib.import_module(".env", __name__).register_envs()
