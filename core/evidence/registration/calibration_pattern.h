// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The picture that is printed on a sheet to see where each of its points went (thesis 4.2.3): noise, colour patches and
// four corner marks. Sheet coordinates: mm, x to the right and y to the back, centred on the sheet.
#include <array>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "base/data/json.h"
#include "base/data/parameters.h"
#include "imaging/drawing/noise_pattern.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct CalibrationPatternOptions {
  int seed = 1;
  double sheet_x_mm = 240, sheet_y_mm = 260;
  double clamp_opening_x_mm = 220, clamp_opening_y_mm = 240;
  double finest_mm = 1.2, coarsest_mm = 40;
  double margin_mm = 3;

  static constexpr auto parameters = std::tuple{
      parameter(
          "seed", &CalibrationPatternOptions::seed, "Seed", unit::none, 0, 2147483647,
          "Number that selects the random noise, or which numbers the coded marks have. The same number gives the same pattern again.")
          .group("Pattern")
          .slider(1, 100),
      parameter(
          "finest_mm", &CalibrationPatternOptions::finest_mm, "Finest noise", unit::mm, 0.2, 20,
          "Spacing of the finest noise in the pattern. It must survive printing, heat and the camera: 1.2 mm is usual.")
          .group("Pattern")
          .slider(0.5, 4)
          .only_with("kind", "noise"),
      parameter(
          "coarsest_mm", &CalibrationPatternOptions::coarsest_mm, "Coarsest noise", unit::mm, 1, 500,
          "Spacing of the coarsest noise in the pattern. Each level between it and the finest is twice as coarse as the one before.")
          .group("Pattern")
          .slider(10, 80)
          .only_with("kind", "noise"),
      parameter("margin_mm", &CalibrationPatternOptions::margin_mm, "Margin", unit::mm, 0, 100,
                "Distance from the edge of the clamp opening inwards to the outermost marks.")
          .group("Pattern")
          .slider(0, 15),
      parameter("sheet_x_mm", &CalibrationPatternOptions::sheet_x_mm, "Sheet width", unit::mm, 60, 3000,
                "Width of the flat sheet, including the rim held by the clamp.")
          .group("Sheet")
          .slider(100, 600),
      parameter("sheet_y_mm", &CalibrationPatternOptions::sheet_y_mm, "Sheet length", unit::mm, 60, 3000,
                "Length of the flat sheet, front to back, including the rim held by the clamp.")
          .group("Sheet")
          .slider(100, 600),
      parameter("clamp_opening_x_mm", &CalibrationPatternOptions::clamp_opening_x_mm, "Opening width", unit::mm, 50,
                3000, "Width of the clamp's opening: the part of the sheet that is formed.")
          .group("Sheet")
          .slider(100, 600),
      parameter("clamp_opening_y_mm", &CalibrationPatternOptions::clamp_opening_y_mm, "Opening length", unit::mm, 50,
                3000, "Length of the clamp's opening, front to back: the part of the sheet that is formed.")
          .group("Sheet")
          .slider(100, 600)};
};

/// A disc of concentric rings, black and white: the same from all sides, unlike the other three.
struct CornerMark {
  std::string name;  // "front left", ...
  Vec2 centre_mm;
  double radius_mm = 8;  // of the white rim around the outermost black ring
  int code = 0;          // 0 to 3
};

/// Is a mark of this code black at `share` of its radius from the middle, 0 to 1?
bool mark_is_black(int code, double share);

struct ColourPatch {
  Vec2 centre_mm;
  double side_mm = 8;
  Rgba colour{};
};

/// All that is needed to draw it again.
struct CalibrationPattern {
  Vec2 sheet_mm{240, 260}, opening_mm{220, 240};
  std::uint32_t seed = 1;
  std::vector<double> scales_mm;
  double contrast = 0.2;
  std::array<CornerMark, 4> marks;  // front left, then counter-clockwise seen from above
  std::vector<ColourPatch> patches;
};

/// Throws Error{invalid_input}: an opening larger than the sheet, scales in the wrong order, no room within the margin.
CalibrationPattern make_calibration_pattern(const CalibrationPatternOptions& options);

/// width x height pixels of `pixel_mm`, the sheet's middle in the middle of the picture, y upwards in it. Every machine
/// draws the same bits.
Image draw_calibration_pattern(const CalibrationPattern& pattern, int width, int height, double pixel_mm,
                               const Context& context);

Json calibration_pattern_json(const CalibrationPattern& pattern);
/// Throws Error{invalid_input, "pattern"}, naming the key that is wrong or missing.
CalibrationPattern read_calibration_pattern(ByteView json);

}  // namespace formwright
