# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line in a folder of its own, for tests of what it writes and refuses. The first word after the test's name is PROGRAM."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM = sys.argv.pop(1)
TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


def written(folder: pathlib.Path):
    """What a run has left, without the list of it."""
    return sorted(p.name for p in folder.iterdir() if p.name != ".formwright.json")


class CommandLineCase(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)

    def tearDown(self):
        self.temporary.cleanup()

    def run_program(self, *words, **options):
        return subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, timeout=300, **options)

    def expect_refused(self, part: str, *words, code: int = 2):
        run = self.run_program(*words)
        self.assertEqual(run.returncode, code, (words, run.stderr))
        lines = [line for line in run.stderr.splitlines() if line.startswith("formwright: ")]
        self.assertEqual(len(lines), 1, run.stderr)
        self.assertIn(part, lines[0])
        self.assertTrue(lines[0].rstrip().endswith((".", "?")), lines[0])
        self.assertFalse((self.folder / "out" / "report.json").exists())
