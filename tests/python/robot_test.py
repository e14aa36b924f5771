"""moma.Robot: against finite differences, its own batches, and a description that is read back."""

import json
import os
import pathlib
import sys
import tempfile
import unittest

import numpy as np

import moma

ROOT = pathlib.Path(os.environ["MOMA_SOURCE_DIR"])


def configurations(robot, count, seed=7):
    rng = np.random.default_rng(seed)
    low, high = np.maximum(robot.lower, -2.0), np.minimum(robot.upper, 2.0)
    q = low + (high - low) * rng.uniform(0.1, 0.9, (count, len(robot.joints)))
    base = rng.uniform(-2.0, 2.0, (count, 3)) if robot.base != "fixed" else np.zeros((count, 3))
    return q, base


class RobotTest(unittest.TestCase):
    def setUp(self):
        self.robot = moma.Robot(ROOT / "configs/robots/frankie.yaml")

    def test_says_what_it_is(self):
        robot = self.robot
        self.assertEqual(robot.base, "differential")
        self.assertEqual(robot.velocities, ("v", "omega", *robot.joints))
        self.assertEqual(len(robot.velocity_limits), 9)
        self.assertTrue(np.all(robot.lower < robot.ready) and np.all(robot.ready < robot.upper))
        self.assertIn("@base", robot.links)

    def test_a_batch_is_what_its_members_are(self):
        q, base = configurations(self.robot, 5)
        poses, jacobians = self.robot.fk(q, base), self.robot.jacobian(q, base)
        self.assertEqual(poses.shape, (5, 4, 4))
        self.assertEqual(jacobians.shape, (5, 6, 9))
        for i in range(5):
            np.testing.assert_array_equal(poses[i], self.robot.fk(q[i], base[i]))
            np.testing.assert_array_equal(jacobians[i], self.robot.jacobian(q[i], base[i]))
            self.assertEqual(self.robot.manipulability(q)[i], self.robot.manipulability(q[i]))
            np.testing.assert_array_equal(
                self.robot.manipulability_gradient(q)[i], self.robot.manipulability_gradient(q[i])
            )
        np.testing.assert_array_equal(self.robot.fk(q[0], base)[3], self.robot.fk(q[0], base[3]))
        np.testing.assert_array_equal(self.robot.fk(q, base, link="panda_link3")[2].shape, (4, 4))

    def test_batches_of_motion_and_of_distances(self):
        q, base = configurations(self.robot, 4)
        velocity = np.random.default_rng(3).uniform(-1, 1, (4, 9))
        turned, moved = self.robot.integrate(q, velocity, 0.1, base)
        for i in range(4):
            one = self.robot.integrate(q[i], velocity[i], 0.1, base[i])
            np.testing.assert_array_equal(turned[i], one[0])
            np.testing.assert_array_equal(moved[i], one[1])
        fan, _ = self.robot.integrate(q[0], velocity, 0.1)
        np.testing.assert_allclose(fan, q[0] + 0.1 * velocity[:, 2:])
        objects = [{"shape": "sphere", "size": [0.1], "position": [1, 0.2, 0.5]}, {"shape": "box", "size": [0.2, 0.1, 0.3], "position": [-1, 0, 1]}]
        least = self.robot.clearance(q, base, objects)
        for i in range(4):
            nearest = self.robot.distances(q[i], base[i], objects, within=100)[0].d
            self.assertEqual(least[i], nearest)
            self.assertEqual(self.robot.clearance(q[i], base[i], objects), nearest)
        self.assertEqual(self.robot.clearance(q[0]), np.inf)
        with self.assertRaisesRegex(ValueError, "velocity: found 8 numbers, expected 9"):
            self.robot.integrate(q[0], np.zeros(8), 0.1)

    def test_jacobian_is_the_derivative_of_the_pose(self):
        q, base = configurations(self.robot, 4)
        h = 1e-6
        for i in range(4):
            jacobian = self.robot.jacobian(q[i], base[i])
            for j in range(9):
                velocity = np.eye(9)[j]
                ahead = self.robot.fk(*self.robot.integrate(q[i], velocity, h, base[i]))
                behind = self.robot.fk(*self.robot.integrate(q[i], velocity, -h, base[i]))
                spin = ahead[:3, :3] @ behind[:3, :3].T
                turn = np.array([spin[2, 1] - spin[1, 2], spin[0, 2] - spin[2, 0], spin[1, 0] - spin[0, 1]]) / (4 * h)
                move = (ahead[:3, 3] - behind[:3, 3]) / (2 * h)
                np.testing.assert_allclose(jacobian[:, j], np.concatenate([turn, move]), atol=1e-8)

    def test_manipulability_and_its_gradient(self):
        q, _ = configurations(self.robot, 4)
        h = 1e-6
        for rows, part in (("translation", slice(3, 6)), ("rotation", slice(0, 3)), ("all", slice(0, 6))):
            for i in range(4):
                arm = self.robot.jacobian(q[i])[part, 2:]
                self.assertAlmostEqual(self.robot.manipulability(q[i], rows), np.sqrt(np.linalg.det(arm @ arm.T)), 10)
                gradient = self.robot.manipulability_gradient(q[i], rows)
                for j in range(7):
                    step = h * np.eye(7)[j]
                    change = self.robot.manipulability(q[i] + step, rows) - self.robot.manipulability(q[i] - step, rows)
                    self.assertAlmostEqual(gradient[j], change / (2 * h), 7)

    def test_distances(self):
        ball = {"name": "ball", "shape": "sphere", "size": [0.1], "position": [3, 0, 0.3]}
        near = self.robot.distances(self.robot.ready, objects=[ball], within=10)
        self.assertEqual({pair.second for pair in near}, {"ball"})
        self.assertEqual([pair.d for pair in near], sorted(pair.d for pair in near))
        for pair in near:
            # The gap is between the two points, along the normal.
            np.testing.assert_allclose(pair.p_first_W - pair.p_second_W, pair.d * pair.n_W, atol=1e-9)
            self.assertAlmostEqual(np.linalg.norm(pair.p_second_W - [3, 0, 0.3]), 0.1, 9)
        moved = self.robot.distances(self.robot.ready, base=[1, 0, 0], objects=[ball], within=10)
        self.assertAlmostEqual(near[0].d - moved[0].d, 1.0, 1)
        self.assertEqual(self.robot.distances(self.robot.ready, objects=[ball], within=0.1), [])

    def test_peers_number_solids_as_moma_does(self):
        """examples/peers/parts.py: the numbers of the description's pairs are those of its solids, wheels among them."""
        sys.path.insert(0, str(ROOT / "examples/peers"))
        import parts
        for file in ("frankie", "panda"):
            robot = moma.Robot(ROOT / f"configs/robots/{file}.yaml")
            self.assertEqual(len(parts.solids(robot)), 1 + max(second for _, second in parts.pairs(robot)), file)
            near = robot.distances(robot.ready, objects=[{"shape": "sphere", "size": [0.01], "position": [0, 1, 0.1]}], within=100)
            links = sorted(link or "@base" for link, *_ in parts.solids(robot))
            self.assertEqual(sorted(pair.first.split("/")[0] for pair in near), links, file)

    def test_its_description_is_the_same_robot(self):
        again = moma.Robot(json.loads(json.dumps(self.robot.description)))
        q, base = configurations(self.robot, 3)
        np.testing.assert_array_equal(again.jacobian(q, base), self.robot.jacobian(q, base))
        self.assertEqual(again.description, self.robot.description)

    def test_mistakes_have_momas_own_messages(self):
        with self.assertRaisesRegex(ValueError, "q: found 3 numbers, expected 7"):
            self.robot.fk([0, 0, 0])
        with self.assertRaisesRegex(ValueError, "no link 'elbow'"):
            self.robot.fk(self.robot.ready, link="elbow")
        with self.assertRaisesRegex(ValueError, "rows: found 'some', expected translation, rotation or all"):
            self.robot.manipulability(self.robot.ready, rows="some")
        with self.assertRaisesRegex(ValueError, "configurations of the base"):
            self.robot.fk(np.zeros((3, 7)), np.zeros((2, 3)))
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "robot.yaml"
            file.write_text("urdf: none.urdf\nbass: {}\n")
            with self.assertRaisesRegex(moma.ConfigError, "robot.yaml"):
                moma.Robot(file)
        with self.assertRaises(moma.ConfigError):
            moma.Robot({"urdf": "none.urdf"})


if __name__ == "__main__":
    unittest.main()
