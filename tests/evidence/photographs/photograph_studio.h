// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Virtual photographs of a formed sheet with coded marks: a bump known by formula, strips on the frame, a phone's lens
// and its faults. It shares nothing with the code under test but the list of printed marks.
#include <array>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "evidence/photographs/mark_sheet.h"

namespace formwright::test {

/// Height peak_mm (1 - (r / radius)^2)^2 over the machine's plane, on a sheet that was drawn towards the middle: the
/// point at r comes from the flat sheet's radius r (1 - draw (1 - (r / radius)^2)^2).
struct Bump {
  double base_mm = 1.5, peak_mm = 35, radius_mm = 95, draw = 0.25;

  double height_mm(const Vec2& machine_mm) const;
  Vec3 normal(const Vec2& machine_mm) const;
  Vec2 sheet_mm(const Vec2& machine_mm) const;
  /// Where a point of the flat sheet went, by bisection.
  Vec3 place_mm(const Vec2& sheet_mm) const;
};

struct Scene {
  MarkSheet sheet;
  Bump bump;
  double board_z_mm = 12;
  double board_scale = 1;
  std::array<Vec2, 4> strip_shift_mm{Vec2(0, 0.7), Vec2(0.8, 0), Vec2(0, -0.7), Vec2(-0.8, 0)};
  std::array<double, 4> strip_turn_rad{0.006, -0.004, -0.006, 0.004};
  bool has_board = true;
  double gloss = 0;     // brightness of the lamp's reflection in the sheet, 1: white
  double uneven = 0.3;  // by how much the light falls from one side to the other
};

struct Phone {
  int width = 1600, height = 1200;
  double focal = 0.8;        // of the longer side
  Vec2 centre_off_px{0, 0};  // principal point from the middle
  double k1 = 0.08, k2 = -0.12;
  double defocus_px = 0.7;  // standard deviation of the blur
  Vec2 motion_px{0, 0};     // way of the picture during the exposure
  double noise_levels = 2;  // of 255, at white
  int samples = 2;          // per pixel and direction
  int jpeg_quality = 92;    // 0: PNG
  bool mirrored = false;
};

/// Where a camera stands and what it looks at, in machine coordinates.
struct View {
  Vec3 from_mm, at_mm;
  double roll_rad = 0;
};

/// `count` views from a ring around the sheet; elevations alternate.
std::vector<View> ring_of_views(int count, double distance_mm = 430, double elevation_deg = 52);

/// The file of one photograph.
Bytes photograph(const Scene& scene, const Phone& phone, const View& view, std::uint64_t seed);

/// The ideal picture coordinates of a point, by the formula alone.
Vec2 pictured(const Phone& phone, const View& view, const Vec3& point_mm);

MarkSheet small_mark_sheet();

}  // namespace formwright::test
