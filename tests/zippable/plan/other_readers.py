#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Plans as other programs read them: pieces of the written SVG are valid polygons that keep apart and fit their bed (shapely), DXF
(ezdxf) and PDF (pdfinfo) say the same at the same size, marks lie in their pieces and pair up, kerf is what separates two cuts.
Usage: other_readers.py PROGRAM. Needs shapely, ezdxf and pdfinfo, which setup/apt_packages_test.txt names."""
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree
import zipfile

import ezdxf
from shapely.geometry import LineString, Point, Polygon, box
from shapely.ops import unary_union

PROGRAM = sys.argv.pop(1)
BED_X_MM, BED_Y_MM, MARGIN_MM, SPACING_MM, KERF_MM = 320, 260, 6, 3, 0.2
SVG = "{http://www.w3.org/2000/svg}"


def run(folder, operation, *flags):
    subprocess.run([PROGRAM, operation, *flags, "--out", str(folder)], check=True, capture_output=True, timeout=300)
    return json.loads((folder / "report.json").read_text())


def points_of(d):
    return [tuple(float(word) for word in pair.split()) for pair in re.split("[ML]", d.rstrip("Z"))[1:]]


def read_svg(text):
    """(width, height) in mm and {layer: [(name, points, closed)]}, y down."""
    root = ElementTree.fromstring(text)
    size = [float(root.get(k)[:-2]) for k in ("width", "height")]
    assert all(root.get(k).endswith("mm") for k in ("width", "height"))
    assert [float(v) for v in root.get("viewBox").split()] == [0, 0, *size], "one user unit must be one mm"
    layers = {}
    for group in root.iter(SVG + "g"):
        layers[group.get("id")] = [(p.get("id"), points_of(p.get("d")), p.get("d").endswith("Z")) for p in group.iter(SVG + "path")]
    return size, layers


class Plans(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.place.name)
        cls.plans = {}
        for sample, width_mm in (("star", 30), ("t_shape", 35), ("octopus", 20), ("torus", 40)):
            run(cls.folder / sample, "zippable-design", "--sample", sample, "--size-mm", "220", "--width-mm", str(width_mm))
            for method in ("sewing", "gluing"):
                out = cls.folder / f"{sample}_{method}"
                flags = ["--design", str(cls.folder / sample / "design.json"), "--method", method, "--bed-x-mm", str(BED_X_MM),
                         "--bed-y-mm", str(BED_Y_MM), "--margin-mm", str(MARGIN_MM), "--spacing-mm", str(SPACING_MM)]
                cls.plans[out] = (run(out, "zippable-plan", *flags, "--kerf-mm", str(KERF_MM)), flags)

    @classmethod
    def tearDownClass(cls):
        cls.place.cleanup()

    def each(self):
        return [(out, report) for out, (report, _) in self.plans.items()]

    def papers(self):
        """Paper models with tabs on the same beds."""
        plans = []
        for sample in ("star", "t_shape", "octopus", "torus"):
            out = self.folder / f"{sample}_tabs"
            flags = self.plans[self.folder / f"{sample}_sewing"][1]
            plans.append((out, run(out, "zippable-plan", *flags, "--coil", "none", "--edges", "tabs", "--kerf-mm", str(KERF_MM))))
        return plans

    def sheets(self, out, report):
        with zipfile.ZipFile(out / "sheets.zip") as archive:
            self.assertEqual(len(archive.namelist()), 2 * report["sheets"])
            for i in range(report["sheets"]):
                yield archive.read(f"sheet_{i + 1}.svg"), archive.read(f"sheet_{i + 1}.dxf").decode()

    def test_pieces_are_valid_keep_apart_and_fit(self):
        for out, report in self.each() + self.papers():
            pieces = 0
            for svg, _ in self.sheets(out, report):
                size, layers = read_svg(svg)
                self.assertEqual(size, [BED_X_MM, BED_Y_MM])
                cut = [Polygon(points) for _, points, closed in layers["cut"] if closed]
                self.assertEqual(len(cut), len(layers["cut"]))
                pieces += len(cut)
                bed = box(MARGIN_MM, MARGIN_MM, BED_X_MM - MARGIN_MM, BED_Y_MM - MARGIN_MM).buffer(1e-3)
                for i, piece in enumerate(cut):
                    self.assertTrue(piece.is_valid, f"{out.name}: {layers['cut'][i][0]} crosses itself")
                    self.assertTrue(bed.contains(piece))
                    for other in cut[:i]:
                        self.assertGreaterEqual(piece.distance(other), SPACING_MM - 1e-3)
            self.assertEqual(pieces, len(report["pieces"]))

    def test_area_is_that_of_the_report(self):
        for out, report in self.each():
            area = grown = 0
            for svg, _ in self.sheets(out, report):
                for _, points, _ in read_svg(svg)[1]["cut"]:
                    area += Polygon(points).buffer(-KERF_MM / 2, join_style=2).area
                    grown += Polygon(points).area
            self.assertAlmostEqual(area / report["outline_area_mm2"], 1, delta=2e-3)
            self.assertAlmostEqual((grown - area) / (KERF_MM / 2 * report["cut_length_mm"]), 1, delta=0.02)
            self.assertAlmostEqual(report["area_before_mm2"] / report["area_after_mm2"], 1, delta=1e-9)

    def test_marks_lie_in_their_pieces_and_pair_up(self):
        for out, report in self.each():
            names = {}
            for svg, _ in self.sheets(out, report):
                layers = read_svg(svg)[1]
                cut = [Polygon(points).buffer(1e-2) for _, points, _ in layers["cut"]]
                for layer in ("mark", "engrave"):
                    for name, points, _ in layers[layer]:
                        line = LineString(points)
                        self.assertTrue(any(piece.contains(line) for piece in cut), f"{out.name}: {layer} {name} leaves its piece")
                        if name:
                            names[name] = line.length
            for number in range(report["markers"]):
                self.assertTrue({f"marker-{number}-left", f"marker-{number}-right"} <= names.keys())
            self.assertEqual(sum(name.startswith("marker-") for name in names), 2 * report["markers"])
            splits = {}
            for name, length in names.items():
                if name.startswith("split-"):
                    splits.setdefault(name.split("-")[1], []).append(length)
            self.assertEqual(len(splits), report["splits"])
            for letter, lengths in splits.items():
                self.assertEqual(len(lengths), 2, letter)
                self.assertAlmostEqual(*lengths, delta=1e-3)

    def test_cut_handles_have_the_same_numbers_on_both_sides(self):
        for out, report in self.each():
            numbers = {"hook": set(), "loop": set()}
            for svg, _ in self.sheets(out, report):
                for name, _, _ in read_svg(svg)[1]["mark"]:
                    if name and name.startswith("closure-"):
                        _, cut, number, side = name.split("-")
                        self.assertNotIn((cut, number), numbers[side])
                        numbers[side].add((cut, number))
            self.assertEqual(numbers["hook"], numbers["loop"])
            self.assertEqual("hook_and_loop" in report, "torus" in out.name)
            told = {(str(i + 1), str(n)) for i, cut in enumerate(report.get("hook_and_loop", [])) for n in cut["numbers"]}
            self.assertEqual(numbers["hook"], told)

    def test_tabs_stand_on_folds_and_every_seam_is_said(self):
        for out, report in self.papers():
            folds = {}
            for svg, _ in self.sheets(out, report):
                layers = read_svg(svg)[1]
                pieces = [Polygon(points).buffer(-KERF_MM / 2, join_style=2) for _, points, _ in layers["cut"]]
                for name, points, _ in layers["mark"]:
                    if name and name.startswith("tab-"):
                        folds[name] = LineString(points)
                        # Paper on both sides of the fold: the tab and its piece.
                        middle = folds[name].interpolate(0.5, normalized=True).buffer(0.3)
                        self.assertTrue(any(piece.buffer(1e-2).contains(middle) for piece in pieces), f"{out.name} {name}")
            made, _, _ = report["tabs"]
            self.assertEqual(len(folds), made)
            self.assertGreater(sum(fold.length for fold in folds.values()), 0.8 * report["zipper_length_mm"])
            text = " ".join(subprocess.run(["pdftotext", "-raw", str(out / "assembly.pdf"), "-"], check=True, capture_output=True, text=True).stdout.split())
            for seam in report["seams"]:
                if seam["kind"] == "edge":
                    self.assertIn(f"Seam {seam['number']}: left edge of {seam['pieces'][0]} to right edge of {seam['pieces'][1]}, ", text)
            edges = [seam for seam in report["seams"] if seam["kind"] == "edge"]
            self.assertAlmostEqual(sum(seam["length_mm"] for seam in edges), report["zipper_length_mm"], delta=1e-6)
            self.assertFalse((out / "tape.pdf").exists())

    def test_dxf_says_the_same(self):
        for out, report in self.each():
            for svg, dxf in self.sheets(out, report):
                (_, height), layers = read_svg(svg)
                path = self.folder / "sheet.dxf"
                path.write_text(dxf)
                document = ezdxf.readfile(path)
                self.assertEqual(document.header["$INSUNITS"], 4)
                self.assertFalse(document.audit().has_errors)
                for layer, paths in layers.items():
                    self.assertIn(layer, document.layers)
                    read = []
                    for entity in document.modelspace().query(f'*[layer=="{layer}"]'):
                        if entity.dxftype() == "LINE":
                            read.append([entity.dxf.start, entity.dxf.end])
                        else:
                            read.append(list(entity.points()))
                            self.assertEqual(entity.is_closed, paths[len(read) - 1][2])
                    self.assertEqual(len(read), len(paths))
                    for entity, (_, points, _) in zip(read, paths):
                        self.assertEqual(len(entity), len(points))
                        for (x, y, _), (u, v) in zip(entity, points):
                            self.assertLess(max(abs(x - u), abs(height - y - v)), 1e-4)

    def test_pdf_has_the_sheets_size(self):
        for out, report in self.each():
            said = subprocess.run(["pdfinfo", str(out / "plan.pdf")], check=True, capture_output=True, text=True).stdout
            self.assertEqual(int(re.search(r"Pages:\s+(\d+)", said).group(1)), report["sheets"])
            width, height = (float(v) * 25.4 / 72 for v in re.search(r"Page size:\s+([\d.]+) x ([\d.]+)", said).groups())
            self.assertAlmostEqual(width, BED_X_MM, delta=0.01)
            self.assertAlmostEqual(height, BED_Y_MM, delta=0.01)

    def test_a_sheet_longer_than_a_pdf_page_is_drawn_without_one(self):
        out = self.folder / "roll"
        report = run(out, "zippable-plan", "--design", str(self.folder / "star" / "design.json"), "--bed-x-mm", "6000")
        self.assertTrue((out / "plan.svg").exists() and (out / "plan.dxf").exists())
        self.assertFalse((out / "plan.pdf").exists())
        self.assertTrue(any("5.08 m" in note for note in report["notes"]), report["notes"])

    def test_kerf_is_said_to_who_cuts(self):
        for out, report in self.each():
            root = ElementTree.parse(out / "plan.svg").getroot()
            self.assertEqual(float(root.get("data-formwright-kerf-mm")), KERF_MM)

    def test_tape_template_numbers_both_sides_at_true_distances(self):
        for out, report in self.each():
            (width, _), layers = read_svg((out / "tape.svg").read_text())
            rows = {}
            for name, points, _ in layers["note"]:
                if name and name.startswith("row-"):
                    _, row, side = name.split("-")
                    rows[side, int(row)] = Polygon(points)
            self.assertEqual(len(rows), 2 * report["tape_rows"])
            for side in ("left", "right"):
                length = 0
                found = {}
                for row in range(1, report["tape_rows"] + 1):
                    strip = rows[side, row]
                    x_min, y_min, x_max, y_max = strip.bounds
                    self.assertAlmostEqual(y_max - y_min, report["tape_width_mm"], delta=1e-3)
                    for name, points, _ in layers["mark"]:
                        if name and name.endswith(side) and strip.buffer(1e-3).contains(LineString(points)):
                            found[int(name.split("-")[1])] = length + points[0][0] - x_min
                    length += x_max - x_min
                self.assertAlmostEqual(length, report["zipper_length_mm"], delta=1e-3 * report["tape_rows"])
                self.assertEqual(sorted(found), list(range(report["markers"])))
                for number, place in found.items():
                    self.assertAlmostEqual(place, number * report["marker_spacing_mm"], delta=1e-3 * report["tape_rows"])
            strips = list(rows.values())
            for i, strip in enumerate(strips):
                self.assertTrue(all(strip.disjoint(other) for other in strips[:i]))
            said = subprocess.run(["pdfinfo", str(out / "tape.pdf")], check=True, capture_output=True, text=True).stdout
            page_x, page_y = (float(v) * 25.4 / 72 for v in re.search(r"Page size:\s+([\d.]+) x ([\d.]+)", said).groups())
            self.assertAlmostEqual(page_x, 297, delta=0.01)
            self.assertAlmostEqual(page_y, 210, delta=0.01)
            pages = int(re.search(r"Pages:\s+(\d+)", said).group(1))
            self.assertAlmostEqual(pages * 297 + (pages - 1) * 20, width, delta=1e-3)

    def test_assembly_sheet_says_every_seam_and_keeps_its_scale(self):
        for out, report in self.each():
            pdf = str(out / "assembly.pdf")
            said = subprocess.run(["pdfinfo", pdf], check=True, capture_output=True, text=True).stdout
            self.assertEqual(int(re.search(r"Pages:\s+(\d+)", said).group(1)), report["assembly_pages"])
            text = " ".join(subprocess.run(["pdftotext", "-raw", pdf, "-"], check=True, capture_output=True, text=True).stdout.split())
            self.assertEqual([int(n) for n in re.findall(r"Seam (\d+):", text)], [seam["number"] for seam in report["seams"]])
            for seam in report["seams"]:
                if seam["kind"] == "join":
                    words = f"Seam {seam['number']}: letter {seam['letters']}, {seam['pieces'][0]} to {seam['pieces'][1]}, {seam['length_mm']:.1f} mm"
                else:
                    words = f"Seam {seam['number']}: along {seam['pieces'][0]}, "
                    if seam["first_marker"] < seam["last_marker"]:
                        words += f"numbers {seam['first_marker']} to {seam['last_marker']}"
                self.assertIn(words, text)
            self.assertIn(f"{report['zipper_to_cut_mm'] / 1000:.2f} m of coil zipper", text)
            # Every thing that must be joined is: splits once, both tapes from end to end.
            self.assertEqual(sum(seam["kind"] == "join" for seam in report["seams"]), report["splits"])
            for side in ("left", "right"):
                tape = sum(seam["length_mm"] for seam in report["seams"] if seam["side"] == side)
                self.assertAlmostEqual(tape, report["zipper_length_mm"], delta=1e-6)
            # The ruler: from the middle of its 0 to the middle of its 100.
            boxes = subprocess.run(["pdftotext", "-bbox", "-l", "1", pdf, "-"], check=True, capture_output=True, text=True).stdout
            places = {"0": [], "100": []}
            for x_min, y_min, x_max, word in re.findall(r'<word xMin="([\d.]+)" yMin="([\d.]+)" xMax="([\d.]+)" yMax="[\d.]+">(0|100)</word>', boxes):
                places[word].append(((float(x_min) + float(x_max)) / 2 * 25.4 / 72, float(y_min)))
            lengths = [x - u for u, v in places["0"] for x, y in places["100"] if y == v]
            self.assertTrue(any(abs(length - 100) < 0.05 for length in lengths), lengths)

    def test_kerf_separates_two_cuts(self):
        out, (report, flags) = next(iter(self.plans.items()))
        plain = self.folder / "no_kerf"
        run(plain, "zippable-plan", *flags, "--kerf-mm", "0")

        def largest(folder):
            report_of = json.loads((folder / "report.json").read_text())
            return max((Polygon(p) for svg, _ in self.sheets(folder, report_of) for _, p, _ in read_svg(svg)[1]["cut"]), key=lambda p: p.area)

        with_kerf, without = largest(out), largest(plain)
        expected = without.buffer(KERF_MM / 2, join_style=2, mitre_limit=2)
        self.assertAlmostEqual(with_kerf.area, expected.area, delta=0.02 * (expected.area - without.area))

    def test_paper_keeps_both_sides_as_long_as_the_zipper(self):
        out = self.folder / "paper"
        report = run(out, "zippable-plan", "--design", str(self.folder / "star" / "design.json"), "--coil", "none")
        for side in ("left_length_mm", "right_length_mm"):
            self.assertAlmostEqual(report[side] / report["zipper_length_mm"], 1, delta=1e-6)
        self.assertLess(report["interval_error_max"], 1e-6)


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


class Strips(unittest.TestCase):
    def test_pieces_are_valid_keep_apart_and_fit(self):
        with tempfile.TemporaryDirectory() as place:
            out = pathlib.Path(place)
            report = run(out, "zippable-baseline", "--sample", "star", "--width-mm", "15")
            layers = read_svg((out / "strips.svg").read_text())[1]
            strips = [Polygon(points) for _, points, _ in layers["cut"]]
            self.assertEqual(len(strips), report["pieces"])
            sheets = [Polygon(points) for name, points, _ in layers["note"] if name and name.startswith("sheet-")]
            for i, strip in enumerate(strips):
                self.assertTrue(strip.is_valid)
                self.assertTrue(any(sheet.contains(strip) for sheet in sheets))
                self.assertTrue(all(strip.distance(other) > 2 - 1e-3 for other in strips[:i]))
            self.assertAlmostEqual(sum(strip.length for strip in strips), report["cut_length_mm"], delta=0.01)
            self.assertAlmostEqual(min(2 * strip.area / strip.length for strip in strips), report["narrowest_mm"], delta=1e-3)
            self.assertLess(report["isometry_error"], 1e-9)


if __name__ == "__main__":
    unittest.main()
