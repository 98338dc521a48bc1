#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A relief on a base from a file, on the command line: what the base misses is refused, or free and said in a note.
Usage: relief_base_test.py PROGRAM"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM = sys.argv.pop(1)


def square(side_mm, z_mm=0):
    """An OBJ of two triangles that face the viewer."""
    half = side_mm / 2
    corners = ((-half, -half), (half, -half), (half, half), (-half, half))
    return "".join(f"v {x} {y} {z_mm}\n" for x, y in corners) + "f 1 2 3\nf 1 3 4\n"


class ReliefBase(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.addCleanup(self.temporary.cleanup)
        self.out = self.folder / "out"

    def relief(self, base, *words):
        path = self.folder / "base.obj"
        path.write_text(base)
        return subprocess.run(
            [PROGRAM, "relief", "--sample", "octopus", "--sample-vertices", "2000", "--width-mm", "100", "--base-mesh", path, *words, "--out", self.out],
            capture_output=True, text=True, timeout=300)

    def report(self):
        return json.loads((self.out / "report.json").read_text())

    def test_a_base_behind_all_of_the_model_needs_no_note(self):
        run = self.relief(square(300))
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(self.report()["notes"], [])

    def test_a_small_base_is_refused_with_the_fix(self):
        run = self.relief(square(40))
        self.assertEqual(run.returncode, 2)
        self.assertIn("base", run.stderr)
        self.assertFalse((self.out / "report.json").exists())

    def test_what_a_small_base_leaves_free_is_said(self):
        run = self.relief(square(40), "--base-misses", "free")
        self.assertEqual(run.returncode, 0, run.stderr)
        report = self.report()
        self.assertGreater(report["vertices_beyond_base"], 0)
        self.assertEqual(len(report["notes"]), 1)
        self.assertIn(f"{report['vertices_beyond_base']} vertices have nothing behind", report["notes"][0])

    def test_a_file_that_is_no_base_is_named(self):
        run = self.relief("not a model\n")
        self.assertEqual(run.returncode, 2)
        self.assertIn("base.obj", run.stderr)


if __name__ == "__main__":
    unittest.main()
