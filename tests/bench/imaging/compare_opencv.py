#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""OpenCV's DIS flow and two rounds of its variational refinement on the pairs that `bench_flow --write FOLDER` left.
Every channel by itself, then averaged, so that OpenCV sees what variational_flow sees. Seconds are processor time.
OpenCV's flow knows no weights. Holes of the second picture are filled for it first: from their borders (Telea), or from
the first picture where the flow found with that filling says that it belongs.
Usage: compare_opencv.py FOLDER. Needs python3-opencv or opencv-python-headless."""
import pathlib
import sys
import time

import cv2
import numpy


def dis_medium():
    return cv2.DISOpticalFlow_create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM)


def dis_fine():
    dis = dis_medium()
    dis.setFinestScale(0)
    dis.setPatchStride(2)
    dis.setGradientDescentIterations(40)
    return dis


def refinement():
    refine = cv2.VariationalRefinement_create()
    refine.setAlpha(20)  # smoothness
    refine.setDelta(0)  # equal colours: the light changes across the pairs
    refine.setGamma(10)  # equal gradients
    refine.setSorIterations(20)
    return refine


def flow_to(second_places, flow):
    """The flow at the places of the second picture: where p + flow(p) = place, by repetition."""
    places = second_places.copy()
    for _ in range(20):
        there = cv2.remap(flow, places[..., 0], places[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        places = (second_places - there).astype(numpy.float32)
    return places


def filled_from(first, second, hole, flow):
    height, width = hole.shape
    places = numpy.stack(numpy.meshgrid(numpy.arange(width), numpy.arange(height)), axis=-1).astype(numpy.float32)
    places = flow_to(places, flow.astype(numpy.float32))
    seen = cv2.remap(first, places[..., 0], places[..., 1], cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
    return numpy.where(hole[..., None], seen, second)


def mean_over_channels(method, first, second, guess):
    flows = []
    for c in range(3):
        one, other = (numpy.ascontiguousarray(picture[..., c]) for picture in (first, second))
        flows.append(method.calc(one, other, None if guess is None else guess.copy()))
    return sum(flows) / 3


folder = pathlib.Path(sys.argv[1])
for path in sorted(folder.glob("*_1.png")):
    stem = path.name[:-6]
    first = cv2.imread(str(folder / f"{stem}_1.png"))
    second = cv2.imread(str(folder / f"{stem}_2.png"), cv2.IMREAD_UNCHANGED)
    hole = second[..., 3] == 0 if second.shape[2] == 4 else numpy.zeros(second.shape[:2], bool)
    second = numpy.ascontiguousarray(second[..., :3])
    truth = numpy.stack([numpy.fromfile(folder / f"{stem}_{c}.f32", numpy.float32).reshape(first.shape[:2]) for c in "uv"], axis=-1)
    margin = first.shape[1] // 40
    inner = (slice(margin, -margin), slice(margin, -margin))
    here = numpy.stack(numpy.meshgrid(numpy.arange(first.shape[1]), numpy.arange(first.shape[0])), axis=-1)
    there = numpy.clip(numpy.rint(here + truth).astype(int), 0, numpy.array(first.shape[1::-1]) - 1)
    seen = ~hole[there[..., 1], there[..., 0]][inner]
    fillings = {"": second}
    if hole.any():
        border = cv2.inpaint(second, hole.astype(numpy.uint8), 3, cv2.INPAINT_TELEA)
        rough = mean_over_channels(dis_medium(), first, border, None)
        fillings = {", filled from the border": border, ", filled from the pattern": filled_from(first, second, hole, rough)}
    for filling, picture in fillings.items():
        for name, dis in (("DIS medium", dis_medium()), ("DIS fine", dis_fine())):
            start = time.process_time()
            flow = mean_over_channels(dis, first, picture, None)
            for label in (name, name + " + refinement"):
                if label != name:
                    for _ in range(2):
                        flow = mean_over_channels(refinement(), first, picture, flow)
                seconds = time.process_time() - start
                error = numpy.linalg.norm(flow - truth, axis=-1)[inner]
                print(f"{stem:12s} {label + filling:50s} {seconds:6.2f} s  mean {error.mean():.4f}  of what is seen {error[seen].mean():.4f}  rms {numpy.sqrt((error ** 2).mean()):.4f}  95 % {numpy.percentile(error, 95):.4f} px")
