#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the PNG files of a folder small: colours from a palette, the fewest that keep each file below 150 kB."""
import pathlib
import sys

from PIL import Image

MAX_BYTES = 150_000


def shrink(path: pathlib.Path) -> None:
    picture = Image.open(path).convert("RGB")
    for colours in (256, 128, 64, 32):
        small = picture.quantize(colours, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.FLOYDSTEINBERG if colours < 256 else Image.Dither.NONE)
        small.save(path, optimize=True)
        if path.stat().st_size <= MAX_BYTES:
            break
    print(f"{path.name}  {path.stat().st_size} bytes, {colours} colours")


def main() -> int:
    for path in sorted(pathlib.Path(sys.argv[1]).glob("*.png")):
        if path.stat().st_size > MAX_BYTES:
            shrink(path)
    return 0


if __name__ == "__main__":
    sys.exit(main())
