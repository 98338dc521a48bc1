// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// From a photographed scan of a formed sheet to where each point of the flat sheet went (thesis 4.2.3).
#include <optional>
#include <string>
#include <vector>

#include "evidence/registration/calibration_pattern.h"
#include "evidence/registration/corner_marks.h"
#include "evidence/registration/flat_scan.h"
#include "imaging/colour/colour_correction.h"
#include "imaging/flow/variational_flow.h"

namespace formwright {

enum class ScanCoordinates { rim, scan };
template <>
struct EnumNames<ScanCoordinates> {
  static constexpr std::array<std::string_view, 2> names{"rim", "scan"};
  static constexpr std::array<std::string_view, 2> labels{"Machine, by the rim", "As scanned"};
};

struct ScanRegistrationOptions : VariationalFlowOptions {
  double grid_mm = 4;
  ScanCoordinates coordinates = ScanCoordinates::rim;
  bool sheet_turned = false;
  double clamp_height_mm = 1;
  double sheet_thickness_mm = 1;
  double scan_unit_mm = 1;
  double scan_sigma_mm = 0.05;
  double max_sigma_mm = 1;
  std::string corners;
  int picture_px = 2048;
  int flatten_iterations = 60;

  static constexpr auto parameters = std::tuple_cat(
      std::tuple{
          parameter("grid_mm", &ScanRegistrationOptions::grid_mm, "Point spacing", unit::mm, 0.2, 100,
                    "Distance between measured points on the flat sheet. Smaller gives more points and takes longer.")
              .group("Points")
              .slider(1, 10),
          parameter(
              "coordinates", &ScanRegistrationOptions::coordinates, "Coordinates",
              "Coordinate system of the measured points. Machine, by the rim: the scan is moved so that its clamped rim lies where the machine holds it. As scanned: the scanner's own coordinates; also used if the scan shows no rim.")
              .group("Points"),
          parameter(
              "sheet_turned", &ScanRegistrationOptions::sheet_turned, "Sheet was turned",
              "Switch on if the sheet lay in the clamp rotated by half a turn (180°); the setup.json of the object must say the same.")
              .group("Points"),
          parameter("clamp_height_mm", &ScanRegistrationOptions::clamp_height_mm, "Clamp height", unit::mm, -500, 500,
                    "Height of the middle of the clamped sheet above the raised base plate.")
              .group("Points")
              .slider(0, 10),
          parameter(
              "sheet_thickness_mm", &ScanRegistrationOptions::sheet_thickness_mm, "Rim thickness", unit::mm, 0, 20,
              "Thickness of the sheet at the clamped rim. The scan shows the upper face, and this gives its distance from the middle of the sheet.")
              .group("Points")
              .slider(0.2, 3),
          parameter(
              "max_sigma_mm", &ScanRegistrationOptions::max_sigma_mm, "Largest uncertainty", unit::mm, 0.01, 100,
              "Points with a larger standard deviation than this are left out. Smaller keeps fewer, more reliable points.")
              .group("Points")
              .formerly("most_sigma_mm")
              .slider(0.2, 3),
          parameter("scan_sigma_mm", &ScanRegistrationOptions::scan_sigma_mm, "Scan noise", unit::mm, 0, 10,
                    "Standard deviation of the scanner's own error, added to that of every point. 0.05 mm is usual.")
              .group("Points")
              .slider(0, 0.5),
          parameter(
              "scan_unit_mm", &ScanRegistrationOptions::scan_unit_mm, "Unit of the scan", unit::mm, 0.0001, 10000,
              "Length in millimetres of one unit in the scan's file: 1 for millimetres, 1000 for metres, 25.4 for inches.")
              .group("Scan")
              .slider(0.1, 1000),
          parameter(
              "corners", &ScanRegistrationOptions::corners, "Corners",
              "Where the four corner marks lie in the scan's picture, if they are not found: x,y in pixels from the top left, in the order front left, front right, back right, back left. Example: 120,80 1900,95 1880,2010 110,1990.")
              .group("Scan"),
          parameter(
              "flatten_iterations", &ScanRegistrationOptions::flatten_iterations, "Flattening steps", unit::none, 0,
              1000,
              "Iterations of the as-rigid-as-possible method that lays the scan flat. More distort it less; 0 keeps the first, harmonic map.")
              .group("Scan")
              .advanced(),
          parameter(
              "picture_px", &ScanRegistrationOptions::picture_px, "Picture size", unit::none, 64, 8192,
              "Longer side, in pixels, of the two pictures that are compared. More finds smaller movements and takes longer.")
              .group("Flow")
              .slider(512, 4096)},
      inherit_parameters<ScanRegistrationOptions>(VariationalFlowOptions::parameters));
};

struct RegisteredPoint {
  Vec2 sheet_mm;  // on the flat sheet, centred on it
  Vec3 place_mm;
  double sigma_mm;  // standard deviation along the surface, per direction, and of the scan
};

struct ScanRegistration {
  std::vector<RegisteredPoint> points;
  int points_without_evidence = 0;
  FoundMarks marks;
  std::array<std::optional<Vec2>, 4>
      corner_px{};  // where the scan's picture shows them, from its top left; none without a picture
  std::array<double, 4>
      corner_residual_mm{};  // from each mark as found to where the registration has it; -1 where that is not known
  double plane_scale = 1;    // mean length on the sheet of 1 mm of the flat scan, at the corners
  ColourCorrection colours;
  int colour_samples = 0;
  double colour_error_levels = 0;      // root mean square over all compared pixels, all three channels
  double similarity = 0;               // correlation of scan and pattern once matched, at most 1
  double residual_correlation_px = 1;  // pixels over which what is left is alike
  double blur_px = 0;                  // by which the scan is less sharp than the print
  FlatScan flat;
  int holes = 0, other_parts = 0, scan_faces = 0;
  double first_displacement_rms_mm = 0;  // of the flow after the corners alone
  double last_displacement_rms_mm = 0;   // of the last correction
  std::optional<double> rim_rms_mm,
      rim_scale;  // of the rim's points from where the machine holds them; length there against length scanned
  bool in_machine_coordinates = false;
  Image aligned;       // the scan's colours in the sheet's frame
  Image displacement;  // how far each point had to be moved after the corners: hue is the direction, colour the length
  double displacement_full_mm = 0;  // of full colour
  std::vector<std::string> notes;
  double seconds_flatten = 0, seconds_marks = 0, seconds_draw = 0, seconds_flow = 0, seconds_points = 0;
};

/// `scan`: repaired, with its pictures. Faces look out of the printed side; a scan that looks the other way is turned.
/// Throws Error: invalid_input ("scan": not a sheet, no colours; "corners": marks not found, not four points),
/// could_not_solve (not the pattern's print, or too little of it), cancelled.
ScanRegistration register_scan(const Model& scan, const CalibrationPattern& pattern,
                               const ScanRegistrationOptions& options, Context& context);

}  // namespace formwright
