#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Several models made one on the command line: where they come to lie, what becomes of them in a relief, and what is refused.
Usage: combine_test.py PROGRAM"""
import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

PROGRAM = sys.argv.pop(1)
# 1 wide, 2 high and 3 deep, far from the origin.
BOX = "".join(f"v {x + 50} {2 * y} {3 * z}\n" for z in (0, 1) for y in (0, 1) for x in (0, 1)) + \
    "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"


def read_ply(path):
    """Positions and triangles of a binary PLY; other properties are left out."""
    data = path.read_bytes()
    head, _, body = data.partition(b"end_header\n")
    sizes = {"float": 4, "double": 8, "uchar": 1, "int": 4, "float32": 4, "float64": 8, "uint8": 1, "int32": 4}
    elements = []
    for line in head.decode().splitlines():
        words = line.split()
        if words[0] == "element":
            elements.append((words[1], int(words[2]), []))
        elif words[0] == "property":
            elements[-1][2].append(words[1:])
    (_, count, columns), (_, faces, _) = elements[:2]
    stride = sum(sizes[kind] for kind, _ in columns)
    kind = "d" if sizes[columns[0][0]] == 8 else "f"
    places = [struct.unpack_from("<3" + kind, body, i * stride) for i in range(count)]
    at, triangles = count * stride, []
    for _ in range(faces):
        assert body[at] == 3
        triangles.append(struct.unpack_from("<3i", body, at + 1))
        at += 13
    return places, triangles


def box_of(places):
    return [min(p[k] for p in places) for k in range(3)], [max(p[k] for p in places) for k in range(3)]


class Combine(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.addCleanup(self.temporary.cleanup)
        self.out = self.folder / "out"
        self.box = self.folder / "box.obj"
        self.box.write_text(BOX)

    def run_program(self, *words):
        return subprocess.run([PROGRAM, *words, "--quiet"], capture_output=True, text=True, timeout=300)

    def combine(self, what, *words):
        path = self.folder / "scene.json"
        path.write_text(what if isinstance(what, str) else json.dumps(what))
        return self.run_program("combine", "--scene", path, *words, "--out", self.out)

    def report(self):
        return json.loads((self.out / "report.json").read_text())

    def test_models_lie_where_the_scene_puts_them(self):
        scene = {"models": [{"model": 1, "name": "Box", "size_mm": 30, "at_mm": [10, 20, -5]},
                            {"model": 1, "size_mm": 60, "turn_deg": [0, 0, 90], "at_mm": [100, 0, 0]},
                            {"sample": "heart", "vertices": 1000, "size_mm": 40, "at_mm": [-100, 0, 0]}]}
        run = self.combine(scene, "--model", self.box)
        self.assertEqual(run.returncode, 0, run.stderr)
        places, triangles = read_ply(self.out / "model.ply")
        self.assertEqual([model["name"] for model in self.report()["models"]], ["Box", "model 1", "heart"])
        counts = [model["vertices"] for model in self.report()["models"]]
        self.assertEqual((counts[:2], sum(counts)), ([8, 8], len(places)))
        for part, (low, high) in zip((places[:8], places[8:16]), (([5, 10, -20], [15, 30, 10]), ([80, -10, -30], [120, 10, 30]))):
            for found, wanted in zip(box_of(part), (low, high)):
                for a, b in zip(found, wanted):
                    self.assertAlmostEqual(a, b, places=4)
        low, high = box_of(places[16:])
        self.assertAlmostEqual(max(b - a for a, b in zip(low, high)), 40, places=4)
        self.assertEqual(len(triangles), self.report()["faces"])

    def test_scene_can_be_run_again(self):
        self.assertEqual(self.run_program("combine", "--scene-vertices", "800", "--outputs", "model.obj,scene.json", "--out", self.out).returncode, 0)
        again = self.folder / "again"
        run = self.run_program("combine", "--scene", self.out / "scene.json", "--outputs", "model.obj", "--out", again)
        self.assertEqual(run.returncode, 0, run.stderr)
        # Their comments say how each was made.
        first, second = ([line for line in (folder / "model.obj").read_text().splitlines() if not line.startswith("#")] for folder in (self.out, again))
        self.assertGreater(len(first), 2000)
        self.assertEqual(first, second)

    def test_models_without_a_scene_stand_side_by_side(self):
        run = self.run_program("combine", "--model", self.box, "--model", self.box, "--out", self.out)
        self.assertEqual(run.returncode, 0, run.stderr)
        places, _ = read_ply(self.out / "model.ply")
        left, right = box_of(places[:8]), box_of(places[8:])
        self.assertLess(left[1][0], right[0][0])
        for model in self.report()["models"]:
            self.assertAlmostEqual(max(model["size_mm"]), 100, places=6)

    def rim_heights(self, *flags):
        """Of the solid's triangles between bare plate and relief: how far the relief stands out there, mm, sorted."""
        relief = self.folder / "relief"
        run = self.run_program("relief", "--mesh", self.out / "model.ply", "--thickness-mm", "4", "--plate-mm", "3", "--margin-mm", "5",
                               "--pixel-mm", "0.3", "--outputs", "relief.stl", "--out", relief, *flags)
        self.assertEqual(run.returncode, 0, run.stderr)
        report = json.loads((relief / "report.json").read_text())
        self.assertEqual(report["order_rows_left_out"], 0)
        self.assertAlmostEqual(report["size_mm"][2], 7)
        stl = (relief / "relief.stl").read_bytes()
        heights = []
        for k in range(struct.unpack_from("<I", stl, 80)[0]):
            z = sorted(struct.unpack_from("<12f", stl, 84 + 50 * k)[5::3])
            if abs(z[0] - 3) < 1e-4 and z[2] > 3.001:
                heights.append(z[2] - 3)
        return sorted(heights)

    def test_outlines_held_to_the_plate_leave_no_cliffs(self):
        self.assertEqual(self.run_program("combine", "--scene-vertices", "3000", "--out", self.out).returncode, 0)
        held, free = self.rim_heights("--outline-mm", "0.1"), self.rim_heights()
        self.assertLess(held[len(held) // 2], 0.3)
        self.assertGreater(free[len(free) // 2], 1.5)

    def test_bad_scenes_are_named(self):
        for words, scene, flags in (
                ("not a JSON object", "[]", ()),
                ("no models", {"models": []}, ()),
                ("must be a list", {"models": 3}, ()),
                ("\"pillars\", which is not known", {"pillars": []}, ()),
                ("Model 1 of the scene needs either a sample", {"models": [{"size_mm": 3}]}, ()),
                ("Model 2 of the scene asks for model 3, which was not given", {"models": [{"model": 1}, {"model": 3}]}, ("--model", self.box)),
                ("asks for a sample \"cow\"", {"models": [{"sample": "cow"}]}, ()),
                ("size_mm that is not between", {"models": [{"sample": "cat", "size_mm": -4}]}, ()),
                ("turn_deg that is not a list of 3 numbers", {"models": [{"sample": "cat", "turn_deg": [1, 2]}]}, ()),
                ("at_mm that is not within", {"models": [{"sample": "cat", "at_mm": [1e9, 0, 0]}]}, ()),
                ("at most 40 models, and has 41", {"models": [{"sample": "cat"}] * 41}, ())):
            run = self.combine(scene, *flags)
            self.assertEqual(run.returncode, 2, run.stderr)
            self.assertIn(words, run.stderr)
            self.assertFalse((self.out / "report.json").exists())


if __name__ == "__main__":
    unittest.main()
