#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""One clear sentence and exit code 2 for wrong words and wrong files. Usage: refusals_test.py PROGRAM"""
import random
import struct
import unittest

from command_line_case import TETRAHEDRON, CommandLineCase


class CommandLine(CommandLineCase):
    def test_bad_words(self):
        out = self.folder / "out"
        mesh = self.folder / "tetrahedron.obj"
        mesh.write_text(TETRAHEDRON)
        self.expect_refused("no command rleief", "rleief")
        self.expect_refused("no flag --thickness-m; did you mean --thickness-mm?", "relief", "--mesh", mesh, "--thickness-m", 5, "--out", out)
        self.expect_refused("not a number", "relief", "--mesh", mesh, "--thickness-mm", "thin", "--out", out)
        for value in ("0", "-3", "nan", "inf", "1e9"):
            self.expect_refused("thickness_mm", "relief", "--mesh", mesh, "--thickness-mm", value, "--out", out)
        self.expect_refused("--out DIR", "relief", "--mesh", mesh)
        self.expect_refused("--mesh FILE", "relief", "--out", out)
        self.expect_refused("needs a value", "relief", "--out")
        self.expect_refused("not both", "relief", "--mesh", mesh, "--sample", "bust", "--out", out)
        self.expect_refused("bust", "relief", "--sample", "bst", "--out", out)
        self.expect_refused("perspective, orthographic", "relief", "--mesh", mesh, "--projection", "isometric", "--out", out)
        self.expect_refused("distance", "relief", "--mesh", mesh, "--distance-mm", 1, "--out", out)
        self.expect_refused("Up lies along", "relief", "--mesh", mesh, "--direction", "0,-1,0", "--out", out)
        self.expect_refused("relief.ply", "relief", "--mesh", mesh, "--outputs", "relief.dwg", "--out", out)

    def test_bad_files(self):
        out = self.folder / "out"
        noise = random.Random(1).randbytes(20000)
        files = {
            "absent.obj": None,
            "empty.obj": b"",
            "noise.obj": noise,
            "noise.stl": noise,
            "noise.ply": b"ply\n" + noise,
            "noise.glb": b"glTF" + noise,
            "noise.3mf": b"PK\x03\x04" + noise,
            "truncated.stl": b"\0" * 80 + struct.pack("<I", 1000) + b"\0" * 200,
            "nan.obj": b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
            "range.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n",
            "flat.obj": b"v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n",
            "points.obj": b"v 0 0 0\nv 1 1 1\n",
        }
        for name, content in files.items():
            path = self.folder / name
            if content is not None:
                path.write_bytes(content)
            self.expect_refused(name.split(".")[0] if name in ("absent.obj", "empty.obj") else "", "relief", "--mesh", path, "--out", out)

    def test_a_line_seen_end_on(self):
        mesh = self.folder / "sliver.obj"
        mesh.write_text("v 0 0 0\nv 0 0 1\nv 0 1 0\nv 0 1 1\nf 1 2 3\nf 2 4 3\n")
        self.expect_refused("only a line", "relief", "--mesh", mesh, "--out", self.folder / "out")


if __name__ == "__main__":
    unittest.main(verbosity=2)
