#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A formed object that was measured, compared with its simulation. Usage: measured_object_test.py PROGRAM"""
import json
import unittest

from command_line_case import CommandLineCase


class CommandLine(CommandLineCase):
    def measured_object(self, rows, **setup):
        folder = self.folder / "object"
        folder.mkdir(exist_ok=True)
        s = 20.0
        pyramid = [(-s, -s, 0), (s, -s, 0), (s, s, 0), (-s, s, 0), (0, 0, 30)]
        faces = ["1 2 5", "2 3 5", "3 4 5", "4 1 5", "1 3 2", "1 4 3"]
        (folder / "mould.obj").write_text("".join("v %g %g %g\n" % v for v in pyramid) + "".join(f"f {f}\n" for f in faces))
        values = {"sheet_mm": [140, 150], "sheet_thickness_mm": 1, "clamp_opening_mm": [120, 130], "clamp_height_mm": 3, "base_plate_start_z_mm": -60,
                  "base_plate_end_z_mm": 0, "mould_speed_mm_per_s": 100, "relaxation_s": 1, "vacuum_kpa": 80, "density_kg_per_m3": 1330,
                  "poisson_ratio": 0.35, "measured_surface": "mid", "triangles": 800, **setup}
        (folder / "setup.json").write_text(json.dumps(values))
        text = "sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm,sigma_mm\n" + "".join(",".join(f"{v:.9g}" for v in row) + "\n" for row in rows)
        (folder / "measured.csv").write_text(text)
        return folder

    def test_a_measured_object_is_compared(self):
        places = [(x, y) for x in range(-55, 56, 11) for y in range(-60, 61, 12)] + [(66, 70)]  # the last one in the clamp
        folder = self.measured_object([(x, y, 0, 0, 0, 0.1) for x, y in places])
        run = self.run_program("thermoform-compare", "--object", folder, "--out", self.folder / "first", "--quiet")
        self.assertEqual(run.returncode, 0, run.stderr)
        lines = (self.folder / "first" / "residuals.csv").read_text().splitlines()
        simulated = [tuple(map(float, line.split(",")))[5:8] for line in lines[1:]]
        self.assertEqual(simulated[-1], (66, 70, 3))
        # Measured exactly where the simulation has it, but 0.3 mm further in x: that is the error.
        rows = [(x, y, p[0] + 0.3, p[1], p[2], 0.1) for (x, y), p in zip(places, simulated)]
        self.measured_object(rows)
        run = self.run_program("thermoform-compare", "--object", folder, "--out", self.folder / "out", "--quiet")
        self.assertEqual(run.returncode, 0, run.stderr)
        report = json.loads((self.folder / "out" / "report.json").read_text())
        self.assertAlmostEqual(report["error_mean_mm"], 0.3, places=6)
        self.assertAlmostEqual(report["error_max_mm"], 0.3, places=6)
        self.assertEqual(report["points"], len(places))
        # The outer face lies half a thickness beyond the middle.
        self.measured_object([(x, y, *p, 0.1) for (x, y), p in zip(places, simulated)], measured_surface="outer")
        run = self.run_program("thermoform-compare", "--object", folder, "--out", self.folder / "outer", "--quiet")
        report = json.loads((self.folder / "outer" / "report.json").read_text())
        self.assertTrue(0.2 < report["error_mean_mm"] <= 0.55, report["error_mean_mm"])
        self.assertAlmostEqual(report["error_along_normal_mean_mm"], -report["error_mean_mm"], places=3)

    def test_a_turned_sheets_points_are_where_it_turned_them(self):
        places = [(x, y) for x in range(-55, 56, 11) for y in range(-60, 61, 12)]
        folder = self.measured_object([(x, y, 0, 0, 0, 0.1) for x, y in places], thickness_wedge_x=0.4)
        run = self.run_program("thermoform-compare", "--object", folder, "--out", self.folder / "straight", "--quiet")
        self.assertEqual(run.returncode, 0, run.stderr)
        lines = (self.folder / "straight" / "residuals.csv").read_text().splitlines()
        simulated = [tuple(map(float, line.split(",")))[5:8] for line in lines[1:]]
        # The same object with the sheet laid in the other way round: its coordinates and its wedge are turned.
        self.measured_object([(-x, -y, *p, 0.1) for (x, y), p in zip(places, simulated)], thickness_wedge_x=-0.4, sheet_turned=True)
        run = self.run_program("thermoform-compare", "--object", folder, "--out", self.folder / "turned", "--quiet")
        self.assertEqual(run.returncode, 0, run.stderr)
        report = json.loads((self.folder / "turned" / "report.json").read_text())
        self.assertLess(report["error_max_mm"], 1e-6)
        row = (self.folder / "turned" / "residuals.csv").read_text().splitlines()[1].split(",")
        self.assertEqual((float(row[0]), float(row[1])), (55, 60))  # as measured

    def test_a_measured_objects_mistakes_are_named(self):
        folder = self.measured_object([(0, 0, 0, 0, 30, 0.1)], vacuum_kpa="much")
        self.expect_refused("vacuum_kpa", "thermoform-simulate", "--object", folder, "--out", self.folder / "out")
        folder = self.measured_object([(0, 0, 0, 0, 30, 0.1)])
        (folder / "measured.csv").write_text("sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm\n0,0,0,zero,30\n")
        self.expect_refused("line 2", "thermoform-compare", "--object", folder, "--out", self.folder / "out")
        self.expect_refused("no folder", "thermoform-compare", "--object", self.folder / "none", "--out", self.folder / "out")
        self.expect_refused("beyond the clamp opening", "thermoform-simulate", "--sample", "pyramid", "--size-mm", 300, "--out", self.folder / "out")
        self.expect_refused("deep", "thermoform-simulate", "--sample", "pyramid", "--size-mm", 200, "--platform-travel-mm", 50, "--out", self.folder / "out")


if __name__ == "__main__":
    unittest.main(verbosity=2)
