"""moma.tune(): the program's search, over the parameters of a class of one's own."""

import os
import pathlib
import tempfile
import unittest

import moma
import wrapped

ROOT = pathlib.Path(os.environ["MOMA_SOURCE_DIR"])
SUITE = {
    "name": "gain",
    "robot": str(ROOT / "configs/robots/panda.yaml"),
    "controllers": {"rrmc": str(ROOT / "configs/controllers/rrmc.yaml")},
    "worlds": {"seed": 5, "families": {"open": {}}},
    "simulation": {"mode": "kinematic", "time_limit": 4},
    "trials": 3,
}
SEARCH = {
    "controller": "mine",
    "variables": {"controller.parameters.gain": {"range": [0.05, 2], "scale": "log", "start": 0.1}},
    "objective": {"minimize": {"position_error_m": 1}},
    "algorithm": "BOBYQA",
    "budget": {"trials": 18},
    "worlds": 3,
    "held_out": 3,
    "confirm": "none",
    "racing": "none",
    "sensitivity": "none",
}


class TuneTest(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.folder = pathlib.Path(self.scratch.name)

    def tune(self, **more):
        return moma.tune(
            SUITE, {"mine": wrapped.Gain}, tune=SEARCH, store=self.folder / "a.db", threads=1, progress=False, **more
        )

    def test_finds_a_better_gain_and_goes_on_from_what_is_there(self):
        tuned = self.tune()
        self.assertGreater(tuned.controller["parameters"]["gain"], 0.3)
        self.assertEqual(tuned.gains, self.folder / "a.yaml")
        self.assertIn("On worlds that took no part in the search", tuned.text)
        trials = len(tuned.store.sql("SELECT * FROM trial"))
        again = self.tune()
        self.assertEqual(again.controller, tuned.controller)
        self.assertEqual(len(again.store.sql("SELECT * FROM trial")), trials)
        # What was found is a controller like any other.
        store = moma.evaluate(SUITE, {"found": tuned.gains}, store=self.folder / "b.db", progress=False)
        best = store.trials("controller = 'found'").position_error_m
        self.assertEqual(len(best), 3)

    def test_says_what_is_wrong(self):
        with self.assertRaisesRegex(moma.ProgramError, "gian"):
            moma.tune(SUITE, {"mine": wrapped.Gain}, tune={**SEARCH, "variables": {"controller.parameters.gian": {"range": [0, 1]}}},
                      store=self.folder / "a.db", progress=False)
        with self.assertRaisesRegex(moma.ProgramError, "budgets: unknown key"):
            moma.tune(SUITE, {"mine": wrapped.Gain}, tune={**SEARCH, "budgets": 3}, store=self.folder / "a.db", progress=False)


if __name__ == "__main__":
    unittest.main()
