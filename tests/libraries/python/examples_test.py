# SPDX-License-Identifier: Apache-2.0
"""The examples in examples/python run and print what their last line says. Arguments: names of the
examples; without them those that do not run the whole system."""

import os
import re
import subprocess
import sys
import unittest
from pathlib import Path

FOLDER = Path(os.environ["HANDSEL_SOURCE_DIR"]) / "examples/python"
EXAMPLES = ([FOLDER / f"{name}.py" for name in sys.argv[1:]]
            or [file for file in sorted(FOLDER.glob("*.py"))
                if "handsel.Environment" not in file.read_text()])


class Examples(unittest.TestCase):
    def test_run_and_print_what_they_promise(self):
        self.assertGreaterEqual(len(EXAMPLES), 1 if sys.argv[1:] else 6)
        for example in EXAMPLES:
            expected = re.search(r"^# Prints: (.*)$", example.read_text(), re.M)
            self.assertIsNotNone(expected, f"{example} has no line \"# Prints: \"")
            done = subprocess.run([sys.executable, "-B", str(example)], capture_output=True,
                                  text=True, timeout=500, check=False)
            self.assertEqual(done.returncode, 0, f"{example}\n{done.stderr}")
            self.assertRegex(done.stdout, expected[1], str(example))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
