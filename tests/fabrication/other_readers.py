#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Laser jobs as programs read them that nobody here wrote: G-code by gcodeparser, what it burns by shapely, EGV and RD by MeerK40t's readers,
EGV against the bytes of MeerK40t's own driver; pages by poppler.
Usage: other_readers.py PROGRAM. Needs shapely (setup/apt_packages_test.txt) and PYTHONPATH from setup/python_packages.sh."""
import json
import math
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import types
import unittest

from gcodeparser import parse_gcode_lines
from meerk40t.lihuiyu.driver import LihuiyuDriver
from meerk40t.lihuiyu.laserspeed import LaserSpeed
from meerk40t.lihuiyu.parser import LihuiyuParser
from meerk40t.ruida.rdjob import RDJob, decode_bytes, parse_commands
from PIL import Image, ImageChops, ImageOps
from shapely.geometry import LineString, Point, Polygon
from shapely.ops import unary_union

PROGRAM = sys.argv.pop(1)
WIDTH_MM, HEIGHT_MM = 260, 200
MIL_MM = 0.0254


def run(folder, drawing, *flags, outputs="job.gcode,toolpath.json,job.egv,job.rd", ok=True):
    (folder / "drawing.svg").write_text(drawing)
    done = subprocess.run([PROGRAM, "laser-job", "--drawing", str(folder / "drawing.svg"), "--out", str(folder), "--outputs", outputs, *flags],
                          capture_output=True, timeout=120, text=True)
    assert (done.returncode == 0) == ok, done.stderr
    return done.stderr if not ok else json.loads((folder / "report.json").read_text())


def blob(rng, x, y, low, high):
    corners = rng.randint(3, 25)
    spread = [rng.uniform(low, high) for _ in range(corners)]
    return [(x + r * math.cos(2 * math.pi * i / corners), y + r * math.sin(2 * math.pi * i / corners)) for i, r in enumerate(spread)]


class RandomDrawing:
    """Parts with openings on a grid, lines to mark and blobs to engrave."""

    def __init__(self, seed):
        rng = random.Random(seed)
        self.parts, shapes = [], []
        for row in range(3):
            for column in range(4):
                if rng.random() < 0.25:
                    continue
                x, y = 32 + 64 * column, 34 + 66 * row
                outline = blob(rng, x, y, 18, 28)
                openings = []
                for dx, dy in ((-6, 0), (6, 0)):
                    if rng.random() < 0.7:
                        openings.append(blob(rng, x + dx, y + dy, 1.5, 4.5))
                self.parts.append(Polygon(outline, openings))
                shapes += [("red", outline, True)] + [("red", o, True) for o in openings]
                shapes.append(("blue", [(x + rng.uniform(-8, 8), y + rng.uniform(-8, 8)) for _ in range(rng.randint(2, 6))], False))
                shapes.append(("black", blob(rng, x, y + 9, 1, 2), True))
        rng.shuffle(shapes)
        paths = "".join(f'<path stroke="{c}" d="M{" ".join(f"{x:.4f},{HEIGHT_MM - y:.4f}" for x, y in p)}{"Z" if closed else ""}"/>' for c, p, closed in shapes)
        self.svg = (f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH_MM}mm" height="{HEIGHT_MM}mm" viewBox="0 0 {WIDTH_MM} {HEIGHT_MM}" '
                    f'fill="none">{paths}<path stroke="#00a000" d="M0 0h{WIDTH_MM}"/></svg>')


def read_gcode(text):
    """[(layer, [points])] of what burns, and all positions, in file's coordinates."""
    at, burning, paths, everywhere, layer, power = (0, 0), False, [], [], "", 0
    comments = {i: line for i, line in enumerate(text.splitlines(), 1) if line.startswith("; layer")}
    lines = text.splitlines()
    layer_of_command = []
    for line in lines:
        if line.startswith("; layer"):
            layer = line.split()[2]
        elif line and not line.startswith(";"):
            layer_of_command.append(layer)
    assert comments
    commands = list(parse_gcode_lines(text, include_comments=False))
    for index, command in enumerate(commands):
        name, p = command.command, command.params
        power = p.get("S", power)
        if name not in (("G", 0), ("G", 1)):
            assert name in {("G", 21), ("G", 90), ("G", 17), ("G", 94), ("G", 54), ("M", 3), ("M", 4), ("M", 5), ("M", 2), ("M", 8), ("M", 9)}, name
            continue
        to = (p.get("X", at[0]), p.get("Y", at[1]))
        if name == ("G", 1) and power > 0:
            if not burning:
                paths.append((layer_of_command[index], [at]))
            paths[-1][1].append(to)
            burning = True
        else:
            burning = False
        everywhere.append(to)
        at = to
    assert len(commands) == len(layer_of_command)
    return paths, everywhere


class Jobs(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.place.name)

    def tearDown(self):
        self.place.cleanup()

    def toolpath(self):
        return json.loads((self.folder / "toolpath.json").read_text())

    def test_burned_area_is_the_drawings(self):
        for seed in range(6):
            drawing = RandomDrawing(seed)
            kerf = random.Random(seed).choice((0.1, 0.2, 0.35))
            report = run(self.folder, drawing.svg, "--kerf-mm", str(kerf), "--join-mm", "0")
            self.assertTrue(report["fits"], report["misfits"])
            text = (self.folder / "job.gcode").read_text()
            self.assertLessEqual(max(map(len, text.splitlines())), 80)
            self.assertEqual(len(text.splitlines()), report["line_count"])
            paths, everywhere = read_gcode(text)
            self.assertTrue(all(0 <= x <= 400 and 0 <= y <= 400 for x, y in everywhere))
            burned = unary_union([LineString(points).buffer(kerf / 2, 32) for layer, points in paths if layer == "cut"])
            # A round beam along the outline: what stands is the drawing with its inner corners filled by the beam's radius.
            parts = unary_union(drawing.parts)
            expected = parts.buffer(kerf, 32).difference(parts.buffer(kerf / 2, 32).buffer(-kerf / 2, 32))
            length = sum(LineString(points).length for layer, points in paths if layer == "cut")
            self.assertLess(burned.symmetric_difference(expected).area, 0.006 * length, f"seed {seed}")
            self.assertLess(burned.intersection(parts).area, 0.003 * length)
            self.assertAlmostEqual(sum(LineString(points).length for _, points in paths), report["cut_mm"], places=3)

    def test_openings_are_cut_before_their_parts(self):
        drawing = RandomDrawing(4)
        run(self.folder, drawing.svg, "--kerf-mm", "0.1")
        cuts = [[p["points_mm"][i:i + 2] for i in range(0, len(p["points_mm"]), 3)] for p in self.toolpath()["paths"] if p["layer"] == "cut"]
        areas = [Polygon(points) for points in cuts]
        for i, early in enumerate(areas):
            for late in areas[i + 1:]:
                self.assertFalse(early.contains(late), "an outline is cut before what lies in it")
        self.assertEqual(len(cuts), sum(1 + len(p.interiors) for p in drawing.parts))

    def test_toolpath_is_the_gcode(self):
        drawing = RandomDrawing(2)
        run(self.folder, drawing.svg, "--cut-passes", "2", "--tabs-count", "3", "--overcut-mm", "1", "--origin", "centre")
        lines = (self.folder / "job.gcode").read_text().splitlines()
        seconds = -1
        at = [200, 200]
        for path in self.toolpath()["paths"]:
            points, count = path["points_mm"], len(path["points_mm"]) // 3
            self.assertEqual(points[:2], at, "paths do not follow each other")
            at = points[-3:-1]
            self.assertEqual(len(path["times_s"]), count)
            self.assertEqual(len(path["lines"]), count)
            for i in range(count):
                self.assertGreaterEqual(path["times_s"][i], seconds)
                seconds = path["times_s"][i]
                if i > 0:
                    command = next(iter(parse_gcode_lines(lines[path["lines"][i] - 1])))
                    self.assertEqual(command.command, ("G", 1 if path["kind"] == "work" else 0))
                    self.assertAlmostEqual(command.params["X"], points[3 * i] - 200, places=6)
                    self.assertAlmostEqual(command.params["Y"], points[3 * i + 1] - 200, places=6)
        self.assertEqual(seconds, self.toolpath()["seconds"])

    def works(self):
        return [[(p["points_mm"][i], p["points_mm"][i + 1]) for i in range(0, len(p["points_mm"]), 3)] for p in self.toolpath()["paths"] if p["kind"] == "work"]

    def test_egv_reads_back(self):
        """MeerK40t's parser of LHYMICRO-GL sees the same strokes within half a step across and burns nothing else."""
        run(self.folder, RandomDrawing(1).svg, "--controller", "k40", "--cut-passes", "2")
        data = (self.folder / "job.egv").read_bytes()
        parser, strokes, last = LihuiyuParser(), [], [None]

        def position(p):
            if p is None or not (parser.program_mode and parser.laser):
                last[0] = None
            elif last[0] == (p[0], p[1]):
                strokes[-1].append((p[2], p[3]))
                last[0] = (p[2], p[3])
            else:
                strokes.append([(p[0], p[1]), (p[2], p[3])])
                last[0] = (p[2], p[3])

        parser.position = position
        parser.header_write(data)
        self.assertEqual((parser.x, parser.y), (0, 0), "the head is not back where it began")
        read = [LineString([(x * MIL_MM, 400 - y * MIL_MM) for x, y in stroke]) for stroke in strokes]
        meant = [LineString(points) for points in self.works()]
        # Passes of closed paths follow without a jog.
        self.assertLess(unary_union(read).hausdorff_distance(unary_union(meant)), 0.04)
        burned = unary_union([line.buffer(0.2) for line in read]).area
        self.assertAlmostEqual(burned / unary_union([line.buffer(0.2) for line in meant]).area, 1, delta=0.04)
        starts = [Point(w.coords[0]) for w in meant]
        self.assertTrue(all(min(s.distance(p) for p in starts) < 0.03 for s in (Point(r.coords[0]) for r in read)))

    def test_egv_is_what_meerk40t_would_send(self):
        run(self.folder, RandomDrawing(3).svg, "--controller", "k40", "--mark-speed-mm-per-s", "33.3", "--cut-speed-mm-per-s", "6.5")
        data = (self.folder / "job.egv").read_bytes()
        service = types.SimpleNamespace(
            setting=lambda *a: False, signal=lambda *a: None, plot_shift=False, plot_phase_type=0, plot_phase_value=0, supports_pwm=False, board="M2",
            strict=False, twitches=False, fix_speeds=False, rapid_override=False, autolock=True, pwm_speedcode=False, current=(0, 0))
        sent = bytearray()
        driver = LihuiyuDriver(service)
        driver._signal_updates = False
        driver.out_pipe = types.SimpleNamespace(write=sent.extend)
        steps = lambda p: (round(p[0] / MIL_MM), round((400 - p[1]) / MIL_MM))
        speed = None
        for path in self.toolpath()["paths"]:
            if path["kind"] != "work":
                continue
            points = [steps(path["points_mm"][i:i + 2]) for i in range(0, len(path["points_mm"]), 3)]
            if speed != path["speed_mm_per_s"]:
                driver.rapid_mode()
                speed = path["speed_mm_per_s"]
                driver.settings["speed"] = speed
                driver.program_mode(dx=points[0][0] - driver.native_x, dy=points[0][1] - driver.native_y)
            elif points[0] != (driver.native_x, driver.native_y):
                driver._jog_absolute(*points[0])
            for point in points[1:]:
                driver._goto_absolute(*point, 1)
        driver.rapid_mode()
        driver._move_absolute(0, 0)
        self.assertEqual(LihuiyuParser.remove_header(data).lstrip(b"%\n"), bytes(sent))

    def test_egv_speed_codes(self):
        for speed in (0.5, 1, 3, 6.99, 7, 10, 12.5, 25.4, 33, 60, 99.9, 127, 200, 239):
            rectangle = '<svg width="50mm" height="50mm" viewBox="0 0 50 50"><path stroke="red" d="M5 5h9"/></svg>'
            run(self.folder, rectangle, "--controller", "k40", "--cut-speed-mm-per-s", str(speed), outputs="job.egv")
            expected = LaserSpeed("M2", speed, raster_step=0, fix_limit=True, fix_lows=True, suffix_c=True).speedcode
            self.assertIn(b"I" + expected.encode(), (self.folder / "job.egv").read_bytes())

    def test_rd_reads_back(self):
        report = run(self.folder, RandomDrawing(5).svg, "--controller", "ruida", "--cut-power-percent", "63", "--mark-speed-mm-per-s", "44.5")
        data = (self.folder / "job.rd").read_bytes()
        commands = list(parse_commands(decode_bytes(data, 0x88)))
        self.assertEqual(commands[-1], b"\xd7")
        total = next(c for c in commands if c[:2] == b"\xe5\x05")
        before = sum(sum(c) for c in commands[:commands.index(total)]) + 0xD7
        self.assertEqual(sum(b << (7 * (4 - i)) for i, b in enumerate(total[2:])), before & 0x7FFFFFFFF)

        class Matrix:
            def transform_point(self, p):
                return p

        plots = []
        driver = types.SimpleNamespace(plot=lambda cut: plots.append((cut.settings, list(zip(cut._points[1:], cut._powers)))), plot_start=lambda: None)
        job = RDJob(driver=driver, priority=0, channel=None, units_to_device_matrix=Matrix())
        job.scale = 1
        job._driver = driver
        for command in commands:
            job.process(command)
        job.plot_commit()
        strokes = []
        for settings, plot in plots:
            for (x, y), on in plot:
                if not on:
                    strokes.append([settings["power"], settings["speed"], (x, y)])
                elif (x, y) != strokes[-1][-1]:
                    strokes[-1].append((x, y))
        strokes = [s for s in strokes if len(s) > 3]
        meant = [p for p in self.toolpath()["paths"] if p["kind"] == "work"]
        self.assertEqual(len(strokes), len(meant))
        for stroke, path in zip(strokes, meant):
            points = [(round(1000 * path["points_mm"][i]), round(1000 * path["points_mm"][i + 1])) for i in range(0, len(path["points_mm"]), 3)]
            self.assertEqual(stroke[2:], points)
            self.assertAlmostEqual(stroke[0] / 10, path["power_percent"], delta=0.01)
            self.assertAlmostEqual(stroke[1], path["speed_mm_per_s"], delta=1e-3)
        self.assertTrue(report["fits"])

    def test_nothing_is_written_for_a_machine_it_does_not_fit(self):
        self.assertTrue(run(self.folder, RandomDrawing(1).svg)["fits"])
        self.assertIn("beyond the right edge", run(self.folder, RandomDrawing(1).svg, "--bed-x-mm", "150", ok=False))
        for name in ("job.gcode", "job.egv", "job.rd", "toolpath.json", "report.json"):
            self.assertFalse((self.folder / name).exists(), name)


class Pages(unittest.TestCase):
    """page-tiles, rendered by poppler at the picture's own resolution and put together again."""

    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.place.name)

    def tearDown(self):
        self.place.cleanup()

    def pages(self, source, *flags):
        subprocess.run([PROGRAM, "page-tiles", "--drawing", str(source), "--out", str(self.folder), *flags], check=True, capture_output=True, timeout=120)
        report = json.loads((self.folder / "report.json").read_text())
        info = subprocess.run(["pdfinfo", str(self.folder / "pages.pdf")], check=True, capture_output=True, text=True).stdout
        self.assertEqual(int(re.search(r"Pages: +(\d+)", info)[1]), report["pages"])
        size = [float(v) * 25.4 / 72 for v in re.search(r"Page size: +([\d.]+) x ([\d.]+)", info).groups()]
        for told, meant in zip(size, report["page_mm"]):
            self.assertAlmostEqual(told, meant, delta=0.02)
        # 254 dots an inch: a pixel is 0.1 mm.
        subprocess.run(["pdftoppm", "-r", "254", "-gray", "-png", str(self.folder / "pages.pdf"), str(self.folder / "page")], check=True, timeout=120)
        return report, [Image.open(p).convert("L") for p in sorted(self.folder.glob("page-*.png"))]

    def put_together(self, report, pages, margin, overlap):
        width, height = (round(10 * v) for v in report["page_mm"])
        room = (width - 20 * margin, height - 20 * margin)
        whole = Image.new("L", [round(10 * v) for v in report["size_mm"]], 255)
        for i, page in enumerate(pages):
            c, r = i % report["columns"], i // report["columns"]
            part = page.crop((10 * margin, 10 * margin, 10 * margin + room[0], 10 * margin + room[1]))
            whole.paste(part, (c * (room[0] - 10 * overlap), r * (room[1] - 10 * overlap)))
        return whole

    def test_a_picture_over_pages_is_the_picture(self):
        rng = random.Random(3)
        coarse = Image.new("L", (30, 25))
        coarse.putdata([rng.randint(0, 255) for _ in range(750)])
        picture = coarse.resize((3000, 2500), Image.NEAREST)
        picture.save(self.folder / "picture.png")
        for mirrored in (False, True):
            report, pages = self.pages(self.folder / "picture.png", "--width-mm", "300", "--overlap-mm", "10", "--marks", "off", "--ruler", "off", "--media", "a4",
                                       "--margin-left-mm", "10", "--margin-right-mm", "10", "--margin-top-mm", "10", "--margin-bottom-mm", "10",
                                       "--turn", "upright", "--mirrored", "on" if mirrored else "off")
            self.assertEqual((report["columns"], report["rows"]), (2, 1))
            whole = self.put_together(report, pages, 10, 10)
            meant = ImageOps.mirror(picture) if mirrored else picture
            wrong = ImageChops.difference(whole, meant).point(lambda v: 255 if v > 4 else 0)
            self.assertLess(sum(wrong.histogram()[128:]) / (3000 * 2500), 0.03)  # edges of the coarse pixels only

    def test_a_page_that_lies_sideways_keeps_the_wider_margins(self):
        (self.folder / "d.svg").write_text('<svg width="400mm" height="100mm" viewBox="0 0 400 100"><rect width="400" height="100" fill="black" stroke="red"/></svg>')
        report, pages = self.pages(self.folder / "d.svg", "--turn", "sideways", "--margin-left-mm", "3", "--margin-right-mm", "5", "--margin-top-mm", "4", "--margin-bottom-mm", "14",
                                   "--ruler", "off")
        self.assertEqual(report["room_mm"], [297 - 28, 210 - 10])
        for page in pages:
            left, top, right, bottom = ImageOps.invert(page).point(lambda v: 255 if v > 200 else 0).getbbox()
            self.assertGreaterEqual(left, 138)
            self.assertGreaterEqual(top, 48)
            self.assertLessEqual(right, 2970 - 138)

    def test_a_drawing_has_its_size_and_the_ruler_its_hundred_millimetres(self):
        (self.folder / "d.svg").write_text('<svg width="250mm" height="60mm" viewBox="0 0 250 60"><rect x="20" y="20" width="220" height="30" fill="none" stroke="red"/></svg>')
        report, pages = self.pages(self.folder / "d.svg", "--turn", "upright", "--marks", "off")
        self.assertEqual(report["pages"], 2)
        whole = self.put_together(report, pages, 8, 10)
        dark = ImageOps.invert(whole).point(lambda v: 255 if v > 128 else 0)
        left, top, right, bottom = dark.crop((150, 150, 2450, 560)).getbbox()
        self.assertAlmostEqual((right - left) / 10, 220.2, delta=0.25)
        self.assertAlmostEqual((bottom - top) / 10, 30.2, delta=0.25)
        strip = ImageOps.invert(pages[0]).crop((0, pages[0].height - 60, 1090, pages[0].height)).point(lambda v: 255 if v > 100 else 0)
        left, _, right, _ = strip.getbbox()
        self.assertAlmostEqual((right - left) / 10, 100.15, delta=0.25)


if __name__ == "__main__":
    unittest.main(verbosity=2)
