// SPDX-License-Identifier: GPL-3.0-or-later
// What evidence-register reads, makes and reports, without the code that does it: the page lists it before the module
// that runs it is loaded.
#include "evidence/registration/scan_registration.h"
#include "job/contract/model_input.h"
#include "job/contract/operation_options.h"
#include "job/operations/evidence/evidence_registration_operations.h"

namespace formwright {
namespace {

std::vector<InputInfo> inputs() {
  InputInfo scan = model_input_info();
  scan.name = "scan";
  scan.label = "Scan";
  scan.help = "A 3D scan of the formed sheet with its picture: GLB, OBJ with texture, or PLY with colours.";
  scan.accepts_sample = false;
  return {
      scan,
      {"pattern",
       "Pattern",
       "The pattern.json that evidence-pattern wrote together with the print.",
       {"json"},
       true,
       false,
       ""},
      {"material", "Material file", "The material file (MTL) that belongs to an OBJ model.", {"mtl"}, false, false, ""},
      {"texture",
       "Picture",
       "A PNG or JPEG picture that replaces the scan's own, placed by the scan's texture coordinates.",
       {"png", "jpg", "jpeg"},
       false,
       false,
       ""}};
}

std::vector<OutputInfo> outputs() {
  return {{"measured.csv", "text/csv", "Measured points",
           "Where each point of the flat sheet moved, with its uncertainty (format: docs/measured_data.md).", true},
          {"aligned.png", "image/png", "Scan on the sheet",
           "The colours of the scan mapped back to the flat sheet. It should look like the pattern.", true},
          {"flow.png", "image/png", "Displacement",
           "The displacement found beyond the four corners: hue is its direction, saturation its length.", true}};
}

std::vector<ReportField> report_fields() {
  return {
      {"points", "Measured points", "", "Number of measured points: rows of measured.csv."},
      {"points_without_evidence", "Points left out", "",
       "Number of points left out because they were not seen, too plain to match, or too uncertain."},
      {"sigma_median_mm", "Median uncertainty", "mm", "Median standard deviation of the points along the surface."},
      {"sigma_95_mm", "95 % of uncertainties below", "mm",
       "95 % of the points have a smaller standard deviation than this."},
      {"coordinates", "Coordinates", "",
       "Coordinate system of the measured points: rim (the machine's) or scan (the scanner's)."},
      {"rim_rms_mm", "Rim error", "mm",
       "Root mean square distance of the scanned rim from where the machine holds it; null if no rim was scanned."},
      {"rim_scale", "Scale of the rim", "",
       "Length on the flat sheet divided by the same length in the scanned rim; 1 is correct, null if no rim was scanned."},
      {"corner_likeness", "Match of the corner marks", "",
       "Correlation of each corner mark with the pattern, at most 1. 0 if it was not found or was given by hand."},
      {"corner_px", "Corners in the picture", "px",
       "Position of each corner mark in the scan's picture, x and y from the top left; null if the picture does not show it."},
      {"corner_residual_mm", "Corner errors", "mm",
       "Distance between each corner mark as found and its final position; -1 if unknown."},
      {"colour_rms_levels", "Colour correction error", "",
       "Difference of the mean colours that remains after colour correction, in grey levels from 0 to 255."},
      {"colour_error_levels", "Colour difference", "",
       "Root mean square colour difference between matched scan and pattern over all pixels, in grey levels from 0 to 255."},
      {"likeness", "Match", "", "Correlation of scan and pattern after matching; 1 is a perfect match."},
      {"blur_px", "Blur", "px", "How much less sharp the scan is than the print, in pixels of the compared pictures."},
      {"pixel_mm", "Compared pixel", "mm", "Length on the sheet of one pixel of the compared pictures."},
      {"displacement_first_mm", "First displacement", "mm",
       "Root mean square displacement found by the first comparison, beyond what the four corners give."},
      {"displacement_last_mm", "Last correction", "mm",
       "Root mean square displacement added by the last comparison. Small if the matching has converged."},
      {"flow_full_colour_mm", "Longest displacement shown", "mm",
       "Displacement that flow.png shows in its strongest colour."},
      {"flattening_stretch_rms", "Flattening stretch", "",
       "Root mean square stretch of the scan when it is laid flat; 0 is none."},
      {"flattening_flipped", "Flipped triangles", "",
       "Number of triangles that are upside down in the flattened scan."},
      {"plane_scale", "Scale by the corners", "",
       "Length on the sheet divided by the same length in the flattened scan, from the corner marks."},
      {"scan_faces", "Faces", "", "Number of triangles of the scan."},
      {"other_parts", "Other parts", "",
       "Number of parts of the scan that are not joined to the sheet and were left out."},
      {"holes", "Holes", "", "Number of holes in the scan of the sheet."},
      {"seconds_read", "Reading", "s", "Time for reading scan and picture."},
      {"seconds_flatten", "Flattening", "s", "Time for laying the scan flat."},
      {"seconds_marks", "Marks", "s", "Time for finding the corner marks."},
      {"seconds_draw", "Drawing", "s", "Time for drawing scan and pattern on the flat sheet."},
      {"seconds_flow", "Comparing", "s", "Time for comparing the pictures at three resolutions."},
      {"seconds_points", "Points", "s", "Time for measuring the points and drawing the pictures of the result."},
      {"peak_memory_mb", "Peak memory", "MB", "Largest amount of memory that the process used."},
      {"notes", "Notes", "", "What to know about the result, as sentences."}};
}

}  // namespace

Operation evidence_register_declaration() {
  Operation operation;
  operation.name = "evidence-register";
  operation.title = "Measure a scan";
  operation.summary =
      "Finds where every point of a printed sheet moved, from a scan of the formed sheet and its pattern.";
  operation.module = "formwright_pictures";
  operation.inputs = inputs();
  operation.outputs = outputs();
  operation.report = report_fields();
  declare_options<ScanRegistrationOptions>(operation);
  return operation;
}

}  // namespace formwright
