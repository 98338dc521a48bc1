#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Do trends that others measured on formed sheets show in the simulation? Prints the table of docs/thermoform_published.md.

  published_trends.py build/formwright [--triangles 5000]

The mouthguards' casts are made here: a dental arch as a D of 60 x 50 mm with a ridge of teeth and a palate, its front as high as
published and its back 5 mm lower. Nothing is fitted: each row is asked of the thesis's material and
of the same with 5 and 10 % of its stiffness in a network that never flows."""
import argparse
import math
import statistics
import struct
import subprocess
import tempfile
from pathlib import Path

SHARES = (0, 0.05, 0.1)  # network_share: 0 is the thesis's law
OPENING_MM = 110  # sheets of 127 mm, held by a rim of 8.5 mm: an assumption, the publications here name distances to the frame
EVA = {"density_kg_per_m3": 940, "sheet_x_mm": 127, "sheet_y_mm": 127, "clamp_opening_x_mm": OPENING_MM, "clamp_opening_y_mm": OPENING_MM}
WIDTH_MM, DEPTH_MM = 60, 50


def arch(inset_mm):
    """The outline of the arch, `inset_mm` within it: half an ellipse in front (negative y), a straight back."""
    half_width, front, back = WIDTH_MM / 2 - inset_mm, 35 - inset_mm, DEPTH_MM - 35 - inset_mm
    curve = [math.pi * i / 96 for i in range(97)]
    points = [(-half_width * math.cos(a), -front * math.sin(a)) for a in curve]
    return points + [(half_width * (1 - 2 * i / 24), back) for i in range(25)]


def cast_model(front_height_mm, wall_deg=90, front_up_deg=0):
    """The cast as vertices and triangles, foremost at y = 0, and how far it was moved for that: (y, z). `wall_deg` is the angle between
    wall and base inside the cast, below 90 where it leans back."""
    lean = 1 / math.tan(math.radians(wall_deg))

    def top(y):
        return front_height_mm - 5 * (y + 35) / DEPTH_MM

    rings = []
    for inset, z in ((0, lambda y: 0), (0, top), (8, top), (11, lambda y: top(y) - 10)):
        rings.append([(x, y, z(y)) for x, y in arch(inset + z(-35) * lean)])
    # Tilted about its back edge. Walls go straight down from its base, as a wedge of putty does under a cast.
    angle = math.radians(front_up_deg)
    tilted = [[(x, y * math.cos(angle) + z * math.sin(angle), z * math.cos(angle) - y * math.sin(angle)) for x, y, z in ring] for ring in rings]
    lowest = min(z for _, _, z in tilted[0])
    rings = [[(x, y, 0) for x, y, _ in tilted[0]]] if front_up_deg else []
    rings += [[(x, y, z - lowest) for x, y, z in ring] for ring in tilted]
    front = min(y for ring in rings for _, y, _ in ring)
    rings = [[(x, y - front, z) for x, y, z in ring] for ring in rings]
    count = len(rings[0])
    vertices = [point for ring in rings for point in ring]
    faces = []
    for lower in range(len(rings) - 1):
        for i in range(count):
            a, b = lower * count + i, lower * count + (i + 1) % count
            faces += [(a, b, b + count), (a, b + count, a + count)]
    palate = len(vertices)
    last = rings[-1]
    vertices.append(tuple(statistics.fmean(point[axis] for point in last) for axis in range(3)))
    faces += [(palate, (len(rings) - 1) * count + i, (len(rings) - 1) * count + (i + 1) % count) for i in range(count)]
    return (vertices, faces), (front, lowest)


def minus(a, b):
    return tuple(p - q for p, q in zip(a, b))


def cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def truncated_pyramid(top_mm, height_mm, wall_deg):
    foot = top_mm / 2 + height_mm / math.tan(math.radians(wall_deg))
    corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    vertices = [(x * foot, y * foot, 0) for x, y in corners] + [(x * top_mm / 2, y * top_mm / 2, height_mm) for x, y in corners]
    faces = [(4, 5, 6), (4, 6, 7)]
    for i in range(4):
        j = (i + 1) % 4
        faces += [(i, j, 4 + j), (i, 4 + j, 4 + i)]
    return vertices, faces


class FormedSheet:
    """The sheet's vertices: place in mm, thickness as a share of the flat sheet's."""

    def __init__(self, program, model, flat_mm, values):
        vertices, faces = model
        with tempfile.TemporaryDirectory() as folder:
            mould = Path(folder) / "mould.obj"
            mould.write_text("".join("v %.9g %.9g %.9g\n" % v for v in vertices) + "".join("f %d %d %d\n" % tuple(i + 1 for i in f) for f in faces), encoding="utf-8")
            size = max(max(v[axis] for v in vertices) - min(v[axis] for v in vertices) for axis in range(3))
            flags = [text for name, value in {"up": "0,0,1", "size_mm": size, "sheet_thickness_mm": flat_mm, **values}.items()
                     for text in ("--" + name.replace("_", "-"), str(value))]
            subprocess.run([program, "thermoform-simulate", "--mould", mould, *flags, "--outputs", "sheet.ply", "--quiet", "--out", folder], check=True, capture_output=True)
            header, data = (Path(folder) / "sheet.ply").read_bytes().split(b"end_header\n", 1)
        words = header.decode().split()
        count, properties = int(words[words.index("vertex") + 1]), header.split(b"element face")[0].count(b"property double")
        rows = [struct.unpack_from(f"<{properties}d", data, 8 * properties * i) for i in range(count)]
        self.places, self.shares = [row[:3] for row in rows], [row[5] / flat_mm for row in rows]
        self.triangles = [struct.unpack_from("<3i", data, 8 * properties * count + 13 * i + 1) for i in range((len(data) - 8 * properties * count) // 13)]

    def share(self, where):
        """Mean thickness over the part of the surface where `where(x, y, z)` holds. Triangles are asked every millimetre, because one may
        reach over a whole wall."""
        total = weight = 0.0
        for corners in self.triangles:
            a, b, c = (self.places[i] for i in corners)
            parts = math.ceil(max(math.dist(a, b), math.dist(b, c), math.dist(c, a)))
            area = math.sqrt(sum(n * n for n in cross(minus(b, a), minus(c, a)))) / 2
            for i in range(parts):
                for j in range(parts - i):
                    u, v = (i + 1 / 3) / parts, (j + 1 / 3) / parts
                    if where(*(p + u * (q - p) + v * (r - p) for p, q, r in zip(a, b, c))):
                        share = sum(w * self.shares[k] for w, k in zip((1 - u - v, u, v), corners))
                        total, weight = total + share * area / parts**2, weight + area / parts**2
        if weight == 0:
            raise SystemExit("no part of the sheet lies in a measured region: ask for more triangles")
        return total / weight


class Mouthguard:
    """Thickness of a mouthguard, as a share of the sheet's, where the publications measure it."""

    def __init__(self, asked, front_height_mm=25, flat_mm=4.0, to_frame_mm=25, wall_deg=90, front_up_deg=0, **values):
        model, (moved_y, moved_z) = cast_model(front_height_mm, wall_deg, front_up_deg)
        front = -OPENING_MM / 2 + to_frame_mm
        centre = max(y for _, y, _ in model[0]) / 2
        sheet = FormedSheet(asked.program, model, flat_mm, {**EVA, **asked.values, "y_mm": front + centre, **values})
        lean, up = 1 / math.tan(math.radians(wall_deg)), math.radians(front_up_deg)

        def on_cast(x, y, z):
            """A place in the cast's own axes: distance behind its front and height over its base."""
            y, z = y - front + moved_y, z + moved_z
            return x, y * math.cos(up) - z * math.sin(up) + 35, z * math.cos(up) + y * math.sin(up)

        def labial(x, y, z):
            x, y, z = on_cast(x, y, z)
            return abs(x) < 6 and y < 4 + z * lean and front_height_mm - 12 < z < front_height_mm - 4

        def incisal(x, y, z):
            x, y, z = on_cast(x, y, z)
            return abs(x) < 6 and 0 < y - front_height_mm * lean < 8 and z > front_height_mm - 2

        def buccal(x, y, z):
            x, y, z = on_cast(x, y, z)
            return 32 < y < 44 and abs(x) > WIDTH_MM / 2 - z * lean - 4 and front_height_mm - 15 < z < front_height_mm - 7
        self.labial, self.incisal, self.buccal = (sheet.share(where) for where in (labial, incisal, buccal))


class Asked:
    """One hot sheet of which all trends are asked."""

    def __init__(self, program, triangles, network_share):
        self.program, self.values = program, {"triangles": triangles, "network_share": network_share}
        self.known = {}

    def mouthguard(self, **values):
        key = tuple(sorted(values.items()))
        if key not in self.known:
            self.known[key] = Mouthguard(self, **values)
        return self.known[key]

    def tray(self, depth_mm, wall_deg, flat_mm=1.5):
        """Thickness along the wall of a square tray over a positive mould, in the middle of its side: beside the top edge, half way, at
        the foot."""
        top = 80
        sheet = FormedSheet(self.program, truncated_pyramid(top, depth_mm, wall_deg), flat_mm, {**self.values, "density_kg_per_m3": 1050})
        slant = depth_mm / math.sin(math.radians(wall_deg))

        def band(low, high):
            def inside(x, y, z):
                along = (depth_mm - z) / depth_mm
                wall = top / 2 + (depth_mm - z) / math.tan(math.radians(wall_deg))
                return low <= along * slant <= high and min(abs(abs(x) - wall) + (0 if abs(y) < 15 else 9), abs(abs(y) - wall) + (0 if abs(x) < 15 else 9)) < 3
            return inside
        return [sheet.share(band(low, high)) for low, high in ((0, 5), (0.4 * slant, 0.6 * slant), (slant - 6, slant - 1))]


def percent(change):
    return f"{100 * change:+.0f} %".replace("-", "−")


def higher_model(asked):
    low, middle, high = (asked.mouthguard(front_height_mm=height) for height in (25, 30, 35))
    return f"labial {percent(middle.labial / low.labial - 1)}, {percent(high.labial / low.labial - 1)}; buccal {percent(middle.buccal / low.buccal - 1)}, {percent(high.buccal / low.buccal - 1)}"


def ordinary(asked):
    guard = asked.mouthguard()
    return f"incisal edge {percent(guard.incisal - 1)}, labial {percent(guard.labial - 1)}, buccal {percent(guard.buccal - 1)}"


def sheet_of_half(asked):
    thick, thin = asked.mouthguard(), asked.mouthguard(flat_mm=2.0)
    return f"labial {percent(thick.labial - 1)} and {percent(thin.labial - 1)}"


def nearer_the_frame(asked):
    return "labial " + ", ".join(percent(asked.mouthguard(to_frame_mm=distance).labial - 1) for distance in (40, 30, 20, 10))


def nearer_and_thinner(asked):
    changes = [asked.mouthguard(to_frame_mm=10, flat_mm=flat).labial - asked.mouthguard(to_frame_mm=25, flat_mm=flat).labial for flat in (4.0, 2.0)]
    return f"labial {percent(changes[0])} of 4 mm, {percent(changes[1])} of 2 mm"


def wall_angle(asked):
    return "labial " + ", ".join(percent(asked.mouthguard(wall_deg=angle).labial - 1) for angle in (85, 90, 95))


def tilted(asked):
    flat = asked.mouthguard(front_height_mm=20)
    return "labial " + ", ".join(percent(asked.mouthguard(front_height_mm=20, front_up_deg=angle).labial / flat.labial - 1) for angle in (15, 30, 45))


def extrusion(asked):
    across, along = asked.mouthguard(anisotropy=0.3), asked.mouthguard(anisotropy=-0.3)
    return f"labial {percent(along.labial - 1)} along, {percent(across.labial - 1)} across"


def along_the_wall(asked):
    return ", ".join(percent(share - 1) for share in asked.tray(50, 75))


def deeper_tray(asked):
    return "foot " + ", ".join(percent(asked.tray(depth, 75)[2] - 1) for depth in (30, 50, 70))


def steeper_tray(asked):
    return "half way " + ", ".join(percent(asked.tray(50, angle)[1] - 1) for angle in (85, 75, 60))


# As docs/thermoform_published.md names them.
HEIGHT, POSITION, FRAME, TILT, ANGLE, EXTRUSION, TRAY = "[MH22]", "[TB18]", "[TB21]", "[FI16]", "[MA17]", "[VF, TS]", "[HIPS]"
TRENDS = [
    ("cast 30 and 35 instead of 25 mm high", f"labial and buccal −6 to −7 %, −14 to −16 % {HEIGHT}", higher_model),
    ("usual cast, 25 mm from the frame", f"incisal edge about −60 %, labial −50 %, buccal −40 % {POSITION}", ordinary),
    ("sheet of 4 and of 2 mm, 25 mm from the frame", f"alike {POSITION}", sheet_of_half),
    ("40, 30, 20, 10 mm from the frame", f"thinner the nearer {FRAME}", nearer_the_frame),
    ("10 instead of 25 mm from the frame, sheet of 4 and of 2 mm", f"the thin sheet loses more {POSITION}", nearer_and_thinner),
    ("front wall at 85, 90, 95°", f"thickest at 85° {ANGLE}", wall_angle),
    ("front tilted up by 15, 30, 45°", f"thicker with the angle, +75 % at 45° {TILT}", tilted),
    ("stiffer along, or across, the cast's midline", f"extruded along: thicker, or thinner {EXTRUSION}", extrusion),
    ("wall of a tray over a positive mould: near the top edge, half way, foot", f"falls steeply near the edge, is even half way, falls a little at the clamp {TRAY}", along_the_wall),
    ("the tray 30, 50, 70 mm deep", f"thinner the deeper {TRAY}", deeper_tray),
    ("its wall at 85, 75, 60°", f"thicker the flatter {TRAY}", steeper_tray),
]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--triangles", type=int, default=5000)
    options = parser.parse_args()
    sheets = [Asked(options.program, options.triangles, share) for share in SHARES]
    print("| change | published | " + " | ".join(f"ours, network {share}" for share in SHARES) + " |\n|---|---|" + "---|" * len(sheets))
    for change, published, ours in TRENDS:
        print(f"| {change} | {published} | " + " | ".join(ours(sheet) for sheet in sheets) + " |", flush=True)


if __name__ == "__main__":
    main()
