#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of docs/ray_casting.md from the JSON of bench_rays: bench_rays 5 | ray_table.py"""
import json
import sys

SETS = {"eye": "from an eye to vertices", "down": "down on a grid", "normal": "inwards along normals", "random": "at random"}


def rows_of(embree: dict, ours: dict) -> list[tuple[str, float, float, int]]:
    rows = [
        ("build, one thread, ms", 1e3 * embree["build_one_thread_seconds"], 1e3 * ours["build_one_thread_seconds"], 1),
        ("memory, bytes a triangle", embree["bytes_per_triangle"], ours["bytes_per_triangle"], 0),
    ]
    for key, what in (("first_hit", "first hit"), ("all_hits", "all hits")):
        for name, text in SETS.items():
            rows.append((f"{what} {text}, µs", embree[f"{key}_microseconds"][name], ours[f"{key}_microseconds"][name], 2))
    return rows


def main() -> None:
    meshes = json.load(sys.stdin)["meshes"]
    print("| | " + " | ".join(f"{mesh['triangles']:,} triangles: Embree | ours | Embree / ours" for mesh in meshes) + " |")
    print("|---|" + "---:|---:|---:|" * len(meshes))
    for lines in zip(*(rows_of(mesh["embree"], mesh["ours"]) for mesh in meshes), strict=True):
        cells = [f"{embree:.{digits}f} | {ours:.{digits}f} | {embree / ours:.2f}" for _, embree, ours, digits in lines]
        print(f"| {lines[0][0]} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
