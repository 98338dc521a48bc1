#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Counts the answers of zippable_table as Markdown, all cases first: score_zippable_table.py RESULTS.jsonl"""
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from counted_shares import share_of  # noqa: E402


def strength(values):
    """The largest of a cause's true values, which is what its strength is about."""
    return ", ".join(f"{name} {value:.3g}" for name, value in values.items() if value)


def answer(line):
    if "error" in line:
        return "failed: " + line["error"]
    if not line["verdict"]:
        return line["reading"]
    first = line["first"][0]
    half = (first["high"] - first["low"]) / 2
    text = f"{' and '.join(line['verdict'])} {first['strength']:.3g} ± {half:.2g}"
    if line["reading"] == "cannot_separate":
        text += ", or a twin"
    return text + (", in doubt" if line["doubts"] else "")


def twins(line):
    return {name for pair in line.get("not_separable", []) for name in pair[:2] if line["cause"] in pair[:2]}


def main():
    lines = [json.loads(text) for text in pathlib.Path(sys.argv[1]).read_text().splitlines()]
    hidden = [line for line in lines if line["cause"] != "none"]
    clean = [line for line in lines if line["cause"] == "none"]
    named = [line for line in hidden if line.get("verdict", [])[:1] == [line["cause"]]]
    or_twin = [line for line in hidden if line in named or (line.get("reading") == "cannot_separate" and line["cause"] in twins(line))]
    wrong = [line for line in hidden if line.get("verdict") and line not in or_twin]
    print("| of all cases | |\n|---|---|")
    print(f"| named first | {share_of(len(named), len(hidden))} |")
    print(f"| named first, or as the twin of what is named | {share_of(len(or_twin), len(hidden))} |")
    print(f"| another cause named | {share_of(len(wrong), len(hidden))} |")
    print(f"| the same, without doubt | {share_of(sum(not line['doubts'] for line in wrong), len(hidden))} |")
    print(f"| nothing hidden: something named, or unknown | {share_of(sum(line.get('reading') != 'none' for line in clean), len(clean))} |")
    repaired = [line["second_shape_mm"] for line in named if "second_shape_mm" in line]
    worse = [s for s in repaired if s["as_planned_before"] > 1.2 * s["without_error"]]
    halved = sum(s["as_planned_after"] - s["without_error"] < 0.5 * (s["as_planned_before"] - s["without_error"]) for s in worse)
    print(f"| a plan of another shape that makes up for it removes more than half of what the error adds | {share_of(halved, len(worse))} |")
    print("\n| hidden | shape | answer | left out, mm | another shape, mm | seed |\n|---|---|---|---:|---:|---:|")
    for line in lines:
        if "error" in line:
            print(f"| {line['cause']} | {line['shape']} | {answer(line)} | | | {line['seed']} |")
            continue
        second = line.get("second_shape_mm")
        shape = f"{second['as_planned_before']:.2f} → {second['as_planned_after']:.2f} ({second['without_error']:.2f})" if second else ""
        print(f"| {strength(line['truth']) or 'none'} | {line['shape']} | {answer(line)} | {line['error_before_mm']:.2f} → {line['error_after_mm']:.2f} | {shape} | {line['seed']} |")


if __name__ == "__main__":
    main()
