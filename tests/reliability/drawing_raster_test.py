#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A drawing's cut lies where a browser draws it: what `formwright laser-job` burns of drawing_cases.py, at 8 pixels a millimetre, against the pictures of
Chromium and Inkscape. Every pixel of ours is within 1.5 pixels of one of theirs, and theirs of ours.
Usage: drawing_raster_test.py PROGRAM [--all] [--keep FOLDER]
Without --all: the short form, Chromium only. Needs chromium (CHROMIUM names another), with --all inkscape, and Debian's numpy and Pillow."""
import argparse
import concurrent.futures
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy
from PIL import Image, ImageDraw, ImageFilter

from drawing_cases import CASES, HEIGHT_MM, WIDTH_MM

PIXELS_PER_MM = 8
FINER = 4  # our lines are drawn so much larger, and a pixel counts when a line touches it
CELL_MM = (WIDTH_MM + 5, HEIGHT_MM + 5)
COLUMNS = 8
MARGIN_MM = 100  # what reaches outside the page stays on the bed
SECONDS = 300


def ours(program, case, file, folder):
    """The lines of laser-job as a picture of True and False."""
    words = [program, "laser-job", "--drawing", file, "--kerf-mm", 0, "--overcut-mm", 0, "--x-mm", MARGIN_MM, "--y-mm", MARGIN_MM, "--bed-x-mm", 400,
             "--bed-y-mm", 400, "--outputs", "toolpath.json", "--out", folder]
    if case.unit:
        words += ["--user-unit", case.unit]
    answer = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=SECONDS)
    if answer.returncode != 0:
        raise SystemExit(f"{case.name}: laser-job ended with {answer.returncode}: {answer.stderr}")
    scale = PIXELS_PER_MM * FINER
    picture = Image.new("1", (WIDTH_MM * scale, HEIGHT_MM * scale))
    draw = ImageDraw.Draw(picture)
    for path in json.loads((folder / "toolpath.json").read_text())["paths"]:
        if path["kind"] == "work":
            points = path["points_mm"]
            draw.line([((x - MARGIN_MM) * scale, (HEIGHT_MM - (y - MARGIN_MM)) * scale) for x, y in zip(points[0::3], points[1::3])], fill=1)
    fine = numpy.asarray(picture).reshape(HEIGHT_MM * PIXELS_PER_MM, FINER, WIDTH_MM * PIXELS_PER_MM, FINER)
    return fine.any(axis=(1, 3))


def outlines(picture):
    """What is painted on white, areas reduced to their edges."""
    painted = numpy.asarray(picture.convert("RGB")).min(axis=2) < 190
    inside = numpy.asarray(Image.fromarray(painted).convert("L").filter(ImageFilter.MinFilter(3))) > 0
    return painted & ~inside


def chromium(files, folder):
    """One page with every drawing at its size, each on whole pixels."""
    page = ['<!doctype html><meta charset="utf-8"><style>body{margin:0;background:white}img{position:absolute;'
            f'width:{WIDTH_MM}mm;height:{HEIGHT_MM}mm}}</style>']
    for i, file in enumerate(files):
        x, y = i % COLUMNS * CELL_MM[0], i // COLUMNS * CELL_MM[1]
        page.append(f'<img src="{file.name}" style="left:{x}mm;top:{y}mm">')
    (folder / "page.html").write_text("\n".join(page))
    rows = (len(files) + COLUMNS - 1) // COLUMNS
    picture = folder / "chromium.png"
    window = [round(n * cell * 96 / 25.4) + 1 for n, cell in ((COLUMNS, CELL_MM[0]), (rows, CELL_MM[1]))]
    words = [os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("google-chrome"), "--headless=new", "--no-sandbox", "--disable-gpu",
             "--hide-scrollbars", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync", "--lang=en-US",
             f"--user-data-dir={folder / 'profile'}", f"--force-device-scale-factor={PIXELS_PER_MM * 25.4 / 96}", f"--window-size={window[0]},{window[1]}",
             f"--screenshot={picture}", (folder / "page.html").as_uri()]
    subprocess.run([str(word) for word in words], check=True, capture_output=True, timeout=SECONDS)
    whole = Image.open(picture)
    cells = []
    for i in range(len(files)):
        x, y = (n * cell * PIXELS_PER_MM for n, cell in ((i % COLUMNS, CELL_MM[0]), (i // COLUMNS, CELL_MM[1])))
        cells.append(whole.crop((x, y, x + WIDTH_MM * PIXELS_PER_MM, y + HEIGHT_MM * PIXELS_PER_MM)))
    return cells


def inkscape(files, folder):
    home = folder / "home"
    home.mkdir()
    environment = {**os.environ, "HOME": str(home), "INKSCAPE_PROFILE_DIR": str(home), "XDG_CACHE_HOME": str(home), "LANG": "en_US.UTF-8"}
    environment.pop("DISPLAY", None)
    subprocess.run(["inkscape", "--export-type=png", "--export-background=white", f"--export-dpi={PIXELS_PER_MM * 25.4}", "--export-area-page",
                    *map(str, files)], check=True, capture_output=True, timeout=SECONDS, env=environment)
    size = (WIDTH_MM * PIXELS_PER_MM, HEIGHT_MM * PIXELS_PER_MM)
    return [Image.open(file.with_suffix(".png")).crop((0, 0, *size)) for file in files]


def near(picture):
    """Within 1.5 pixels: the pixel itself and its eight neighbours."""
    return numpy.asarray(Image.fromarray(picture).convert("L").filter(ImageFilter.MaxFilter(3))) > 0


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--keep", type=pathlib.Path, help="folder for the files and, red ours, blue theirs, a picture of every case that differs")
    arguments = parser.parse_args()
    cases = CASES if arguments.all else [case for case in CASES if case.quick]
    renderers = {"chromium": chromium, "inkscape": inkscape} if arguments.all else {"chromium": chromium}
    failures = lacking = compared = 0
    with tempfile.TemporaryDirectory() as place:
        folder = arguments.keep or pathlib.Path(place)
        folder.mkdir(exist_ok=True)
        files = []
        for i, case in enumerate(cases):
            files.append(folder / f"case_{i:03d}.svg")
            files[-1].write_bytes(case.file())
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            lines = list(pool.map(lambda i: ours(arguments.program, cases[i], files[i], folder / f"job_{i:03d}"), range(len(cases))))
        for name, render in renderers.items():
            for i, picture in enumerate(render(files, folder)):
                case = cases[i]
                if name in case.lacking:
                    lacking += 1
                    print(f"not asked: {case.name}: {name} {case.lacking[name]}")
                    continue
                compared += 1
                theirs = outlines(picture)
                only_ours, only_theirs = lines[i] & ~near(theirs), theirs & ~near(lines[i])
                if not lines[i].any() or only_ours.any() or only_theirs.any():
                    failures += 1
                    print(f"DIFFERS: {case.name} (case_{i:03d}) from {name}: {only_ours.sum()} pixels only ours, {only_theirs.sum()} only theirs, "
                          f"{lines[i].sum()} ours, {theirs.sum()} theirs")
                    if arguments.keep:
                        both = numpy.full((*theirs.shape, 3), 255, numpy.uint8)
                        both[theirs] = (120, 120, 255)
                        both[lines[i]] = (255, 120, 120)
                        both[only_ours] = (200, 0, 0)
                        both[only_theirs] = (0, 0, 200)
                        Image.fromarray(both).save(folder / f"differs_{i:03d}_{name}.png")
    print(f"{len(cases)} drawings, {compared} pictures compared at {PIXELS_PER_MM} pixels a mm, {lacking} not asked, {failures} differ")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
