#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The rig's boards as other programs read them: tracks and plates in the SVG (shapely), DXF (ezdxf) and PDF (pdfinfo).
Usage: rig_other_readers.py PROGRAM. Needs shapely, ezdxf, pdfinfo and pdftotext, which setup/apt_packages_test.txt names."""
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import ezdxf
from shapely.geometry import LineString, Point, Polygon
from shapely.ops import unary_union

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from written_plans import read_svg, run

KERF_MM = 0.2
TRACK_MM, SLOT_MM, OPENING_MM, WALL_MM = 4, 1.6, 10, 1.5


class Rigs(unittest.TestCase):
    """The rig's boards as written: tracks of exact width, holes off them, nothing over anything else, all on the bed."""

    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory()
        cls.rigs = []
        for sample, width_mm in (("star", 30), ("heart", 40)):
            folder = pathlib.Path(cls.place.name) / sample
            run(folder, "zippable-design", "--sample", sample, "--size-mm", "250", "--width-mm", str(width_mm), "--fabrics", "two")
            out = folder / "rig"
            report = run(out, "zippable-plan", "--design", str(folder / "design.json"), "--method", "gluing", "--rig", "on",
                         "--kerf-mm", str(KERF_MM), "--bed-x-mm", "600", "--bed-y-mm", "400")
            cls.rigs.append((out, report, read_svg((out / "rig.svg").read_text())[1]))

    @classmethod
    def tearDownClass(cls):
        cls.place.cleanup()

    def plates(self, layers):
        """{plate: (outline, [(name, what falls out)])} in finished size."""
        outlines = {}
        holes = []
        for name, points, closed in layers["cut"]:
            self.assertTrue(closed, name)
            shape = Polygon(points)
            self.assertTrue(shape.is_valid, f"{name} crosses itself")
            if name.startswith(("base-", "tracks-", "cover-")):
                outlines[name] = shape.buffer(-KERF_MM / 2, join_style=2)
            else:
                holes.append((name, shape.buffer(KERF_MM / 2)))
        plates = {name: (outline, []) for name, outline in outlines.items()}
        for name, hole in holes:
            owners = [plate for plate, (outline, _) in plates.items() if outline.contains(hole)]
            self.assertEqual(len(owners), 1, f"{name} is in no plate")
            plates[owners[0]][1].append((name, hole))
        return plates

    def test_tracks_have_their_width(self):
        for _, report, layers in self.rigs:
            middles = {name.removeprefix("middle-"): LineString(points) for name, points, _ in layers["note"] if name and name.startswith("middle-")}
            self.assertEqual(len(middles), report["rig_tracks"])
            for plate, (_, holes) in self.plates(layers).items():
                for name, hole in holes:
                    if not name.startswith("track-"):
                        continue
                    middle = middles.pop(name.removeprefix("track-"))
                    self.assertLess(middle.buffer(TRACK_MM / 2 - 0.02, resolution=64).difference(hole).area, 1e-6, name)
                    openings = [Point(middle.coords[k]).buffer(OPENING_MM / 2 + 0.02) for k in (0, -1)]
                    beyond = hole.difference(middle.buffer(TRACK_MM / 2 + 0.02, resolution=64))
                    # Where an opening meets its track, the cutter's round leaves a corner of a few hundredths.
                    self.assertLess(beyond.difference(unary_union(openings).buffer(0.1)).area, 1e-6, name)
            self.assertFalse(middles)

    def test_nothing_overlaps_and_holes_are_off_the_tracks(self):
        for out, report, layers in self.rigs:
            plates = self.plates(layers)
            self.assertEqual(len(plates), report["rig_plates"])
            self.assertEqual(len(plates), 3 * len(report["pieces"]))
            screws = {}
            for plate, (outline, holes) in plates.items():
                layer, piece = plate.split("-")
                screws.setdefault(piece, set()).add(sum(name.startswith("screw-") for name, _ in holes))
                for i, (name, hole) in enumerate(holes):
                    for other_name, other in holes[:i]:
                        self.assertGreater(hole.distance(other), WALL_MM - 0.1, f"{out.parent.name}: {name} and {other_name}")
                for other, (other_outline, _) in plates.items():
                    if other < plate:
                        self.assertGreaterEqual(outline.distance(other_outline), 2 - 1e-3)
            self.assertTrue(all(len(counts) == 1 and counts.pop() >= 4 for counts in screws.values()), "the layers' screws differ")

    def test_all_fits_the_bed(self):
        for _, report, layers in self.rigs:
            sheets = [Polygon(points) for name, points, _ in layers["note"] if name and name.startswith("sheet-")]
            self.assertEqual(len(sheets), report["rig_sheets"])
            for layer in ("cut", "mark", "engrave"):
                for name, points, _ in layers[layer]:
                    self.assertTrue(any(sheet.buffer(1e-3).contains(LineString(points)) for sheet in sheets), name)

    def test_markers_are_those_of_the_cloth_and_the_tape(self):
        for out, report, layers in self.rigs:
            self.assertEqual(report["marker_spacing_mm"], 50)

            def markers(file, layer="mark"):
                return {name for name, _, _ in read_svg((out / file).read_text())[1][layer] if name and name.startswith("marker-")}

            rig = markers("rig.svg")
            self.assertEqual(rig, markers("plan.svg"))
            tape = {name for name, _, _ in read_svg((out / "tape.svg").read_text())[1]["mark"] if name and name.startswith("tape-")}
            self.assertEqual({name.replace("marker", "tape") for name in rig}, tape)

    def test_dxf_and_pdf_are_there(self):
        for out, report, layers in self.rigs:
            document = ezdxf.readfile(out / "rig.dxf")
            self.assertFalse(document.audit().has_errors)
            self.assertEqual(len(document.modelspace().query('*[layer=="cut"]')), len(layers["cut"]))
            said = subprocess.run(["pdfinfo", str(out / "rig.pdf")], check=True, capture_output=True, text=True).stdout
            self.assertEqual(int(re.search(r"Pages:\s+(\d+)", said).group(1)), report["rig_sheets"])

    def test_fabrics_have_sheets_of_their_own(self):
        for out, report, _ in self.rigs:
            self.assertEqual(sorted(set(report["sheet_fabrics"])), [1, 2])
            for piece in report["pieces"]:
                self.assertEqual(report["sheet_fabrics"][piece["sheet"] - 1], piece["fabric"])
            text = " ".join(subprocess.run(["pdftotext", "-raw", str(out / "assembly.pdf"), "-"], check=True, capture_output=True, text=True).stdout.split())
            for fabric in (1, 2):
                names = ", ".join(piece["name"] for piece in report["pieces"] if piece["fabric"] == fabric)
                self.assertIn(f"Cloth, Colour {fabric}: ", text)
                self.assertIn(f"of it: {names}.", text)


if __name__ == "__main__":
    unittest.main()
