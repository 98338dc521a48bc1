#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A pattern that is printed, and found again on a scan. Usage: pattern_scan_test.py PROGRAM"""
import json
import struct
import unittest

from command_line_case import CommandLineCase, written


class CommandLine(CommandLineCase):
    def domed_scan(self, name: str = "scan.obj"):
        """A dome of 90 x 100 mm whose texture coordinates are the flat sheet's own: the pattern's picture fits it."""
        n, width, length = 45, 90.0, 100.0
        lines = []
        for j in range(n + 1):
            for i in range(n + 1):
                x, y = width * (i / n - 0.5), length * (j / n - 0.5)
                share = (x * x + y * y) / 34**2
                z = 1.5 + (9 * (1 - share) ** 2 if share < 1 else 0)
                # Lying on its side, in metres, somewhere.
                lines.append(f"v {z / 1000 + 3:.9f} {x / 1000:.9f} {y / 1000 - 1:.9f}\nvt {i / n:.7f} {j / n:.7f}\n")
        for j in range(n):
            for i in range(n):
                a = j * (n + 1) + i + 1
                b, c, d = a + 1, a + n + 2, a + n + 1
                lines.append(f"f {a}/{a} {b}/{b} {c}/{c}\nf {a}/{a} {c}/{c} {d}/{d}\n")
        (self.folder / name).write_text("".join(lines))
        return self.folder / name

    PATTERN = ("--sheet-x-mm", 90, "--sheet-y-mm", 100, "--clamp-opening-x-mm", 78, "--clamp-opening-y-mm", 88, "--coarsest-mm", 20)

    def test_a_pattern_is_printed_and_found_again_on_a_scan(self):
        made = self.folder / "pattern"
        run = self.run_program("evidence-pattern", *self.PATTERN, "--seed", 5, "--dots-per-inch", 250, "--out", made, "--quiet")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(written(made), ["pattern.json", "pattern.pdf", "pattern.png", "report.json"])
        width, height = struct.unpack(">II", (made / "pattern.png").read_bytes()[16:24])
        self.assertEqual([width, height], json.loads((made / "report.json").read_text())["picture_pixels"])
        self.assertAlmostEqual(width / 250 * 25.4, 90, delta=0.1)
        page = (made / "pattern.pdf").read_bytes()
        self.assertIn(b"/MediaBox", page)
        out = self.folder / "out"
        run = self.run_program("evidence-register", "--scan", self.domed_scan(), "--pattern", made / "pattern.json", "--texture", made / "pattern.png",
                               "--scan-unit-mm", 1000, "--picture-px", 600, "--out", out, "--quiet")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(written(out), ["aligned.png", "flow.png", "measured.csv", "report.json"])
        report = json.loads((out / "report.json").read_text())
        described = json.loads(self.run_program("describe", "evidence-register").stdout)
        self.assertEqual(set(report) - {f["name"] for f in described["report"]}, set())
        self.assertEqual(report["coordinates"], "rim")
        lines = (out / "measured.csv").read_text().splitlines()
        self.assertEqual(lines[0], "sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm,sigma_mm")
        self.assertEqual(len(lines) - 1, report["points"])
        self.assertGreater(report["points"], 250)
        errors = []
        for line in lines[1:]:
            sx, sy, x, y, z, sigma = map(float, line.split(","))
            share = (sx * sx + sy * sy) / 34**2
            errors.append(((x - sx) ** 2 + (y - sy) ** 2 + (z - 1.5 - (9 * (1 - share) ** 2 if share < 1 else 0)) ** 2) ** 0.5)
            self.assertTrue(0 < sigma <= 1)
        errors.sort()
        self.assertLess(errors[len(errors) // 2], 0.06)
        self.assertLess(errors[len(errors) * 95 // 100], 0.2)

    def test_wrong_patterns_and_scans_are_refused(self):
        made, out = self.folder / "pattern", self.folder / "out"
        self.run_program("evidence-pattern", *self.PATTERN, "--out", made, "--dots-per-inch", 100, "--quiet")
        scan = self.domed_scan()
        self.expect_refused("wider than the sheet", "evidence-pattern", "--clamp-opening-x-mm", 300, "--out", out)
        self.expect_refused("not a pattern.json", "evidence-register", "--scan", scan, "--pattern", made / "report.json", "--texture", made / "pattern.png", "--out", out)
        self.expect_refused("without its picture", "evidence-register", "--scan", scan, "--pattern", made / "pattern.json", "--out", out)
        # Taken for millimetres, metres are too small for any mark.
        self.expect_refused("corner marks", "evidence-register", "--scan", scan, "--pattern", made / "pattern.json", "--texture", made / "pattern.png", "--out", out)
        self.expect_refused("four pairs", "evidence-register", "--scan", scan, "--pattern", made / "pattern.json", "--texture", made / "pattern.png", "--corners", "1,2", "--out", out)


if __name__ == "__main__":
    unittest.main(verbosity=2)
