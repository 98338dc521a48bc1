// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/sha256.h"
#include "evidence/registration/calibration_pattern.h"
#include "imaging/picture/png_writer.h"
#include "job/contract/operation_options.h"
#include "job/operations/evidence/evidence_registration_operations.h"
#include "job/contract/model_input.h"
#include "thermoform/print/print_pages.h"

namespace formwright {
namespace {

struct EvidencePatternOptions : CalibrationPatternOptions {
  double dots_per_inch = 300;
  bool mirror = false;
  Paper paper = Paper::sheet;
  double paper_margin_mm = 5;
  double overlap_mm = 10;

  static constexpr auto parameters = std::tuple_cat(
      inherit_parameters<EvidencePatternOptions>(CalibrationPatternOptions::parameters),
      std::tuple{
          parameter(
              "dots_per_inch", &EvidencePatternOptions::dots_per_inch, "Resolution", unit::dots_per_inch, 36, 1200,
              "Dots per inch of the printed pattern. 300 is as fine as transfer paper can hold; more makes larger files.")
              .group("Print")
              .slider(100, 600),
          parameter(
              "mirror", &EvidencePatternOptions::mirror, "Mirror horizontally",
              "Swaps left and right in the printed files, as transfer paper needs. The description in pattern.json stays as seen on the sheet.")
              .group("Print"),
          parameter(
              "paper", &EvidencePatternOptions::paper, "Paper",
              "Paper size of the PDF. If the paper is smaller than the sheet, the pattern is split over several pages to be joined.")
              .group("Paper"),
          parameter("paper_margin_mm", &EvidencePatternOptions::paper_margin_mm, "Paper margin", unit::mm, 0, 50,
                    "White rim that the printer cannot print on. Not used if the paper is the size of the sheet.")
              .group("Paper")
              .slider(0, 15),
          parameter(
              "overlap_mm", &EvidencePatternOptions::overlap_mm, "Overlap", unit::mm, 0, 50,
              "Width of the strip that neighbouring pages share, so that they can be glued together. 10 mm is usual.")
              .group("Paper")
              .slider(0, 30)});
};

std::vector<OutputInfo> evidence_pattern_outputs() {
  return {{"pattern.png", "image/png", "Pattern", "The pattern for the whole sheet. The file contains its true size.",
           true},
          {"pattern.pdf", "application/pdf", "Pages", "The pattern at true size on the chosen paper. Print at 100 %.",
           true},
          {"pattern.json", "application/json", "Description",
           "The description of the pattern that evidence-register needs later. Keep it.", true}};
}

std::vector<ReportField> evidence_pattern_report_fields() {
  return {
      {"sheet_mm", "Sheet", "mm", "Width and length of the flat sheet."},
      {"picture_pixels", "Pixels", "", "Width and height of the picture in pixels."},
      {"dots_per_inch", "Resolution", "dpi",
       "Resolution as stored in the picture file, which holds whole pixels per metre."},
      {"noise_scales_mm", "Noise levels", "mm", "Spacings of the noise levels in the pattern, from fine to coarse."},
      {"patches", "Colour patches", "", "Number of colour patches inside the clamp opening."},
      {"marks_mm", "Corner marks", "mm",
       "Centres of the corner marks on the sheet, in the order front left, front right, back right, back left."},
      {"pixels_sha256", "Fingerprint", "",
       "Checksum (SHA-256) of the pixels before mirroring. Equal patterns have equal checksums."},
      {"pages", "Pages", "", "Number of pages in the PDF."},
      {"seconds_draw", "Drawing", "s", "Time for drawing the pattern."},
      {"seconds_write", "Writing", "s", "Time for writing the output files."},
      {"peak_memory_mb", "Peak memory", "MB", "Largest amount of memory that the process used."}};
}

/// The print's own options: no marks and lines, which would lie on the noise.
ThermoformPrintOptions print_options(const EvidencePatternOptions& options) {
  ThermoformPrintOptions print;
  print.sheet_x_mm = options.sheet_x_mm;
  print.sheet_y_mm = options.sheet_y_mm;
  print.clamp_opening_x_mm = options.clamp_opening_x_mm;
  print.clamp_opening_y_mm = options.clamp_opening_y_mm;
  print.dots_per_inch = options.dots_per_inch;
  print.mirror = options.mirror;
  print.paper = options.paper;
  print.paper_margin_mm = options.paper_margin_mm;
  print.overlap_mm = options.overlap_mm;
  print.marks = print.outlines = false;
  return print;
}

OperationResult run_pattern(const OperationCall& call, const EvidencePatternOptions& options) {
  Context& context = call.context;
  const CalibrationPattern pattern = make_calibration_pattern(options);
  const ThermoformPrintOptions print = print_options(options);
  const PrintGrid grid = print_grid(print);
  const PageLayout layout = page_layout(print);
  Stopwatch watch;
  context.progress(0, "Drawing the pattern");
  const Image picture = draw_calibration_pattern(pattern, grid.width, grid.height, grid.pixel_mm(), context);
  OperationResult result;
  Json& report = result.report;
  report["sheet_mm"] = {options.sheet_x_mm, options.sheet_y_mm};
  report["picture_pixels"] = {grid.width, grid.height};
  report["dots_per_inch"] = 25.4 / grid.pixel_mm();
  report["noise_scales_mm"] = pattern.scales_mm;
  report["patches"] = pattern.patches.size();
  report["marks_mm"] = Json::array();
  for (const CornerMark& mark : pattern.marks) report["marks_mm"].push_back({mark.centre_mm.x(), mark.centre_mm.y()});
  report["pixels_sha256"] = sha256_hex(
      ByteView(reinterpret_cast<const std::byte*>(picture.pixels.data()), sizeof(Rgba) * picture.pixels.size()));
  report["pages"] = layout.tiles.size();
  report["seconds_draw"] = watch.lap();
  context.progress(0.5, "Writing");
  const auto add = [&](const char* name, const auto& bytes) {
    if (!call.wants(name)) return;
    for (const OutputInfo& info : evidence_pattern_outputs())
      if (info.name == name) result.outputs.push_back(make_output(info, bytes()));
    context.check_cancelled();
  };
  add("pattern.png", [&] { return write_png(with_marks(picture, grid, print), grid.per_metre, context); });
  add("pattern.pdf", [&] { return write_print_pdf(picture, grid, layout, print, "Calibration pattern", context); });
  add("pattern.json", [&] { return to_bytes(calibration_pattern_json(pattern).dump(1) + "\n"); });
  report["seconds_write"] = watch.seconds();
  report["peak_memory_mb"] = context.peak_memory_mb();
  return result;
}

}  // namespace

Operation evidence_pattern_operation() {
  Operation operation;
  operation.name = "evidence-pattern";
  operation.title = "Calibration pattern";
  operation.summary =
      "Makes a pattern to print on a sheet. A scan of the formed sheet then shows where every point of the sheet moved.";
  operation.outputs = evidence_pattern_outputs();
  operation.report = evidence_pattern_report_fields();
  take_options<EvidencePatternOptions>(
      operation, run_pattern, [](const EvidencePatternOptions& options) { make_calibration_pattern(options); });
  return operation;
}

}  // namespace formwright
