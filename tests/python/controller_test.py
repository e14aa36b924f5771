"""moma.Controller, step by step."""

import os
import pathlib
import unittest

import numpy as np

import moma

ROOT = pathlib.Path(os.environ["MOMA_SOURCE_DIR"])
BALL = {"name": "ball", "kind": "sphere", "size": [0.2]}


class ControllerTest(unittest.TestCase):
    def setUp(self):
        self.robot = moma.Robot(ROOT / "configs/robots/frankie.yaml")
        self.goal = moma.Pose(position=[2.0, 0.4, 0.6], rotation=np.diag([1.0, -1.0, -1.0]))

    def drive(self, controller, steps, objects=()):
        q, base, commands = self.robot.ready, np.zeros(3), []
        velocity = np.zeros(9)
        for k in range(steps):
            seen = moma.Observation(q, velocity, self.goal, base, 0.02 * k, objects)
            step = controller.step(seen)
            velocity = step.command
            commands.append(step.command)
            q, base = self.robot.integrate(q, velocity, 0.02, base)
        return np.array(commands), q, base

    def test_reaches_the_goal(self):
        controller = moma.Controller(self.robot, ROOT / "configs/controllers/holistic.yaml")
        _, q, base = self.drive(controller, 900)
        np.testing.assert_allclose(self.robot.fk(q, base)[:3, 3], self.goal.position, atol=0.02)

    def test_a_file_and_what_is_in_it_are_the_same(self):
        controller = moma.Controller(self.robot, ROOT / "configs/controllers/moma-reactive.yaml")
        same = moma.Controller(self.robot, controller.parameters)
        self.assertEqual(same.parameters, controller.parameters)
        other = moma.Controller(self.robot, {**controller.parameters, "lambda_q": 0.5})
        first, again = self.drive(controller, 20)[0], self.drive(same, 20)[0]
        np.testing.assert_array_equal(first, again)
        self.assertFalse(np.array_equal(first, self.drive(other, 20)[0]))
        controller.reset()
        np.testing.assert_array_equal(first, self.drive(controller, 20)[0])

    def test_sees_velocities_and_covariances(self):
        controller = moma.Controller(self.robot, {"limits": {"acceleration": 1}})
        resting = controller.step(moma.Observation(self.robot.ready, np.zeros(9), self.goal))
        moving = controller.step(moma.Observation(self.robot.ready, 0.3 * np.ones(9), self.goal))
        self.assertLess(np.max(np.abs(resting.command)), 0.03)
        self.assertGreater(np.max(np.abs(moving.command)), 0.2)
        tracking = moma.Controller(self.robot, {"prediction": {}, "uncertainty": {}})
        commands = []
        for covariance in (None, 0.01 * np.eye(3)):
            tracking.reset([BALL])
            ball = moma.SensedObject([0.9, 0.0, 0.5], position_covariance=covariance)
            commands.append(tracking.step(moma.Observation(self.robot.ready, np.zeros(9), self.goal, objects=[ball])).command)
        self.assertFalse(np.array_equal(*commands))

    def test_sees_objects(self):
        controller = moma.Controller(self.robot, ROOT / "configs/controllers/moma-reactive.yaml")
        free = self.drive(controller, 20)[0]
        controller.reset([BALL])
        ball = moma.SensedObject(position=[0.9, 0.0, 0.5])
        self.assertFalse(np.array_equal(free, self.drive(controller, 20, [ball])[0]))
        controller.reset([BALL])
        hidden = moma.SensedObject(position=[0.9, 0.0, 0.5], visible=False)
        np.testing.assert_array_equal(free, self.drive(controller, 20, [hidden])[0])

    def test_shows_the_next_step_without_taking_it(self):
        controller = moma.Controller(self.robot, ROOT / "configs/controllers/moma-reactive.yaml")
        controller.reset([BALL])
        ball = moma.SensedObject(position=[0.9, 0.0, 0.5])
        self.drive(controller, 5, [ball])
        seen = moma.Observation(self.robot.ready, np.zeros(9), self.goal, objects=[ball])
        shown = controller.solve(seen)
        self.assertGreater(len(controller.explain(seen).splitlines()), 3)
        step = controller.step(seen)
        np.testing.assert_array_equal(shown["qdot"], step.command)
        self.assertEqual(shown["status"], step.status)

    def test_a_case_is_what_the_program_makes_of_it(self):
        case = ROOT / "tests/data/qp_cases/cases/frankie_119.json"
        self.assertEqual(str(moma.solve(case)["status"]), "solved")
        self.assertGreater(len(moma.explain(case).splitlines()), 3)

    def test_mistakes_have_momas_own_messages(self):
        with self.assertRaisesRegex(moma.ConfigError, "lambda_p: unknown key"):
            moma.Controller(self.robot, {"lambda_p": 1})
        controller = moma.Controller(self.robot, {})
        ready, still = self.robot.ready, np.zeros(9)
        for words, seen in {
            "q: found 6 numbers, expected 7 numbers": moma.Observation(ready[:6], still, self.goal),
            "qdot: found None, expected 9 numbers": moma.Observation(ready, None, self.goal),
            "goal.rotation: found 4 numbers, which a quaternion has": moma.Observation(
                ready, still, moma.Pose([1, 0, 1], [0, 0, 0, 1])
            ),
            "base: found 2 numbers, expected 3": moma.Observation(ready, still, self.goal, [0, 0]),
            r"objects\[0\].twist: found 3 numbers": moma.Observation(
                ready, still, self.goal, objects=[moma.SensedObject(twist=[0, 0, 0])]
            ),
            "observation: found 76 numbers, expected 38": moma.Observation(
                ready, still, self.goal, objects=[moma.SensedObject()]
            ),
        }.items():
            with self.assertRaisesRegex(ValueError, words):
                controller.step(seen)
        with self.assertRaises(TypeError, msg="velocities have no default: made-up ones are learnt from"):
            moma.Observation(q=ready, goal=self.goal)
        with self.assertRaisesRegex(ValueError, "no such kind of shape"):
            controller.reset([{"name": "ball", "kind": "egg", "size": [1]}])


if __name__ == "__main__":
    unittest.main()
