// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a maker chooses for a zippable: thesis chapter 5.
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>

#include "base/data/parameters.h"

namespace formwright {

enum class RibbonFabrics { one, two };
template <>
struct EnumNames<RibbonFabrics> {
  static constexpr std::array<std::string_view, 2> names{"one", "two"};
  static constexpr std::array<std::string_view, 2> labels{"One colour", "Two colours"};
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
  std::optional<double> min_radius_mm;
  WindingCourse winding_course = WindingCourse::even;
  std::optional<double> sample_mm;
  bool measure_distances = true;
  bool check_parts = false;

  /// Diameter of the holes at the tips: as given; else half the ribbon's width, or more where the ribbon's middle may
  /// not bend more tightly.
  double hole_mm() const {
    const double inner = min_radius_mm ? 2 * *min_radius_mm - width_mm : 0;
    return puncture_mm.value_or(inner > 0.5 * width_mm ? inner : 0.5 * width_mm);
  }

  static constexpr auto parameters = std::tuple{
      parameter(
          "width_mm", &ZippableOptions::width_mm, "Ribbon width", unit::mm, 0.1, 10000,
          "Approximate distance between one winding of the zipper and the next. Narrower follows the model better and needs a longer zipper; 15 to 20 mm is usual.")
          .slider(5, 100)
          .group("Ribbon"),
      parameter(
          "windings", &ZippableOptions::windings, "Windings", unit::none, 0.1, 1000,
          "Number of turns that the zipper makes around every part. Automatic: as many as the ribbon width gives.")
          .slider(1, 20)
          .group("Ribbon"),
      parameter(
          "part_windings", &ZippableOptions::part_windings, "Windings per part",
          "Number of turns for each part, separated by spaces, in the order of the parts, such as 3 0 2.5. 0 or a missing number: the same as for all parts.")
          .group("Ribbon")
          .advanced(),
      parameter(
          "size_mm", &ZippableOptions::size_mm, "Size", unit::mm, 1, 100000,
          "Largest dimension of the finished object. Automatic: the size in the file if it is from 50 to 3000 mm, else 300 mm.")
          .slider(50, 1000)
          .group("Ribbon"),
      parameter(
          "fabrics", &ZippableOptions::fabrics, "Fabrics",
          "One: the whole ribbon is cut from one fabric. Two colours: neighbouring bands alternate between two fabrics.")
          .group("Ribbon"),
      parameter(
          "parts_max", &ZippableOptions::parts_max, "Maximum number of parts", unit::none, 1, 40,
          "Largest number of cylinders that the model may be divided into. More follow limbs better and give more seams. 1 or 2: a single spiral over the whole model.")
          .slider(1, 12)
          .group("Parts"),
      parameter(
          "prominence_percent", &ZippableOptions::prominence_percent, "Smallest limb", unit::percent, 0.1, 100,
          "How far a limb must stand out to become a part of its own, in percent of the largest mean distance between one point of the surface and all others. Smaller finds shorter limbs; 8 % is usual.")
          .slider(2, 30)
          .group("Parts")
          .advanced(),
      parameter(
          "puncture_mm", &ZippableOptions::puncture_mm, "Hole at the tip", unit::mm, 0.01, 10000,
          "Largest diameter of the hole left open at the tip of each part. Automatic: half the ribbon width, or more if a smallest radius is set.")
          .slider(1, 50)
          .group("Parts"),
      parameter(
          "borders", &ZippableOptions::borders, "Borders of parts",
          "Straight: borders take the shortest way over the surface. Along creases: drawn borders snap to nearby edges, ridges and valleys, and automatic borders move into valleys.")
          .group("Parts"),
      parameter(
          "crease_degrees", &ZippableOptions::crease_degrees, "Smallest crease angle", unit::degrees, 1, 120,
          "How sharply the surface must bend at a line for it to count as a crease. Smaller finds weaker creases; 20° is usual.")
          .slider(5, 60)
          .group("Parts")
          .advanced(),
      parameter(
          "crease_mm", &ZippableOptions::crease_mm, "Width of creases", unit::mm, 0.001, 1000,
          "Width over which a crease may be rounded and still count. Automatic: twice the mean edge length, or a tenth of the ribbon width if that is more.")
          .slider(0.5, 20)
          .group("Parts")
          .advanced(),
      parameter(
          "traversal", &ZippableOptions::traversal, "Order of parts", unit::none, 1, 100000,
          "Which of the possible orders the zipper follows through the parts. 1 is the most even one; higher numbers are less even.")
          .slider(1, 50)
          .group("Zipper line"),
      parameter("start_part", &ZippableOptions::start_part, "Start in part", unit::none, 0, 40,
                "Number of the part where the zipper must start. 0: any part.")
          .slider(0, 12)
          .group("Zipper line"),
      parameter("end_part", &ZippableOptions::end_part, "End in part", unit::none, 0, 40,
                "Number of the part where the zipper must end. 0: any part.")
          .slider(0, 12)
          .group("Zipper line"),
      parameter(
          "min_radius_mm", &ZippableOptions::min_radius_mm, "Smallest radius", unit::mm, 0.1, 10000,
          "Smallest radius to which the centre line of the flat ribbon may bend; a stiff zipper needs more. Larger values enlarge the holes at the tips and may change the order of parts. Automatic: no limit.")
          .slider(5, 100)
          .group("Zipper line")
          .formerly("radius_least_mm"),
      parameter(
          "winding_course", &ZippableOptions::winding_course, "Windings follow",
          "Even: windings are equally spaced. Along creases: windings move, by less than half their spacing, onto creases that run in nearly the same direction.")
          .group("Zipper line"),
      parameter(
          "sample_mm", &ZippableOptions::sample_mm, "Sampling", unit::mm, 0.01, 1000,
          "Approximate distance between neighbouring corner points of the ribbon's edge. Smaller follows the model better and makes larger files. Automatic: a fifth of the ribbon width.")
          .slider(1, 20)
          .group("Zipper line")
          .advanced(),
      parameter("measure_distances", &ZippableOptions::measure_distances, "Measure distances",
                "Measures how far the zipped ribbon lies from the model. Switch it off to change windings faster.")
          .group("Zipper line")
          .advanced(),
      parameter(
          "check_parts", &ZippableOptions::check_parts, "Check parts only",
          "Stops after the model is divided and reports for every part whether a ribbon can cover it, and if not, why.")
          .group("Parts")
          .advanced()};
};

}  // namespace formwright
