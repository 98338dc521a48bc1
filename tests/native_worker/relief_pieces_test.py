#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reliefs on stairs, strips and a base of several parts in pieces on the command line: all files by readers of our own.
Usage: relief_pieces_test.py PROGRAM"""
import json
import math
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree
import zipfile

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from written_solids import triangles_of_stl, unpaired_and_volume, vertices_and_triangles_of_ply  # noqa: E402

PROGRAM = sys.argv.pop(1)
PIXEL_MM = 0.8
FILES = "pieces.zip,pieces.3mf,pieces.glb,placement.svg,placement.pdf,relief.ply"
STAIRS = ("--base", "stairs", "--base-depth-mm", "40", "--base-steps", "4", "--thickness-mm", "4")
STRIPS = ("--base", "strips", "--base-steps", "5", "--thickness-mm", "2")
ZIGZAG = (*STRIPS, "--base-bend", "zigzag", "--carve-depth-mm", "1")


def blocks(path, *boxes):
    """An OBJ of boxes, each from its lower to its upper corner."""
    faces = [(1, 3, 2), (2, 3, 4), (5, 6, 7), (6, 8, 7), (1, 2, 5), (2, 6, 5), (3, 7, 4), (4, 7, 8), (1, 5, 3), (3, 5, 7), (2, 4, 6), (4, 8, 6)]
    lines = []
    for k, box in enumerate(boxes):
        lines += ["v " + " ".join(str(box[corner >> axis & 1][axis]) for axis in range(3)) for corner in range(8)]
        lines += ["f " + " ".join(str(v + 8 * k) for v in face) for face in faces]
    path.write_text("\n".join(lines) + "\n")
    return ("--base-mesh", path)


WALL = ((-120, -120, -60), (120, 120, -30))
POST = ((-15, -120, -25), (20, 10, -5))


def objects_of_3mf(path):
    with zipfile.ZipFile(path) as archive:
        name, = [n for n in archive.namelist() if n.lower().endswith(".model")]
        root = xml.etree.ElementTree.fromstring(archive.read(name))
    space = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
    for item in root.iter(space + "object"):
        places = [tuple(float(v.get(k)) for k in "xyz") for v in item.iter(space + "vertex")]
        yield item.get("name"), [[places[int(t.get(k))] for k in ("v1", "v2", "v3")] for t in item.iter(space + "triangle")]


def objects_of_glb(data):
    length, = struct.unpack_from("<I", data, 12)
    scene = json.loads(data[20:20 + length])
    binary = data[28 + length:]

    def numbers(index):
        accessor = scene["accessors"][index]
        view = scene["bufferViews"][accessor["bufferView"]]
        kind = {5126: "f", 5125: "I", 5123: "H"}[accessor["componentType"]]
        count = accessor["count"] * {"VEC3": 3, "SCALAR": 1}[accessor["type"]]
        return struct.unpack_from(f"<{count}{kind}", binary, view.get("byteOffset", 0) + accessor.get("byteOffset", 0))

    for node in (scene["nodes"][n] for n in scene["scenes"][0]["nodes"]):
        primitive, = scene["meshes"][node["mesh"]]["primitives"]
        flat, order = numbers(primitive["attributes"]["POSITION"]), numbers(primitive["indices"])
        places = [flat[k:k + 3] for k in range(0, len(flat), 3)]
        yield node["name"], [[places[order[k + i]] for i in range(3)] for k in range(0, len(order), 3)]


def depth_picture(triangles, eye_mm, half_width_mm, half_height_mm):
    """The depth of what is nearest at each pixel of 1 mm on the plate's front, seen from (0, 0, eye_mm)."""
    columns, rows = int(2 * half_width_mm), int(2 * half_height_mm)
    picture = {}
    for corners in triangles:
        seen = []
        for x, y, z in corners:
            shrink = eye_mm / (eye_mm - z)
            seen.append((x * shrink + half_width_mm, y * shrink + half_height_mm, 1 / (eye_mm - z)))
        (ax, ay, a), (bx, by, b), (cx, cy, c) = seen
        doubled = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if abs(doubled) < 1e-12:
            continue
        for row in range(max(0, math.ceil(min(ay, by, cy) - 0.5)), min(rows - 1, math.floor(max(ay, by, cy) - 0.5)) + 1):
            for column in range(max(0, math.ceil(min(ax, bx, cx) - 0.5)), min(columns - 1, math.floor(max(ax, bx, cx) - 0.5)) + 1):
                x, y = column + 0.5, row + 0.5
                of_b = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / doubled
                of_c = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / doubled
                if min(of_b, of_c, 1 - of_b - of_c) < 0:
                    continue
                depth = 1 / (a + of_b * (b - a) + of_c * (c - a))
                picture[column, row] = min(picture.get((column, row), math.inf), depth)
    return picture, columns, rows


class ReliefPieces(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.out = self.folder / "out"
        self.addCleanup(self.temporary.cleanup)

    def relief(self, *words):
        return subprocess.run([PROGRAM, "relief", "--sample", "octopus", "--sample-vertices", "2500", "--width-mm", "100", "--pixel-mm", str(PIXEL_MM),
                               *words, "--quiet", "--out", self.out], capture_output=True, text=True, timeout=600)

    def made(self, *words):
        run = self.relief("--outputs", FILES, *words)
        self.assertEqual(run.returncode, 0, run.stderr)
        return json.loads((self.out / "report.json").read_text())

    def test_every_file_has_the_same_closed_pieces(self):
        for flags, count in ((STAIRS, 4), (ZIGZAG, 5)):
            report = self.made(*flags)
            self.assertTrue(report["pieces_watertight"])
            self.assertEqual([piece["number"] for piece in report["pieces"]], list(range(1, count + 1)))
            names = [f"Piece {k}" for k in range(1, count + 1)]
            placed = dict(objects_of_3mf(self.out / "pieces.3mf"))
            drawn = dict(objects_of_glb((self.out / "pieces.glb").read_bytes()))
            self.assertEqual((list(placed), list(drawn)), (names, names))
            with zipfile.ZipFile(self.out / "pieces.zip") as archive:
                self.assertEqual(archive.namelist(), [f"piece_0{k}.stl" for k in range(1, count + 1)])
                for piece in report["pieces"]:
                    self.assertTrue(piece["numbered"])
                    name = f"Piece {piece['number']}"
                    for triangles in (triangles_of_stl(archive.read(f"piece_0{piece['number']}.stl")), placed[name], drawn[name]):
                        unpaired, volume = unpaired_and_volume(triangles)
                        self.assertEqual(unpaired, 0, name)
                        self.assertAlmostEqual(volume / 1000, piece["volume_ml"], delta=1e-3)

    def test_blocks_of_a_file_become_pieces(self):
        base = blocks(self.folder / "blocks.obj", WALL, POST, ((60, 60, -20), (90, 90, -10)))
        report = self.made(*base, "--thickness-mm", "4", "--carve-depth-mm", "1")
        self.assertEqual((report["base_parts"], report["pieces_watertight"]), (3, True))
        own_ml = [240 * 240 * 30 / 1000, 35 * 130 * 20 / 1000, 30 * 30 * 10 / 1000]
        placed = dict(objects_of_3mf(self.out / "pieces.3mf"))
        drawn = dict(objects_of_glb((self.out / "pieces.glb").read_bytes()))
        # All stand in the row of the wall, from left to right.
        for piece, ml in zip(report["pieces"], own_ml):
            self.assertTrue(piece["numbered"])
            for triangles in (placed[f"Piece {piece['number']}"], drawn[f"Piece {piece['number']}"]):
                unpaired, volume = unpaired_and_volume(triangles)
                self.assertEqual(unpaired, 0)
                self.assertAlmostEqual(volume / 1000, piece["volume_ml"], delta=1e-3)
            self.assertLess(abs(piece["volume_ml"] / ml - 1), 0.25)
        low, high = POST
        corners = [p for triangle in placed["Piece 2"] for p in triangle]
        for axis in range(3):
            self.assertAlmostEqual(min(p[axis] for p in corners), low[axis], delta=1e-3)
            self.assertAlmostEqual(max(p[axis] for p in corners), high[axis] + (4 if axis == 2 else 0), delta=0.5)
        svg = (self.out / "placement.svg").read_text()
        for view in ("piece", "above", "right"):
            self.assertEqual(len(re.findall(f'id="{view}-[123]"', svg)), 3)
        # As one surface it is one relief without pieces.
        run = self.relief(*base, "--base-mesh-parts", "together", "--outputs", "relief.stl,pieces.zip")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertFalse((self.out / "pieces.zip").exists())

    def test_the_picture_from_the_viewpoint_is_whole(self):
        for flags in (STAIRS, STRIPS, ZIGZAG, (*blocks(self.folder / "blocks.obj", WALL, POST), "--thickness-mm", "4")):
            report = self.made(*flags)
            eye, (width, height, _) = report["distance_mm"], report["size_mm"]
            solids = [t for _, triangles in objects_of_3mf(self.out / "pieces.3mf") for t in triangles]
            right, up, look, centre = (report[k] for k in ("right", "up", "direction", "plate_centre_mm"))

            def on_plate(p):
                off = [p[k] - centre[k] for k in range(3)]
                return [sign * sum(off[k] * axis[k] for k in range(3)) for axis, sign in ((right, 1), (up, 1), (look, -1))]

            surface = [[on_plate(p) for p in corners] for corners in vertices_and_triangles_of_ply((self.out / "relief.ply").read_bytes())[1]]
            of_pieces, columns, rows = depth_picture(solids, eye, width / 2, height / 2)
            of_surface, _, _ = depth_picture(surface, eye, width / 2, height / 2)
            self.assertEqual(len(of_pieces), columns * rows)  # no gap anywhere
            self.assertGreater(len(of_surface), 1000)
            differing = {pixel for pixel, depth in of_surface.items() if abs(of_pieces[pixel] - depth) > 0.3}

            # Where depth jumps between neighbours, as at silhouettes and borders, a pixel may show either side.
            def jumps(column, row):
                around = [of_surface.get((column + x, row + y)) for x in (-1, 0, 1) for y in (-1, 0, 1)]
                return None in around or max(around) - min(around) > 0.6

            at_jumps = {pixel for pixel in of_surface if jumps(*pixel)}
            self.assertEqual(differing - at_jumps, set())
            self.assertLess(len(differing), 0.2 * len(at_jumps))

    def test_the_plan_is_at_true_scale(self):
        self.made(*STAIRS)
        svg = (self.out / "placement.svg").read_text()
        millimetres, units = re.search(r'width="([\d.]+)mm"', svg), re.search(r'viewBox="0 0 ([\d.]+) ', svg)
        self.assertEqual(millimetres.group(1), units.group(1))
        widths, lows = {}, {}
        for number, d in re.findall(r'<path id="piece-(\d+)" d="([^"]+)"', svg):
            numbers = [float(n) for n in re.findall(r"-?\d+\.?\d*", d)]
            widths[int(number)] = max(numbers[::2]) - min(numbers[::2])
            lows[int(number)] = max(numbers[1::2])  # y of a picture points down
        # The eye sees 20 degrees: what is 40 mm farther away is wider by 40 mm over the distance.
        distance = 50 / math.tan(math.radians(10))
        self.assertAlmostEqual(widths[4], 100, delta=1e-3)
        self.assertAlmostEqual(widths[1], 100 * (1 + 40 / distance), delta=1e-3)
        self.assertEqual(sorted(lows, key=lows.get), [1, 2, 3, 4])  # from top to bottom
        self.assertTrue((self.out / "placement.pdf").read_bytes().startswith(b"%PDF"))

    def test_what_cannot_be_is_refused_in_a_sentence(self):
        touching = ((-15, -120, -40), (20, 10, -5))
        for words, flags in (("This base is one piece", ("--outputs", "pieces.zip")),
                             ("This base is one piece", (*blocks(self.folder / "one.obj", WALL), "--outputs", "pieces.zip")),
                             ("Parts 1 and 2 of the base overlap", (*blocks(self.folder / "two.obj", WALL, touching), "--outputs", "pieces.zip")),
                             ("seen from its edge", (*STRIPS, "--base-fold-deg", "40", "--outputs", "pieces.zip"))):
            run = self.relief(*flags)
            self.assertEqual(run.returncode, 2, run.stderr)
            self.assertIn(words, run.stderr)
            self.assertFalse((self.out / "report.json").exists())


if __name__ == "__main__":
    unittest.main()
