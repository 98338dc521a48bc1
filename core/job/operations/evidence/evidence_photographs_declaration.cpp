// SPDX-License-Identifier: GPL-3.0-or-later
// What evidence-photographs reads, makes and reports, without the code that does it: the page lists it before the
// module that runs it is loaded.
#include "evidence/photographs/photograph_measurement.h"
#include "job/contract/operation_options.h"
#include "job/operations/evidence/evidence_registration_operations.h"

namespace formwright {
namespace {

std::vector<InputInfo> photographs_inputs() {
  InputInfo photograph;
  photograph.name = "photograph";
  photograph.label = "Photographs";
  photograph.help =
      "Two or more photographs (JPEG or PNG) of the formed sheet with the printed strips in view, from different sides, with one camera that does not zoom.";
  photograph.extensions = {"jpg", "jpeg", "png"};
  photograph.repeatable = true;
  return {photograph,
          {"pattern",
           "Pattern",
           "The pattern.json that evidence-pattern wrote together with the print of coded marks.",
           {"json"},
           true,
           false,
           ""}};
}

std::vector<OutputInfo> photographs_outputs() {
  return {
      {"measured.csv", "text/csv", "Measured points",
       "Where each corner of the marks moved, with its uncertainty (format: docs/measured_data.md).", true},
      {"seen.png", "image/png", "What was seen",
       "The flat sheet from above. Green: measured. Frames in yellow, orange and red: uncertain, seen once, not seen.",
       true}};
}

std::vector<ReportField> photographs_report_fields() {
  return {
      {"points", "Measured points", "", "Number of measured points, four for each mark: rows of measured.csv."},
      {"marks", "Marks", "", "Number of marks on the sheet."},
      {"marks_measured", "Marks measured", "", "Number of marks of which at least one corner was measured."},
      {"marks_uncertain", "Marks too uncertain", "", "Number of marks left out because of their uncertainty."},
      {"marks_small_angle", "Marks at a small angle", "",
       "Number of marks that were seen from nearly the same direction only."},
      {"marks_seen_once", "Marks seen once", "", "Number of marks found in one photograph only."},
      {"marks_unclear", "Marks unclear", "", "Number of marks that were read but are not clear enough to measure."},
      {"marks_not_seen", "Marks not seen", "", "Number of marks that were found in no photograph."},
      {"marks_left_out", "Left out", "",
       "Marks that were not measured: number, place on the sheet in mm, reason, and photographs in which they were found."},
      {"photographs_a_mark", "Photographs per mark", "",
       "Mean number of photographs in which a measured mark was found."},
      {"sigma_median_mm", "Median uncertainty", "mm", "Median standard deviation of the points, per direction."},
      {"sigma_95_mm", "95 % of uncertainties below", "mm",
       "95 % of the points have a smaller standard deviation than this."},
      {"reprojection_rms_px", "Remaining error", "px",
       "Root mean square difference between the corners as seen and as computed, per direction."},
      {"noise", "Noise", "",
       "How many times larger the remaining errors are than the sharpness of the marks' edges lets expect. Around 1 is usual."},
      {"observations", "Corners seen", "", "Number of corners in all photographs that were used."},
      {"outliers", "Corners rejected", "", "Number of corners that do not fit the others, for example in glare."},
      {"photographs", "Photographs", "",
       "For every photograph: file, marks of sheet and board found in it, whether it was used, remaining error and camera's place."},
      {"lenses", "Lens", "",
       "Focal length in pixels and as on a camera with film of 36 mm, principal point, radial distortion k1 and k2; one for each size of photograph."},
      {"board_scale", "Scale of the board", "", "Length of the board as printed divided by the nominal one."},
      {"board_misfit_mm", "Strips off their place", "mm",
       "Root mean square distance of the strips from where they should lie. The machine's origin is uncertain by about a quarter of it."},
      {"seconds_find", "Finding marks", "s", "Time for reading the photographs and finding the marks."},
      {"seconds_solve", "Solving", "s", "Time for finding cameras and points."},
      {"peak_memory_mb", "Peak memory", "MB", "Largest amount of memory that the process used."},
      {"notes", "Notes", "", "What to know about the result, as sentences."}};
}

}  // namespace

Operation evidence_photographs_declaration() {
  Operation operation;
  operation.name = "evidence-photographs";
  operation.title = "Measure photographs";
  operation.summary =
      "Finds where the coded marks of a printed sheet moved, from photographs of the formed sheet with a printed board in view.";
  operation.module = "formwright_pictures";
  operation.inputs = photographs_inputs();
  operation.outputs = photographs_outputs();
  operation.report = photographs_report_fields();
  declare_options<PhotographOptions>(operation);
  return operation;
}

}  // namespace formwright
