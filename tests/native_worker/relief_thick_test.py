#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reliefs as thick surfaces on the command line: the written STL by a reader of our own.
Usage: relief_thick_test.py PROGRAM"""
import bisect
import collections
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from written_solids import triangles_of_stl, unpaired_and_volume, vertices_and_triangles_of_ply  # noqa: E402

PROGRAM = sys.argv.pop(1)
PIXEL_MM = 0.4
WALL_MM = 1.5
TOLERANCE_MM = 0.3  # along a line of sight: what a pixel is worth on the slopes that are compared
MODEL = ("--sample", "octopus", "--sample-vertices", "2500", "--width-mm", "100", "--pixel-mm", str(PIXEL_MM))
THICK = ("--solid", "thick", "--wall-mm", str(WALL_MM))


def sights(triangles, eye_mm, half_width_mm, half_height_mm, step_mm):
    """All depths, -z, at which the lines of sight through a grid on the plate's front, z = 0, meet the triangles. The eye is at
    (0, 0, eye_mm), or infinitely far."""
    columns, rows = int(2 * half_width_mm / step_mm), int(2 * half_height_mm / step_mm)
    depths = collections.defaultdict(list)
    for corners in triangles:
        seen = []
        for x, y, z in corners:
            shrink = eye_mm / (eye_mm - z) if eye_mm else 1
            # Along a line of sight 1 / (eye - z) is linear over a plane; straight on, z itself is.
            seen.append(((x * shrink + half_width_mm) / step_mm, (y * shrink + half_height_mm) / step_mm, 1 / (eye_mm - z) if eye_mm else z))
        (ax, ay, a), (bx, by, b), (cx, cy, c) = seen
        doubled = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if abs(doubled) < 1e-12:
            continue
        for row in range(max(0, math.ceil(min(ay, by, cy) - 0.413)), min(rows - 1, math.floor(max(ay, by, cy) - 0.413)) + 1):
            for column in range(max(0, math.ceil(min(ax, bx, cx) - 0.413)), min(columns - 1, math.floor(max(ax, bx, cx) - 0.413)) + 1):
                x, y = column + 0.413, row + 0.413
                of_b = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / doubled
                of_c = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / doubled
                if min(of_b, of_c, 1 - of_b - of_c) < 0:
                    continue
                value = a + of_b * (b - a) + of_c * (c - a)
                bisect.insort(depths[column, row], 1 / value - eye_mm if eye_mm else -value)
    return depths


class ReliefThick(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.out = self.folder / "out"
        self.addCleanup(self.temporary.cleanup)

    def run_job(self, operation, *words):
        return subprocess.run([PROGRAM, operation, *words, "--quiet", "--out", self.out], capture_output=True, text=True, timeout=600)

    def made(self, *words):
        run = self.run_job("relief", *MODEL, *words)
        self.assertEqual(run.returncode, 0, run.stderr)
        return json.loads((self.out / "report.json").read_text())

    def free_arms(self):
        """A painting: what reaches towards the viewer on the right is free."""
        run = self.run_job("import", "--sample", "octopus", "--sample-vertices", "2500", "--outputs", "model.ply")
        self.assertEqual(run.returncode, 0, run.stderr)
        places, _ = vertices_and_triangles_of_ply((self.out / "model.ply").read_bytes())
        free = [math.hypot(x, z) > 16 and y < 22 and z > 0 and x > -8 for x, y, z in places]
        self.assertGreater(sum(free), 100)
        painting = self.folder / "painting.json"
        painting.write_text(json.dumps({"vertices": len(free), "region": ["free" if f else "usual" for f in free]}))
        return ("--painting", str(painting), "--outline-mm", "0.1", "--bounded-vertices", "visible")

    def check_file(self, report, plate_mm=3):
        """The solid as it stands in the file against the relief's surface, along lines of sight."""
        solid = list(triangles_of_stl((self.out / "relief.stl").read_bytes()))
        unpaired, volume = unpaired_and_volume(solid)
        self.assertEqual(unpaired, 0)
        self.assertAlmostEqual(volume / report["volume_mm3"], 1, delta=1e-5)
        width, height, deep = report["size_mm"]
        for k, size in enumerate((width, height, deep)):
            self.assertAlmostEqual(min(p[k] for t in solid for p in t), 0, delta=1e-3)
            self.assertLessEqual(max(p[k] for t in solid for p in t), size + 1e-3)
        _, surface = vertices_and_triangles_of_ply((self.out / "relief.ply").read_bytes())
        right, up, look, centre = (report[k] for k in ("right", "up", "direction", "plate_centre_mm"))

        def on_plate(p):
            off = [p[k] - centre[k] for k in range(3)]
            return [sign * sum(off[k] * axis[k] for k in range(3)) for axis, sign in ((right, 1), (up, 1), (look, -1))]

        eye = report["distance_mm"] or 0
        step = 0.5
        of_surface = sights([[on_plate(p) for p in t] for t in surface], eye, width / 2, height / 2, step)
        of_solid = sights([[(x - width / 2, y - height / 2, z - plate_mm) for x, y, z in t] for t in solid], eye, width / 2, height / 2, step)
        first = {place: min(0, depths[0]) for place, depths in of_surface.items()}
        compared = different = opened = 0
        thinnest = math.inf
        for place, depths in of_solid.items():
            around = [first.get((place[0] + x, place[1] + y), 0) for x in (-1, 0, 1) for y in (-1, 0, 1)]
            if max(around) - min(around) > 1.5:
                continue  # beside an edge where depth jumps, a line of sight may pass on either side
            compared += 1
            expected = first.get(place, 0)
            different += abs(depths[0] - expected) > TOLERANCE_MM
            if expected < -0.01 and abs(depths[0] - expected) <= TOLERANCE_MM:
                thinnest = min(thinnest, depths[1] - depths[0])
                opened += len(depths) > 2
        self.assertGreater(compared, 2000)
        self.assertLess(different / compared, 0.01)
        self.assertGreaterEqual(thinnest, WALL_MM - TOLERANCE_MM)
        return opened

    def test_the_file_is_the_surface_with_its_wall(self):
        painted = self.free_arms()
        for flags in (("--projection", "orthographic"), ("--margin-mm", "6")):
            report = self.made(*THICK, *painted, *flags, "--outputs", "relief.stl,relief.ply")
            self.assertTrue(report["watertight"])
            self.assertGreater(report["stands_out_max_mm"], 10)
            self.assertGreater(self.check_file(report), 20)  # lines of sight with room behind the wall
            thick_ml = report["volume_mm3"]
            self.made(*painted, *flags, "--outputs", "relief.stl")
            unpaired, filled_ml = unpaired_and_volume(triangles_of_stl((self.out / "relief.stl").read_bytes()))
            self.assertEqual(unpaired, 0)
            self.assertLess(thick_ml, filled_ml)

    def test_all_files_of_a_carved_relief_with_a_thin_wall(self):
        report = self.made("--solid", "thick", "--wall-mm", "0.3", "--carve-depth-mm", "1", "--outputs", "relief.stl,relief.3mf,relief.obj,heightmap.png")
        self.assertTrue(report["watertight"])
        unpaired, _ = unpaired_and_volume(triangles_of_stl((self.out / "relief.stl").read_bytes()))
        self.assertEqual(unpaired, 0)
        self.assertGreater((self.out / "relief.3mf").stat().st_size, 1000)
        # What a wall this thin is made of does not get finer than the plate allows.
        self.assertGreater(report["smallest_gap_mm"], 0.3)

    def test_only_the_outline_is_held(self):
        report = self.made("--only-outline", "on", "--bounded-vertices", "visible", *THICK, "--outputs", "relief.stl,relief.ply")
        self.assertGreater(report["stands_out_max_mm"], 5)
        self.check_file(report)

    def test_loose_parts_are_reported(self):
        box = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
        faces = [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5)]
        corners = [(x, y, z) for x, y, z in box] + [(x + 2, y, z) for x, y, z in box]
        model = self.folder / "two.obj"
        model.write_text("\n".join(["v %g %g %g" % c for c in corners] + ["f %d %d %d" % tuple(8 * k + i + 1 for i in f) for k in (0, 1) for f in faces]))
        painting = self.folder / "painting.json"
        painting.write_text(json.dumps({"vertices": 16, "region": [[0, 16, "own_thickness"]], "thickness_mm": [[0, 8, 5], [8, 8, 30]],
                                        "carve_depth_mm": [[0, 8, 0], [8, 8, -20]]}))
        run = self.run_job("relief", "--mesh", str(model), "--painting", str(painting), *THICK, "--width-mm", "60", "--pixel-mm", "0.5", "--outputs", "relief.stl")
        self.assertEqual(run.returncode, 0, run.stderr)
        report = json.loads((self.out / "report.json").read_text())
        self.assertEqual(report["loose_parts"], 1)
        self.assertTrue(any("1 part of the solid touches nothing else" in note for note in report["notes"]), report["notes"])

    def test_what_cannot_be_made_is_refused_in_one_sentence(self):
        base = self.folder / "base.obj"
        base.write_text("v -200 -200 0\nv 200 -200 0\nv 200 200 0\nv -200 200 0\nf 1 2 3 4\n")
        for flags in (("--base", "wave"), ("--base", "stairs"), ("--base-mesh", str(base))):
            run = self.run_job("relief", *MODEL, *THICK, *flags)
            self.assertNotEqual(run.returncode, 0)
            self.assertIn("joined to a flat base only", run.stderr)
        run = self.run_job("relief", *MODEL, "--solid", "thick", "--wall-mm", "0")
        self.assertNotEqual(run.returncode, 0)
        self.assertIn("wall", run.stderr)


if __name__ == "__main__":
    unittest.main()
