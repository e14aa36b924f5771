"""Suites, their evaluation by the program, and stores as tables. A controller in a process of its own that calls
moma.Controller has the trials of the program's own, bit for bit."""

import contextlib
import io
import os
import pathlib
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
import unittest

import moma
import wrapped
from moma.suite import entry_of

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
# What a row has to say about a motion, whoever computed its commands.
MOTION = "outcome, reason, time_end_s, position_error_m, orientation_error_rad, path_ee_m, clearance_min_m, manip_mean"
# What moma's controller remembers stays in its process.
REMEMBERED = {"escape_best", "escape_idle", "stagnations"} | {
    "detour" + part for part in ("", "_side", "_remaining", "_x", "_y", "_z")
}


class EvaluateTest(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.folder = pathlib.Path(self.scratch.name)

    def evaluate(self, suite=SUITE, controllers=None, **more):
        chosen = moma.Suite(suite, directory=self.folder)
        return moma.evaluate(chosen, controllers, store=self.folder / "a.db", progress=False, **more)

    def test_the_same_trial_by_the_program_and_by_a_process_of_the_package(self):
        store = self.evaluate(controllers={"mine": (wrapped.Wrapped, {"file": GAINS})})
        trials = store.trials()
        self.assertEqual(len(trials), 6)
        self.assertEqual(set(trials.controller), {"own", "mine"})
        self.assertGreater(trials.clearance_min_m.notna().sum(), 0)
        for world in range(3):
            own, mine = (
                store.sql(f"SELECT trial, {MOTION} FROM v_trials WHERE controller = '{name}' AND world = {world}")
                for name in ("own", "mine")
            )
            self.assertTrue(own.drop(columns="trial").equals(mine.drop(columns="trial")), f"{own}\n{mine}")
            samples = [store.samples(table.trial[0]) for table in (own, mine)]
            self.assertGreater(len(samples[0]), 20)
            compared = 0
            for column in samples[0].columns:
                if column in REMEMBERED or column.startswith("plan_"):
                    continue
                self.assertTrue(samples[0][column].equals(samples[1][column]), f"world {world}: {column}")
                compared += 1
            self.assertGreater(compared, 40)
        self.assertEqual(int(store.pairs().n.sum()), 3)
        compared = store.compare("own", "mine")
        self.assertIn("A = own, B = mine", str(compared))
        self.assertEqual(list(compared.rates.rate), ["success", "collision"])
        self.assertEqual((compared.rates.only_a + compared.rates.only_b).sum(), 0)
        self.assertEqual(compared.metrics.difference.abs().max(), 0.0)
        self.assertTrue((compared.metrics.mean_a == compared.metrics.mean_b).all())
        page = store.report(self.folder / "page.html")
        self.assertIn("<html", page.read_text()[:200])

    def test_goes_on_from_what_is_there(self):
        self.evaluate(trials=1)
        store = self.evaluate(trials=2)
        self.assertEqual(len(store.trials()), 2)
        self.assertEqual(len(store.trials("world = 1")), 1)
        self.assertEqual(list(store.trials("world = 7").columns), list(store.trials().columns))
        self.assertEqual(int(store.summary().n.sum()), 2)
        replay = store.replay(store.trials().trial[0])
        self.assertEqual(len(replay["samples"]), len(store.samples(store.trials().trial[0])))

    def test_ctrl_c_keeps_what_is_done(self):
        file = self.folder / "a.db"
        suite = {**SUITE, "controllers": {"slow": entry_of(wrapped.Slow)}, "simulation": {"mode": "kinematic", "time_limit": 0.4}}
        call = f"moma.evaluate(moma.Suite({suite!r}, directory={str(self.folder)!r}), store={str(file)!r}, trials=1000, progress=False)"
        # In a group of its own, as a terminal has it: Ctrl-C is a signal to Python and to the program that it waits for.
        child = subprocess.Popen([sys.executable, "-c", f"import moma; {call}"], start_new_session=True, stderr=subprocess.PIPE, text=True)
        self.addCleanup(child.kill)
        self.wait_for_trials(file, child)
        os.killpg(child.pid, signal.SIGINT)
        said = child.communicate(timeout=100)[1]
        self.assertEqual(child.returncode, -signal.SIGINT, said)
        self.assertIn("KeyboardInterrupt", said)
        store = moma.Store(file)
        self.assertEqual(list(store.sql("SELECT status FROM invocation").status), ["stopped"])
        self.assertEqual(set(store.trials().outcome), {"timeout"}, "trials in flight were let end")
        done = len(store.trials())
        self.assertLess(done, 1000)
        self.assertEqual(sorted(path.name for path in self.folder.glob(".moma-*")), [], "files for the program")
        self.assertEqual(len(self.evaluate(suite, trials=done + 1).trials()), done + 1)

    def wait_for_trials(self, file, child):
        for _ in range(1000):
            if child.poll() is not None:
                self.fail(f"ended before it was told to: {child.communicate()[1]}")
            if file.is_file():
                with contextlib.closing(sqlite3.connect(f"file:{file}?mode=ro", uri=True)) as store:
                    with contextlib.suppress(sqlite3.OperationalError):  # no tables yet
                        if store.execute("SELECT count(*) FROM trial").fetchone()[0] > 0:
                            return
            time.sleep(0.1)
        self.fail("no trial in 100 s")

    def test_a_controller_that_fails_is_an_error_of_its_trials(self):
        with self.assertRaisesRegex(moma.ProgramError, "RuntimeError: not today"):
            self.evaluate(controllers={"mine": wrapped.Failing}, trials=1)
        store = self.evaluate(controllers={"mine": wrapped.Failing}, trials=2, keep_going=True)
        self.assertEqual(list(store.trials("outcome = 'error'").controller), ["mine", "mine"])
        reason = store.trials("controller = 'mine'").reason[0]
        self.assertIn("RuntimeError: not today | wrapped.py:", reason)
        with self.assertRaisesRegex(moma.ProgramError, "--allow-plugins"):
            store.replay(store.trials("controller = 'mine'").trial[0])

    def test_each_way_of_going_wrong_ends_its_own_trial(self):
        ways = {
            "raises": "RuntimeError: not today",
            "exits": "SystemExit: 3",
            "dies": "signal",
            "hoards": "MemoryError",
            "prints": None,
        }
        limits = {"deadline": 25, "memory": 1}
        controllers = {way: {**entry_of((wrapped.Wrong, {"way": way})), **limits} for way in ways}
        store = self.evaluate(
            {**SUITE, "simulation": {"mode": "kinematic", "time_limit": 0.4}}, controllers, trials=2, keep_going=True
        )
        for way, reason in ways.items():
            trials = store.trials(f"controller = '{way}'")
            self.assertEqual(len(trials), 2, way)
            if reason is None:
                self.assertEqual(set(trials.outcome), {"timeout"})
            else:
                self.assertEqual(set(trials.outcome), {"error"}, way)
                self.assertIn(reason, trials.reason[0])
        self.assertEqual(set(store.trials("controller = 'own'").outcome), {"timeout"})

    def test_what_real_time_ended_is_no_result(self):
        hangs = {**entry_of((wrapped.Wrong, {"way": "hangs"})), "deadline": 25}
        with self.assertRaisesRegex(moma.ProgramError, "no answer to a step within"):
            self.evaluate(controllers={"hangs": hangs}, trials=1, keep_going=True)
        self.assertEqual(len(moma.Store(self.folder / "a.db").trials("controller = 'hangs'")), 0)

    def test_the_reason_is_in_the_exception_where_progress_is_shown_too(self):
        shown = io.StringIO()
        with contextlib.redirect_stderr(shown), self.assertRaisesRegex(moma.ProgramError, "trails: unknown key") as raised:
            moma.evaluate({**SUITE, "trails": 3}, store=self.folder / "shown.db", progress=True)
        self.assertIn("trails: unknown key", shown.getvalue())
        self.assertNotIn("ended with exit code", str(raised.exception))

    def test_mistakes(self):
        with self.assertRaisesRegex(moma.ProgramError, "trails: unknown key"):
            self.evaluate(suite={**SUITE, "trails": 3})
        with self.assertRaisesRegex(ValueError, "is inside of something else"):
            self.evaluate(controllers={"mine": lambda: None})
        with self.assertRaisesRegex(ValueError, "needs a name"):
            moma.Suite({"robot": "x"})
        store = self.evaluate(trials=1)
        with self.assertRaisesRegex(moma.ProgramError, "no such table"):
            store.sql("SELECT * FROM no_such")
        with self.assertRaisesRegex(ValueError, "hexadecimal"):
            store.samples("x'; DROP TABLE trial")
        with self.assertRaises(FileNotFoundError):
            moma.Store(self.folder / "none.db")
        self.assertEqual([f.name for f in self.folder.iterdir() if f.name.startswith(".moma-")], [])

    def test_suites(self):
        suite = moma.Suite(SUITE, {"trials": 2}, self.folder)
        self.assertIn("small", suite.check())
        self.assertEqual(suite.points, [("own", "")])
        with self.assertRaisesRegex(moma.ConfigError, "trails: unknown key"):
            suite.changed({"trails": 3}).load()

    def test_worlds_as_data(self):
        suite = moma.Suite(SUITE, {}, self.folder)
        worlds = [suite.world(index) for index in range(2)]
        self.assertEqual([world["index"] for world in worlds], [0, 1])
        worlds[0].save(self.folder / "world.json")
        self.assertEqual(moma.World(self.folder / "world.json"), worlds[0])
        with self.assertRaisesRegex(moma.ConfigError, "objects"):
            moma.World({**worlds[0], "objects": [{"name": "ball"}]})
        # The ball that the first controller has to go around is gone from a world of one's own.
        empty = moma.World({**worlds[1], "objects": []})
        chosen = moma.Suite(SUITE, {}, self.folder, worlds=[worlds[0], empty])
        store = moma.evaluate(chosen, store=self.folder / "own.db", progress=False)
        drawn = self.evaluate(trials=2)
        trials, usual = store.trials(), drawn.trials()
        self.assertEqual(len(trials), 2)
        self.assertEqual(trials.path_ee_m[0], usual.path_ee_m[0])
        self.assertEqual(list(trials.clearance_min_m.notna()), [True, False])
        moma.save_worlds(worlds, self.folder / "frozen.jsonl")
        frozen = moma.Suite({**SUITE, "worlds": {"frozen": str(self.folder / "frozen.jsonl")}, "trials": 2})
        self.assertEqual(frozen.world(1), worlds[1])
        worlds[0].save(self.folder / "frozen.jsonl")  # an earlier set gives way
        notes = self.folder / "notes.txt"
        for file, force, words in ((notes, False, "force"), (store.path, False, "is a store"), (store.path, True, "is a store")):
            notes.write_text("mine")
            before = pathlib.Path(file).read_bytes()
            with self.assertRaisesRegex(FileExistsError, words):
                worlds[0].save(file, force=force)
            self.assertEqual(pathlib.Path(file).read_bytes(), before)
        worlds[0].save(notes, force=True)
        self.assertEqual(moma.World(notes), worlds[0])
        self.assertEqual([f.name for f in self.folder.iterdir() if f.name.startswith(".moma-")], [])

    def test_a_script_that_evaluates_as_it_is_read_starts_nothing_without_end(self):
        script = self.folder / "script.py"
        script.write_text(
            f"""import os, moma
with open({str(self.folder / "read")!r}, "a") as file:
    file.write(str(os.getpid()) + "\\n")
class Still:
    def reset(self, robot, objects):
        self.size = len(robot.velocities)
    def step(self, seen):
        return [0.0] * self.size
moma.evaluate({dict(SUITE, controllers={})!r}, {{"still": Still}}, store={str(self.folder / "n.db")!r}, progress=False)
"""
        )
        read = self.folder / "read"
        child = subprocess.Popen([sys.executable, str(script)], stderr=subprocess.PIPE, text=True, start_new_session=True)
        try:
            while child.poll() is None:
                time.sleep(0.02)
                count = len(read.read_text().split()) if read.exists() else 0
                self.assertLess(count, 8, "the script reads itself again and again")
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(child.pid, signal.SIGKILL)
            said = child.communicate()[1]
        self.assertNotEqual(child.returncode, 0)
        self.assertIn("__main__", said)
        self.assertLessEqual(len(read.read_text().split()), 2)


if __name__ == "__main__":
    unittest.main()
