#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: what it writes, and one clear sentence with exit code 2 for everything wrong.
Usage: command_line_test.py PROGRAM"""
import json
import os
import pathlib
import pty
import random
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = sys.argv.pop(1)
TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


def read_stl(path: pathlib.Path):
    """Triangles of a binary STL, read by a few lines of its own."""
    data = path.read_bytes()
    count = struct.unpack_from("<I", data, 80)[0]
    assert len(data) == 84 + 50 * count, "not the length that a binary STL of that many triangles has"
    return [struct.unpack_from("<12f", data, 84 + 50 * i)[3:] for i in range(count)]


def volume_and_edges(triangles):
    volume, edges = 0.0, {}
    for t in triangles:
        a, b, c = t[0:3], t[3:6], t[6:9]
        volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])) / 6
        for p, q in ((a, b), (b, c), (c, a)):
            edges[(p, q)] = edges.get((p, q), 0) + 1
    return volume, edges


def written(folder: pathlib.Path):
    """What a run has left, without the list of it."""
    return sorted(p.name for p in folder.iterdir() if p.name != ".formwright.json")


def square_svg(size_mm: float) -> str:
    return f'<svg xmlns="http://www.w3.org/2000/svg" width="{size_mm}mm" height="{size_mm}mm" viewBox="0 0 {size_mm} {size_mm}"><rect x="1" y="1" width="{size_mm - 2}" height="{size_mm - 2}" fill="none" stroke="red"/></svg>'


class CommandLine(unittest.TestCase):
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

    def test_a_zippable_is_designed_whole(self):
        out = self.folder / "out"
        segments = self.folder / "segments.json"
        segments.write_text(json.dumps({"punctures": [[0, 0, 0], [50, 90, 0], [-50, 90, 0]]}))
        words = ("zippable-design", "--sample", "t_shape", "--sample-vertices", 1500, "--width-mm", 18, "--segments", segments, "--out", out, "--quiet")
        self.assertEqual(self.run_program(*words, "--fabrics", "two", "--winding-course", "creases").returncode, 0)
        whole = set(json.loads((out / "report.json").read_text()))
        run = self.run_program(*words)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(written(out), ["curve.obj", "design.json", "formed.ply", "parameterised.ply", "report.json", "ribbon.svg"])
        report = json.loads((out / "report.json").read_text())
        described = json.loads(self.run_program("describe", "zippable-design").stdout)
        old_names = {"winding_spacing_least"}
        self.assertEqual((whole | {"hook_and_loop_mm_total"}) - old_names, {f["name"] for f in described["report"]})  # the T has no handle
        two_fabrics, creases = {"fabric_area_mm2", "fabric_seams", "interleaved_share"}, {"crease_mm", "crease_off_mm", "crease_off_even_mm", "min_winding_spacing"} | old_names
        self.assertEqual(set(report), whole - two_fabrics - creases)
        self.assertEqual(report["parts"], 3)
        design = json.loads((out / "design.json").read_text())
        self.assertEqual(len(design["ribbon"]["triangles"]), len(design["ribbon"]["boundary"]) - 2)
        self.assertIn(f'width="{report["ribbon_size_mm"][0] + 10:.2f}'[:-1], (out / "ribbon.svg").read_text())
        torus = self.folder / "torus"
        self.assertEqual(self.run_program("zippable-design", "--sample", "torus", "--width-mm", 20, "--out", torus, "--quiet").returncode, 0)
        cuts = json.loads((torus / "design.json").read_text())["handle_cuts"]
        self.assertEqual(json.loads((torus / "report.json").read_text())["hook_and_loop_mm_total"], sum(cut["length_mm"] for cut in cuts))
        segments.write_text("{}")
        shutil.rmtree(out)
        self.expect_refused("segments.json is empty", "zippable-design", "--sample", "t_shape", "--segments", segments, "--out", out)

    def test_a_relief_is_written_whole(self):
        out = self.folder / "out"
        run = self.run_program("relief", "--sample", "bust", "--sample-vertices", 6000, "--thickness-mm", 4, "--width-mm", 80, "--out", out, "--quiet")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(written(out), ["heightmap.png", "relief.glb", "relief.ply", "relief.stl", "report.json"])
        report = json.loads((out / "report.json").read_text())
        described = json.loads(self.run_program("describe", "relief").stdout)
        self.assertEqual(set(report) - {f["name"] for f in described["report"]}, set())
        self.assertLess(report["energy"], report["energy_linear"])
        self.assertLess(report["normal_error_mean_deg"], report["normal_error_linear_mean_deg"])
        self.assertLessEqual(report["bound_violation_max_mm"], 4e-9)
        self.assertTrue(report["watertight"])
        triangles = read_stl(out / "relief.stl")
        volume, edges = volume_and_edges(triangles)
        self.assertGreater(volume, 0)
        for (p, q), count in edges.items():
            self.assertEqual(count, 1)
            self.assertIn((q, p), edges)
        xs, ys, zs = zip(*(t[i:i + 3] for t in triangles for i in (0, 3, 6)))
        self.assertAlmostEqual(max(xs) - min(xs), 80, places=3)
        self.assertAlmostEqual(max(zs) - min(zs), 7, places=3)
        self.assertAlmostEqual(max(ys) - min(ys), report["size_mm"][1], places=3)

    def test_the_plys_numbers_are_the_reports(self):
        out = self.folder / "out"
        self.run_program("relief", "--sample", "bust", "--sample-vertices", 3000, "--thickness-mm", 5, "--out", out, "--outputs", "relief.ply", "--quiet")
        report = json.loads((out / "report.json").read_text())
        data = (out / "relief.ply").read_bytes()
        head, body = data.split(b"end_header\n", 1)
        names = [line.split()[2] for line in head.decode().splitlines() if line.startswith("property") and "list" not in line]
        self.assertEqual(names, ["x", "y", "z", "lambda", "lambda_min", "lambda_max", "visible", "normal_error_deg"])
        row = struct.Struct("<dddddd" + "B" + "d")
        eye = report["viewpoint_mm"]
        for i in range(report["vertices"]):
            x, y, z, value, least, most, visible, error = row.unpack_from(body, i * row.size)
            self.assertLessEqual(least, value)
            self.assertLessEqual(value, most)
            # lambda is the distance from the viewpoint that the report names (eq. 3.3).
            self.assertAlmostEqual(((x - eye[0]) ** 2 + (y - eye[1]) ** 2 + (z - eye[2]) ** 2) ** 0.5, value, places=8)
            self.assertIn(visible, (0, 1))
            self.assertTrue(0 <= error <= 180)

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

    def test_bad_words(self):
        out = self.folder / "out"
        mesh = self.folder / "tetrahedron.obj"
        mesh.write_text(TETRAHEDRON)
        self.expect_refused("no command rleief", "rleief")
        self.expect_refused("no flag --thickness-m; did you mean --thickness-mm?", "relief", "--mesh", mesh, "--thickness-m", 5, "--out", out)
        self.expect_refused("not a number", "relief", "--mesh", mesh, "--thickness-mm", "thin", "--out", out)
        for value in ("0", "-3", "nan", "inf", "1e9"):
            self.expect_refused("thickness_mm", "relief", "--mesh", mesh, "--thickness-mm", value, "--out", out)
        self.expect_refused("--out DIR", "relief", "--mesh", mesh)
        self.expect_refused("--mesh FILE", "relief", "--out", out)
        self.expect_refused("needs a value", "relief", "--out")
        self.expect_refused("not both", "relief", "--mesh", mesh, "--sample", "bust", "--out", out)
        self.expect_refused("bust", "relief", "--sample", "bst", "--out", out)
        self.expect_refused("perspective, orthographic", "relief", "--mesh", mesh, "--projection", "isometric", "--out", out)
        self.expect_refused("distance", "relief", "--mesh", mesh, "--distance-mm", 1, "--out", out)
        self.expect_refused("Up lies along", "relief", "--mesh", mesh, "--direction", "0,-1,0", "--out", out)
        self.expect_refused("relief.ply", "relief", "--mesh", mesh, "--outputs", "relief.dwg", "--out", out)

    def test_bad_files(self):
        out = self.folder / "out"
        noise = random.Random(1).randbytes(20000)
        files = {
            "absent.obj": None,
            "empty.obj": b"",
            "noise.obj": noise,
            "noise.stl": noise,
            "noise.ply": b"ply\n" + noise,
            "noise.glb": b"glTF" + noise,
            "noise.3mf": b"PK\x03\x04" + noise,
            "truncated.stl": b"\0" * 80 + struct.pack("<I", 1000) + b"\0" * 200,
            "nan.obj": b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
            "range.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n",
            "flat.obj": b"v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n",
            "points.obj": b"v 0 0 0\nv 1 1 1\n",
        }
        for name, content in files.items():
            path = self.folder / name
            if content is not None:
                path.write_bytes(content)
            self.expect_refused(name.split(".")[0] if name in ("absent.obj", "empty.obj") else "", "relief", "--mesh", path, "--out", out)

    def test_a_line_seen_end_on(self):
        mesh = self.folder / "sliver.obj"
        mesh.write_text("v 0 0 0\nv 0 0 1\nv 0 1 0\nv 0 1 1\nf 1 2 3\nf 2 4 3\n")
        self.expect_refused("only a line", "relief", "--mesh", mesh, "--out", self.folder / "out")

    def test_earlier_results_survive_a_failure(self):
        out = self.folder / "out"
        self.assertEqual(self.run_program("import", "--sample", "pyramid", "--out", out, "--quiet").returncode, 0)
        before = {p.name: p.read_bytes() for p in out.iterdir()}
        self.assertEqual(self.run_program("import", "--mesh", self.folder / "absent.obj", "--out", out).returncode, 2)
        self.assertEqual({p.name: p.read_bytes() for p in out.iterdir()}, before)

    def test_a_job_that_does_not_fit_leaves_none_to_be_sent(self):
        out, drawing = self.folder / "out", self.folder / "drawing.svg"
        drawing.write_text(square_svg(50))
        words = ("laser-job", "--drawing", drawing, "--bed-x-mm", 100, "--bed-y-mm", 100, "--out", out, "--quiet")
        self.assertEqual(self.run_program(*words).returncode, 0)
        self.assertEqual(written(out), ["job.gcode", "report.json", "toolpath.json"])
        (out / "mine.gcode").write_text("G0 X1")
        for wrong, sentence in ((square_svg(150), "beyond the right edge of the bed"), ("<svg", "drawing")):
            self.assertEqual(self.run_program(*words, "--outputs", "job.gcode,job.rd").returncode, 0)
            self.assertEqual(written(out), ["job.gcode", "job.rd", "mine.gcode", "report.json"])
            drawing.write_text(wrong)
            self.expect_refused(sentence, *words)
            self.assertEqual(written(out), ["mine.gcode"])
            drawing.write_text(square_svg(50))
        # What the person made stays, also under a name of ours, until a run of ours writes it.
        (out / "preview.svg").write_text("mine")
        self.assertEqual(self.run_program(*words).returncode, 0)
        self.assertEqual((out / "preview.svg").read_text(), "mine")
        self.assertEqual(self.run_program(*words, "--outputs", "preview.svg").returncode, 0)
        self.assertEqual(written(out), ["mine.gcode", "preview.svg", "report.json"])
        # Another command's files stay, too.
        self.assertEqual(self.run_program("import", "--sample", "pyramid", "--out", out, "--quiet").returncode, 0)
        drawing.write_text(square_svg(150))
        self.assertEqual(self.run_program(*words).returncode, 2)
        self.assertEqual(written(out), ["mine.gcode", "model.ply", "report.json"])

    def test_outputs_of_an_earlier_version_go_with_a_job_that_does_not_fit(self):
        out, drawing = self.folder / "out", self.folder / "drawing.svg"
        out.mkdir()
        for name in ("report.json", "job.gcode", "notes.txt"):
            (out / name).write_text("old")
        drawing.write_text(square_svg(150))
        self.expect_refused("edge", "laser-job", "--drawing", drawing, "--bed-x-mm", 100, "--out", out, "--quiet")
        self.assertEqual(written(out), ["notes.txt"])

    def test_a_killed_run_leaves_nothing_for_long(self):
        out = self.folder / "out"
        (out / ".formwright-part-999999999").mkdir(parents=True)
        (out / ".formwright-part-999999999" / "job.gcode").write_text("G0")
        self.assertEqual(self.run_program("import", "--sample", "pyramid", "--out", out, "--quiet").returncode, 0)
        self.assertEqual(written(out), ["model.ply", "report.json"])

    def test_two_tools_are_two_jobs(self):
        out = self.folder / "out"
        words = ("mill-job", "--sample", "pyramid", "--sample-vertices", 500, "--width-mm", 30, "--pixel-mm", 0.5, "--out", out, "--quiet")
        self.assertEqual(self.run_program(*words, "--diameter-mm", 3, "--tool", "flat").returncode, 0)
        self.assertEqual(written(out), ["carved.ply", "job.gcode", "report.json", "toolpath.json"])
        self.assertEqual(json.loads((out / "report.json").read_text())["stages"], [])
        run = self.run_program(*words, "--diameter-mm", 2, "--outputs", "job.gcode,toolpath.json")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(written(out), ["job_1_rough.gcode", "job_2_finish.gcode", "report.json", "toolpath.json"])
        report, path = (json.loads((out / name).read_text()) for name in ("report.json", "toolpath.json"))
        self.assertEqual([stage["file"] for stage in report["stages"]], ["job_1_rough.gcode", "job_2_finish.gcode"])
        self.assertEqual([stage["file"] for stage in path["stages"]], ["job_1_rough.gcode", "job_2_finish.gcode"])
        self.assertEqual(report["line_count"], sum(stage["lines"] for stage in report["stages"]))
        self.assertIn("set z to 0", " ".join(report["notes"]))
        ends = [*(stage["first_path"] for stage in path["stages"][1:]), len(path["paths"])]
        for stage, told, end in zip(path["stages"], report["stages"], ends):
            lines = (out / stage["file"]).read_text().splitlines()
            self.assertEqual(len(lines), told["lines"])
            self.assertNotIn("M0", lines)
            moves = [line for line in lines if line.startswith(("G0 ", "G1 "))]
            self.assertTrue(moves[0].startswith("G0 Z"), moves[0])
            self.assertLess(lines.index("M5"), lines.index(moves[0]))
            self.assertEqual(lines[-3:], ["M5", "G0 X0 Y0", "M2"])
            # Lines of the preview are those of the stage's own file.
            for part in path["paths"][stage["first_path"]:end]:
                for i, line in enumerate(part["lines"][1:], 1):
                    self.assertTrue(lines[line - 1].startswith("G1" if part["kind"] == "work" else "G0"))
                    if "X" in lines[line - 1]:
                        self.assertAlmostEqual(float(lines[line - 1].split("X")[1].split()[0]), part["points_mm"][3 * i], places=3)

    def test_an_unwritable_folder_is_said(self):
        blocked = self.folder / "file"
        blocked.write_text("not a folder")
        run = self.run_program("import", "--sample", "pyramid", "--out", blocked / "out")
        self.assertEqual(run.returncode, 2)
        self.assertIn("cannot be made", run.stderr)

    @unittest.skipUnless(os.path.exists("/dev/full"), "no /dev/full here")
    def test_a_full_disk_is_said(self):
        out = self.folder / "out"
        out.mkdir()
        limited = subprocess.run(["bash", "-c", f"ulimit -f 4; trap '' XFSZ; exec {PROGRAM} import --sample bust --out {out} --quiet"], capture_output=True, text=True)
        self.assertEqual(limited.returncode, 2, limited.stderr)
        self.assertIn("make room", limited.stderr)
        self.assertEqual([p.name for p in out.iterdir()], [])

    def test_interrupting_ends_with_130(self):
        process = subprocess.Popen([PROGRAM, "relief", "--sample", "bust", "--sample-vertices", "400000", "--out", str(self.folder / "out")],
                                   stderr=subprocess.PIPE, text=True)
        time.sleep(0.7)
        process.send_signal(signal.SIGINT)
        said = process.communicate(timeout=20)[1]
        self.assertEqual(process.returncode, 130)
        self.assertIn("formwright: ", said)
        self.assertFalse((self.folder / "out" / "relief.ply").exists())

    def test_names_that_are_not_utf8(self):
        out = self.folder / "out"
        path = os.fsencode(self.folder) + b"/t\xff\xfe.obj"
        pathlib.Path(os.fsdecode(path)).write_text(TETRAHEDRON)
        run = subprocess.run([PROGRAM, b"import", b"--mesh", path, b"--out", str(out), b"--quiet"], capture_output=True, timeout=300)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(json.loads((out / "report.json").read_text())["faces"], 4)

    def test_a_terminal_shows_a_bar_and_leaves_a_clean_line(self):
        master, slave = pty.openpty()
        run = subprocess.Popen([PROGRAM, "import", "--sample", "bust", "--out", str(self.folder / "out")], stdout=subprocess.DEVNULL, stderr=slave)
        os.close(slave)
        shown = b""
        try:
            while part := os.read(master, 65536):
                shown += part
        except OSError:
            pass  # its other end closed
        os.close(master)
        self.assertEqual(run.wait(60), 0)
        self.assertIn("█".encode(), shown)
        self.assertTrue(shown.endswith(b"\r\033[K"), shown[-80:])

    def test_help_and_list_come_from_the_catalog(self):
        self.assertEqual(self.run_program().returncode, 2)
        catalog = json.loads(self.run_program("describe").stdout)
        names = [line.split("\t")[0] for line in self.run_program("list").stdout.splitlines()]
        self.assertEqual(names, [operation["name"] for operation in catalog["operations"]])
        for operation in catalog["operations"]:
            text = self.run_program(operation["name"], "--help").stdout
            for name, schema in operation["parameters"]["properties"].items():
                self.assertIn("--" + name.replace("_", "-"), text)
                self.assertIn(schema["description"], " ".join(text.split()))
            self.assertLessEqual(max(map(len, text.splitlines())), 100)


if __name__ == "__main__":
    unittest.main(verbosity=2)
