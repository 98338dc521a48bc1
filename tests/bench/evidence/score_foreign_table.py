#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Counts the lines of run_foreign_table.py: score_foreign_table.py FILE... prints docs/foreign_table.md.

Of every case the last answer counts. Nothing is left out: failures count as not named, and on clean sheets as an alarm."""
import argparse
import json
import math
import statistics

import nearest_baseline
from counted_shares import share, share_of
from intervals import holds, off_by, with_interval


def named(case):
    """What the answer names, the stronger cause first; empty for none, unknown and failures."""
    return [] if case.get("reading") in (None, "none", "unknown") else case["verdict"]


def visible(case):
    """Whether the hidden cause is stronger than what the diagnosis says would show; only where it lists the cause among its first."""
    found = [f for f in case.get("first", []) if f["name"] == case["cause"]]
    return bool(found) and found[0]["min_visible_strength"] is not None and abs(found[0]["strength"]) > found[0]["min_visible_strength"]


def right(case):
    return named(case)[:1] == [case["cause"]]


def answer(case):
    if "error" in case:
        return "failed: " + case["error"].split("\n")[0][:80].replace("|", "/")
    if not named(case):
        return case["reading"]
    found = {f["name"]: f for f in case["first"]}
    said = " and ".join(f"{name} {with_interval(found[name]['strength'], *found[name]['interval'])}" if name in found else name for name in named(case))
    return said + (", in doubt" if case["doubtful"] else "") + (", or a twin" if case["reading"] == "cannot_separate" else "")


def without_doubt(case):
    return not case.get("doubtful", False) and case.get("reading") != "cannot_separate"


def strength(case):
    return ", ".join(f"{name} {value:.3g}" for name, value in case.get("strength", {}).items()) or "nothing"


def first_names(case):
    return ", ".join(f"{f['name']} {f['probability']:.2g}" for f in case.get("first", []) if f["probability"] >= 0.005)


def table(title, groups):
    print(f"\n## {title}\n")
    print("| of | strong cause named first | named and not in doubt | another cause named | the same, not in doubt | clean: something named or unknown | clean: not in doubt |")
    print("|---|---|---|---|---|---|---|")
    for name, cases in groups:
        listed = [c for c in cases if c["cause"] != "none" and c.get("in_the_list", True)]
        clean = [c for c in cases if c["cause"] == "none"]
        wrong = [c for c in listed if named(c) and not right(c)]
        alarms = [c for c in clean if c.get("reading") != "none"]
        sure = lambda group: sum(map(without_doubt, group))
        hits = [c for c in listed if right(c)]
        print(f"| {name} | {share_of(len(hits), len(listed))} | {share_of(sure(hits), len(listed))} | {share_of(len(wrong), len(listed))} | {share_of(sure(wrong), len(listed))} "
              f"| {share_of(len(alarms), len(clean))} | {share_of(sure(alarms), len(clean))} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+")
    a = parser.parse_args()
    latest = {}
    for name in a.files:
        with open(name) as file:
            for line in map(json.loads, filter(str.strip, file)):
                latest[line["seed"], line["mould"], line["cause"], line["level"], line["noise_mm"], line["points"], line["pairs"], line.get("known_machine", False), line.get("good_part", False)] = line
    everything = sorted(latest.values(), key=lambda c: (c["cause"], c["mould"], c["seed"], -c["level"]))
    cases = [c for c in everything if not c.get("known_machine") and not c.get("good_part")]
    beside = [c for c in everything if c.get("good_part")]
    known = [c for c in everything if c.get("known_machine")]
    strong = [c for c in cases if c["level"] == 1]
    print("""# The diagnosis on sheets of another laboratory

Sheets that `tests/foreign_laboratory` formed, with a simulation of another kind, and that `evidence-diagnose` was asked about.
[evidence.md](evidence.md#a-laboratory-of-another-kind) says what differs and which commands make this page.

- All cases that were run are counted, whether the cause can be visible or not. Diagnoses that failed count as wrong. Shares have Wilson's 95 % interval [Wil27].
- *Named first*: the verdict's first cause is the hidden one. *In doubt*: the report doubts its answer, or says that it cannot separate it from another cause (*or a twin*).
- *Moved*: mean movement of the measured marks against the sheet of the same seed without fault.
- Strengths are those of the laboratory (`tests/foreign_laboratory/faults.h`). Behind a strength that was found is its 95 % interval, in the diagnosis's own unit and without sign.""")
    if not cases:
        print("\nNo case has been answered yet.")
        return
    meshes = sorted({c.get("triangles", 5000) for c in cases})
    print(f"\nCases: {len(cases)}, {sum(c['cause'] == 'none' for c in cases)} of them clean. Triangles of the simulated sheet: {' or '.join(f'{n:,}' for n in meshes)}; strengths and errors are those of a sheet with twice as many.")
    table("All cases", by_mould(strong))
    seen = [c for c in strong if c["cause"] == "none" or visible(c)]
    table("Only causes that the answer lists as visible", [("every mould", seen)])
    print("\nA cause counts as visible if it is among the three likeliest and found stronger than its `min_visible_strength`. This row is chosen by the answer itself: it is no "
          "measure of how often the diagnosis is right.")
    table("By cause", [(cause, [c for c in strong if c["cause"] == cause]) for cause in sorted({c["cause"] for c in strong} - {"none"})
                       if all(c.get("in_the_list", True) for c in strong if c["cause"] == cause)])
    tell_of_causes_in_no_list(strong)
    strengths(strong)
    weaker_levels(cases)
    print_baselines("Baselines", strong)
    good = [c for c in cases if "error" not in c]
    if good:
        clean = [c["error_before_mm"] for c in good if c["cause"] == "none"]
        if clean:
            print(f"\nClean sheets: mean distance of {statistics.median(clean):.2f} mm (median) between sheet and calibrated simulation on held-out blocks, noise alone would give "
                  f"{statistics.median(c['noise_floor_mm'] for c in good if c['cause'] == 'none'):.2f} mm.")
        # Of an object that was kept, simulations may be, too: its times say nothing.
        timed = [c for c in good if c["seconds_forming"] >= 1]
        if timed:
            print(f"\nMedian wall time of a case, with whatever else the machine did: {statistics.median(c['seconds_forming'] for c in timed):.0f} s to form, "
                  f"{statistics.median(c['seconds_diagnosing'] for c in timed):.0f} s to diagnose.")
        print(f"\nFailed: {len(cases) - len(good)}.")
    list_answers("Every answer", cases)
    if beside:
        strong = [c for c in beside if c["level"] == 1]
        table("Beside a good part", by_mould(strong))
        print("\nA sheet without fault over the same mould, of the same machine and plastic, was given as a good part (`--good-part`). It is of another day: another temperature, thickness, pump and "
              "mould, by as much as machines in order differ (`on_another_day` in `forming.h`), with marks and noise of its own.")
        tell_of_causes_in_no_list(strong)
        strengths(strong)
        weaker_levels(beside)
        print_baselines("Baselines beside a good part", strong)
        list_answers("Every answer beside a good part", beside)
    if known:
        table("With a profile from when the machine was in order", by_mould([c for c in known if c["level"] == 1]))
        print("\nOne sheet without fault over another mould, of the same machine and plastic, was measured and calibrated first (`--known-machine`); the diagnosis got that profile.")
        list_answers("Every answer with a profile", known)


def tell_of_causes_in_no_list(cases):
    foreign = [c for c in cases if not c.get("in_the_list", True)]
    if foreign:
        careful = sum(1 for c in foreign if "error" not in c and (not named(c) or not without_doubt(c)))
        names = ", ".join(f"`{name}`" for name in sorted({c["cause"] for c in foreign}))
        print(f"\nCauses that are in no list ({names}): unknown, none or in doubt in {share_of(careful, len(foreign))}.")


def print_baselines(title, cases):
    """The cause whose sensitivity is nearest to the residual, and a discrepancy field without causes."""
    answered = [c for c in cases if "nearest" in c]
    if not answered:
        return
    print(f"\n## {title}\n")
    faulty = [c for c in answered if c["cause"] != "none" and c.get("in_the_list", True)]
    clean = [c for c in answered if c["cause"] == "none"]
    rows = [(mould, lambda c, mould=mould: c["mould"] == mould) for mould in sorted({c["mould"] for c in faulty})]
    threshold = nearest_baseline.print_table(faulty, clean, lambda c: c["cause"], right, lambda c: c["reading"] != "none", rows)
    foreign = [c for c in answered if not c.get("in_the_list", True)]
    if foreign and threshold is not None:
        wrong = [c for c in foreign if c["nearest"][1] > threshold]
        print(f"\nOf the causes that are in no list it calls {share_of(len(wrong), len(foreign))} something else, even with that threshold, and has no doubts.")
    better = [c["verdict_gain"] for c in faulty if named(c) and (c["verdict_gain"] or 0) > 0]
    print(f"\n*A discrepancy field and no causes*: on the blocks that were left out, the named causes and the field together predict better than the field alone in {share(better, faulty)} of all cases. "
          f"Their error is {100 * statistics.median(better):.0f} % lower there (median)." if better else "")


def weaker_levels(cases):
    """The same faults at half or a quarter of their size; clean sheets are tried once, with the strong ones."""
    for level, word in ((0.5, "medium"), (0.25, "weak")):
        of = [c for c in cases if c["level"] == level and c.get("in_the_list", True)]
        if not of:
            continue
        wrong = [c for c in of if named(c) and not right(c)]
        sure = [c for c in of if right(c) and without_doubt(c)]
        surely_wrong = [c for c in wrong if without_doubt(c)]
        print(f"\nOf the same faults, {word} ({level:g} times as large), {share([c for c in of if right(c)], of)} are named first, {share(sure, of)} named and not in doubt; "
              f"for {share(wrong, of)} another cause is named, not in doubt for {share(surely_wrong, of)}.")
        tell_of_causes_in_no_list([c for c in cases if c["level"] == level])


def strengths(cases):
    """Of causes that the laboratory hides in the unit that they are found in."""
    found = [(c, c["first"][0], math.hypot(*c["strength"].values())) for c in cases
             if right(c) and c["first"][0]["name"] == c["cause"] and c["first"][0]["values"].keys() == c["strength"].keys()]
    if found:
        off = statistics.median(off_by(first["strength"], hidden) for _, first, hidden in found)
        inside = [c for c, first, hidden in found if holds(first["strength"], *first["interval"], hidden)]
        print(f"\nOf the causes named first that the laboratory hides in the unit they are found in ({', '.join(sorted({c['cause'] for c, _, _ in found}))}), the 95 % interval holds the hidden strength in {share(inside, found)}; "
              f"strengths are off by {100 * off:.0f} % (median).")


def by_mould(cases):
    return [("every mould", cases)] + [(mould, [c for c in cases if c["mould"] == mould]) for mould in sorted({c["mould"] for c in cases})]


def list_answers(title, cases):
    print(f"\n## {title}\n\n| hidden | strength | mould | moved mm | answer | likeliest causes | simulation with | error before → after, mm | seed |\n|---|---|---|---:|---|---|---|---|---:|")
    for c in cases:
        errors = f"{c['error_before_mm']:.2f} → {c['error_after_mm']:.2f}" if "error" not in c else ""
        mark = "" if c["cause"] == "none" or right(c) or not c.get("in_the_list", True) else " ✗"
        print(f"| {c['cause']} | {strength(c)} | {c['mould']} | {c.get('movement_mean_mm', 0):.2f} | {answer(c)}{mark} | {first_names(c)} | {', '.join(c.get('simulation', []))} | {errors} | {c['seed']} |")


if __name__ == "__main__":
    main()
