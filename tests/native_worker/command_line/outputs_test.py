#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the commands for a zippable and a relief write, by the files they leave. Usage: outputs_test.py PROGRAM"""
import json
import pathlib
import shutil
import struct
import unittest

from command_line_case import CommandLineCase, written


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


class CommandLine(CommandLineCase):
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


if __name__ == "__main__":
    unittest.main(verbosity=2)
