"""moma from Python: its robots and controllers in the process, its evaluations by the program `moma`.

>>> robot = moma.Robot("configs/robots/frankie.yaml")
>>> robot.jacobian(robot.ready)                                    # 6 x 9, [angular; linear] at E
>>> store = moma.evaluate("configs/suites/demo.yaml", {"mine": Mine}, trials=20)
>>> store.summary()

Units, frames, names and orders are those of docs/reference/conventions.md; arrays are NumPy's. docs/how-to/python-package.md.
"""

from ._core import ConfigError
from .case import explain, solve
from .controller import Controller, Observation, Pose, SensedObject, Step
from .program import ProgramError, program
from .robot import Distance, Robot
from .store import Store
from .suite import Suite, evaluate

__all__ = [
    "ConfigError",
    "Controller",
    "Distance",
    "Observation",
    "Pose",
    "ProgramError",
    "Robot",
    "SensedObject",
    "Step",
    "Store",
    "Suite",
    "evaluate",
    "explain",
    "program",
    "solve",
]
