# SPDX-License-Identifier: GPL-3.0-or-later
"""Shares of counted cases with their intervals, as the tables of the evidence show them."""
import math


def wilson(part, whole, z=1.959964):
    """95 % interval of a share [Wil27], which holds for few cases, too; whole > 0."""
    p = part / whole
    middle = (p + z * z / (2 * whole)) / (1 + z * z / whole)
    half = z / (1 + z * z / whole) * math.sqrt(p * (1 - p) / whole + z * z / (4 * whole * whole))
    return max(0.0, middle - half), min(1.0, middle + half)


def share_of(hits, count):
    """"12 of 13 (92 %; 67 to 99)"."""
    if count == 0:
        return "none tried"
    low, high = wilson(hits, count)
    return f"{hits} of {count} ({100 * hits / count:.0f} %; {100 * low:.0f} to {100 * high:.0f})"


def share(part, whole):
    """The same of two lists."""
    return share_of(len(part), len(whole))
