"""How pip builds the package (python/backend): in the checkout, or beside one that cannot be written to."""

import os
import pathlib
import sys
import types
import unittest
from unittest import mock

ROOT = pathlib.Path(os.environ["MOMA_SOURCE_DIR"])
build = types.ModuleType("scikit_build_core.build")
build.calls = []
build.build_wheel = lambda *arguments: build.calls.append(arguments) or "moma.whl"
build.get_requires_for_build_wheel = lambda settings=None: []
package = types.ModuleType("scikit_build_core")
package.build = build
sys.modules.update({"scikit_build_core": package, "scikit_build_core.build": build})
sys.path.insert(0, str(ROOT / "python/backend"))

import moma_backend  # noqa: E402


class BackendTest(unittest.TestCase):
    def settings(self, writable, given=None):
        with mock.patch("os.access", lambda path, mode: writable), mock.patch.dict(os.environ, XDG_CACHE_HOME="/cache"):
            self.assertEqual(moma_backend.build_wheel("dist", given), "moma.whl")
        return build.calls[-1][1]

    def test_a_checkout_keeps_what_was_compiled(self):
        self.assertIsNone(self.settings(True))
        self.assertEqual(self.settings(True, {"build-dir": "x"}), {"build-dir": "x"})

    def test_nothing_is_written_into_a_checkout_that_is_only_read(self):
        self.assertEqual(self.settings(False)["build-dir"], "/cache/moma/build-wheel")
        self.assertEqual(self.settings(False)["cmake.define.MOMA_REUSE_BUILD"], "OFF")
        self.assertEqual(self.settings(False, {"build-dir": "x"})["build-dir"], "x")

    def test_the_rest_is_scikit_build_cores(self):
        self.assertTrue(hasattr(moma_backend, "get_requires_for_build_wheel"))
        text = (ROOT / "pyproject.toml").read_text()
        self.assertIn('build-backend = "moma_backend"', text)
        self.assertIn('backend-path = ["python/backend"]', text)


if __name__ == "__main__":
    unittest.main()
