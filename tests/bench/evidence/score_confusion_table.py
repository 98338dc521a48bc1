#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Counts the lines of confusion_table and lists them: score_confusion_table.py FILE... [--rules N...] prints docs/confusion_table.md.

Of every case the newest engine's answer counts, or the newest of engines N.
A hidden cause is visible if it is stronger than `min_visible_strength`, which the diagnosis states without knowing the truth."""
import argparse
import collections
import json
import math
import statistics

import nearest_baseline
from counted_shares import share
from intervals import holds, off_by, with_interval

named_level = {1: "strong", 0.5: "medium", 0.25: "weak"}


def visible(case):
    return all(least is not None and strength > least for strength, least in zip(case["strength"], case["min_visible_strength"]))


def right(case):
    return case["first"] == case["hidden"][0]


def names_wrongly(case):
    return is_named(case) and not set(case["verdict"]) <= set(case["hidden"])


def is_named(case):
    return case["reading"] in ("cause", "cannot_separate")


def without_doubt(case):
    return case["reading"] == "cause" and not case["doubtful"]


def wrong_without_doubt(case):
    return without_doubt(case) and names_wrongly(case)


def number(value):
    return f"{value:.3g}"


def answer(case):
    """What was named, with strength and interval."""
    if case["reading"] in ("none", "unknown"):
        return case["reading"]
    found = {cause[0]: f"{cause[0]} {with_interval(*cause[2:5])}" for cause in case["causes"]}
    said = [found.get(name, name) for name in case["verdict"]]  # only the likeliest causes are kept
    return " and ".join(said) + (", in doubt" if case["doubtful"] else "") + (", or a twin" if case["reading"] == "cannot_separate" else "")


def inside(case):
    return holds(*case["causes"][0][2:5], case["strength"][0])


def strengths(cases):
    """Of the causes that were named first, by the rules that found them."""
    for level in sorted({c["level"] for c in cases}, reverse=True):
        for engine in sorted({c.get("engine", 1) for c in cases if c["level"] == level}):
            some = [c for c in cases if c["level"] == level and c.get("engine", 1) == engine]
            off = statistics.median(off_by(c["causes"][0][2], c["strength"][0]) for c in some)
            print(f"| {named_level.get(level, level)}, version {engine}: 95 % interval holds the hidden strength; strength off by (median) | {share([c for c in some if inside(c)], some)}; {100 * off:.0f} % |")


def by_mould(cases, clean):
    """Every case counts, whether its cause can show in its data or not."""
    levels = sorted({c["level"] for c in cases}, reverse=True)
    print("## Named first, all cases\n\nNo case is left out: causes that these data cannot show count as missed. Intervals are 95 %.\n")
    print("| mould | " + " | ".join(named_level.get(level, str(level)) for level in levels) + " | nothing hidden: an alarm |")
    print("|---|" + "---|" * (len(levels) + 1))
    rows = [(mould, lambda c, mould=mould: c["mould"] == mould) for mould in sorted({c["mould"] for c in cases + clean})]
    rows += [(f"noise {sigma} mm", lambda c, sigma=sigma: c["sigma_mm"] == sigma) for sigma in sorted({c["sigma_mm"] for c in cases})]
    rows += [("all", lambda c: True)]
    for label, belongs in rows:
        cells = []
        for level in levels:
            asked = [c for c in cases if c["level"] == level and belongs(c)]
            cells.append(share([c for c in asked if right(c)], asked))
        quiet = [c for c in clean if belongs(c)]
        cells.append(share([c for c in quiet if c["reading"] != "none"], quiet))
        print(f"| {label} | " + " | ".join(cells) + " |")


def doubts(cases):
    """Of what is named with and without doubt, how much is wrong."""
    print("\n## Is doubt right?\n\nOf the answers that name a cause, the share that names one that was not hidden.\n")
    print("| answers | in doubt, or a twin: wrong | without doubt: wrong |\n|---|---|---|")
    rows = [(mould, lambda c, mould=mould: c["mould"] == mould) for mould in sorted({c["mould"] for c in cases})]
    rows += [(f"noise {sigma} mm", lambda c, sigma=sigma: c["sigma_mm"] == sigma) for sigma in sorted({c["sigma_mm"] for c in cases})]
    rows += [("all", lambda c: True)]
    for label, belongs in rows:
        cells = []
        for sure in (False, True):
            asked = [c for c in cases if is_named(c) and without_doubt(c) == sure and belongs(c)]
            cells.append(share([c for c in asked if names_wrongly(c)], asked))
        print(f"| {label} | " + " | ".join(cells) + " |")


def baselines(cases, clean):
    """The cause whose sensitivity is nearest to the residual, and a discrepancy field without causes."""
    print("\n## Baselines\n")
    rows = [(named_level.get(level, str(level)), lambda c, level=level: c["level"] == level) for level in sorted({c["level"] for c in cases}, reverse=True)]
    rows += [(mould, lambda c, mould=mould: c["mould"] == mould) for mould in sorted({c["mould"] for c in cases})]
    nearest_baseline.print_table(cases, clean, lambda c: c["hidden"][0], right, lambda c: c["reading"] != "none", rows)
    tried = [(c, trial) for c in cases for trial in c["trials"] if trial[0] == "+".join(sorted(c["verdict"])) and len(c["verdict"]) == 1 and trial[2] > 0]
    if tried:
        fall = statistics.median(1 - trial[3] / trial[2] for _, trial in tried)
        better = [t for t in tried if t[1][3] < t[1][2]]
        print(f"\n*A discrepancy field and no causes*: on the blocks that were left out, the named cause and the field together predict better than the field alone in {share(better, cases)} of all cases. "
              f"Their error is {100 * fall:.0f} % lower there (median). In the others no cause is named, and both are the same; by versions before 23 no cause is named that fails this comparison, by later ones only in doubt. "
              "On another object a field has nothing to say: its error there is that of the calibrated simulation.")


def above(error_mm, case):
    """Of a mean distance, what is more than the mean length of the noise: of a Gaussian with sigma in each of three coordinates."""
    noise_mm = case["sigma_mm"] * math.sqrt(8 / math.pi)
    return math.sqrt(max(0.0, error_mm**2 - noise_mm**2))


def hidden(case):
    if not case["hidden"]:
        return "nothing"
    return " and ".join(f"{name} {number(strength)}" for name, strength in zip(case["hidden"], case["strength"]))


def listed(cases, title):
    if not cases:
        return
    print(f"\n## {title}\n\n| hidden | noise mm | mould | visible | answer | another object, mm | seed | engine |\n|---|---:|---|---|---|---|---:|---:|")
    for c in cases:
        gain = f"{c['unseen_mm'][0]:.2f} → {c['unseen_mm'][1]:.2f}" if "unseen_mm" in c else ""
        mark = "" if not c["hidden"] or c["left_out"] or set(c["verdict"]) == set(c["hidden"]) or not visible(c) else " ✗"
        print(f"| {hidden(c)} | {c['sigma_mm']} | {c['mould']} | {'yes' if c['hidden'] and visible(c) else '' if not c['hidden'] else 'no'} | {answer(c)}{mark} | {gain} | {c['seed'] // 1000} | {c.get('engine', 1)} |")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("files", nargs="+")
    parser.add_argument("--rules", type=int, nargs="+", metavar="VERSION", help="counts the answers by these versions of the rules alone")
    a = parser.parse_args()
    answers = [json.loads(line) for name in a.files for line in open(name) if line.startswith("{")]
    latest = {}
    for c in sorted(answers, key=lambda c: c.get("engine", 1)):
        if not a.rules or c.get("engine", 1) in a.rules:
            latest[c["seed"]] = c
    failed = [c for c in latest.values() if "error" in c]
    cases = [c for c in latest.values() if "error" not in c]
    by_engine = collections.Counter(c.get("engine", 1) for c in cases)
    single = [c for c in cases if len(c["hidden"]) == 1 and not c["left_out"]]
    clean = [c for c in cases if not c["hidden"]]
    missing = [c for c in cases if c["left_out"] and len(c["hidden"]) == 1]
    pairs = [c for c in cases if len(c["hidden"]) == 2 and not c["left_out"]]

    print("""# The confusion table

Causes were hidden in virtual objects and diagnosed. `score_confusion_table.py` counts the answers in `tests/bench/evidence/confusion_table.jsonl`.
[evidence.md](evidence.md) says how the objects are made, what the causes mean, and which command makes this page.

- A cause is *visible* if it is stronger than `min_visible_strength`, which the diagnosis computes without knowing the truth.
- Behind a strength is its 95 % interval, without sign. Strengths are in the units of [thermoform.md](thermoform.md).
- *In doubt*: the report doubts its answer and says why. *Or a twin*: another cause does nearly the same to these data. ✗: visible, but not what was named.
- *Another object* is the mean error on an object that the diagnosis did not see, before and after the simulation is extended.
""")
    print(f"{len(cases)} cases, by the engine that answered: " + ", ".join(f"{engine}: {count}" for engine, count in sorted(by_engine.items())) + ".\n")
    by_mould(single, clean)
    doubts([c for c in cases if not c["left_out"]])
    baselines(single, clean)
    print("\n## Counts\n\n| count | result |\n|---|---|")
    for level in sorted({c["level"] for c in single}, reverse=True):
        for sigma in sorted({c["sigma_mm"] for c in single}):
            shown = [c for c in single if c["level"] == level and c["sigma_mm"] == sigma and visible(c)]
            print(f"| {named_level.get(level, level)}, {sigma} mm, visible: named first | {share([c for c in shown if right(c)], shown)} |")
    every = [c for c in single if visible(c)]
    print(f"| one hidden cause: another one named, without doubt | {share([c for c in single if wrong_without_doubt(c)], single)} |")
    print(f"| nothing hidden: something named, or unknown | {share([c for c in clean if c['reading'] != 'none'], clean)} |")
    print(f"| hidden cause is not in the list: unknown, none or in doubt | {share([c for c in missing if not without_doubt(c)], missing)} |")
    shown = [c for c in pairs if visible(c)]
    both = [c for c in pairs if set(c["verdict"]) == set(c["hidden"])]
    print(f"| two strong causes: both named | {share(both, pairs)}; where both are visible {share([c for c in both if visible(c)], shown)} |")
    found = [c for c in every if right(c)]
    unseen = [c for c in found if "unseen_mm" in c and c["level"] == 1]
    gains = [1 - c["unseen_mm"][1] / c["unseen_mm"][0] for c in unseen]
    if gains:
        print(f"| error on another object, strong cause named | falls by {100 * statistics.median(gains):.0f} % (median), by half or more in {share([g for g in gains if g >= 0.5], gains)} |")
        above_noise = [1 - above(c["unseen_mm"][1], c) / above(c["unseen_mm"][0], c) for c in unseen if above(c["unseen_mm"][0], c) > 0]
        print(f"| the same above the noise of the measurement, which no simulation takes away (squares subtracted) | falls by {100 * statistics.median(above_noise):.0f} % (median), by half or more in {share([g for g in above_noise if g >= 0.5], above_noise)} |")
    if found:
        print(f"| found strength divided by hidden strength | {statistics.median(abs(c['causes'][0][2]) / c['strength'][0] for c in found):.2f} (median) |")
        strengths([c for c in single if right(c)])
    if cases:
        print(f"| seconds per diagnosis, one processor | {statistics.median(c['seconds'] for c in cases):.0f} (median); failed diagnoses: {len(failed)} |")
    by_cause = lambda c: (c["hidden"], c["sigma_mm"], c["seed"])
    for level in sorted({c["level"] for c in single}, reverse=True):
        listed(sorted((c for c in single if c["level"] == level), key=by_cause), f"One cause, {named_level.get(level, level)}")
    listed(sorted(missing, key=by_cause), "A cause that is not in the list")
    listed(sorted(pairs, key=by_cause), "Two causes")
    listed(sorted(clean, key=by_cause), "Nothing hidden")


main()
