#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A forest of pillars on the command line: its solids by a reader of our own, its floor plan, and what is refused.
Usage: relief_forest_test.py PROGRAM"""
import collections
import json
import math
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import unittest
import zipfile

PROGRAM = sys.argv.pop(1)
QUICK = ("--pixel-mm", "1", "--check-rays", "80", "--picture-pixels", "100", "--quiet")


def scene():
    """Two samples from two sides, on two pillars each."""
    sides = (("heart", 0, -1), ("star", 1, 0))
    viewpoints = [{"eye_mm": [400 * x, 400 * y, 40], "look_at_mm": [0, 0, 40], "width_mm": 40, "sample": sample, "vertices": 1500}
                  for sample, x, y in sides]
    pillars = [{"shape": "square", "x_mm": -12, "y_mm": -60, "width_mm": 18, "height_mm": 80},
               {"shape": "round", "x_mm": 12, "y_mm": -80, "width_mm": 30, "height_mm": 80},
               {"outline_mm": [[80, -24], [92, -22], [90, 4], [78, 2]], "height_mm": 80},
               {"shape": "square", "x_mm": 56, "y_mm": 14, "width_mm": 22, "turn_deg": 30, "height_mm": 70}]
    return {"viewpoints": viewpoints, "pillars": pillars}


def edges_and_volume(stl):
    """Of a binary STL, places compared as their 32-bit numbers stand: edges without their opposite, parts, and the volume."""
    count, = struct.unpack_from("<I", stl, 80)
    assert len(stl) == 84 + 50 * count
    places, edges, volume, parent = {}, collections.Counter(), 0, []

    def root(i):
        while parent[i] != i:
            i = parent[i]
        return i

    for k in range(count):
        numbers = struct.unpack_from("<12f", stl, 84 + 50 * k)[3:]
        corners = [numbers[i:i + 3] for i in (0, 3, 6)]
        face = []
        for place in corners:
            face.append(places.setdefault(place, len(places)))
            if face[-1] == len(parent):
                parent.append(face[-1])
        for i in range(3):
            edges[face[i], face[(i + 1) % 3]] += 1
            parent[root(face[i])] = root(face[0])
        (a, b, c), (d, e, f), (g, h, i) = corners
        volume += (a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)) / 6
    unpaired = sum(1 for (a, b), n in edges.items() if n != 1 or edges.get((b, a), 0) != 1)
    return unpaired, len({root(i) for i in range(len(parent))}), volume


class ReliefForest(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.addCleanup(self.temporary.cleanup)
        self.out = self.folder / "out"

    def forest(self, what, *words):
        path = self.folder / "scene.json"
        path.write_text(what if isinstance(what, str) else json.dumps(what))
        return subprocess.run([PROGRAM, "relief-forest", "--scene", path, *QUICK, *words, "--out", self.out], capture_output=True, text=True, timeout=300)

    def report(self):
        return json.loads((self.out / "report.json").read_text())

    def expect_refused(self, words, what, *flags):
        run = self.forest(what, *flags)
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertIn(words, run.stderr)
        self.assertFalse((self.out / "report.json").exists())

    def test_solids_are_closed_and_of_the_reported_volume(self):
        for flags in ((), ("--carve-depth-mm", "1")):
            run = self.forest(scene(), *flags)
            self.assertEqual(run.returncode, 0, run.stderr)
            report = self.report()
            with zipfile.ZipFile(self.out / "pillars.zip") as pillars:
                self.assertEqual(pillars.namelist(), [f"pillar_0{k}.stl" for k in range(1, 5)])
                for pillar in report["pillars"]:
                    unpaired, parts, volume = edges_and_volume(pillars.read(f"pillar_0{pillar['number']}.stl"))
                    self.assertEqual((unpaired, parts), (0, 1), pillar)
                    self.assertAlmostEqual(volume / 1000, pillar["volume_ml"], delta=1e-4)
            self.assertEqual(report["intrusion_percent_max"], 0)
            self.assertGreater(report["seen_percent_min"], 85)

    def test_holes_of_the_floor_plan_are_as_wide_as_pins_and_clearance(self):
        run = self.forest(scene(), "--outputs", "floor_plan.svg,plan.json", "--pin-diameter-mm", "5", "--pin-clearance-mm", "0.3")
        self.assertEqual(run.returncode, 0, run.stderr)
        svg = (self.out / "floor_plan.svg").read_text()
        width, height = self.report()["floor_size_mm"]
        self.assertRegex(svg, rf'width="{width:g}\d*mm"')
        holes = re.findall(r'id="hole-(\d)"[^>]*\bd="([^"]+)"|\bd="([^"]+)"[^>]*id="hole-(\d)"', svg)
        self.assertEqual(len(holes), 4)
        for before, d, otherwise, after in holes:
            numbers = [float(n) for n in re.findall(r"-?\d+\.?\d*", d or otherwise)]
            points = list(zip(numbers[::2], numbers[1::2]))
            middle = [sum(p[k] for p in points) / len(points) for k in (0, 1)]
            # Between the circle around which it is drawn and the one through its corners.
            sides = [abs((p[0] - middle[0]) * (q[1] - middle[1]) - (p[1] - middle[1]) * (q[0] - middle[0])) / math.dist(p, q)
                     for p, q in zip(points, points[1:] + points[:1]) if math.dist(p, q) > 0.01]
            self.assertAlmostEqual(min(sides), 2.65, delta=2e-3)
            self.assertLess(max(math.dist(p, middle) for p in points), 2.66)

    def test_bad_scenes_are_named(self):
        self.expect_refused("not a JSON object", "[]")
        broken = scene()
        broken["viewpoints"][0]["eye_mm"] = [12, -80, 40]
        self.expect_refused("Viewpoint 1 stands inside pillar 2", broken)
        broken = scene()
        broken["viewpoints"][1]["look_at_mm"] = [900, 0, 40]
        self.expect_refused("All pillars stand behind viewpoint 2", broken)
        broken = scene()
        del broken["pillars"][2:]
        self.expect_refused("No line of sight from viewpoint 2 to its model meets a pillar", broken)
        broken = scene()
        broken["pillars"][0]["x_mm"] = -3
        broken["pillars"][0]["y_mm"] = -70
        self.expect_refused("Pillars 1 and 2", broken)
        broken = scene()
        broken["viewpoints"][1]["eye_mm"] = [250, -320, 40]
        broken["viewpoints"][1]["look_at_mm"] = [0, -70, 40]
        self.expect_refused("see the same side of pillar", broken, "--shared-walls", "refused")
        self.expect_refused("of the picture from viewpoint", broken, "--shared-walls", "squarest")
        self.expect_refused("too narrow for its pin", scene(), "--pin-diameter-mm", "17")


if __name__ == "__main__":
    unittest.main()
