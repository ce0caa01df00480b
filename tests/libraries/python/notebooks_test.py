# SPDX-License-Identifier: Apache-2.0
"""Runs the notebooks in examples/notebooks: each cell in turn, in one namespace, as Jupyter does
without magics. A cell prints what its metadata says under handsel.prints.

Arguments: names of notebooks to run; without them all.
"""

import contextlib
import io
import json
import os
import sys
import unittest
from pathlib import Path

NOTEBOOKS = Path(os.environ["HANDSEL_SOURCE_DIR"]) / "examples/notebooks"
NAMES = sys.argv[1:] or sorted(path.stem for path in NOTEBOOKS.glob("*.ipynb"))


class Notebooks(unittest.TestCase):
    def run_notebook(self, name):
        cells = json.loads((NOTEBOOKS / f"{name}.ipynb").read_text())["cells"]
        space, promised = {"__name__": "__main__"}, 0
        for number, cell in enumerate(cells):
            if cell["cell_type"] != "code":
                continue
            self.assertEqual(cell["outputs"], [], "notebooks are stored without outputs")
            printed = io.StringIO()
            code = compile("".join(cell["source"]), f"{name}, cell {number + 1}", "exec")
            with contextlib.redirect_stdout(printed):
                exec(code, space)
            expected = cell["metadata"].get("handsel", {}).get("prints")
            if expected:
                promised += 1
                self.assertRegex(printed.getvalue(), expected, f"{name}, cell {number + 1}")
                print(f"{name}: {printed.getvalue().strip()}", file=sys.stderr)
        self.assertGreater(promised, 0, f"{name} states nowhere what it prints")

    def test_cells_run_and_print_what_they_promise(self):
        self.assertGreaterEqual(len(NAMES), 1 if sys.argv[1:] else 3)
        for name in NAMES:
            with self.subTest(name):
                self.run_notebook(name)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
