# SPDX-License-Identifier: GPL-3.0-or-later
"""Shares of counted cases with their intervals, as the tables of the evidence show them."""
import math


def wilson(part, whole, z=1.959964):
    """95 % interval of a share (Wilson 1927); whole > 0."""
    p = part / whole
    middle = (p + z * z / (2 * whole)) / (1 + z * z / whole)
    half = z / (1 + z * z / whole) * math.sqrt(p * (1 - p) / whole + z * z / (4 * whole * whole))
    return max(0.0, middle - half), min(1.0, middle + half)


def share(part, whole):
    """"12 of 13 (92 %; 67 to 99)" of two lists."""
    if not whole:
        return "–"
    low, high = wilson(len(part), len(whole))
    return f"{len(part)} of {len(whole)} ({100 * len(part) / len(whole):.0f} %; {100 * low:.0f} to {100 * high:.0f})"
