#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How a file was made stands in it, where readers of others find it, and hurts none of them.
Usage: made_by_test.py PROGRAM, with a Python that has Pillow"""
import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree
import zipfile

from PIL import Image

PROGRAM = sys.argv.pop(1)


class MadeBy(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def made(self, *words):
        run = subprocess.run([PROGRAM, *map(str, words), "--out", self.folder], capture_output=True, text=True, timeout=300)
        self.assertEqual(run.returncode, 0, run.stderr)
        return json.loads((self.folder / "report.json").read_text())["made_by"]

    def test_a_relief(self):
        record = self.made("relief", "--sample", "pyramid", "--sample-vertices", 2000, "--width-mm", 50, "--pixel-mm", 1,
                           "--outputs", "relief.stl,relief.glb,relief.ply,relief.obj,heightmap.png")
        self.assertEqual(record["parameters"], {"width_mm": 50.0, "pixel_mm": 1.0})
        self.assertEqual(record["inputs"], {"mesh": {"sample": "pyramid", "vertices": 2000}})

        picture = Image.open(self.folder / "heightmap.png")
        picture.load()
        self.assertEqual(json.loads(picture.text["Comment"]), record)

        stl = (self.folder / "relief.stl").read_bytes()
        self.assertIn(f', job {record["job"]}\0', stl[:80].decode())
        self.assertEqual(len(stl), 84 + 50 * struct.unpack_from("<I", stl, 80)[0])

        glb = (self.folder / "relief.glb").read_bytes()
        magic, version, length, chunk, kind = struct.unpack_from("<4sIII4s", glb)
        self.assertEqual((magic, version, length, kind, chunk % 4), (b"glTF", 2, len(glb), b"JSON", 0))
        self.assertEqual(json.loads(glb[20:20 + chunk])["asset"]["extras"]["made_by"], record)
        rest, kind = struct.unpack_from("<I4s", glb, 20 + chunk)
        self.assertEqual((rest + 28 + chunk, kind), (len(glb), b"BIN\0"))

        for name, mark in (("relief.ply", "comment made by "), ("relief.obj", "# made by ")):
            head = (self.folder / name).read_bytes()[:3000].decode(errors="replace").split("\n")
            line = next(line for line in head if line.startswith(mark))
            self.assertEqual(json.loads(line.removeprefix(mark)), record, name)

    def test_archives_and_models_in_them(self):
        record = self.made("relief", "--sample", "pyramid", "--sample-vertices", 2000, "--width-mm", 50, "--pixel-mm", 1, "--outputs", "relief.3mf")
        with zipfile.ZipFile(self.folder / "relief.3mf") as archive:
            self.assertIsNone(archive.testzip())
            self.assertEqual(json.loads(archive.comment), record)
        self.made("zippable-design", "--sample", "star", "--outputs", "design.json")
        record = self.made("zippable-plan", "--design", self.folder / "design.json", "--outputs", "plan.dxf,plan.pdf,sheets.zip")
        with zipfile.ZipFile(self.folder / "sheets.zip") as archive:
            self.assertIsNone(archive.testzip())
            self.assertEqual(json.loads(archive.comment), record)
        self.assertTrue((self.folder / "plan.dxf").read_text().startswith(f'999\nFormwright, job {record["job"]}\n0\nSECTION\n'))
        # Poppler reads the properties; with anything wrong in the tables it rebuilds them and says so.
        read = subprocess.run(["pdfinfo", self.folder / "plan.pdf"], capture_output=True, text=True, check=True)
        self.assertEqual(read.stderr, "")
        subject = next(line for line in read.stdout.splitlines() if line.startswith("Subject:"))
        self.assertEqual(json.loads(subject.removeprefix("Subject:")), record)
        self.assertRegex(read.stdout, r"Creator: +Formwright")

    def test_a_drawing(self):
        drawing = self.folder / "square & circle.svg"
        drawing.write_text('<svg xmlns="http://www.w3.org/2000/svg" width="30mm" height="30mm" viewBox="0 0 30 30">'
                           '<rect x="1" y="1" width="28" height="28" fill="none" stroke="red"/></svg>')
        record = self.made("laser-job", "--drawing", drawing, "--outputs", "preview.svg")
        self.assertEqual(record["inputs"]["drawing"]["file_name"], "square & circle.svg")
        tree = xml.etree.ElementTree.parse(self.folder / "preview.svg")
        notes = [node.text for node in tree.iter("{http://www.w3.org/2000/svg}metadata") if node.get("id") == "made_by"]
        self.assertEqual([json.loads(note) for note in notes], [record])


unittest.main()
