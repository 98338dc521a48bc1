#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Counts the lines of confusion_table: score_confusion_table.py FILE... [--engine N] prints tables for docs/evidence.md.

Of every case the newest engine's answer counts, or that of engine N.
A hidden cause is visible if it is stronger than `least_visible`, which the diagnosis states without knowing the truth."""
import argparse
import collections
import json
import statistics

parser = argparse.ArgumentParser()
parser.add_argument("files", nargs="+")
parser.add_argument("--engine", type=int)
a = parser.parse_args()
answers = [json.loads(line) for name in a.files for line in open(name) if line.startswith("{")]
latest = {}
for c in sorted(answers, key=lambda c: c.get("engine", 1)):
    if a.engine in (None, c.get("engine", 1)):
        latest[c["seed"]] = c
cases = list(latest.values())
by_engine = collections.Counter(c.get("engine", 1) for c in cases)
print(f"{len(cases)} cases; answers of " + ", ".join(f"engine {engine}: {count}" for engine, count in sorted(by_engine.items())))
failed = [c for c in cases if "error" in c]
cases = [c for c in cases if "error" not in c]
named_level = {1: "strong", 0.5: "medium", 0.25: "weak"}


def share(part, whole):
    return f"{len(part)} of {len(whole)}" + (f" ({100 * len(part) / len(whole):.0f} %)" if whole else "")


def visible(case):
    return all(least is not None and strength > least for strength, least in zip(case["strength"], case["least_visible"]))


single = [c for c in cases if len(c["hidden"]) == 1 and not c["left_out"]]
print("| hidden | strength | noise mm | answers (first name) | visible |\n|---|---|---|---|---|")
rows = collections.defaultdict(list)
for c in single:
    rows[c["hidden"][0], c["level"], c["sigma_mm"]].append(c)
for (cause, level, sigma), own in sorted(rows.items(), key=lambda row: (row[0][0], -row[0][1], row[0][2])):
    answers = collections.Counter(c["first"] for c in own)
    print(f"| {cause} | {named_level.get(level, level)} | {sigma} | {', '.join(f'{n} {a}' for a, n in answers.most_common())} | {sum(map(visible, own))} of {len(own)} |")
print()
for level in sorted({c["level"] for c in single}, reverse=True):
    shown = [c for c in single if c["level"] == level and visible(c)]
    print(f"- {named_level.get(level, level)}, visible: named first in {share([c for c in shown if c['first'] == c['hidden'][0]], shown)}; "
          f"a wrong name without doubt in {share([c for c in shown if c['first'] not in (c['hidden'][0], 'none', 'unknown') and not c['doubtful'] and c['reading'] == 'cause'], shown)}")
clean = [c for c in cases if not c["hidden"]]
print(f"- false alarms on clean data: {share([c for c in clean if c['reading'] not in ('none',)], clean)}")
missing = [c for c in cases if c["left_out"] and len(c["hidden"]) == 1]
print(f"- cause left out of the list: unknown, none or doubt in {share([c for c in missing if c['reading'] != 'cause' or c['doubtful']], missing)}")
pairs = [c for c in cases if len(c["hidden"]) == 2 and not c["left_out"]]
print(f"- pairs: both named in {share([c for c in pairs if set(c['verdict']) == set(c['hidden'])], pairs)}; of those visible "
      f"{share([c for c in pairs if visible(c) and set(c['verdict']) == set(c['hidden'])], [c for c in pairs if visible(c)])}")
gains = [1 - c["unseen_mm"][1] / c["unseen_mm"][0] for c in single if "unseen_mm" in c and c["level"] == 1 and c["first"] == c["hidden"][0]]
if gains:
    print(f"- error on another object, strong cause named: falls by {100 * statistics.median(gains):.0f} % (median), by half or more in {share([g for g in gains if g >= 0.5], gains)}")
ratios = [c["causes"][0][2] / c["strength"][0] for c in single if c["first"] == c["hidden"][0] and c["strength"][0]]
if ratios:
    print(f"- strength found over hidden: median {statistics.median(map(abs, ratios)):.2f}")
if cases:
    print(f"- seconds a diagnosis: median {statistics.median(c['seconds'] for c in cases):.0f}, longest {max(c['seconds'] for c in cases):.0f}; failed: {len(failed)}")
