#!/usr/bin/env python3
"""bench/check.py: verdicts on times that are given, errors, exit codes. No clock is looked at."""
import contextlib
import io
import os
import pathlib
import random
import sys
import tempfile
import unittest
import unittest.mock

ROOT = pathlib.Path(sys.argv.pop(1))
sys.path.insert(0, str(ROOT / "bench"))
import check  # noqa: E402


class Verdicts(unittest.TestCase):
    def times(self, factor, noise, seed, n=11):
        """Rounds in which the machine is up to twice as slow, the same for both programs."""
        rng = random.Random(seed)
        machine = [rng.uniform(10, 20) for _ in range(n)]
        return ([m * rng.gauss(1, noise) for m in machine], [factor * m * rng.gauss(1, noise) for m in machine])

    def test_interval_holds_the_median_as_often_as_it_says(self):
        rng = random.Random(4)
        for n, least in ((6, 0.95), (11, 0.95), (21, 0.95)):
            hits = 0
            for _ in range(4000):
                low, high = check.interval([rng.expovariate(1.0) for _ in range(n)])
                hits += low <= 0.6931471805599453 <= high
            self.assertGreater(hits / 4000, least - 0.012, n)
        self.assertEqual(check.interval([3, 1, 2]), (1, 3))
        # 11 values: ranks 2 and 10 hold the median with 0.988, ranks 3 and 9 with 0.935.
        self.assertEqual(check.interval(list(range(1, 12))), (2, 10))

    def test_a_slower_program_is_noticed_on_a_noisy_machine(self):
        for seed in range(20):
            self.assertEqual(check.verdict(*self.times(1.25, 0.04, seed), 0.05)[2], "SLOWER", seed)

    def test_an_equal_or_faster_one_is_not_accused(self):
        for seed in range(200):
            self.assertNotEqual(check.verdict(*self.times(1.0, 0.05, seed), 0.05)[2], "SLOWER", seed)
        self.assertEqual(check.verdict(*self.times(0.7, 0.04, 1), 0.05)[2], "faster")

    def test_ratio_is_of_rounds(self):
        self.assertAlmostEqual(check.verdict([1, 10, 2, 4, 5, 6], [2, 20, 4, 8, 10, 12], 0.05)[0], 2.0)


class Program(unittest.TestCase):
    def fake(self, folder, name, text):
        file = pathlib.Path(folder) / name
        file.write_text(f"#!{sys.executable}\n{text}")
        os.chmod(file, 0o755)
        return str(file)

    def run_check(self, *words):
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            try:
                code = check.main(list(words))
            except SystemExit as refused:
                code = refused.code
        return code, out.getvalue(), err.getvalue()

    def test_refuses(self):
        with tempfile.TemporaryDirectory() as folder:
            good = self.fake(folder, "good", "")
            for words, text in (((folder + "/none", good), "is no program"), ((good, folder), "is no program"),
                                ((good, good, "--rounds", "5"), "at least 6"), ((good, good, "--slower", "-1"), "at least 0")):
                code, _, err = self.run_check(*words)
                self.assertEqual(code, 2, words)
                self.assertIn(text, err)
            broken = self.fake(folder, "broken", "import sys\nsys.exit('no such suite')\n")
            code, _, err = self.run_check(broken, good)
            self.assertEqual(code, 2)
            self.assertIn("no such suite", err)

    def test_time_is_per_control_step(self):
        """A program that says that it made ten times the steps in the same work is faster, the other way round slower."""
        work = "import json, pathlib, sys\nif sys.argv[1] == 'run':\n    pass\n" \
               "    pathlib.Path(sys.argv[sys.argv.index('-o') + 1]).touch()\nelse:\n    print(json.dumps([{'steps': STEPS}]))\n"
        one_kind = dict(list(check.WORK.items())[:1])
        with tempfile.TemporaryDirectory() as folder, unittest.mock.patch.dict(check.WORK, one_kind, clear=True):
            few, many = (self.fake(folder, f"steps{n}", work.replace("STEPS", str(n))) for n in (100, 100000))
            code, out, _ = self.run_check(many, few, "--rounds", "6")
            self.assertEqual((code, out.count("SLOWER")), (1, len(check.WORK)), out)
            code, out, _ = self.run_check(few, many, "--rounds", "6")
            self.assertEqual((code, out.count("faster")), (0, len(check.WORK)), out)


if __name__ == "__main__":
    unittest.main()
