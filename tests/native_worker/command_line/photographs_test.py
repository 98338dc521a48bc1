#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A sheet with coded marks, photographed by the virtual studio and measured. Usage: photographs_test.py PROGRAM RENDER_PHOTOGRAPHS"""
import json
import pathlib
import subprocess
import sys
import unittest

RENDER = sys.argv.pop(2)

from command_line_case import CommandLineCase, written  # noqa: E402  takes PROGRAM from the command line

OPENING = 120


class CommandLine(CommandLineCase):
    def photographed(self, count: int, width: int) -> pathlib.Path:
        made = self.folder / "pattern"
        run = self.run_program("evidence-pattern", "--kind", "marks", "--sheet-x-mm", 140, "--sheet-y-mm", 140, "--clamp-opening-x-mm", OPENING,
                               "--clamp-opening-y-mm", OPENING, "--board-mark-mm", 14, "--dots-per-inch", 200, "--out", made, "--quiet")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(written(made), ["board.pdf", "pattern.json", "pattern.pdf", "pattern.png", "report.json"])
        subprocess.run([RENDER, self.folder, made / "pattern.json", str(count), str(width)], check=True, timeout=300)
        return made / "pattern.json"

    def photographs(self, count: int):
        return [word for i in range(count) for word in ("--photograph", self.folder / f"photo{i + 1}.jpg")]

    def test_photographs_become_a_measured_object(self):
        pattern, out = self.photographed(5, 1400), self.folder / "out"
        run = self.run_program("evidence-photographs", *self.photographs(5), "--pattern", pattern, "--board-height-mm", 12, "--out", out, "--quiet")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(written(out), ["measured.csv", "report.json", "seen.png"])
        report = json.loads((out / "report.json").read_text())
        described = json.loads(self.run_program("describe", "evidence-photographs").stdout)
        self.assertEqual(set(report) - {f["name"] for f in described["report"]}, set())
        counted = sum(report[f"marks_{k}"] for k in ("measured", "uncertain", "small_angle", "seen_once", "unclear", "not_seen"))
        self.assertEqual(counted, report["marks"])
        self.assertEqual(len(report["marks_left_out"]), report["marks"] - report["marks_measured"])
        self.assertAlmostEqual(report["lenses"][0]["focal_px"], 0.8 * 1400, delta=10)
        truth = {}
        for line in (self.folder / "truth.csv").read_text().splitlines():
            sx, sy, *place = map(float, line.split(","))
            truth[round(sx, 3), round(sy, 3)] = place
        lines = (out / "measured.csv").read_text().splitlines()
        self.assertEqual(lines[0], "sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm,sigma_mm")
        self.assertEqual(len(lines) - 1, report["points"])
        errors = []
        for line in lines[1:]:
            sx, sy, *place, sigma = map(float, line.split(","))
            errors.append(sum((a - b) ** 2 for a, b in zip(place, truth[round(sx, 3), round(sy, 3)])) ** 0.5)
            self.assertTrue(0 < sigma <= 1)
        errors.sort()
        self.assertGreater(len(errors), 150)
        self.assertLess(errors[len(errors) // 2], 0.1)
        self.assertLess(errors[len(errors) * 95 // 100], 0.3)
        # The folder of a measured object takes the points as they are.
        folder = self.folder / "object"
        folder.mkdir()
        (folder / "measured.csv").write_text((out / "measured.csv").read_text())
        (folder / "mould.obj").write_text("v -20 -20 0\nv 20 -20 0\nv 20 20 0\nv -20 20 0\nv 0 0 20\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 1 3 2\nf 1 4 3\n")
        (folder / "setup.json").write_text(json.dumps({"sheet_mm": [140, 140], "clamp_opening_mm": [OPENING, OPENING], "clamp_height_mm": 1, "measured_surface": "outer",
                                                       "base_plate_start_z_mm": -60, "base_plate_end_z_mm": 0, "triangles": 800}))
        run = self.run_program("thermoform-compare", "--object", folder, "--out", self.folder / "compared", "--quiet")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(json.loads((self.folder / "compared" / "report.json").read_text())["points"], report["points"])

    def test_what_cannot_be_measured_is_refused(self):
        pattern, out = self.photographed(2, 800), self.folder / "out"
        one = self.folder / "photo1.jpg"
        self.expect_refused("two or more", "evidence-photographs", "--photograph", one, "--pattern", pattern, "--out", out)
        self.expect_refused("several times", "evidence-photographs", "--photograph", one, "--photograph", one, "--pattern", pattern, "--out", out)
        broken = self.folder / "broken.jpg"
        broken.write_bytes(one.read_bytes()[:2000])
        self.expect_refused("broken.jpg", "evidence-photographs", "--photograph", one, "--photograph", broken, "--pattern", pattern, "--out", out)
        both = self.photographs(2)
        self.expect_refused("not a pattern.json", "evidence-photographs", *both, "--pattern", pattern.parent / "report.json", "--out", out)
        self.expect_refused("check length", "evidence-photographs", *both, "--pattern", pattern, "--board-check-mm", 12, "--out", out)
        noise = self.folder / "noise"
        self.run_program("evidence-pattern", "--out", noise, "--dots-per-inch", 50, "--quiet")
        self.expect_refused("no coded marks", "evidence-photographs", *both, "--pattern", noise / "pattern.json", "--out", out)


if __name__ == "__main__":
    unittest.main(verbosity=2)
