#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Evidence from the command line: a small object is calibrated and diagnosed; runs share their work and survive a kill.
Usage: evidence_command_test.py PROGRAM"""
import json
import math
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = sys.argv.pop(1)
MOULD = ("v -25 -25 0\nv 25 -25 0\nv 25 25 0\nv -25 25 0\nv -8 -8 25\nv 8 -8 25\nv 8 8 25\nv -8 8 25\n"
         "f 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nf 5 6 7 8\n")
SETUP = {"sheet_mm": [130, 130], "sheet_thickness_mm": 1, "clamp_opening_mm": [110, 110], "clamp_height_mm": 1, "base_plate_start_z_mm": -60,
         "base_plate_end_z_mm": 0, "mould_speed_mm_per_s": 100, "relaxation_s": 1, "vacuum_kpa": 80, "density_kg_per_m3": 1330,
         "poisson_ratio": 0.35, "measured_surface": "mid"}
PLACES = [(x, y) for x in range(-52, 53, 8) for y in range(-52, 53, 8)]


class Evidence(unittest.TestCase):
    stiffer = ("--young-modulus-pa", 3.4e6, "--yield-strain", 0.16, "--triangles", 1000)

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        # What the simulation itself measures with a stiffer sheet.
        cls.write(cls.folder / "first", [(x, y, x, y, 1) for x, y in PLACES])
        simulated = cls.simulated(cls.folder / "first", *cls.stiffer)
        draw = random.Random(3)
        cls.points = [(x, y, *(v + draw.gauss(0, 0.04) for v in p)) for (x, y), p in zip(PLACES, simulated)]
        cls.object = cls.write(cls.folder / "lamp", cls.points)
        # The same, scanned beside its place.
        cls.shifted_points = [(*p[:2], p[2] + 1.5, *p[3:]) for p in cls.points]
        cls.shifted = cls.write(cls.folder / "shifted", cls.shifted_points)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    @classmethod
    def write(cls, folder, points, **setup):
        folder.mkdir(exist_ok=True)
        (folder / "mould.obj").write_text(MOULD)
        (folder / "setup.json").write_text(json.dumps({**SETUP, **setup}))
        rows = "".join(",".join(f"{v:.9g}" for v in p) + ",0.04\n" for p in points)
        (folder / "measured.csv").write_text("sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm,sigma_mm\n" + rows)
        return folder

    @classmethod
    def simulated(cls, folder, *flags):
        out = folder.parent / "compared"
        subprocess.run([PROGRAM, "thermoform-compare", "--object", folder, "--out", out, "--quiet", *map(str, flags)], check=True, capture_output=True)
        lines = (out / "residuals.csv").read_text().splitlines()[1:]
        return [tuple(map(float, line.split(",")))[5:8] for line in lines]

    def run_program(self, *words):
        run = subprocess.run([PROGRAM, *map(str, words), "--quiet"], capture_output=True, text=True, timeout=500)
        self.assertEqual(run.returncode, 0, run.stderr)

    def expect_refused(self, part, *words):
        run = subprocess.run([PROGRAM, *map(str, words), "--quiet"], capture_output=True, text=True, timeout=300)
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertIn(part, run.stderr)
        self.assertEqual(len(run.stderr.strip().splitlines()), 1, run.stderr)

    def test_a_print_brings_its_own_set_up(self):
        """What thermoforming writes for measuring simulates the same sheet again."""
        flags = ("--triangles", 800, "--former", "sheet_a4_cleaner")
        first, again = self.folder / "formed", self.folder / "formed again"
        self.run_program("thermoform-simulate", "--sample", "pyramid", "--size-mm", 60, "--turn-deg", 30, "--vacuum-kpa", 61, *flags,
                         "--outputs", "mould.obj,setup.json", "--out", first)
        self.run_program("thermoform-simulate", "--object", first, "--triangles", 800, "--out", again)
        reports = [json.loads((folder / "report.json").read_text()) for folder in (first, again)]
        for figure in ("vertices", "model_height_mm", "thickness_min_mm", "formed_area_mm2", "elastic_energy_mj"):
            self.assertAlmostEqual(reports[0][figure], reports[1][figure], delta=1e-3 * abs(reports[0][figure]), msg=figure)
        self.assertAlmostEqual(json.loads((first / "setup.json").read_text())["vacuum_kpa"], 61)

    def test_a_calibration_fits_and_makes_a_profile(self):
        out = self.folder / "calibrated"
        # As many triangles as the object was made with: what fewer leave out would pass for the material.
        self.run_program("evidence-calibrate", "--object", str(self.object) + "/", "--triangles", 1000, "--out", out)
        report = json.loads((out / "report.json").read_text())
        self.assertLess(report["error_mean_mm"], 0.8 * report["error_nominal_mm"])
        truth = {"young_modulus_pa": 3.4e6, "yield_strain": 0.16, "creep_per_s": 500, "viscosity_s": 2.5e-5}
        for parameter in report["parameters"]:
            if parameter["name"] in truth:
                self.assertLessEqual(0.9 * parameter["low"], truth[parameter["name"]], parameter)
                self.assertGreaterEqual(1.1 * parameter["high"], truth[parameter["name"]], parameter)
        described = json.loads(subprocess.run([PROGRAM, "describe", "evidence-calibrate"], capture_output=True, text=True, check=True).stdout)
        self.assertEqual(set(report) - {f["name"] for f in described["report"]}, set())
        profile = json.loads((out / "profile.json").read_text())
        self.assertEqual(profile["from"], ["lamp"])
        self.assertNotIn("mould_shift_x_mm", profile["parameters"])
        # A later simulation takes it; a flag goes over it.
        for flags in ([], ["--young-modulus-pa", "1e6"]):
            self.run_program("thermoform-simulate", "--object", self.object, "--profile", out / "profile.json", "--triangles", 500, "--out", self.folder / "later", *flags)

    def test_runs_share_their_work_and_one_may_be_killed(self):
        words = ["evidence-calibrate", "--object", str(self.object), "--triangles", "500"]
        self.run_program(*words, "--out", self.folder / "alone")
        shared = self.folder / "shared"
        runs = [subprocess.Popen([PROGRAM, *words, "--results", shared, "--out", self.folder / f"run{i}", "--quiet"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
                for i in range(3)]
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and not (shared.exists() and len(list(shared.iterdir())) > 4):
            time.sleep(0.01)
        runs[1].send_signal(signal.SIGKILL)
        self.addCleanup(lambda: [run.kill() for run in runs])
        for i in (0, 2):
            _, error = runs[i].communicate(timeout=400)
            self.assertEqual(runs[i].returncode, 0, error)
            self.assertEqual((self.folder / f"run{i}" / "profile.json").read_bytes(), (self.folder / "alone" / "profile.json").read_bytes())
        runs[1].communicate()
        self.assertEqual(runs[1].returncode, -signal.SIGKILL)
        # Nothing was simulated that a run alone would not have been, and one that starts now finds everything.
        kept = {p.name for p in shared.iterdir() if len(p.name) == 64}
        self.assertEqual(kept, {p.name for p in (self.folder / "alone" / "simulations").iterdir() if len(p.name) == 64})
        self.run_program(*words, "--results", shared, "--out", self.folder / "again")
        self.assertEqual({p.name for p in shared.iterdir() if len(p.name) == 64}, kept)

    def test_a_good_part_shows_what_has_changed(self):
        out = self.folder / "beside"
        # As many as the sheet that was measured has: with 500 it leaps where the material is another by a hundredth.
        words = ("--triangles", 1000, "--pairs", "off", "--separate", "off", "--out", out)
        # The same mould, as another program writes it.
        mould = self.object / "mould.obj"
        mould.write_text("# by another program\n" + MOULD)
        self.addCleanup(mould.write_text, MOULD)
        self.run_program("evidence-diagnose", "--object", self.shifted, "--good", self.object, *words)
        diagnosis = json.loads((out / "diagnosis.json").read_text())
        self.assertEqual(diagnosis["verdict"], ["scan_shift"])
        self.assertEqual(diagnosis["good_parts"], ["lamp"])
        self.assertAlmostEqual(diagnosis["causes"][0]["values"]["scan_shift_x_mm"], 1.5, delta=0.1)
        # Of the same marks not even the noise is left, 0.064 mm on average; the coarse simulation alone misses far more.
        self.assertLess(diagnosis["error_after_mm"], 0.064)
        self.assertIn("What the simulation misses of the good part lamp", (out / "diagnosis.html").read_text())
        self.expect_refused("has the same measured.csv as", "evidence-diagnose", "--object", self.object, "--good", self.object, *words)
        elsewhere = self.write(self.folder / "elsewhere", self.points[1:])
        (elsewhere / "mould.obj").write_text(MOULD.replace(" 25\n", " 26\n"))
        self.expect_refused("elsewhere: this good part was formed over another mould", "evidence-diagnose", "--object", self.shifted, "--good", elsewhere, *words)

    def test_a_diagnosis_names_the_shift(self):
        out = self.folder / "diagnosed"
        # Another sheet, scanned on the same bench.
        thin = {"sheet_thickness_mm": 0.8}
        blank = self.write(self.folder / "blank", [(x, y, x, y, 1) for x, y in PLACES], **thin)
        formed = self.simulated(blank, *self.stiffer)
        draw = random.Random(4)
        points = [(x, y, *(v + draw.gauss(0, 0.04) + shift for v, shift in zip(p, (1.5, 0, 0)))) for (x, y), p in zip(PLACES, formed)]
        other = self.write(self.folder / "other", points, **thin)
        self.run_program("evidence-diagnose", "--object", self.shifted, "--unseen", other, "--triangles", 500, "--pairs", "off", "--out", out)
        diagnosis = json.loads((out / "diagnosis.json").read_text())
        self.assertEqual(diagnosis["verdict"][0], "scan_shift")
        self.assertEqual(diagnosis["causes"][0]["name"], "scan_shift")
        self.assertAlmostEqual(diagnosis["causes"][0]["values"]["scan_shift_x_mm"], 1.5, delta=0.3)
        self.assertLess(diagnosis["error_after_mm"], 0.5 * diagnosis["error_before_mm"])
        self.assertLess(diagnosis["unseen"]["error_after_mm"], 0.5 * diagnosis["unseen"]["error_before_mm"])
        self.assertAlmostEqual(sum(c["probability"] for c in diagnosis["hypotheses"]), 1, delta=0.05)
        page = (out / "diagnosis.html").read_text()
        self.assertIn("Scan in the wrong place", page)
        self.assertNotIn("<script", page)
        # Both objects, the one that was not used for the fit too: there, too, the extended simulation is nearer.
        rows = [line.split(",") for line in (out / "residuals.csv").read_text().splitlines()]
        self.assertEqual(len(rows), 2 * len(PLACES) + 1)
        unseen = [dict(zip(rows[0], row)) for row in rows[1:] if row[0] == "other"]
        self.assertEqual(len(unseen), len(PLACES))
        distances = {
            model: sum(math.dist([float(row[f"{model}_{a}_mm"]) for a in "xyz"], [float(row[f"{a}_mm"]) for a in "xyz"]) for row in unseen)
            for model in ("calibrated", "extended")
        }
        self.assertLess(distances["extended"], 0.5 * distances["calibrated"])
        self.assertFalse(any(math.isnan(v) for v in diagnosis["error_before_interval_mm"]))

    def test_a_rim_that_is_thicker_on_one_side_names_the_wedge(self):
        wedge = 0.25
        formed = self.simulated(self.folder / "first", *self.stiffer, "--thickness-wedge-x", wedge)
        draw = random.Random(5)
        points = [(x, y, *(v + draw.gauss(0, 0.04) for v in p)) for (x, y), p in zip(PLACES, formed)]
        wedged = self.write(self.folder / "wedged", points)
        half = [0.25 * (sheet + opening) for sheet, opening in zip(SETUP["sheet_mm"], SETUP["clamp_opening_mm"])]
        rim = [(-half[0], 0), (half[0], 0), (0, -half[1]), (0, half[1])]
        thickness = [SETUP["sheet_thickness_mm"] * (1 + wedge * 2 * x / SETUP["clamp_opening_mm"][0]) + draw.gauss(0, 0.02) for x, _ in rim]
        lines = (wedged / "measured.csv").read_text().splitlines()
        lines = [lines[0] + ",thickness_mm,thickness_sigma_mm"] + [line + ",," for line in lines[1:]]
        lines += [f"{x:g},{y:g},,,,,{t:.3f},0.02" for (x, y), t in zip(rim, thickness)]
        (wedged / "measured.csv").write_text("\n".join(lines) + "\n")
        out = self.folder / "wedged-report"
        self.run_program("evidence-diagnose", "--object", wedged, "--triangles", 500, "--pairs", "off", "--separate", "off", "--out", out)
        diagnosis = json.loads((out / "diagnosis.json").read_text())
        self.assertEqual(diagnosis["verdict"], ["thickness_wedge"])
        self.assertAlmostEqual(diagnosis["causes"][0]["values"]["thickness_wedge_x"], wedge, delta=0.06)
        self.assertEqual(diagnosis["other_quantities"][0]["object"], "wedged, thickness of the rim")
        self.assertLess(diagnosis["other_quantities"][0]["error_after_mm"], 0.5 * diagnosis["other_quantities"][0]["error_before_mm"])
        rows = [dict(zip((out / "thickness.csv").read_text().splitlines()[0].split(","), line.split(",")))
                for line in (out / "thickness.csv").read_text().splitlines()[1:]]
        self.assertEqual(len(rows), 4)
        for row, measured in zip(rows, thickness):
            self.assertAlmostEqual(float(row["thickness_mm"]), measured, delta=0.001)
            self.assertAlmostEqual(float(row["calibrated_mm"]), SETUP["sheet_thickness_mm"], delta=0.001)
            self.assertAlmostEqual(float(row["extended_mm"]), measured, delta=0.08)
        self.assertEqual(len((out / "residuals.csv").read_text().splitlines()), len(PLACES) + 1)
        self.assertIn("wedged, thickness of the rim", (out / "diagnosis.html").read_text())
        lines[-1] = lines[-1].replace(f"{thickness[-1]:.3f}", "950")
        (wedged / "measured.csv").write_text("\n".join(lines) + "\n")
        self.expect_refused("give it in millimetres", "evidence-diagnose", "--object", wedged, "--out", self.folder / "refused")

    def test_what_is_wrong_with_data_is_said(self):
        calibrate = ("evidence-calibrate", "--out", self.folder / "refused", "--object")
        self.expect_refused("metres", *calibrate, self.write(self.folder / "metres", [(p[0], p[1], *(v / 1000 for v in p[2:])) for p in self.points]))
        self.expect_refused("inches", *calibrate, self.write(self.folder / "inches", [(p[0], p[1], *(v / 25.4 for v in p[2:])) for p in self.points]))
        self.expect_refused("at least 6", *calibrate, self.write(self.folder / "tiny", self.points[:5]))
        few = self.write(self.folder / "few", self.points[:7])
        (few / "measured.csv").write_text((few / "measured.csv").read_text().replace(",0.04\n", ",0\n"))
        self.expect_refused("give sigma_mm for each point", *calibrate, few)
        self.expect_refused("machine's coordinates", *calibrate, self.write(self.folder / "far", [(p[0], p[1], p[2] + 200, p[3], p[4]) for p in self.points]))
        broken = self.write(self.folder / "broken", self.points)
        (broken / "measured.csv").write_text("sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm\n0,0,0,zero,30\n")
        self.expect_refused("line 2", *calibrate, broken)
        (broken / "measured.csv").unlink()
        self.expect_refused("measured.csv", *calibrate, broken)
        again = self.write(self.folder / "again", self.points)
        self.expect_refused("same measured.csv", *calibrate, self.object, "--object", again)
        self.expect_refused("same measured.csv", "evidence-diagnose", "--object", self.object, "--unseen", again, "--out", self.folder / "refused")
        not_zip = self.folder / "object.zip"
        not_zip.write_text("no archive")
        self.expect_refused("object.zip", *calibrate, not_zip)


if __name__ == "__main__":
    unittest.main()
