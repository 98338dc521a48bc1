#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Moulds in the eyes of other programs.

other_programs.py FORMWRIGHT: makes moulds on the command line, then has admesh judge mould.stl (skipped, visibly, where it
is not installed) and reads mould.3mf with Python's own zip and XML: one object a part, each closed, volumes as reported.
"""
import collections
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as xml
import zipfile

JOBS = [
    ["--sample", "pyramid", "--sample-vertices", "1000"],
    ["--sample", "cat", "--sample-vertices", "3000", "--base-mm", "5"],
    ["--sample", "octopus", "--sample-vertices", "3000", "--outline", "hull"],
    ["--sample", "bust", "--sample-vertices", "3000", "--kind", "positive"],
    ["--sample", "heart", "--sample-vertices", "3000", "--printer-x-mm", "70", "--printer-y-mm", "70", "--printer-z-mm", "70"],
]
CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=300, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))} ended with {done.returncode}:\n{done.stdout}{done.stderr}")
    return done.stdout


def near(what, found, expected, tolerance=1e-4):
    if abs(found - expected) > tolerance * abs(expected):
        sys.exit(f"{what} is {found}, should be {expected}")


def judge_stl(path, volume_ml):
    report = run("admesh", "--exact", path)
    line = {key: next(text for text in report.splitlines() if key in text) for key in ("Total disconnected facets", "Volume")}
    if line["Total disconnected facets"].split(":")[1].split() != ["0", "0"]:
        sys.exit(f"admesh finds {path} open:\n{report}")
    near("admesh's volume", float(line["Volume"].split("Volume")[1].split(":")[1].split()[0]) / 1000, volume_ml)


def judge_three_mf(path, parts):
    with zipfile.ZipFile(path) as archive:
        model = xml.fromstring(archive.read("3D/3dmodel.model"))
    objects = {o.get("id"): o for o in model.iter(CORE + "object")}
    items = [i.get("objectid") for i in model.iter(CORE + "item")]
    if len(objects) != len(parts) or sorted(items) != sorted(objects):
        sys.exit(f"{path}: {len(objects)} objects, {len(items)} items, {len(parts)} parts")
    for identity, part in zip(items, parts):
        points = [tuple(float(v.get(k)) for k in "xyz") for v in objects[identity].iter(CORE + "vertex")]
        edges, volume = collections.Counter(), 0.0
        for t in objects[identity].iter(CORE + "triangle"):
            face = [int(t.get(k)) for k in ("v1", "v2", "v3")]
            (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (points[i] for i in face)
            volume += (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6
            for k in range(3):
                edges[(face[k], face[(k + 1) % 3])] += 1
        if any(count != 1 or edges[(b, a)] != 1 for (a, b), count in list(edges.items())):
            sys.exit(f"{path}: object {identity} is not closed")
        near(f"volume of object {identity}", volume / 1000, part["volume_ml"])
        for k in range(3):
            near(f"size of object {identity}", max(p[k] for p in points) - min(p[k] for p in points), part["size_mm"][k])


def write_sheet(path):
    """A flat sheet over a pyramid of 100 x 100 x 60 mm that arrives last above x = 20 and x = -10, and never at y = 26."""
    nodes = [(2.0 * i - 70, 2.0 * j - 70) for j in range(71) for i in range(71)]
    header = ["ply", "format ascii 1.0", f"element vertex {len(nodes)}"]
    header += [f"property double {name}" for name in ("x", "y", "z", "sheet_x_mm", "sheet_y_mm", "thickness_mm", "stretch", "contact_s")]
    header += [f"element face {2 * 70 * 70}", "property list uchar int vertex_indices", "end_header"]
    rows = []
    for x, y in nodes:
        contact = 1 + max(0, 1 - abs(x - 20) / 8 - abs(y) / 8) + max(0, 0.5 - abs(x + 10) / 8 - abs(y) / 8)
        gap = max(0, 3 - abs(x) - abs(y - 26))
        rows.append(f"{x} {y} {max(0, 60 - 1.2 * max(abs(x), abs(y))) + gap} {x} {y} 1 1 {-1 if gap > 0 else contact}")
    for j in range(70):
        for i in range(70):
            a = 71 * j + i
            rows += [f"3 {a} {a + 1} {a + 72}", f"3 {a} {a + 72} {a + 71}"]
    path.write_text("\n".join(header + rows) + "\n")


def check_vents(program, folder):
    """Vents from a sheet given as a file, drilled into a positive."""
    write_sheet(folder / "sheet.ply")
    job = ["--sample", "pyramid", "--sample-vertices", "1000", "--kind", "positive"]
    run(program, "thermoform-mould", *job, "--sheet", folder / "sheet.ply", "--vents", "9", "--vent-diameter-mm", "2", "--out", folder)
    report = json.loads((folder / "report.json").read_text())
    found = [(round(v["x_mm"]), round(v["y_mm"]), round(v["z_mm"])) for v in report["vents"]]
    if found != [(0, 26, 29), (20, 0, 36), (-10, 0, 48)]:
        sys.exit(f"vents at {found}")
    near("drilled volume", 200 - report["plastic_volume_ml"], 3 * (29 + 36 + 48) / 1000, 0.03)  # a dodecagon of radius 1 has area 3
    judge_three_mf(folder / "mould.3mf", report["parts"])
    print("agrees: vents from a sheet")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    for job in JOBS:
        with tempfile.TemporaryDirectory() as folder:
            run(sys.argv[1], "thermoform-mould", *job, "--out", folder)
            report = json.loads((pathlib.Path(folder) / "report.json").read_text())
            judge_three_mf(pathlib.Path(folder) / "mould.3mf", report["parts"])
            if shutil.which("admesh"):
                judge_stl(pathlib.Path(folder) / "mould.stl", report["plastic_volume_ml"])
            print("agrees:", *job, f"({len(report['parts'])} parts)")
    with tempfile.TemporaryDirectory() as folder:
        check_vents(sys.argv[1], pathlib.Path(folder))
    if not shutil.which("admesh"):
        print("skipped: admesh is not installed")
        sys.exit(77)


if __name__ == "__main__":
    main()
