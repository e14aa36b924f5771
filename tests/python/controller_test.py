"""moma.Controller, step by step."""

import os
import pathlib
import unittest

import numpy as np

import moma

ROOT = pathlib.Path(os.environ["MOMA_SOURCE_DIR"])
BALL = {"name": "ball", "shape": "sphere", "size": [0.2]}


class ControllerTest(unittest.TestCase):
    def setUp(self):
        self.robot = moma.Robot(ROOT / "configs/robots/frankie.yaml")
        self.goal = moma.Pose(position=[2.0, 0.4, 0.6], rotation=np.diag([1.0, -1.0, -1.0]))

    def drive(self, controller, steps, objects=()):
        q, base, commands = self.robot.ready, np.zeros(3), []
        velocity = np.zeros(9)
        for k in range(steps):
            seen = moma.Observation(q, velocity, self.goal, base=base, time=0.02 * k, objects=objects)
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
            r"goal.rotation: found 4 numbers of length 2, expected a unit quaternion \[w, x, y, z\]": moma.Observation(
                ready, still, moma.Pose([1, 0, 1], [1, 1, 1, 1])
            ),
            "goal.rotation: found 3 numbers, expected 9 numbers, or the 4 of a quaternion": moma.Observation(
                ready, still, moma.Pose([1, 0, 1], [0, 0, 1])
            ),
            "goal.rotation: found a matrix that is no rotation": moma.Observation(ready, still, moma.Pose([1, 0, 1], np.ones((3, 3)))),
            "goal.rotation: found a matrix that is no": moma.Observation(ready, still, moma.Pose([1, 0, 1], -np.eye(3))),
            "goal.position: found 2 numbers, expected 3": moma.Observation(ready, still, moma.Pose([1, 0])),
            "base: found 2 numbers, expected 3": moma.Observation(ready, still, self.goal, base=[0, 0]),
            "objects: found 1, expected 0, those of reset": moma.Observation(
                ready, still, self.goal, objects=[moma.SensedObject()]
            ),
        }.items():
            with self.assertRaisesRegex(ValueError, words):
                controller.step(seen)
        controller.reset([BALL])
        for words, ball in {
            r"objects\[0\].twist: found 3 numbers, expected 6": moma.SensedObject(twist=[0, 0, 0]),
            r"objects\[0\].position_covariance: found 4 numbers, expected 9 numbers$": moma.SensedObject(
                position_covariance=[1, 0, 0, 0]
            ),
        }.items():
            with self.assertRaisesRegex(ValueError, words):
                controller.step(moma.Observation(ready, still, self.goal, objects=[ball]))
        with self.assertRaises(TypeError, msg="velocities have no default: made-up ones are learnt from"):
            moma.Observation(q=ready, goal=self.goal)
        with self.assertRaisesRegex(moma.ConfigError, r"objects\[0\].shape: found 'egg'"):
            controller.reset([{"name": "ball", "shape": "egg", "size": [1]}])
        with self.assertRaisesRegex(moma.ConfigError, r"objects\[0\].size: .*a box has the size: 3 numbers"):
            controller.reset([{"name": "crate", "shape": "box", "size": [1]}])

    def test_a_rotation_may_be_a_quaternion(self):
        controller = moma.Controller(self.robot, {})
        turned = moma.Pose(self.goal.position, [0.0, 1.0, 0.0, 0.0])  # w x y z: half a turn about x
        half = np.sqrt(0.5)
        commands = []
        for pose in (self.goal, turned, moma.Pose(self.goal.position, [half, half, 0.0, 0.0])):
            controller.reset()
            commands.append(controller.step(moma.Observation(self.robot.ready, np.zeros(9), pose)).command)
        np.testing.assert_allclose(commands[0], commands[1], atol=1e-12)
        self.assertGreater(np.max(np.abs(commands[0] - commands[2])), 1e-3)
        rotation = moma.Pose([1, 0, 1], [half, 0.0, 0.0, half]).rotation
        seen = moma.Observation(self.robot.ready, np.zeros(9), moma.Pose([1, 0, 1], rotation))
        np.testing.assert_allclose(
            controller._numbers(seen)[7:16].reshape(3, 3), [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-15
        )

    def test_objects_are_described_by_one_word(self):
        controller = moma.Controller(self.robot, ROOT / "configs/controllers/moma-reactive.yaml")
        seen = moma.Observation(
            self.robot.ready, np.zeros(9), self.goal, objects=[moma.SensedObject(position=[0.9, 0.0, 0.5])]
        )
        placed = {**BALL, "position": [0.9, 0.0, 0.5]}  # as Robot.distances() takes it and a world has it
        former = {"name": "ball", "kind": "sphere", "size": np.array([0.2])}
        commands = []
        for ball in (BALL, placed, former):
            controller.reset([ball])
            commands.append(controller.step(seen).command)
        np.testing.assert_array_equal(commands[0], commands[1])
        np.testing.assert_array_equal(commands[0], commands[2])
        self.assertEqual(len(self.robot.distances(self.robot.ready, objects=[placed])) > 0, True)

    def test_a_step_shows_how_it_came_about(self):
        controller = moma.Controller(self.robot, ROOT / "configs/controllers/moma.yaml")
        step = controller.step(moma.Observation(self.robot.ready, np.zeros(9), self.goal))
        self.assertEqual(step.command.shape, (9,))
        self.assertEqual((step.status, step.fallback), ("solved", "none"))
        self.assertIsInstance(step.rows, int)
        self.assertIsInstance(step, moma.Step)
        self.assertGreaterEqual(step.latency_base, 0.0, "moma.yaml identifies")
        self.assertIn(step.plan.mode, ("direct", "follow", "stop", "choose"))
        self.assertEqual(step.escape.stagnations, 0)
        self.assertIn("manipulability=", repr(step))

    def test_a_step_shows_what_was_predicted(self):
        seen = moma.Observation(self.robot.ready, np.full(9, 0.1), self.goal, time=0.02)
        plain = moma.Controller(self.robot, {}).step(seen).predicted
        np.testing.assert_array_equal(plain.q, self.robot.ready)
        np.testing.assert_array_equal(plain.goal.position, self.goal.position)
        self.assertEqual(plain.time, 0.02)
        # The joints' drives are 0.1 s late: their positions are predicted by the commands that are on their way.
        late = moma.Controller(self.robot, {"prediction": {"drives": {"joints": 0.1}}})
        sent, still = [], np.zeros(9)
        for k in range(8):
            step = late.step(moma.Observation(self.robot.ready, still, self.goal, time=0.02 * k))
            ahead = 0.02 * np.sum(sent[-5:], axis=0)[2:] if sent else np.zeros(7)
            np.testing.assert_allclose(step.predicted.q, self.robot.ready + ahead, atol=1e-12)
            sent.append(step.command)
        self.assertGreater(np.max(np.abs(step.predicted.q - self.robot.ready)), 0.001)


if __name__ == "__main__":
    unittest.main()
