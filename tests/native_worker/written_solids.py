# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of written solids that share no code with the program: triangles as lists of three places each."""
import collections
import struct


def triangles_of_stl(stl):
    count, = struct.unpack_from("<I", stl, 80)
    assert len(stl) == 84 + 50 * count
    for k in range(count):
        numbers = struct.unpack_from("<12f", stl, 84 + 50 * k)[3:]
        yield [numbers[i:i + 3] for i in (0, 3, 6)]


def vertices_and_triangles_of_ply(data):
    header, body = data.split(b"end_header\n", 1)
    assert b"format binary_little_endian" in header
    element, counts, layout = None, {}, collections.defaultdict(str)
    for line in header.decode().splitlines():
        words = line.split()
        if words[0] == "element":
            element, counts[words[1]] = words[1], int(words[2])
        elif words[0] == "property" and words[1] != "list":
            layout[element] += {"double": "d", "float": "f", "uchar": "B", "int": "i"}[words[1]]
    size = struct.calcsize("<" + layout["vertex"])
    places = [struct.unpack_from("<" + layout["vertex"], body, k * size)[:3] for k in range(counts["vertex"])]
    faces = counts["vertex"] * size
    return places, [[places[i] for i in struct.unpack_from("<3i", body, faces + 13 * k + 1)] for k in range(counts["face"])]


def unpaired_and_volume(triangles):
    """Edges without their opposite, places compared as they stand, and the volume."""
    edges, volume = collections.Counter(), 0
    for corners in triangles:
        for i in range(3):
            edges[tuple(corners[i]), tuple(corners[(i + 1) % 3])] += 1
        (a, b, c), (d, e, f), (g, h, i) = corners
        volume += (a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)) / 6
    return sum(1 for (a, b), n in edges.items() if n != 1 or edges.get((b, a), 0) != 1), volume
