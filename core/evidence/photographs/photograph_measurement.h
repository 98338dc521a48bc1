// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// From photographs of a formed sheet with coded marks to where the marks went.
#include <array>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "base/bytes.h"
#include "base/context.h"
#include "base/data/parameters.h"
#include "evidence/photographs/camera.h"
#include "evidence/photographs/mark_sheet.h"

namespace formwright {

struct PhotographOptions {
  double board_height_mm = 10;
  double board_check_mm = 0;
  double board_check_sigma_mm = 0.1;
  double max_sigma_mm = 1;
  double min_angle_deg = 5;

  static constexpr auto parameters = std::tuple{
      parameter(
          "board_height_mm", &PhotographOptions::board_height_mm, "Height of the board", unit::mm, -500, 500,
          "Height of the printed side of the strips above the raised base plate. With the strips on the clamp frame: the clamp height plus the frame above it.")
          .group("Board")
          .slider(0, 40),
      parameter(
          "board_check_mm", &PhotographOptions::board_check_mm, "Measured check length", unit::mm, 0, 3000,
          "What a ruler says of the length printed below the front strip, from the first mark's outer edge to the last one's. 0: the board was printed at exactly 100 %.")
          .group("Board")
          .slider(0, 300),
      parameter(
          "board_check_sigma_mm", &PhotographOptions::board_check_sigma_mm, "Error of the check length", unit::mm, 0,
          10,
          "Standard deviation of the check length, which makes all lengths wrong alike. It is added to every point's uncertainty. A steel ruler: 0.1 mm.")
          .group("Board")
          .slider(0, 0.5),
      parameter(
          "max_sigma_mm", &PhotographOptions::max_sigma_mm, "Largest uncertainty", unit::mm, 0.01, 100,
          "Points with a larger standard deviation than this are left out. Smaller keeps fewer, more reliable points.")
          .group("Points")
          .slider(0.1, 3),
      parameter(
          "min_angle_deg", &PhotographOptions::min_angle_deg, "Smallest angle", unit::degrees, 0.5, 60,
          "Points are left out if no two photographs see them from directions this far apart. At small angles heights are uncertain.")
          .group("Points")
          .slider(2, 20)};
};

struct Photograph {
  std::string input, file_name;  // input: for errors
  ByteView bytes;
};

struct PhotographedPoint {
  int mark = 0, corner = 0;  // index into MarkSheet::marks; PlacedMark::corner_mm
  Vec2 sheet_mm;
  Vec3 place_mm;
  double sigma_mm;  // per direction, on the average over the three
};

/// What became of a mark of the sheet: the best of its corners.
enum class MarkSight { measured, uncertain, small_angle, seen_once, unclear, not_seen };
template <>
struct EnumNames<MarkSight> {
  static constexpr std::array<std::string_view, 6> names{"measured",  "uncertain", "small_angle",
                                                         "seen_once", "unclear",   "not_seen"};
};

struct CameraReport {
  std::string file_name;
  int width = 0, height = 0;
  int sheet_marks = 0, board_marks = 0;
  bool used = false;
  double rms_px = 0;
  Vec3 centre_mm{0, 0, 0};
  int lens = -1;
};

struct PhotographMeasurement {
  std::vector<PhotographedPoint> points;
  std::vector<MarkSight> sights;      // per mark of the sheet
  std::vector<int> photographs_of;    // per mark: in how many of the photographs used its corners were found
  std::vector<CameraReport> cameras;  // one per photograph that was given
  std::vector<Lens> lenses;
  double rms_px = 0;  // of what is left between corners as seen and as explained
  double noise = 0;   // how many times larger the errors are than the edges of the marks let expect
  int observations = 0, outliers = 0;
  double board_scale = 1;      // as printed, of nominal
  double board_misfit_mm = 0;  // RMS shift of the strips from where they should lie
  std::vector<std::string> notes;
  double seconds_find = 0, seconds_solve = 0;
};

/// Throws Error: invalid_input (photographs: fewer than two usable, no marks, no board, another sheet's, mirrored; not
/// a picture), could_not_solve (the photographs do not determine the cameras), cancelled.
PhotographMeasurement measure_photographs(std::span<const Photograph> photographs, const MarkSheet& sheet,
                                          const PhotographOptions& options, Context& context);

/// The flat sheet seen from above with every mark in the colour of what became of it. `pixel_mm`: side of a pixel.
Image draw_sights(const MarkSheet& sheet, const PhotographMeasurement& measurement, double pixel_mm);

}  // namespace formwright
