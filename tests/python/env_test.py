"""moma.Env: the program's own trial, stepped from outside. The same trial by `moma run`, by evaluate(), by a process that calls
moma.Controller and by Env has the same bits."""

import json
import os
import pathlib
import sys
import tempfile
import unittest
import warnings

try:
    import gymnasium
    from gymnasium.utils.env_checker import check_env
except ImportError:
    print("skipped: gymnasium is not installed (python/requirements-tests.txt)")
    sys.exit(77)
import numpy as np

import moma
import wrapped
from moma.program import run

ROOT = pathlib.Path(os.environ["MOMA_SOURCE_DIR"])
GAINS = str(ROOT / "configs/controllers/moma-reactive.yaml")
SUITE = {
    "name": "small",
    "robot": str(ROOT / "configs/robots/frankie.yaml"),
    "controllers": {"own": GAINS},
    "worlds": {"seed": 5, "families": {"clutter": {"objects": 6}}},
    "simulation": {"mode": "kinematic", "time_limit": 6},
    "trials": 3,
    "samples": "all",
}
REALISTIC = {
    "disturbances": {"seed": 3, "joints": {"noise": 0.002}, "base": {"delay": 0.04},
                     "objects": {"noise": {"position": 0.01}, "delay": 0.04, "phantoms": {"count": 1}}},
    "simulation.mode": "dynamic",
    "simulation.time_limit": 2,
}
REMEMBERED = {"escape", "plan"}  # of moma's own controllers, inside them


def drive(env, world):
    """One trial by moma.Controller; what info said at its end."""
    env.reset(options={"world": world})
    controller = moma.Controller(env.robot, GAINS, env.control_period)
    controller.reset(env.objects)
    while True:
        _, _, terminated, truncated, info = env.step(controller.step(env.seen))
        if terminated or truncated:
            return info


class EnvTest(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.folder = pathlib.Path(self.scratch.name)

    def test_the_same_trial_by_every_way_has_the_same_bits(self):
        for changes in ({}, REALISTIC):
            suite = {**SUITE, "trials": 2}
            (self.folder / "suite.yaml").write_text(json.dumps(suite))  # JSON is YAML
            whole = moma.Suite(suite, changes, self.folder)
            with moma.Suite(self.folder / "suite.yaml", changes).arguments() as words:
                run(["run", *words, "-o", str(self.folder / "p.db"), "--quiet"])
            program = moma.Store(self.folder / "p.db")
            evaluated = moma.evaluate(
                whole, {"mine": (wrapped.Wrapped, {"file": GAINS})}, store=self.folder / "e.db", progress=False
            )
            env = moma.Env(whole)
            for world in range(2):
                info = drive(env, world)
                samples = [
                    {k: v for k, v in sample.items() if k not in REMEMBERED} for sample in env.trace()["samples"]
                ]
                self.assertGreater(len(samples), 20)
                rows = {
                    "moma run": program.trials(f"world = {world}"),
                    "evaluate": evaluated.trials(f"world = {world} AND controller = 'own'"),
                    "process": evaluated.trials(f"world = {world} AND controller = 'mine'"),
                }
                for way, row in rows.items():
                    store = program if way == "moma run" else evaluated
                    again = store.replay(row.trial[0], allow_plugins=store is evaluated)["samples"]
                    again = [{k: v for k, v in sample.items() if k not in REMEMBERED} for sample in again]
                    self.assertEqual(samples, again, f"world {world} by {way}")
                    compared = 0
                    for name, value in info["trial"].items():
                        if value is None or name not in row.columns:
                            continue
                        self.assertEqual(value, row[name][0], f"world {world} by {way}: {name}")
                        compared += 1
                    self.assertGreater(compared, 25)
            for file in ("p.db", "e.db"):
                (self.folder / file).unlink()

    def test_gymnasium_finds_nothing_wrong(self):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            # What it says of velocities and of unbounded numbers is so: they are SI units.
            warnings.filterwarnings("ignore", message=".*(symmetric and normalized|minimum value is -infinity|maximum value is infinity).*")
            warnings.filterwarnings("ignore", message=".*not an instance of .*gym.*|.*render.*|.*spec.*")
            check_env(moma.Env(SUITE, worlds=[0, 1]))
            for name in ("frankie-clutter", "panda-clutter", "panda-open"):  # in the last nothing has a clearance
                env = gymnasium.make(f"moma/{name}-v0")
                check_env(env.unwrapped, skip_render_check=True)
        vector = gymnasium.make_vec("moma/panda-open-v0", num_envs=3, vectorization_mode="vector_entry_point")
        seen, _ = vector.reset(seed=1)
        self.assertTrue(vector.observation_space.contains(seen))

    def test_observations_are_what_they_say(self):
        env = moma.Env(SUITE)
        seen, info = env.reset(options={"world": 1})
        self.assertTrue(env.observation_space.contains(seen))
        world, tip = env.world, env.robot.fk(seen["q"], seen["base"])
        self.assertEqual(world["index"], 1)
        np.testing.assert_array_equal(seen["goal"][:3], world["goal"]["position"])
        np.testing.assert_allclose(seen["error"][3:], seen["goal"][:3] - tip[:3, 3], atol=1e-12)
        self.assertAlmostEqual(info["position_error"], np.linalg.norm(seen["error"][3:]), 12)
        self.assertAlmostEqual(info["orientation_error"], np.linalg.norm(seen["error"][:3]), 9)
        self.assertAlmostEqual(info["manipulability"], env.robot.manipulability(seen["q"]), 12)
        self.assertAlmostEqual(info["clearance"], env.robot.clearance(seen["q"], seen["base"], world.objects), 9)
        for row, item in zip(seen["objects"], world["objects"]):
            np.testing.assert_array_equal(row[:3], item["position"])
            self.assertEqual(row[21], 1.0)
            if item["shape"] == "sphere":
                np.testing.assert_allclose(row[18:21], 2 * item["size"][0])
        before = env.seen
        forward = np.zeros(9)
        forward[0] = 0.5
        after, reward, *_ = env.step(forward)
        np.testing.assert_allclose(after["base"][:2] - seen["base"][:2],
                                   0.01 * np.array([np.cos(seen["base"][2]), np.sin(seen["base"][2])]), atol=1e-12)
        np.testing.assert_array_equal(before.base, seen["base"])
        self.assertAlmostEqual(reward, info["position_error"] - np.linalg.norm(after["error"][3:]), 12)

    def test_sensed_and_true(self):
        sensed, true = (moma.Env(moma.Suite(SUITE, REALISTIC), sensed=flag) for flag in (True, False))
        a, b = (env.reset(options={"world": 0})[0] for env in (sensed, true))
        np.testing.assert_array_equal(b["q"], true.world["start"]["q"])
        self.assertFalse(np.array_equal(a["q"], b["q"]))
        self.assertLess(np.max(np.abs(a["q"] - b["q"])), 0.02)
        self.assertEqual(len(sensed.objects), 7, "what is not there is among what is sensed")
        self.assertEqual(len(true.objects), 6)
        self.assertEqual(len(list(true.seen.objects)), 6)

    def test_worlds_as_data(self):
        suite = moma.Suite(SUITE)
        env, world = moma.Env(suite), suite.world(2)
        a, _ = env.reset(options={"world": 2})
        b, _ = env.reset(options={"world": world})
        for name in a:
            np.testing.assert_array_equal(a[name], b[name])
        near = moma.World({**world, "objects": world["objects"][:1]})
        c, _ = env.reset(options={"world": near})
        self.assertEqual(c["objects"][:, 21].tolist(), [1, 0, 0, 0, 0, 0])
        self.assertEqual(env.world, near)
        with self.assertRaisesRegex(moma.ConfigError, "world: .*goal"):
            env.reset(options={"world": {**world, "goal": {}}})
        few = moma.Env(SUITE, objects=4)
        with self.assertRaisesRegex(ValueError, "world 0 has 6, the observation has room for 4"):
            few.reset(options={"world": 0})

    def test_ends(self):
        env = moma.Env(SUITE, changes={"stuck.time": 0.2, "simulation.time_limit": 0.5})
        with self.assertRaisesRegex(RuntimeError, "call reset"):
            env.step(np.zeros(9))
        env.reset(seed=1)
        with self.assertRaisesRegex(ValueError, "8 numbers, the robot wants 9: v, omega, panda_joint1"):
            env.step(np.zeros(8))
        _, reward, terminated, truncated, info = env.step(np.full(9, np.nan))
        self.assertEqual((terminated, truncated, info["outcome"], reward), (True, False, "error", -1.0))
        self.assertIn("finite numbers", info["reason"])
        env.reset(seed=1)
        for _ in range(10):
            *_, terminated, truncated, info = env.step(np.zeros(9))
        self.assertEqual((terminated, truncated, info["outcome"]), (True, False, "stuck"))
        with self.assertRaisesRegex(RuntimeError, "ended by stuck"):
            env.step(np.zeros(9))
        env.reset(seed=1)
        done, k = False, 0
        while not done:
            *_, terminated, truncated, info = env.step(np.eye(9)[2] * (0.3 if k // 5 % 2 else -0.3))
            done, k = terminated or truncated, k + 1
        self.assertEqual((terminated, truncated, info["outcome"], k), (False, True, "timeout", 25))

    def test_threads_change_no_bit(self):
        changes = {"simulation.time_limit": 1}
        runs = []
        for threads in (1, 3):
            env = moma.VectorEnv(SUITE, 5, threads=threads, changes={**changes, "simulation.mode": "dynamic"})
            env.action_space.seed(3)
            seen, _ = env.reset(seed=7)
            steps, ended = [seen], 0
            for _ in range(60):
                seen, reward, terminated, truncated, infos = env.step(0.2 * env.action_space.sample())
                steps.append({**seen, "reward": reward, "end": terminated | truncated})
                ended += len([row for row in infos.get("trial", ()) if row is not None])
            self.assertGreaterEqual(ended, 5)
            runs.append(steps)
            env.close()
        for k, (a, b) in enumerate(zip(*runs)):
            for name in a:
                np.testing.assert_array_equal(a[name], b[name], f"step {k}: {name}")

    def test_side_by_side_is_one_by_one(self):
        vector, single = moma.VectorEnv(SUITE, 3, threads=2), moma.Env(SUITE)
        seen, _ = vector.reset(options={"worlds": [2, 0, 1]})
        rng = np.random.default_rng(2)
        actions = rng.uniform(-0.2, 0.2, (30, 3, 9))
        alone, _ = single.reset(options={"world": 0})
        for action in actions:
            for name in alone:
                np.testing.assert_array_equal(seen[name][1], alone[name])
            seen, rewards, terminated, _, _ = vector.step(action)
            alone, reward, ended, _, _ = single.step(action[1])
            self.assertEqual((rewards[1], terminated[1]), (reward, ended))
            if ended:
                break


if __name__ == "__main__":
    unittest.main()
