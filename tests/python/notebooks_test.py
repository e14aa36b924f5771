"""The notebooks of examples/notebooks run from their first cell to their last, and make what they speak of."""

import importlib.util
import os
import pathlib
import sys
import tempfile
import unittest

for package in ("nbclient", "nbformat", "ipykernel", "matplotlib", "gymnasium"):
    if importlib.util.find_spec(package) is None:
        print(f"skipped: {package} is not installed (python/requirements-tests.txt)")
        sys.exit(77)
import nbclient
import nbformat

NOTEBOOKS = pathlib.Path(os.environ["MOMA_SOURCE_DIR"]) / "examples/notebooks"


def run(name, folder):
    notebook = nbformat.read(NOTEBOOKS / name, as_version=4)
    nbformat.validate(notebook)
    os.environ["MPLBACKEND"] = "agg"
    nbclient.NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(folder)}}).execute()
    return "\n".join(
        output.get("text", "") + output.get("data", {}).get("text/plain", "")
        for cell in notebook.cells
        for output in cell.get("outputs", [])
    )


class NotebooksTest(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.folder = pathlib.Path(self.scratch.name)

    def test_your_own_controller(self):
        said = run("your-own-controller.ipynb", self.folder)
        self.assertIn("A = holistic, B = mine", said)
        self.assertIn("20 worlds that both met", said)
        self.assertTrue((self.folder / "mine.db").is_file())

    def test_from_a_sweep_to_a_figure(self):
        said = run("from-a-sweep-to-a-figure.ipynb", self.folder)
        self.assertIn("(True, True)", said.replace("np.True_", "True"))
        self.assertGreater((self.folder / "facing.pdf").stat().st_size, 5000)

    def test_notebooks_are_kept_without_what_they_made(self):
        for file in NOTEBOOKS.glob("*.ipynb"):
            for cell in nbformat.read(file, as_version=4).cells:
                self.assertFalse(cell.get("outputs"), f"{file.name}: clear its outputs")


if __name__ == "__main__":
    unittest.main()
