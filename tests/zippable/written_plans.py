# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the program and reads the SVG that it writes. The first word after the test's name is PROGRAM."""
import json
import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

PROGRAM = sys.argv.pop(1)
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
