#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How near the simulation comes to a measured object at best: material, and slip if asked, fitted by Nelder and Mead without any prior.

best_misfit.py FORMWRIGHT OBJECT [--slip] [--triangles N] [--evaluations N]

Prints the mean distance in mm, no point counted with more than 1.5 mm, and the flags that reach it."""
import argparse
import csv
import math
import pathlib
import subprocess
import tempfile

MAX_DISTANCE_MM = 1.5
FAILED = 99.0


def logistic(x):
    return 1 / (1 + math.exp(-x))


# flag, value of the coordinate, first coordinate, first step
PARAMETERS = [("--young-modulus-pa", math.exp, math.log(1e6), 0.7),
              ("--creep-per-s", lambda x: min(1e5, math.exp(x)), math.log(5), 1.5),
              ("--yield-strain", lambda x: min(2, math.exp(x)), math.log(0.05), 1),
              ("--network-share", logistic, 0, 1),
              ("--viscosity-s", lambda x: min(10, math.exp(x)), math.log(0.01), 1.5)]
SLIP = ("--slip", lambda x: min(20, math.exp(x)), math.log(0.1), 1)


def minimum(function, start, steps, evaluations):
    """Nelder and Mead's simplex."""
    corners = [list(start)] + [[x + (step if i == k else 0) for i, x in enumerate(start)] for k, step in enumerate(steps)]
    simplex = sorted((function(c), c) for c in corners)
    used = len(simplex)
    while used < evaluations:
        middle = [sum(c[i] for _, c in simplex[:-1]) / (len(simplex) - 1) for i in range(len(start))]
        away = lambda factor: [m + factor * (m - w) for m, w in zip(middle, simplex[-1][1])]
        tried = (function(away(1)), away(1))
        used += 1
        if tried[0] < simplex[0][0]:
            further = (function(away(2)), away(2))
            used += 1
            simplex[-1] = min(tried, further)
        elif tried[0] < simplex[-2][0]:
            simplex[-1] = tried
        else:
            side = away(0.5) if tried[0] < simplex[-1][0] else away(-0.5)
            nearer = (function(side), side)
            used += 1
            if nearer[0] < min(tried[0], simplex[-1][0]):
                simplex[-1] = nearer
            else:
                best = simplex[0][1]
                moved = [[0.5 * (b + x) for b, x in zip(best, c)] for _, c in simplex[1:]]
                simplex[1:] = [(function(c), c) for c in moved]
                used += len(moved)
        simplex.sort()
    return simplex[0]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("formwright")
    parser.add_argument("object", type=pathlib.Path)
    parser.add_argument("--slip", action="store_true", help="fits how easily the sheet slides, too")
    parser.add_argument("--triangles", type=int, default=2500)
    parser.add_argument("--evaluations", type=int, default=120, help="of each of three simplices, the next begun where the last ended")
    a = parser.parse_args()
    parameters = PARAMETERS + ([SLIP] if a.slip else [])

    def flags(point):
        return [word for (flag, value, _, _), x in zip(parameters, point) for word in (flag, repr(value(x)))]

    with tempfile.TemporaryDirectory() as folder:
        residuals = pathlib.Path(folder) / "residuals.csv"

        def misfit(point):
            residuals.unlink(missing_ok=True)
            done = subprocess.run([a.formwright, "thermoform-compare", "--object", str(a.object), "--out", folder, "--triangles", str(a.triangles), "--outputs", "residuals.csv", "--quiet",
                                   "--elastic-law", "incompressible_neo_hookean", *flags(point)], capture_output=True, text=True)
            if done.returncode != 0:
                return FAILED
            with residuals.open() as file:
                rows = list(csv.DictReader(file))
            return sum(min(MAX_DISTANCE_MM, float(row["error_mm"])) for row in rows) / len(rows)

        point, steps = [p[2] for p in parameters], [p[3] for p in parameters]
        best = FAILED
        for _ in range(3):
            best, point = minimum(misfit, point, steps, a.evaluations)
            steps = [0.6 * step for step in steps]
    if best >= FAILED:
        raise SystemExit(f"No simulation of {a.object} succeeded: try thermoform-compare on it by hand.")
    print(f"{best:.3f} mm: {' '.join(flags(point))}")


if __name__ == "__main__":
    main()
