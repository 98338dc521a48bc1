// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/sha256.h"
#include "evidence/registration/calibration_pattern.h"
#include "imaging/png_writer.h"
#include "job/evidence_registration_operations.h"
#include "job/model_input.h"
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
          parameter("dots_per_inch", &EvidencePatternOptions::dots_per_inch, "Resolution", unit::dots_per_inch, 36,
                    1200, "Dots per inch of the print.")
              .group("Print")
              .slider(100, 600),
          parameter("mirror", &EvidencePatternOptions::mirror, "Mirror",
                    "For transfer paper: the printed files left to right. pattern.json stays as seen on the sheet.")
              .group("Print"),
          parameter(
              "paper", &EvidencePatternOptions::paper, "Paper",
              "Of the PDF. On paper that is smaller than the sheet the pattern goes over several pages, to be joined.")
              .group("Paper"),
          parameter("paper_margin_mm", &EvidencePatternOptions::paper_margin_mm, "Margin of the paper", unit::mm, 0, 50,
                    "White rim that the printer cannot print on. Not used when the paper is as the sheet.")
              .group("Paper")
              .slider(0, 15),
          parameter("overlap_mm", &EvidencePatternOptions::overlap_mm, "Overlap", unit::mm, 0, 50,
                    "How much neighbouring pages have in common, to be joined by.")
              .group("Paper")
              .slider(0, 30)});
};

std::vector<OutputInfo> outputs() {
  return {{"pattern.png", "image/png", "Pattern", "The whole sheet; the file says its size.", true},
          {"pattern.pdf", "application/pdf", "Pages", "At true size on the paper chosen. Print at 100 %.", true},
          {"pattern.json", "application/json", "Description",
           "All that evidence-register needs to know the pattern again. Keep it.", true}};
}

std::vector<ReportField> report_fields() {
  return {{"sheet_mm", "Sheet", "mm", "width and length"},
          {"picture_pixels", "Pixels", "", "width and height"},
          {"dots_per_inch", "Resolution", "dpi", "as the picture has it: whole pixels per metre"},
          {"noise_scales_mm", "Noise", "mm", "spacings"},
          {"patches", "Colour patches", "", "inside the clamp opening"},
          {"marks_mm", "Corner marks", "mm", "middles on the sheet: front left, front right, back right, back left"},
          {"pixels_sha256", "Fingerprint", "", "of the pixels before mirroring: equal prints have equal ones"},
          {"pages", "Pages", "", "of the PDF"},
          {"seconds_draw", "Drawing", "s", ""},
          {"seconds_write", "Writing", "s", "outputs into their formats"},
          {"peak_memory_mb", "Peak memory", "MB", "of the process"}};
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

OperationResult run_pattern(const OperationCall& call) {
  const auto options = read_parameters<EvidencePatternOptions>(call.parameters);
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
    for (const OutputInfo& info : outputs())
      if (info.name == name) result.outputs.push_back(make_output(info, bytes()));
    context.check_cancelled();
  };
  add("pattern.png", [&] { return write_png(with_marks(picture, grid, print), grid.per_metre, context); });
  add("pattern.pdf", [&] { return write_print_pdf(picture, grid, layout, print, context); });
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
      "Makes the pattern to print on a sheet, so that a scan of it, formed, shows where every point went.";
  operation.parameters = describe_parameters<EvidencePatternOptions>();
  operation.outputs = outputs();
  operation.report = report_fields();
  operation.check = [](const Json& parameters) {
    make_calibration_pattern(read_parameters<EvidencePatternOptions>(parameters));
  };
  operation.run = run_pattern;
  return operation;
}

}  // namespace formwright
