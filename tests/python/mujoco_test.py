"""examples/mujoco: its plant does what it is told, its sensors see what is to be seen, and moma's controller arrives in it."""

import json
import os
import pathlib
import sys
import unittest

import numpy as np

os.environ["MUJOCO_GL"] = "disable"
try:
    import mujoco  # noqa: F401
except ImportError as error:
    print(f"skipped: {error}; scripts/setup.sh installs it from requirements.txt")
    sys.exit(77)

ROOT = pathlib.Path(os.environ["MOMA_SOURCE_DIR"])
sys.path.insert(0, str(ROOT / "examples/mujoco"))
import moma  # noqa: E402
from plant import Plant  # noqa: E402
from sensors import Drives, Late, Sensors, Settings  # noqa: E402
from trials import Point, trial  # noqa: E402

PERIOD = 0.02
SUITE = moma.Suite(ROOT / "examples/mujoco/transfer.yaml")
STRESSES = moma.Suite(ROOT / "examples/mujoco/stresses.yaml")
OPEN, CLUTTER = (next(i for i in range(20) if SUITE.world(i)["family"] == family) for family in ("open", "clutter"))


def with_box(edges, position):
    """The first open world and one box in it, its robot at the origin."""
    world = dict(SUITE.world(OPEN))
    world["start"] = {**world["start"], "base": [0, 0, 0]}
    world["objects"] = [{"name": name, "shape": "box", "size": edges, "position": [position[0] + 0.5 * i, *position[1:]], "quaternion": [1, 0, 0, 0]}
                        for i, name in enumerate(("near", "far"))]
    return moma.World(world)


class MujocoTest(unittest.TestCase):
    def setUp(self):
        self.robot = Point(SUITE, 0).robot

    def test_wheels_and_joints_follow(self):
        plant = Plant(self.robot, moma.World({**SUITE.world(OPEN), "objects": []}))
        base, q = plant.base(), plant.q().copy()
        command = np.array([0.4, 0.6, 0.2, -0.1, 0.1, 0.2, -0.1, 0.1, 0.2])
        for _ in range(100):
            self.assertIsNone(plant.advance(command, PERIOD))
            plant.base()  # which counts turns
        np.testing.assert_allclose(plant.velocities(), command, atol=0.01)
        np.testing.assert_allclose(plant.q() - q, 2.0 * command[2:], atol=2e-3)
        for _ in range(25):
            plant.advance(0 * command, PERIOD)
        # Both ramps are shorter than the way by as much as the way is longer after them.
        np.testing.assert_allclose(plant.base()[2] - base[2], 2.0 * command[1], atol=0.02)
        turned, expected = self.robot.integrate(q, command, 2.0, base)
        np.testing.assert_allclose(plant.base()[:2], expected[:2], atol=0.06)
        self.assertLess(np.abs(plant.velocities()).max(), 5e-3)
        np.testing.assert_allclose(plant.tool(), self.robot.fk(plant.q(), plant.base()), atol=5e-3)

    def test_a_collision_has_names(self):
        plant = Plant(self.robot, with_box([0.2, 2, 0.3], [0.8, 0, 0.15]))
        touching = None
        for _ in range(100):
            touching = touching or plant.advance(np.array([0.5, *[0] * 8]), PERIOD)
        self.assertIn("near", touching)
        self.assertLess(plant.base()[0], 0.6)

    def test_what_hides_is_not_seen(self):
        for edges, position, seen in (([0.1, 1, 1], [1, 0, 0.5], True), ([0.1, 1, 1], [-2, 0, 0.5], False)):
            plant = Plant(self.robot, with_box(edges, position), eye=(0.4, 0, 0.5))
            self.assertEqual(plant.sees("near", 3.0, [1, 0, 0], 3.0, True), seen)
            self.assertFalse(plant.sees("far", 3.0, [1, 0, 0], 3.0, True))
            self.assertEqual(plant.sees("far", 3.0, [1, 0, 0], 3.0, False), seen)
            self.assertFalse(plant.sees("near", 0.5, [1, 0, 0], 3.0, False))

    def test_disturbances_have_their_size(self):
        point = Point(SUITE, [label for _, label in SUITE.points].index("disturbances=realistic"))
        world, settings = SUITE.world(CLUTTER), point.disturbances
        sensors = Sensors(settings, np.random.default_rng(1), Plant(self.robot, world), world, PERIOD)
        seen = [sensors.observe(k * PERIOD) for k in range(200)]
        still = np.array([item.q for item in seen])
        self.assertAlmostEqual(still.std(axis=0).mean(), 2e-4, delta=5e-5)
        self.assertLess(np.abs(still.mean(axis=0) - world["start"]["q"]).max(), 4e-3)
        self.assertAlmostEqual(np.std([item.qdot[0] for item in seen]), 0.01, delta=2e-3)
        known = [i for i, item in enumerate(seen[-1].objects) if item.visible]
        self.assertTrue(known)
        away = [np.linalg.norm(seen[-1].objects[i].position - np.array(world.objects[i]["position"])) for i in known]
        self.assertTrue(1e-4 < np.mean(away) < 0.04, away)
        drives = Drives(settings, np.random.default_rng(1), 7, PERIOD)
        steps = [drives(np.ones(9)) for _ in range(5)]
        self.assertEqual([step[0] > 0 for step in steps], [False, False, False, True, True], "the base is 60 ms late")
        self.assertEqual([step[3] > 0 for step in steps], [False, True, True, True, True], "the arm 20 ms")
        late = Late(0.04, PERIOD)
        self.assertEqual([late(k) for k in range(5)], [0, 0, 0, 1, 2])
        self.assertEqual(Settings({"joints": {"noise": 1, "wobble": 2}}).unused(), ["joints.noise", "joints.wobble"])

    def test_moma_arrives(self):
        outcome, seconds, reason = trial(Point(SUITE, 0), SUITE.world(OPEN))
        self.assertEqual(outcome, "success", reason)
        self.assertLess(seconds, 10.0)

    def test_every_disturbance_of_the_suites_is_known(self):
        for suite in (SUITE, STRESSES):
            for index, (controller, label) in enumerate(suite.points):
                point = Point(suite, index)
                point.simulation = {**point.simulation, "time_limit": 3 * PERIOD}
                outcome, _, reason = trial(point, suite.world(CLUTTER))
                self.assertEqual(outcome, "timeout", f"{controller} {label}: {reason}")
                self.assertEqual(point.disturbances.unused(), [], f"{controller} {label}")


if __name__ == "__main__":
    unittest.main()
