#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Our prints in other programs: Pillow for pictures, poppler for pages.

other_readers.py PRINT_TOOL PAPER MIRROR PRINT_SCALE PRINT_STRETCH_X PRINT_STRETCH_Y. Exits with 77 (skipped, for CTest) and a reason where a program is not
installed. Checks sizes in pixels and mm, where the picture lies on every page, that the pages put together are the
picture again, that marks lie where they are said to, and what is written on the pages. The last three are how much too large the printer prints,
and how much too long along one side alone: what it makes of the files has to be of the sheet's size again.
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

POINTS_PER_MM = 72 / 25.4
DOTS_PER_INCH = 150


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=300, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))} ended with {done.returncode}:\n{done.stdout}{done.stderr}")
    return done.stdout


def near(what, found, expected, tolerance):
    if not abs(found - expected) <= tolerance:
        sys.exit(f"{what} is {found}, should be {expected} within {tolerance}")


def matrices(pdf):
    """The cm operators that place pictures: one list of six numbers a page that has one."""
    import zlib

    data = pdf.read_bytes()
    placed = []
    for match in re.finditer(rb"stream\r?\n", data):
        end = data.find(b"endstream", match.end())
        try:
            text = zlib.decompress(data[match.end() : end]).decode("latin-1")
        except zlib.error:
            continue
        for matrix in re.findall(r"((?:-?[\d.]+ ){6})cm\s+/\w+ Do", text):
            placed.append([float(number) for number in matrix.split()])
    return placed


def check_png(folder, expected, image_module):
    for name in ("print.png", "picture.png"):
        image = image_module.open(folder / name)
        if list(image.size) != expected["pixels"] or image.mode != "RGB":
            sys.exit(f"{name} is {image.size} {image.mode}")
        for k in range(2):
            printed = expected["print_factors"][k] if name == "print.png" else 1
            # A file states whole pixels per metre: where a scale is made up for, half of one is lost.
            lost = 0.5 if printed != 1 else 0
            near(f"resolution of {name}", image.info["dpi"][k], expected["per_metre"] * 0.0254 * printed, 0.01 + lost * 0.0254)
            near(f"size of {name} in mm", image.size[k] / image.info["dpi"][k] * 25.4 * printed, expected["sheet_mm"][k], (510 + lost * expected["sheet_mm"][k]) / expected["per_metre"])
    image = image_module.open(folder / "print.png")
    sign = -1 if expected["mirrored"] else 1
    for mark in expected["marks"]:
        x = expected["pixels"][0] / 2 + sign * mark["place_mm"][0] * expected["per_metre"] / 1000
        y = expected["pixels"][1] / 2 - mark["place_mm"][1] * expected["per_metre"] / 1000
        box = [image.getpixel((int(x) + dx, int(y) + dy))[0] for dx in (-1, 0, 1) for dy in (-1, 0, 1)]
        if min(box) > 60:
            sys.exit(f"no mark {mark['name']} at {x}, {y}: {box}")


def check_pages(folder, expected, image_module):
    pdf = folder / "print.pdf"
    info = run("pdfinfo", "-f", 1, "-l", 1000, pdf)
    sizes = re.findall(r"Page\s+\d+ size:\s+([\d.]+) x ([\d.]+) pts", info)
    tiles = expected["tiles"]
    if len(sizes) != 2 * len(tiles):
        sys.exit(f"{len(sizes)} pages, should be {2 * len(tiles)}")
    for size in sizes:
        for k in range(2):
            near("page size in mm", float(size[k]) / POINTS_PER_MM, expected["page_mm"][k] * page_scale(expected)[k], 0.01)
    placed = matrices(pdf)
    if len(placed) != len(tiles):
        sys.exit(f"{len(placed)} pictures are placed, should be {len(tiles)}")
    pixel_mm = 1000 / expected["per_metre"]
    sign = -1 if expected["mirrored"] else 1
    for tile, (a, b, c, d, e, f) in zip(tiles, placed):
        width, height = (expected["pixels"][k] * pixel_mm for k in range(2))
        near("picture's width in mm", a / POINTS_PER_MM, sign * width, 0.01)
        near("picture's height in mm", d / POINTS_PER_MM, height, 0.01)
        near("picture's skew", abs(b) + abs(c), 0, 0)
        near("picture's left in mm", e / POINTS_PER_MM, tile["origin_mm"][0] - sign * width / 2, 0.01)
        near("picture's foot in mm", f / POINTS_PER_MM, tile["origin_mm"][1] - height / 2, 0.01)
    listed = run("pdfimages", "-list", pdf).splitlines()[2:]
    for line in listed:
        words = line.split()
        if [int(words[3]), int(words[4])] != expected["pixels"] or words[5] != "rgb":
            sys.exit(f"pdfimages finds {line}")
        for k in range(2):
            near("dots per inch", float(words[12 + k]), expected["per_metre"] * 0.0254 * expected["print_factors"][k], 1)
    text = run("pdftotext", "-raw", pdf, "-")
    words = ["FRONT"] + (["MIRRORED"] if expected["mirrored"] else [])
    # Words that lie across two pages are cut.
    words += [tile["name"] for tile in tiles] + ["JOIN A1"] if len(tiles) > 1 else ["CLAMP FRAME SEEN FROM ABOVE, TRUE SIZE"]
    for word in words:
        if word not in text:
            sys.exit(f"{word} is not on the pages:\n{text}")
    if not expected["mirrored"] and "MIRRORED" in text:
        sys.exit("the pages say MIRRORED, and are not")
    reassemble(folder, expected, image_module)


def page_scale(expected):
    """Paper of the sheet's size is as much smaller as what is drawn on it; other paper is not."""
    of_the_sheet = expected["page_mm"] == expected["sheet_mm"]
    return [1 / factor if of_the_sheet else 1 for factor in expected["print_factors"]]


def reassemble(folder, expected, image_module):
    """Draws every page and puts the tiles side by side: inside the opening, where there are no marks, it is the picture."""
    along_x, along_y = (DOTS_PER_INCH * factor for factor in expected["print_factors"])
    run("pdftoppm", "-rx", along_x, "-ry", along_y, "-png", "-l", len(expected["tiles"]), folder / "print.pdf", folder / "page")
    picture = image_module.open(folder / "picture.png").convert("RGB")
    pages = sorted(folder.glob("page-*.png"))
    scale = DOTS_PER_INCH / 25.4
    # Scaled, a tile's edge cuts through dots; these are on the neighbouring tile, too.
    dot_mm = 1 / scale if expected["print_factors"] != [1, 1] else 0
    seen = bytearray(picture.width * picture.height)
    wrong = compared = 0
    for tile, path in zip(expected["tiles"], pages):
        page = image_module.open(path).convert("RGB")
        page_pixels, picture_pixels = page.load(), picture.load()
        # The page's middle, which no scale of the printer moves, on the paper that comes out of it and in what was drawn.
        printed_mm = [side * own * factor / 2 for side, own, factor in zip(expected["page_mm"], page_scale(expected), expected["print_factors"])]
        drawn_mm = [side / 2 for side in expected["page_mm"]]
        for y in range(0, picture.height, 2):
            y_mm = (picture.height / 2 - y - 0.5) * 1000 / expected["per_metre"]
            if not max(tile["lower_mm"][1] + dot_mm, -118) < y_mm < min(tile["upper_mm"][1] - dot_mm, 118):
                continue
            v = int(page.height - (printed_mm[1] + tile["origin_mm"][1] + y_mm - drawn_mm[1]) * scale)
            for x in range(y % 3, picture.width, 3):
                x_mm = (x + 0.5 - picture.width / 2) * 1000 / expected["per_metre"]
                if not max(tile["lower_mm"][0] + dot_mm, -108) < x_mm < min(tile["upper_mm"][0] - dot_mm, 108):
                    continue
                found = page_pixels[int((printed_mm[0] + tile["origin_mm"][0] + x_mm - drawn_mm[0]) * scale), v]
                own = picture_pixels[x, y]
                # Poppler's dots are not ours: equal where the picture is plain about a point.
                around = [picture_pixels[min(max(x + dx, 0), picture.width - 1), min(max(y + dy, 0), picture.height - 1)] for dx in (-2, 2) for dy in (-2, 2)]
                seen[y * picture.width + x] = 1
                if any(other != own for other in around):
                    continue
                compared += 1
                wrong += max(abs(found[k] - own[k]) for k in range(3)) > 8
    inside = sum(
        1
        for y in range(0, picture.height, 2)
        for x in range(y % 3, picture.width, 3)
        if abs((x + 0.5 - picture.width / 2) * 1000 / expected["per_metre"]) < 107.5 and abs((y + 0.5 - picture.height / 2) * 1000 / expected["per_metre"]) < 117.5 and not seen[y * picture.width + x]
    )
    if inside:
        sys.exit(f"{inside} points of the picture are on no page")
    if compared < 100000 or wrong > compared * 1e-4:
        sys.exit(f"{wrong} of {compared} points differ on the pages")
    print(f"{compared} points on {len(pages)} pages agree but for {wrong}")


def main():
    if len(sys.argv) != 7:
        sys.exit(__doc__)
    try:
        from PIL import Image  # pylint: disable=import-outside-toplevel
    except ImportError:
        if sys.executable != "/usr/bin/python3" and pathlib.Path("/usr/bin/python3").exists():
            sys.exit(subprocess.run(["/usr/bin/python3", *sys.argv], check=False).returncode)
        print("skipped: Pillow is not installed")
        sys.exit(77)
    for program in ("pdfinfo", "pdfimages", "pdftotext", "pdftoppm"):
        if shutil.which(program) is None:
            print(f"skipped: {program} (poppler-utils) is not installed")
            sys.exit(77)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        expected = json.loads(run(sys.argv[1], folder, *sys.argv[2:]))
        check_png(folder, expected, Image)
        check_pages(folder, expected, Image)


if __name__ == "__main__":
    main()
