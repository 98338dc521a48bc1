#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What sliding does to a measured object's points on sheets of several meshes.

slip_on_meshes.py FORMWRIGHT OBJECT [--slip S]

Prints the movement by a slip of S (0.7) against a sheet that sticks, as RMS and as cosines between the meshes; then by how much the middle of the sheet is stretched
with a slip of 20 and without creep: the median over points whose flat places lie within 30 mm in x and 22 mm in y and more than 10 mm from the centre."""
import argparse
import csv
import math
import pathlib
import statistics
import subprocess
import tempfile

MESHES = (1250, 2500, 5000, 10000)


def compared(program, item, *flags):
    """The rows of residuals.csv."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([program, "thermoform-compare", "--object", item, "--out", folder, "--outputs", "residuals.csv", "--quiet", *flags], check=True, capture_output=True)
        with (pathlib.Path(folder) / "residuals.csv").open() as file:
            return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]


def places(rows):
    return [row[f"simulated_{axis}_mm"] for row in rows for axis in "xyz"]


def stretch(rows):
    middle = [row for row in rows if abs(row["sheet_x_mm"]) < 30 and abs(row["sheet_y_mm"]) < 22 and math.hypot(row["sheet_x_mm"], row["sheet_y_mm"]) > 10]
    return statistics.median(math.hypot(row["simulated_x_mm"], row["simulated_y_mm"]) / math.hypot(row["sheet_x_mm"], row["sheet_y_mm"]) for row in middle)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("formwright")
    parser.add_argument("object")
    parser.add_argument("--slip", type=float, default=0.7)
    a = parser.parse_args()
    moved = {}
    for triangles in MESHES:
        sticking, sliding = (places(compared(a.formwright, a.object, "--triangles", str(triangles), "--step-mm", "0.6", "--slip", str(slip))) for slip in (0, a.slip))
        moved[triangles] = [there - here for here, there in zip(sticking, sliding)]
    size = {triangles: math.hypot(*field) for triangles, field in moved.items()}
    print("| triangles | RMS mm | " + " | ".join(f"cosine with {m:,}" for m in MESHES) + " | middle stretched |\n|---:|" + "---:|" * (len(MESHES) + 2))
    for one in MESHES:
        cosines = [sum(x * y for x, y in zip(moved[one], moved[other])) / (size[one] * size[other]) for other in MESHES]
        middle = stretch(compared(a.formwright, a.object, "--triangles", str(one), "--young-modulus-pa", "2e6", "--creep-per-s", "0", "--slip", "20"))
        print(f"| {one:,} | {size[one] / math.sqrt(len(moved[one]) / 3):.2f} | " + " | ".join(f"{c:.2f}" for c in cosines) + f" | {100 * (middle - 1):.0f} % |", flush=True)


if __name__ == "__main__":
    main()
