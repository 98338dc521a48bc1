#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets on the command line: their values are used, other flags count more, wrong names are refused.
Usage: preset_flags_test.py PROGRAM"""
import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

PROGRAM = sys.argv.pop(1)


def bounds(ply: pathlib.Path):
    """Width and length of the flat sheet within the clamp, from two of the numbers at every vertex of a binary PLY."""
    data = ply.read_bytes()
    start = data.index(b"end_header\n") + len(b"end_header\n")
    lines = data[:start].decode().split("\n")
    at = next(i for i, line in enumerate(lines) if line.startswith("element vertex"))
    count = int(lines[at].split()[2])
    names, form = [], "<"
    for line in lines[at + 1:]:
        if not line.startswith("property"):
            break
        kind, name = line.split()[1:3]
        names.append(name)
        form += {"float": "f", "double": "d", "int": "i", "uint": "I", "uchar": "B"}[kind]
    step = struct.calcsize(form)
    rows = [struct.unpack_from(form, data, start + step * i) for i in range(count)]
    return [max(row[k] for row in rows) - min(row[k] for row in rows) for k in (names.index("sheet_x_mm"), names.index("sheet_y_mm"))]


class PresetFlags(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.addCleanup(self.temporary.cleanup)

    def run_program(self, *words):
        return subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, timeout=300)

    def formed(self, *words):
        out = self.folder / "out"
        run = self.run_program("thermoform-simulate", "--sample", "pyramid", "--size-mm", 60, "--triangles", 400, *words, "--out", out)
        self.assertEqual(run.returncode, 0, run.stderr)
        return out / "sheet.ply"

    def test_a_former_brings_its_opening(self):
        for got, wanted in zip(bounds(self.formed("--former", "sheet_a4_cleaner")), (190, 277)):
            self.assertAlmostEqual(got, wanted, delta=0.01)

    def test_other_flags_count_more_wherever_they_stand(self):
        former = ("--former", "sheet_a4_cleaner")
        for words in (("--clamp-opening-y-mm", 260, *former), (*former, "--clamp-opening-y-mm", 260)):
            self.assertAlmostEqual(bounds(self.formed(*words))[1], 260, delta=0.01)

    def test_a_name_that_is_none_is_refused_with_the_choices(self):
        run = self.run_program("thermoform-simulate", "--sample", "pyramid", "--plastic", "petgg", "--out", self.folder / "out")
        self.assertEqual(run.returncode, 2)
        self.assertIn('--plastic must be one of pvc, petg, hips, abs, pc, acrylic, and is "petgg".', run.stderr)
        self.assertFalse((self.folder / "out").exists())

    def test_every_preset_is_listed_where_help_is_sought(self):
        catalog = json.loads(self.run_program("describe").stdout)
        lists = [(operation["name"], one) for operation in catalog["operations"] for one in operation["presets"]]
        self.assertGreaterEqual(len(lists), 4)
        for operation, one in lists:
            names = ", ".join(preset["name"] for preset in one["presets"])
            shown = " ".join(self.run_program(operation, "--help").stdout.split())
            self.assertIn(f'--{one["name"]} NAME {one["help"]} Other flags count more. [{names}]', shown)


unittest.main()
