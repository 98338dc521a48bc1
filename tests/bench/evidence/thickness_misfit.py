#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How much the thickness of a formed sheet depends on the simulation, and on the causes of a diagnosis: 3,000 places spread
over the sheet, differences from 5,000 triangles without any cause, as shares of the sheet's thickness (1 mm).

  thickness_misfit.py build/formwright [--network-share 0.1] [pyramid hemisphere t_shape]

--network-share is that of every simulation."""
import argparse
import csv
import math
import subprocess
import tempfile
from pathlib import Path

USUAL = {"triangles": 5000, "step_mm": 0.6}  # as a diagnosis has them
SIMULATIONS = {"2,500 triangles": {"triangles": 2500}, "10,000 triangles": {"triangles": 10000}, "20,000 triangles": {"triangles": 20000},
               "other elastic law": {"elastic_law": "stable_neo_hookean"}, "stiffness times 1.3": {"young_modulus_pa": 3.6e6}}
# At their usual strengths (thermoform_causes.cpp).
CAUSES = {"heating_gradient": {"heating_gradient_x": 0.35}, "heating_centre": {"heating_centre": 0.35}, "slip": {"slip": 1.5},
          "anisotropy": {"anisotropy": 0.4}, "thickness_wedge": {"thickness_wedge_x": 0.3}, "cooling": {"cooling": 1},
          "weak_vacuum": {"weak_vacuum": 0.35}, "clamp_slip": {"clamp_slip_mm": 2}, "mould_shift": {"mould_shift_x_mm": 1.5}}


def thickness(program, mould, changed):
    values = {**USUAL, **changed, "size_mm": 100, "points": 30, "noise_mm": 0, "outlier_percent": 0, "thickness_points": 3000,
              "thickness_noise_mm": 0.001, "seed": 1}
    flags = [text for name, value in values.items() for text in ("--" + name.replace("_", "-"), str(value))]
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([program, "evidence-virtual-object", "--sample", mould, *flags, "--out", folder], check=True, capture_output=True)
        with open(Path(folder) / "measured.csv", newline="", encoding="utf-8") as file:
            return [float(row["thickness_mm"]) for row in csv.DictReader(file) if row["thickness_mm"]]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("moulds", nargs="*")
    parser.add_argument("--network-share", type=float, default=0)
    options = parser.parse_args()
    program, moulds = options.program, options.moulds or ["pyramid", "hemisphere", "t_shape"]
    USUAL["network_share"] = options.network_share
    print("| change | " + " | ".join(moulds) + " |\n|---|" + "---:|" * len(moulds))
    usual = {mould: thickness(program, mould, {}) for mould in moulds}
    for name, changed in {**SIMULATIONS, **CAUSES}.items():
        shares = []
        for mould in moulds:
            differences = [a - b for a, b in zip(thickness(program, mould, changed), usual[mould])]
            shares.append(math.sqrt(sum(d * d for d in differences) / len(differences)))
        print(f"| {name} | " + " | ".join(f"{100 * share:.1f} %" for share in shares) + " |", flush=True)


if __name__ == "__main__":
    main()
