// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a maker chooses for a zippable: thesis chapter 5.
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>

#include "base/parameters.h"

namespace formwright {

enum class RibbonFabrics { one, two };
template <>
struct EnumNames<RibbonFabrics> {
  static constexpr std::array<std::string_view, 2> names{"one", "two"};
  static constexpr std::array<std::string_view, 2> labels{"One", "Two colours"};
};

enum class PartBorders { straight, creases };
template <>
struct EnumNames<PartBorders> {
  static constexpr std::array<std::string_view, 2> names{"straight", "creases"};
  static constexpr std::array<std::string_view, 2> labels{"Straight", "Along creases"};
};

enum class WindingCourse { even, creases };
template <>
struct EnumNames<WindingCourse> {
  static constexpr std::array<std::string_view, 2> names{"even", "creases"};
  static constexpr std::array<std::string_view, 2> labels{"Even", "Along creases"};
};

struct ZippableOptions {
  double width_mm = 20;
  std::optional<double> windings;
  std::string part_windings;
  std::optional<double> size_mm;
  RibbonFabrics fabrics = RibbonFabrics::one;
  int parts_max = 10;
  double prominence_percent = 8;
  std::optional<double> puncture_mm;
  PartBorders borders = PartBorders::straight;
  double crease_degrees = 20;
  std::optional<double> crease_mm;
  int traversal = 1;
  int start_part = 0, end_part = 0;
  std::optional<double> radius_least_mm;
  WindingCourse winding_course = WindingCourse::even;
  std::optional<double> sample_mm;
  bool measure_distances = true;
  bool check_parts = false;

  /// Diameter of the holes at the tips: as given; else half the ribbon's width, or more where the ribbon's middle may
  /// not bend more tightly.
  double hole_mm() const {
    const double inner = radius_least_mm ? 2 * *radius_least_mm - width_mm : 0;
    return puncture_mm.value_or(inner > 0.5 * width_mm ? inner : 0.5 * width_mm);
  }

  static constexpr auto parameters = std::tuple{
      parameter(
          "width_mm", &ZippableOptions::width_mm, "Ribbon width", unit::mm, 0.1, 10000,
          "Between one winding of the zipper and the next, about: narrower follows the model better and takes more zipper.")
          .slider(5, 100)
          .group("Ribbon"),
      parameter("windings", &ZippableOptions::windings, "Windings", unit::none, 0.1, 1000,
                "Turns of the zipper around every part, instead of as many as the width gives.")
          .slider(1, 20)
          .group("Ribbon"),
      parameter("part_windings", &ZippableOptions::part_windings, "Windings by part",
                "Turns around each part on its own, in the order of the parts, such as 3 0 2.5; 0 or none: as for all.")
          .group("Ribbon")
          .advanced(),
      parameter("size_mm", &ZippableOptions::size_mm, "Size", unit::mm, 1, 100000,
                "Largest dimension of the finished object; automatic: as in the file.")
          .slider(50, 1000)
          .group("Ribbon"),
      parameter("fabrics", &ZippableOptions::fabrics, "Fabrics",
                "Two colours: both bands of every Fermat spiral differ, and interleave when it is zipped up.")
          .group("Ribbon"),
      parameter("parts_max", &ZippableOptions::parts_max, "Most parts", unit::none, 1, 40,
                "Into how many cylinders the model is divided at most; 1 or 2: one spiral over everything.")
          .slider(1, 12)
          .group("Parts"),
      parameter("prominence_percent", &ZippableOptions::prominence_percent, "Least limb", unit::percent, 0.1, 100,
                "How far a limb must stand out to become a part, of the farthest tip's mean distance to everywhere.")
          .slider(2, 30)
          .group("Parts")
          .advanced(),
      parameter(
          "puncture_mm", &ZippableOptions::puncture_mm, "Puncture", unit::mm, 0.01, 10000,
          "Diameter of the hole at the tip of each part, at most; automatic: half the ribbon's width, more for a least radius.")
          .slider(1, 50)
          .group("Parts"),
      parameter(
          "borders", &ZippableOptions::borders, "Borders",
          "Along creases: drawn borders snap to edges, ridges and valleys near them; those that are found move into valleys.")
          .group("Parts"),
      parameter("crease_degrees", &ZippableOptions::crease_degrees, "Least crease", unit::degrees, 1, 120,
                "How much the surface bends across a crease, at least, for anything to follow it.")
          .slider(5, 60)
          .group("Parts")
          .advanced(),
      parameter(
          "crease_mm", &ZippableOptions::crease_mm, "Roundness of creases", unit::mm, 0.001, 1000,
          "Over what width a crease may be rounded off; automatic: two edges' length, or a tenth of the ribbon's width.")
          .slider(0.5, 20)
          .group("Parts")
          .advanced(),
      parameter("traversal", &ZippableOptions::traversal, "Order of parts", unit::none, 1, 100000,
                "Which of the possible orders the zipper takes through the parts; 1 is the most even one.")
          .slider(1, 50)
          .group("Curve"),
      parameter("start_part", &ZippableOptions::start_part, "Begins in part", unit::none, 0, 40,
                "Where the zipper begins: only orders that do are counted; 0: anywhere.")
          .slider(0, 12)
          .group("Curve"),
      parameter("end_part", &ZippableOptions::end_part, "Ends in part", unit::none, 0, 40,
                "Where the zipper ends: only orders that do are counted; 0: anywhere.")
          .slider(0, 12)
          .group("Curve"),
      parameter(
          "radius_least_mm", &ZippableOptions::radius_least_mm, "Least radius", unit::mm, 0.1, 10000,
          "How tightly the middle of the flat ribbon may bend; holes at the tips grow, and the first order that keeps it is taken.")
          .slider(5, 100)
          .group("Curve"),
      parameter(
          "winding_course", &ZippableOptions::winding_course, "Course of windings",
          "Along creases: windings move, by less than half their spacing, onto creases that run nearly as they do.")
          .group("Curve"),
      parameter("sample_mm", &ZippableOptions::sample_mm, "Sampling", unit::mm, 0.01, 1000,
                "Between corners of the ribbon along the zipper, about; automatic: a fifth of its width.")
          .slider(1, 20)
          .group("Curve")
          .advanced(),
      parameter("measure_distances", &ZippableOptions::measure_distances, "Measure distances",
                "Between the zipped ribbon and the model; takes longer than another number of windings does.")
          .group("Curve")
          .advanced(),
      parameter(
          "check_parts", &ZippableOptions::check_parts, "Check parts only",
          "Stops after the division; design.json then says of every part whether it is a cylinder, and if not, why.")
          .group("Parts")
          .advanced()};
};

}  // namespace formwright
