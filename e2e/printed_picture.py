# SPDX-License-Identifier: GPL-3.0-or-later
"""printed_picture.py PRINT.pdf PICTURE.png MARGINS: what a printer was given, rendered by poppler, put together again and laid beside the
picture at true size. Prints the sheet's size, the mean difference in grey levels, and by how many millimetres the best shift is off."""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

from PIL import Image, ImageChops, ImageFilter, ImageStat

DPI, OVERLAP_MM = 127, 10  # five pixels a millimetre
PX = DPI / 25.4
pdf, picture_path, margins = sys.argv[1], sys.argv[2], json.loads(sys.argv[3])
info = subprocess.run(["pdfinfo", pdf], check=True, capture_output=True, text=True).stdout
sheet = [float(v) * 25.4 / 72 for v in re.search(r"Page size: +([\d.]+) x ([\d.]+)", info).groups()]
if sheet[0] > sheet[1]:  # lies sideways: the wider of both on either side
    across, along = max(margins["top"], margins["bottom"]), max(margins["left"], margins["right"])
    left = right = across
    top = bottom = along
else:
    left, right, top, bottom = (margins[side] for side in ("left", "right", "top", "bottom"))
with tempfile.TemporaryDirectory() as folder:
    subprocess.run(["pdftoppm", "-r", str(DPI), "-gray", "-png", pdf, f"{folder}/page"], check=True)
    pages = [Image.open(p).convert("L").copy() for p in sorted(pathlib.Path(folder).glob("page-*.png"))]
source = Image.open(picture_path)
size_mm = [n / d * 25.4 for n, d in zip(source.size, source.info["dpi"])]
flat = Image.new("RGB", source.size, "white")
flat.paste(source.convert("RGBA"), mask=source.convert("RGBA").getchannel("A"))
picture = flat.convert("L").resize([round(v * PX) for v in size_mm], Image.LANCZOS)
room = (sheet[0] - left - right, sheet[1] - top - bottom)
columns = 1 if size_mm[0] <= room[0] else 1 + -int(-(size_mm[0] - room[0]) // (room[0] - OVERLAP_MM))
whole = Image.new("L", picture.size, 255)
for i, page in enumerate(pages):
    c, r = i % columns, i // columns
    part = page.crop([round(v * PX) for v in (left, top, left + room[0], top + room[1])])
    whole.paste(part, (round(c * (room[0] - OVERLAP_MM) * PX), round(r * (room[1] - OVERLAP_MM) * PX)))


def difference(dx, dy):
    moved = ImageChops.offset(whole, dx, dy).filter(ImageFilter.BoxBlur(1))
    inner = (10, 10, whole.width - 10, whole.height - 10)
    return ImageStat.Stat(ImageChops.difference(moved, picture.filter(ImageFilter.BoxBlur(1))).crop(inner)).mean[0]


best = min((difference(dx, dy), dx, dy) for dx in range(-3, 4) for dy in range(-3, 4))
print(json.dumps({"sheet_mm": sheet, "off_mean": difference(0, 0), "shifted_mm": max(abs(best[1]), abs(best[2])) / PX}))
