# SPDX-License-Identifier: GPL-3.0-or-later
"""Strengths that were found, beside those that were hidden. Signs do not count: hidden strengths are lengths."""
import math


def without_sign(strength, low, high):
    return (-strength, -high, -low) if strength < 0 else (strength, low, high)


def holds(strength, low, high, hidden):
    """Whether the interval has the hidden strength in it."""
    _, least, most = without_sign(strength, low, high)
    return least <= hidden <= most


def off_by(strength, hidden):
    """By which share the larger of the two is larger."""
    return math.exp(abs(math.log(abs(strength) / hidden))) - 1 if strength else math.inf


def with_interval(strength, low, high):
    strength, low, high = without_sign(strength, low, high)
    return f"{strength:.3g} ({low:.2g} to {high:.2g})"
