#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A few marks to measure by hand, from the command line: chosen, filled in, compared, continued.
Usage: measuring_plan_test.py PROGRAM"""
import csv
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

PROGRAM = sys.argv.pop(1)
SMALL = ("--sample", "pyramid", "--size-mm", 60, "--sheet-x-mm", 130, "--sheet-y-mm", 130, "--clamp-opening-x-mm", 110, "--clamp-opening-y-mm",
         110, "--platform-travel-mm", 60, "--triangles", 500)
MARKS = 8


def rows_of(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


class MeasuringPlan(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.plan = cls.folder / "plan"
        cls.report = cls.planned(cls.plan, "--mark-count", MARKS)
        rows = rows_of(cls.plan / "measured.csv")
        cls.marks = [row for row in rows if row["number"].isdigit()]
        cls.rim = [row for row in rows if row["number"].startswith("rim ")]
        assert len(cls.marks) + len(cls.rim) == len(rows)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    @classmethod
    def planned(cls, out, *flags):
        subprocess.run([PROGRAM, "evidence-plan-points", *map(str, SMALL), "--out", out, "--quiet", *map(str, flags)], check=True,
                       capture_output=True, text=True)
        return json.loads((out / "report.json").read_text())

    def refused(self, *arguments):
        done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertFalse((self.folder / "refused").exists() and list((self.folder / "refused").glob("*.csv")))
        return done.stderr

    def fill(self, name, left_out=0):
        """The plan's folder with the form filled in as expected."""
        folder = self.folder / name
        folder.mkdir()
        for file in ("mould.obj", "setup.json"):
            (folder / file).write_bytes((self.plan / file).read_bytes())
        with open(folder / "measured.csv", "w", encoding="utf-8", newline="") as out:
            writer = csv.DictWriter(out, fieldnames=list(self.marks[0]))
            writer.writeheader()
            for i, mark in enumerate(self.marks):
                done = i >= left_out
                writer.writerow({**mark, **{a: mark[f"expected_{a}"] if done else "" for a in ("x_mm", "y_mm", "z_mm")}})
            for place in self.rim:
                writer.writerow({**place, "thickness_mm": "1"})
        return folder

    def test_marks_lie_on_the_grid_and_apart(self):
        self.assertEqual([row["number"] for row in self.marks], [str(i + 1) for i in range(MARKS)])
        places = [(float(row["sheet_x_mm"]), float(row["sheet_y_mm"])) for row in self.marks]
        for x, y in places:
            self.assertEqual((x % 10, y % 10), (0, 0))
            self.assertLessEqual(max(abs(x), abs(y)), 51)
        self.assertEqual(len(set(places)), MARKS)
        self.assertEqual(len(self.report["marks"]), MARKS)
        self.assertLess(self.report["information_nats"], self.report["information_of_all_nats"])
        self.assertEqual(self.report["information_of_measured_nats"], 0)

    def test_the_rim_shows_a_sheet_that_is_thicker_on_one_side(self):
        places = {row["number"]: (float(row["sheet_x_mm"]), float(row["sheet_y_mm"])) for row in self.rim}
        self.assertEqual(places, {"rim left": (-60, 0), "rim right": (60, 0), "rim front": (0, -60), "rim back": (0, 60)})
        self.assertEqual([(r["side"], r["expected_mm"]) for r in self.report["rim"]],
                         [("left", 1), ("right", 1), ("front", 1), ("back", 1)])
        without = self.planned(self.folder / "without rim", "--mark-count", MARKS, "--rim-thickness", "off")
        self.assertEqual(without["rim"], [])
        visible = [next(c["min_visible_strength"] for c in r["causes"] if c["name"] == "thickness_wedge") for r in (self.report, without)]
        self.assertLess(visible[0], 0.7 * visible[1])
        self.assertGreater(self.report["information_nats"], without["information_nats"])
        self.assertNotIn("the rim's thickness", without["sentence"])
        self.assertIn("the rim's thickness", self.report["sentence"])

    def test_strong_causes_show_sooner_with_all_marks(self):
        causes = self.report["causes"]
        names = [cause["name"] for cause in causes]
        self.assertEqual(len(set(names)), len(names))
        self.assertLessEqual({"heating_gradient", "print_stretch_x", "scan_shift"}, set(names))
        for cause in causes:
            few, every = cause["min_visible_strength"], cause["best_visible_strength"]
            # What contact does differently about two materials can hide a cause from more marks, too.
            if few is not None and every is not None:
                self.assertLessEqual(every, few * (1 + 1e-9), cause["name"])
            if few is not None:
                self.assertEqual(cause["shows"], few <= cause["usual_strength"])
        shifted = next(c for c in causes if c["name"] == "mould_shift")
        self.assertTrue(shifted["shows"])
        self.assertIn(shifted["label"], self.report["sentence"])

    def test_better_gauges_show_more(self):
        fine = self.planned(self.folder / "fine", "--mark-count", MARKS, "--gauge-sigma-mm", 0.05)
        self.assertGreater(fine["information_nats"], self.report["information_nats"])

    def test_the_drawing_has_true_size(self):
        root = ElementTree.parse(self.plan / "marks.svg").getroot()
        self.assertEqual((root.get("width"), root.get("height")), ("130mm", "130mm"))
        texts = [e.text for e in root.iter("{http://www.w3.org/2000/svg}text")]
        self.assertEqual(texts, [str(i + 1) for i in range(MARKS)] + ["front"])

    def test_the_filled_form_is_a_measured_object(self):
        out = self.folder / "compared"
        for left_out in (0, 2):
            folder = self.fill(f"filled {left_out}", left_out)
            subprocess.run([PROGRAM, "thermoform-compare", "--object", folder, "--triangles", "500", "--step-mm", "0.6", "--out", out,
                            "--quiet"], check=True,
                           capture_output=True)
            self.assertEqual(len((out / "residuals.csv").read_text().splitlines()), MARKS - left_out + 1)
            report = json.loads((out / "report.json").read_text())
            self.assertLess(report["error_mean_mm"], 0.01)  # the form has five digits

    def test_further_marks_continue_the_plan(self):
        measured = self.fill("so far") / "measured.csv"
        further = self.planned(self.folder / "further", "--measured", measured, "--mark-count", 3)
        self.assertEqual(further["measured"], MARKS)
        self.assertAlmostEqual(further["information_of_measured_nats"] / self.report["information_nats"], 1, delta=0.05)
        self.assertGreater(further["information_nats"], further["information_of_measured_nats"])
        self.assertEqual(further["rim"], [])  # it is measured
        rows = [row for row in rows_of(self.folder / "further" / "measured.csv") if row["thickness_mm"] == ""]
        self.assertEqual([row["number"] for row in rows], [str(i + 1) for i in range(MARKS + 3)])
        places = {(row["sheet_x_mm"], row["sheet_y_mm"]) for row in rows}
        self.assertEqual(len(places), MARKS + 3)

    def test_what_is_wrong_is_said(self):
        plan = ("evidence-plan-points", *SMALL, "--out", self.folder / "refused")
        self.assertIn("spacing_mm", self.refused(*plan, "--mark-spacing-mm", 100))
        many = self.folder / "many.csv"
        many.write_text("sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm\n" + "0,0,0,0,30\n" * 301)
        self.assertIn("301 points", self.refused(*plan, "--measured", many))
        many.write_text("sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm\n0,0,,,\n")
        self.assertIn("many.csv has no rows", self.refused(*plan, "--measured", many))
        many.write_text("sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm\n0,0,1,,\n")
        self.assertIn("y_mm", self.refused(*plan, "--measured", many))
        self.assertIn("mark_count", self.refused(*plan, "--mark-count", 0).replace("--mark-count", "mark_count"))


if __name__ == "__main__":
    unittest.main()
