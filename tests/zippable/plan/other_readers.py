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
from shapely.geometry import LineString, Polygon, box

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from written_plans import read_svg, run

BED_X_MM, BED_Y_MM, MARGIN_MM, SPACING_MM, KERF_MM = 320, 260, 6, 3, 0.2


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


if __name__ == "__main__":
    unittest.main()
