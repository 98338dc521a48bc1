#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where do a print's colours land, with the machine profile before and after a diagnosis?

pre_distortion.py FORMWRIGHT OBJECT PROFILE...
OBJECT is a folder of evidence-virtual-object: its mould gets a picture that says its own place (a wave of 24 mm in x as red, in y as green), thermoform-texture
makes the print for each PROFILE, and the machine of truth.json forms it. A line of JSON a profile: the distance, in x and y, of where colours are from where
they belong, over the sheet's vertices on the model. Needs numpy, Pillow and meshio."""
import json
import pathlib
import subprocess
import sys
import tempfile

import meshio
import numpy
from PIL import Image

period_mm, low, high = 24.0, 30.0, 225.0


def wave(at_mm):
    """0 to 1 and back over a period."""
    return 1 - numpy.abs(numpy.mod(at_mm / (period_mm / 2), 2) - 1)


def coded_model(mould, folder):
    """The mould with a picture laid on it from above; returns the files."""
    vertices, faces = [], []
    for line in mould.read_text().splitlines():
        word, *rest = line.split() or [""]
        if word == "v":
            vertices.append([float(x) for x in rest[:3]])
        if word == "f":
            faces.append([int(corner.split("/")[0]) for corner in rest])
    V = numpy.array(vertices)
    half = numpy.abs(V[:, :2]).max() + 1
    side = 4096
    across = (numpy.arange(side) + 0.5) / side * 2 * half - half
    levels = low + (high - low) * wave(across)
    picture = numpy.zeros((side, side, 3), numpy.uint8)
    picture[:, :, 0] = numpy.round(levels)[None, :]
    picture[:, :, 1] = numpy.round(levels)[::-1, None]
    Image.fromarray(picture).save(folder / "code.png")
    with open(folder / "coded.obj", "w") as out:
        for v in V:
            out.write("v %.9g %.9g %.9g\n" % tuple(v))
        for v in V:
            out.write("vt %.9g %.9g\n" % tuple((v[:2] + half) / (2 * half)))
        for f in faces:
            out.write("f " + " ".join(f"{i}/{i}" for i in f) + "\n")
    return folder / "coded.obj", folder / "code.png", float(max(V.max(0) - V.min(0)))


def inner_surface(points, faces, thickness):
    """Half the sheet's thickness below its middle."""
    normals = numpy.zeros_like(points)
    across = numpy.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]])
    for k in range(3):
        numpy.add.at(normals, faces[:, k], across)
    normals /= numpy.linalg.norm(normals, axis=1, keepdims=True)
    return points - normals * thickness[:, None] / 2


def main():
    formwright, object_folder, *profiles = sys.argv[1:]
    truth = json.loads((pathlib.Path(object_folder) / "truth.json").read_text())
    machine = []
    for name, value in truth.items():
        if value is None or name in ("size_mm", "up") or name.startswith(("print_", "scan_")):
            continue
        machine += ["--" + name.replace("_", "-"), str(value).lower() if isinstance(value, bool) else str(value)]
    with tempfile.TemporaryDirectory() as work:
        folder = pathlib.Path(work)
        model, picture, size_mm = coded_model(pathlib.Path(object_folder) / "mould.obj", folder)
        placed = ["--mould", model, "--up", "0,0,1", "--size-mm", str(size_mm)]
        subprocess.run([formwright, "thermoform-simulate", *placed, *machine, "--outputs", "sheet.ply", "--out", folder / "formed", "--quiet"], check=True, stdout=subprocess.DEVNULL)
        sheet = meshio.read(folder / "formed" / "sheet.ply")
        thickness = sheet.point_data["thickness_mm"]
        place = inner_surface(sheet.points, sheet.cells_dict["triangle"], thickness)
        flat = numpy.stack([sheet.point_data["sheet_x_mm"], sheet.point_data["sheet_y_mm"]], 1)
        for profile in profiles:
            out = folder / "print"
            subprocess.run([formwright, "thermoform-texture", *placed, "--texture", picture, "--profile", profile, "--outputs", "print.png", "--out", out, "--quiet"],
                           check=True, stdout=subprocess.DEVNULL)
            image = numpy.asarray(Image.open(out / "print.png").convert("RGBA")).astype(float)
            height, width = image.shape[:2]
            x = numpy.floor((flat[:, 0] / truth["sheet_x_mm"] + 0.5) * width).astype(int)
            y = numpy.floor((0.5 - flat[:, 1] / truth["sheet_y_mm"]) * height).astype(int)
            printed = image[numpy.clip(y, 0, height - 1), numpy.clip(x, 0, width - 1)]
            # Off the plate, on the model, away from the turns of both waves by more than what is to be measured.
            turns = numpy.abs(numpy.mod(place[:, :2] + period_mm / 4, period_mm / 2) - period_mm / 4)
            use = (place[:, 2] > 2) & (sheet.point_data["contact_s"] > 0) & (printed[:, 3] > 250) & (turns.max(1) < period_mm / 4 - 2.5)
            slope = numpy.where(numpy.mod(place[:, :2] / (period_mm / 2), 2) < 1, 1, -1) / (period_mm / 2)
            off = ((printed[:, :2] - low) / (high - low) - wave(place[:, :2])) / slope
            distance = numpy.linalg.norm(off[use], axis=1)
            print(json.dumps({"profile": str(profile), "vertices": int(use.sum()), "mean_mm": round(float(distance.mean()), 3), "median_mm": round(float(numpy.median(distance)), 3),
                              "percentile_95_mm": round(float(numpy.percentile(distance, 95)), 3)}))


main()
