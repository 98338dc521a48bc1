#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a diagnosis makes of ten marks measured by hand, on virtual objects with one hidden cause each. Variants: "chosen",
the marks that evidence-plan-points chooses; "raster", as many on a regular raster; "rim", marks chosen beside the rim's
thickness, and that thickness; "scan", a scan of 1,200 points.

  hand_measured.py build/formwright OUT.jsonl [--marks 10] [--only heating_gradient,...] [--moulds pyramid,...]
                   [--variants chosen,raster] [--strength 1]

--strength is the share of the strong cause that is hidden.

Marks are read off a dense scan without noise, by a plane through the nearest points, and get noise of --sigma in each
coordinate. Rows that OUT.jsonl already has are not made again; --table prints what it holds."""
import argparse
import csv
import json
import math
import random
import subprocess
import tempfile
from pathlib import Path

STRONG = {
    "heating_gradient": {"heating_gradient_x": 0.42, "heating_gradient_y": 0.28},
    "slip": {"slip": 3.0},
    "anisotropy": {"anisotropy": 0.5},
    "thickness_wedge": {"thickness_wedge_x": 0.4},
    "clamp_slip": {"clamp_slip_mm": 4.0},
    "mould_shift": {"mould_shift_x_mm": 2.0, "mould_shift_y_mm": -1.5},
    "mould_rotation": {"mould_rotation_deg": 5.0},
    "print_scale": {"print_scale": 0.018},
    "none": {},
}
# The virtual machine's material is not the one that a diagnosis begins with.
THICKNESS_SIGMA_MM = 0.05
MACHINE = {"young_modulus_pa": 3.2e6, "elastic_law": "stable_neo_hookean", "vacuum_ramp_s": 0.2, "triangles": 9000}


def flags(values):
    return [text for name, value in values.items() for text in ("--" + name.replace("_", "-"), str(value))]


def rows_of(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def place_at(dense, x, y):
    """The dense scan at sheet coordinates x, y: a plane through its twelve nearest points."""
    nearest = sorted(dense, key=lambda p: (p[0] - x) ** 2 + (p[1] - y) ** 2)[:12]
    # Normal equations of value = a + b dx + c dy, three unknowns.
    rows = [(1.0, p[0] - x, p[1] - y) for p in nearest]
    matrix = [[sum(r[i] * r[j] for r in rows) for j in range(3)] for i in range(3)]
    result = []
    for k in (2, 3, 4):
        right = [sum(r[i] * p[k] for r, p in zip(rows, nearest)) for i in range(3)]
        result.append(solve(matrix, right)[0])
    return result


def solve(matrix, right):
    a = [row[:] + [b] for row, b in zip(matrix, right)]
    for i in range(3):
        pivot = max(range(i, 3), key=lambda r: abs(a[r][i]))
        a[i], a[pivot] = a[pivot], a[i]
        for r in range(3):
            if r != i:
                factor = a[r][i] / a[i][i]
                a[r] = [x - factor * y for x, y in zip(a[r], a[i])]
    return [a[i][3] / a[i][i] for i in range(3)]


def raster(count, opening):
    """`count` marks, as regular as they go, within the clamp opening."""
    columns = max(1, round(math.sqrt(count * opening[0] / opening[1])))
    lines = math.ceil(count / columns)
    places = []
    for j in range(lines):
        in_line = min(columns, count - len(places))
        for i in range(in_line):
            places.append((((i + 0.5) / in_line - 0.5) * opening[0], ((j + 0.5) / lines - 0.5) * opening[1]))
    return places


class Trial:
    def __init__(self, program, mould, cause, strength, seed, sigma, triangles, folder):
        self.program, self.mould, self.sigma, self.triangles, self.seed = program, mould, sigma, triangles, seed
        self.hidden = {name: strength * value for name, value in STRONG[cause].items()}
        self.random = random.Random(f"{mould} {cause} {seed}")
        self.folder = Path(folder)
        size = ["--sample", mould, "--size-mm", "100"]
        self.run("evidence-virtual-object", *size, *flags(MACHINE), *flags(self.hidden), "--points", "60000", "--noise-mm", "0",
                 "--outlier-percent", "0", "--seed", str(seed), "--out", self.folder / "dense")
        names = ("sheet_x_mm", "sheet_y_mm", "x_mm", "y_mm", "z_mm")
        self.dense = [tuple(float(row[n]) for n in names) for row in rows_of(self.folder / "dense/measured.csv")]

    def run(self, *arguments):
        subprocess.run([self.program, *map(str, arguments)], check=True, capture_output=True, text=True)

    def rim_thickness(self, place):
        """Of the sheet as delivered: nothing stretches it in the clamp."""
        setup = json.loads((self.folder / "dense/setup.json").read_text())
        wedge = self.hidden.get("thickness_wedge_x", 0), self.hidden.get("thickness_wedge_y", 0)
        factor = 1 + sum(w * 2 * at / opening for w, at, opening in zip(wedge, place, setup["clamp_opening_mm"]))
        return setup["sheet_thickness_mm"] * factor + self.random.gauss(0, THICKNESS_SIGMA_MM)

    def measured_by_hand(self, name, places, rim=()):
        folder = self.folder / name
        folder.mkdir()
        for file in ("mould.obj", "setup.json"):
            (folder / file).write_bytes((self.folder / "dense" / file).read_bytes())
        with open(folder / "measured.csv", "w", encoding="utf-8") as out:
            out.write("sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm,sigma_mm,thickness_mm,thickness_sigma_mm\n")
            for x, y in places:
                at = [v + self.random.gauss(0, self.sigma) for v in place_at(self.dense, x, y)]
                out.write(f"{x:g},{y:g},{at[0]:.2f},{at[1]:.2f},{at[2]:.2f},{self.sigma:g},,\n")
            for x, y in rim:
                out.write(f"{x:g},{y:g},,,,,{self.rim_thickness((x, y)):.2f},{THICKNESS_SIGMA_MM:g}\n")
        return folder

    def scanned(self):
        self.run("evidence-virtual-object", "--sample", self.mould, "--size-mm", "100", *flags(MACHINE), *flags(self.hidden), "--points",
                 "1200", "--noise-mm", "0.05", "--seed", str(self.seed), "--out", self.folder / "scan")
        return self.folder / "scan"

    def planned(self, count, rim):
        """Places of the marks, and of the rim."""
        out = self.folder / f"plan-{rim}"
        self.run("evidence-plan-points", "--sample", self.mould, "--size-mm", "100", "--mark-count", count, "--gauge-sigma-mm", self.sigma,
                 "--rim-thickness", "on" if rim else "off", "--out", out)
        report = json.loads((out / "report.json").read_text())
        return tuple([(r["sheet_x_mm"], r["sheet_y_mm"]) for r in report[name]] for name in ("marks", "rim"))

    def information(self, folder):
        """Nats about the causes, of a folder's points alone."""
        out = Path(str(folder) + "-information")
        self.run("evidence-plan-points", "--sample", self.mould, "--size-mm", "100", "--mark-count", 1, "--gauge-sigma-mm", self.sigma,
                 "--rim-thickness", "off", "--measured", folder / "measured.csv", "--out", out)
        report = json.loads((out / "report.json").read_text())
        return report["information_of_measured_nats"]

    def diagnosed(self, folder):
        out = Path(str(folder) + "-report")
        self.run("evidence-diagnose", "--object", folder, "--pairs", "off", "--separate", "off", "--triangles", self.triangles, "--out", out)
        answer = json.loads((out / "diagnosis.json").read_text())
        first = next((a for a in answer["answers"]), {})
        return {"reading": answer["reading"], "verdict": answer["verdict"], "doubtful": answer["doubtful"],
                "probability": first.get("probability"), "simulations": answer.get("simulations")}


def table(path):
    rows = [json.loads(line) for line in Path(path).read_text().splitlines()]
    titles = {"chosen": "chosen marks", "raster": "raster", "rim": "chosen marks and rim", "scan": "scan"}
    print("| mould | hidden cause, strength | " + " | ".join(titles.values()) + " |\n|---|---|" + "---|" * len(titles))

    def words(answer):
        if answer is None:
            return ""
        named = " and ".join(answer["verdict"]) or answer["reading"]
        return (named + (", in doubt" if answer["doubtful"] and answer["verdict"] else "")
                + (f" ({answer['nats']:.1f} nats)" if "nats" in answer else ""))
    for r in rows:
        print(f"| {r['mould']} | {r['cause']}, {r.get('strength', 1):g} | " + " | ".join(words(r.get(name)) for name in titles) + " |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("out")
    parser.add_argument("--table", action="store_true")
    parser.add_argument("--marks", type=int, default=10)
    parser.add_argument("--sigma", type=float, default=0.3)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--triangles", type=int, default=2500)
    parser.add_argument("--variants", default="chosen,raster")
    parser.add_argument("--strength", type=float, default=1)
    parser.add_argument("--only", default=",".join(STRONG))
    parser.add_argument("--moulds", default="pyramid")
    o = parser.parse_args()
    if o.table:
        table(o.out)
        return
    known = set()
    if Path(o.out).exists():
        known = {(r["mould"], r["cause"], r.get("strength", 1), r["seed"], r["marks"]) for r in map(json.loads, Path(o.out).read_text().splitlines())}
    for mould in o.moulds.split(","):
        for cause in o.only.split(","):
            if (mould, cause, o.strength, o.seed, o.marks) in known:
                continue
            with tempfile.TemporaryDirectory() as folder:
                trial = Trial(o.program, mould, cause, o.strength, o.seed, o.sigma, o.triangles, folder)
                setup = json.loads((trial.folder / "dense/setup.json").read_text())
                row = {"mould": mould, "cause": cause, "strength": o.strength, "seed": o.seed, "marks": o.marks,
                       "sigma_mm": o.sigma, "triangles": o.triangles}
                for name in o.variants.split(","):
                    if name == "scan":
                        row[name] = trial.diagnosed(trial.scanned())
                        continue
                    places, rim = {"chosen": lambda: trial.planned(o.marks, False), "rim": lambda: trial.planned(o.marks, True),
                                   "raster": lambda: (raster(o.marks, setup["clamp_opening_mm"]), [])}[name]()
                    own = trial.measured_by_hand(name, places, rim)
                    row[name] = trial.diagnosed(own) | {"nats": trial.information(own)}
                with open(o.out, "a", encoding="utf-8") as out:
                    out.write(json.dumps(row) + "\n")
                print(json.dumps(row), flush=True)


if __name__ == "__main__":
    main()
