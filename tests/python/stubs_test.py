"""The package is typed: the build writes _core.pyi, the types of the extension module."""

import ast
import pathlib
import unittest

import moma
from moma import _core

PACKAGE = pathlib.Path(moma.__file__).parent


def public(names):
    return {name for name in names if not name.startswith("_")}


class StubsTest(unittest.TestCase):
    def test_the_package_says_that_it_is_typed(self):
        self.assertTrue((PACKAGE / "py.typed").is_file())

    def test_stub_and_module_have_the_same_names(self):
        tree = ast.parse((PACKAGE / "_core.pyi").read_text())
        classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
        others = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
        others |= {node.target.id for node in tree.body if isinstance(node, ast.AnnAssign)}
        self.assertEqual(public(classes) | others, public(dir(_core)))
        for name, node in classes.items():
            members = {member.name for member in node.body if isinstance(member, ast.FunctionDef)}
            self.assertEqual(public(members), public(vars(getattr(_core, name))), name)

    def test_all_that_is_exported_is_there(self):
        for name in public(moma.__all__) - {"Env", "VectorEnv", "register_envs"}:  # these need gymnasium
            self.assertTrue(hasattr(moma, name), name)


if __name__ == "__main__":
    unittest.main()
