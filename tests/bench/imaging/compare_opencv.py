#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""OpenCV's DIS flow and its variational refinement on the pairs that `bench_flow --write FOLDER` left.
Usage: compare_opencv.py FOLDER. Needs python3-opencv."""
import pathlib
import sys
import time

import cv2
import numpy

folder = pathlib.Path(sys.argv[1])
for path in sorted(folder.glob("*_1.png")):
    stem = path.name[:-6]
    first, second = (cv2.cvtColor(cv2.imread(str(folder / f"{stem}_{k}.png")), cv2.COLOR_BGR2GRAY) for k in (1, 2))
    truth = numpy.stack([numpy.fromfile(folder / f"{stem}_{c}.f32", numpy.float32).reshape(first.shape) for c in "uv"], axis=-1)
    margin = first.shape[1] // 40
    inner = (slice(margin, -margin), slice(margin, -margin))
    for name, make in (("DIS medium", cv2.DISOPTICAL_FLOW_PRESET_MEDIUM), ("DIS fine", None)):
        # "fine": every patch, finest scale, more refinement.
        dis = cv2.DISOpticalFlow_create(make if make is not None else cv2.DISOPTICAL_FLOW_PRESET_MEDIUM)
        if make is None:
            dis.setFinestScale(0)
            dis.setPatchStride(2)
            dis.setVariationalRefinementIterations(10)
            dis.setGradientDescentIterations(40)
        start = time.time()
        flow = dis.calc(first, second, None)
        refined = cv2.VariationalRefinement_create()
        refined.setFixedPointIterations(10)
        flow_refined = refined.calc(first, second, flow.copy())
        seconds = time.time() - start
        for label, f in ((name, flow), (name + " + refinement", flow_refined)):
            error = numpy.linalg.norm(f - truth, axis=-1)[inner]
            print(f"{stem:12s} {label:26s} {seconds:6.2f} s  mean {error.mean():.4f}  rms {numpy.sqrt((error ** 2).mean()):.4f}  95 % {numpy.percentile(error, 95):.4f} px")
