#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What OpenCV makes of two steps of registration that the program does by itself: the map of four corners, and the masked
correlation of a corner mark. Prints errors and seconds of processor time. Usage: compare_opencv_marks.py.
Needs python3-opencv or opencv-python-headless."""
import time

import cv2
import numpy

random = numpy.random.default_rng(2026)


def solved_in_double(source, target):
    """The same eight equations as `homography` in core/evidence/registration/corner_marks.cpp."""
    rows, right = [], []
    for (x, y), (u, v) in zip(source, target):
        rows += [[x, y, 1, 0, 0, 0, -u * x, -u * y], [0, 0, 0, x, y, 1, -v * x, -v * y]]
        right += [u, v]
    return numpy.append(numpy.linalg.solve(numpy.array(rows), right), 1).reshape(3, 3)


def worst_miss_mm(solve):
    """Largest distance of a mapped corner from its target, over 1000 sheets of 120 x 130 mm."""
    corners = numpy.array([[-60.0, -65], [60, -65], [60, 65], [-60, 65]])
    worst = 0.0
    for _ in range(1000):
        source, target = (corners + random.normal(0, 5, (4, 2)) for _ in range(2))
        mapped = (solve(source, target) @ numpy.column_stack([source, numpy.ones(4)]).T).T
        worst = max(worst, numpy.abs(mapped[:, :2] / mapped[:, 2:] - target).max())
    return worst


def by_opencv(source, target):
    return cv2.getPerspectiveTransform(source.astype(numpy.float32), target.astype(numpy.float32))


print(f"four corners, double     {worst_miss_mm(solved_in_double):.1e} mm")
print(f"four corners, OpenCV     {worst_miss_mm(by_opencv):.1e} mm")

# As find_marks looks for them: a mark is 12 pixels in radius, which makes a sheet of 120 x 130 mm 220 pixels; four marks, three channels. All
# five sizes everywhere, and the middle one alone, which rules out most places.
cv2.setNumThreads(1)
side, radius = 220, 12
for sizes in (5, 1):
    picture = random.random((side, side, 3), dtype=numpy.float32)
    y, x = numpy.mgrid[-radius:radius + 1, -radius:radius + 1]
    mask = (numpy.hypot(x, y) <= radius).astype(numpy.float32)
    mark = (numpy.hypot(x, y) % 6 < 3).astype(numpy.float32)
    start = time.process_time()
    for _ in range(4 * sizes):
        for c in range(3):
            cv2.matchTemplate(numpy.ascontiguousarray(picture[..., c]), mark, cv2.TM_CCOEFF_NORMED, mask=mask)
    print(f"marks, OpenCV, {sizes} sizes   {time.process_time() - start:.3f} s")
