#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Inkscape, where most makers open, change and draw what is cut: it sees our plans (SVG and PDF) where we say they are, and what it saves
(layers of its own, moved groups, words made to paths) is what our jobs cut.
Usage: inkscape_test.py PROGRAM. Needs inkscape (setup/apt_packages_test.txt)."""
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree
import zipfile

PROGRAM = sys.argv.pop(1)
MM = 25.4 / 96  # Inkscape answers in CSS pixels
SVG = "{http://www.w3.org/2000/svg}"

DRAWING = """<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"
  width="12cm" height="60mm" viewBox="0 0 240 120">
<g inkscape:groupmode="layer" inkscape:label="Cut me" style="fill:none;stroke:#000000;stroke-width:0.0002">
  <rect id="outline" x="10" y="10" width="220" height="100" rx="12"/></g>
<g inkscape:groupmode="layer" inkscape:label="Engrave" transform="translate(20,80) rotate(-7) scale(2)">
  <text id="words" style="font-size:20px;font-family:'Noto Sans';fill:#000000">Form</text></g>
<g inkscape:groupmode="layer" inkscape:label="Guide"><path style="fill:none;stroke:#ff0000" d="M0 0H240V120"/></g></svg>"""


class Inkscape(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder = pathlib.Path(place.name)
        self.home = self.folder / "home"
        self.home.mkdir()

    def inkscape(self, *words):
        # A home of its own: nothing of the user's is read, and runs do not wait for each other.
        environment = {**os.environ, "HOME": str(self.home), "INKSCAPE_PROFILE_DIR": str(self.home), "XDG_CACHE_HOME": str(self.home)}
        environment.pop("DISPLAY", None)
        return subprocess.run(["inkscape", *map(str, words)], check=True, capture_output=True, text=True, timeout=120, env=environment).stdout

    def formwright(self, operation, out, *flags):
        subprocess.run([PROGRAM, operation, *map(str, flags), "--out", str(out)], check=True, capture_output=True, timeout=300)
        return json.loads((out / "report.json").read_text())

    def boxes(self, file):
        """{id: (left, top, right, bottom)} in mm, strokes included."""
        found = {}
        for line in self.inkscape("--query-all", file).splitlines():
            name, *numbers = line.split(",")
            x, y, width, height = (float(number) * MM for number in numbers)
            found[name] = (x, y, x + width, y + height)
        return found

    def near(self, found, wanted, within_mm, what):
        for a, b in zip(found, wanted, strict=True):
            self.assertLess(abs(a - b), within_mm, f"{what}: {found} for {wanted}")

    def test_a_plan_is_where_we_say(self):
        self.formwright("zippable-design", self.folder / "design", "--sample", "star", "--size-mm", 220, "--width-mm", 30)
        report = self.formwright("zippable-plan", self.folder / "plan", "--design", self.folder / "design/design.json", "--bed-x-mm", 320,
                                 "--bed-y-mm", 260, "--kerf-mm", 0.2)
        with zipfile.ZipFile(self.folder / "plan/sheets.zip") as archive:
            archive.extractall(self.folder)
        seen = 0
        for sheet in range(1, report["sheets"] + 1):
            file = self.folder / f"sheet_{sheet}.svg"
            boxes = self.boxes(file)
            for group in ElementTree.parse(file).getroot().iter(SVG + "g"):
                half_stroke = float(group.get("stroke-width")) / 2
                for path in group.iter(SVG + "path"):
                    if path.get("id") is None:
                        continue
                    points = [tuple(map(float, pair.split())) for pair in re.split("[ML]", path.get("d").rstrip("Z"))[1:]]
                    x, y = zip(*points)
                    # Round ends and mitred corners reach beyond the line by up to the mitre limit of 4.
                    self.near(boxes[path.get("id")], (min(x), min(y), max(x), max(y)), 4 * half_stroke + 1e-3, path.get("id"))
                    seen += 1
            # A page of the PDF covers what the sheet's SVG covers, within its strokes.
            page = self.folder / f"page_{sheet}.svg"
            self.inkscape(f"--pdf-page={sheet}", self.folder / "plan/plan.pdf", "--export-type=svg", "-o", page)
            cut = [box for name, box in self.boxes(page).items() if name.startswith("path")]
            drawn = [box for name, box in boxes.items() if not name.startswith("svg")]
            ends = lambda all_boxes: [pick(box[i] for box in all_boxes) for i, pick in enumerate((min, min, max, max))]
            self.near(ends(cut), ends(drawn), 0.3, f"page {sheet}")
        self.assertGreaterEqual(seen, len(report["pieces"]) + 2 * report["markers"])

    def test_what_it_saves_is_cut(self):
        (self.folder / "drawing.svg").write_text(DRAWING)
        saved = self.folder / "saved.svg"
        self.inkscape(self.folder / "drawing.svg", "--export-text-to-path", "--export-type=svg", "-o", saved)
        boxes = self.boxes(saved)
        report = self.formwright("laser-job", self.folder / "job", "--drawing", saved, "--kerf-mm", 0, "--overcut-mm", 0)
        self.assertEqual(report["drawing_mm"], [120, 60])
        self.assertEqual(report["notes"], [])
        layers = {layer["layer"]: layer for layer in report["layers"]}
        self.assertEqual(set(layers), {"cut", "engrave"}, "a guide is no work, red or not")
        # The outline: straight sides and four quarter circles of 6 mm.
        self.assertAlmostEqual(layers["cut"]["length_mm"], 2 * (98 + 38) + 2 * math.pi * 6, delta=0.02)
        paths = json.loads((self.folder / "job/toolpath.json").read_text())["paths"]
        for layer, name in (("cut", "outline"), ("engrave", "words")):
            points = [p["points_mm"] for p in paths if p["kind"] == "work" and p["layer"] == layer]
            x = [value for xyz in points for value in xyz[0::3]]
            y = [60 - value for xyz in points for value in xyz[1::3]]  # ours is y up
            self.near((min(x), min(y), max(x), max(y)), boxes[name], 0.02 if layer == "cut" else 0.15, name)


if __name__ == "__main__":
    unittest.main()
