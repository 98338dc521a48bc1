#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Strips as shapely reads them from the written SVG: valid pieces that keep apart and lie on their sheets, as the report says.
Usage: other_readers.py PROGRAM. Needs shapely, which setup/apt_packages_test.txt names."""
import pathlib
import sys
import tempfile
import unittest

from shapely.geometry import Polygon

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from written_plans import read_svg, run


class Strips(unittest.TestCase):
    def test_pieces_are_valid_keep_apart_and_fit(self):
        with tempfile.TemporaryDirectory() as place:
            out = pathlib.Path(place)
            report = run(out, "zippable-baseline", "--sample", "star", "--width-mm", "15")
            layers = read_svg((out / "strips.svg").read_text())[1]
            strips = [Polygon(points) for _, points, _ in layers["cut"]]
            self.assertEqual(len(strips), report["pieces"])
            sheets = [Polygon(points) for name, points, _ in layers["note"] if name and name.startswith("sheet-")]
            for i, strip in enumerate(strips):
                self.assertTrue(strip.is_valid)
                self.assertTrue(any(sheet.contains(strip) for sheet in sheets))
                self.assertTrue(all(strip.distance(other) > 2 - 1e-3 for other in strips[:i]))
            self.assertAlmostEqual(sum(strip.length for strip in strips), report["cut_length_mm"], delta=0.01)
            self.assertAlmostEqual(min(2 * strip.area / strip.length for strip in strips), report["narrowest_mm"], delta=1e-3)
            self.assertLess(report["isometry_error"], 1e-9)


if __name__ == "__main__":
    unittest.main()
