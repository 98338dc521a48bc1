# SPDX-License-Identifier: GPL-3.0-or-later
"""A baseline beside a diagnosis: the cause whose effect points most nearly along what the calibrated simulation leaves."""
from counted_shares import share


def print_table(asked, clean, hidden, right, alarm, rows):
    """Prints a table, and gives the threshold. Of a case, `hidden` is its cause, `right` whether the diagnosis names it first, `alarm` whether it says anything but none; rows are (label, condition).
    case["nearest"] is (name, cosine)."""
    asked, clean = [[c for c in cases if "nearest" in c] for cases in (asked, clean)]
    if not asked or not clean:
        return None
    # It has no answer "nothing": it gets the threshold of its cosine that raises as many alarms as the diagnosis does.
    threshold = (sorted((c["nearest"][1] for c in clean), reverse=True) + [0])[sum(map(alarm, clean))]
    print("*Nearest sensitivity*: the cause whose effect points most nearly along the residual of the calibrated simulation, in the same metric and beside the same material. "
          f"It has no answer \"nothing\"; above a cosine of {threshold:.2f} it gives as many alarms on clean data as the diagnosis. "
          f"Answers that have it: {len(asked)} with a cause, {len(clean)} clean.\n")
    print("| cases | diagnosis | nearest sensitivity | with that threshold |\n|---|---|---|---|")
    for label, belongs in rows + [("all", lambda c: True)]:
        of = [c for c in asked if belongs(c)]
        named = [c for c in of if c["nearest"][0] == hidden(c)]
        print(f"| {label} | {share([c for c in of if right(c)], of)} | {share(named, of)} | {share([c for c in named if c['nearest'][1] > threshold], of)} |")
    return threshold
