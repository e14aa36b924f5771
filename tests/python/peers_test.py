"""Other people's controllers in examples/peers: each runs in an open and a cluttered world without an error of its own, and is short."""

import os
import pathlib
import sys
import tempfile
import unittest

import moma

ROOT = pathlib.Path(os.environ["MOMA_SOURCE_DIR"])
if not all((ROOT / folder / "bin/python3").exists() for folder in (".venv-peers", ".venv-toolbox")):
    print("skipped: the peers are not installed (examples/peers/install.sh)")
    sys.exit(77)


class PeersTest(unittest.TestCase):
    def test_each_runs(self):
        for suite in ("peers", "peers-panda"):
            with tempfile.TemporaryDirectory() as folder:
                store = moma.evaluate(ROOT / f"configs/suites/{suite}.yaml", store=f"{folder}/a.db", trials=2, progress=False, keep_going=True,
                                      changes={"simulation.time_limit": 1})
                trials = store.trials()
                names = [name for name, _ in moma.Suite(ROOT / f"configs/suites/{suite}.yaml").points]
                self.assertEqual(sorted(set(trials.controller)), sorted(names))
                self.assertEqual(list(trials[trials.outcome == "error"].reason), [])
                self.assertGreater(trials.groupby("controller").path_ee_m.max().min(), 0.01, "all of them move")

    def test_each_is_short(self):
        for file in (ROOT / "examples/peers").glob("*.py"):
            if file.name in ("mink_peer.py", "pink_peer.py", "toolbox_peer.py", "policy.py"):
                self.assertLess(len(file.read_text().splitlines()), 100, file.name)


if __name__ == "__main__":
    unittest.main()
