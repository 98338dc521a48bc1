// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/sha256.h"
#include "evidence/photographs/mark_sheet.h"
#include "evidence/registration/calibration_pattern.h"
#include "imaging/picture/png_writer.h"
#include "job/contract/operation_options.h"
#include "job/operations/evidence/evidence_registration_operations.h"
#include "job/contract/model_input.h"
#include "thermoform/print/print_pages.h"

namespace formwright {
namespace {

enum class PatternKind { noise, marks };

}  // namespace

template <>
struct EnumNames<PatternKind> {
  static constexpr std::array<std::string_view, 2> names{"noise", "marks"};
  static constexpr std::array<std::string_view, 2> labels{"Noise, for a 3D scan", "Coded marks, for photographs"};
};

namespace {

struct EvidencePatternOptions : CalibrationPatternOptions {
  PatternKind kind = PatternKind::noise;
  double mark_mm = 9, mark_pitch_mm = 15, board_mark_mm = 16;
  double dots_per_inch = 300;
  bool mirror = false;
  Paper paper = Paper::sheet;
  double paper_margin_mm = 5;
  double overlap_mm = 10;

  static constexpr auto parameters = std::tuple_cat(
      inherit_parameters<EvidencePatternOptions>(CalibrationPatternOptions::parameters),
      std::tuple{
          parameter(
              "kind", &EvidencePatternOptions::kind, "Kind",
              "What is printed on the sheet. Noise shows every point to a 3D scan. Coded marks are found in photographs; board.pdf has the paper strips that lie around them.")
              .group("Pattern"),
          parameter(
              "mark_mm", &EvidencePatternOptions::mark_mm, "Size of the marks", unit::mm, 2, 100,
              "Side of the coded marks on the sheet. They must be at least 30 pixels wide in the photographs: 8 to 10 mm is usual.")
              .group("Pattern")
              .slider(5, 20)
              .only_with("kind", "marks"),
          parameter(
              "mark_pitch_mm", &EvidencePatternOptions::mark_pitch_mm, "Spacing of the marks", unit::mm, 3, 200,
              "Distance between the middles of neighbouring marks. Smaller gives more points; at least 1.25 times the size of the marks.")
              .group("Pattern")
              .slider(8, 40)
              .only_with("kind", "marks"),
          parameter(
              "board_mark_mm", &EvidencePatternOptions::board_mark_mm, "Size of the board's marks", unit::mm, 4, 100,
              "Side of the coded marks on the paper strips. The strips are 1.5 times as wide: choose it to fit the bars of the clamp frame.")
              .group("Pattern")
              .slider(8, 30)
              .only_with("kind", "marks"),
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
  return {
      {"pattern.png", "image/png", "Pattern", "The pattern for the whole sheet. The file contains its true size.",
       true},
      {"pattern.pdf", "application/pdf", "Pages", "The pattern at true size on the chosen paper. Print at 100 %.",
       true},
      {"board.pdf", "application/pdf", "Board",
       "The strips that lie on the clamp frame in the photographs, at true size on A4. Only with coded marks.", true},
      {"pattern.json", "application/json", "Description",
       "The description of the pattern that evidence-register or evidence-photographs needs later. Keep it.", true}};
}

std::vector<ReportField> evidence_pattern_report_fields() {
  return {
      {"sheet_mm", "Sheet", "mm", "Width and length of the flat sheet."},
      {"picture_pixels", "Pixels", "", "Width and height of the picture in pixels."},
      {"dots_per_inch", "Resolution", "dpi",
       "Resolution as stored in the picture file, which holds whole pixels per metre."},
      {"noise_scales_mm", "Noise levels", "mm", "Spacings of the noise levels in the pattern, from fine to coarse."},
      {"patches", "Colour patches", "", "Number of colour patches inside the clamp opening."},
      {"coded_marks", "Coded marks", "", "Number of coded marks on the sheet."},
      {"board_marks", "Marks of the board", "", "Number of coded marks on the four strips."},
      {"board_check_mm", "Check length", "mm",
       "Length between the outer edges of the front strip's marks, to be measured on the printed board."},
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

MarkSheetPlan mark_sheet_plan(const EvidencePatternOptions& options) {
  return {{options.sheet_x_mm, options.sheet_y_mm},
          {options.clamp_opening_x_mm, options.clamp_opening_y_mm},
          options.seed,
          options.margin_mm,
          options.mark_mm,
          options.mark_pitch_mm,
          options.board_mark_mm};
}

/// What is printed, described and reported of either kind.
struct DrawnPattern {
  Image picture;
  Json description;
  std::optional<MarkSheet> marks;
};

DrawnPattern draw_noise(const EvidencePatternOptions& options, const PrintGrid& grid, Json& report, Context& context) {
  const CalibrationPattern pattern = make_calibration_pattern(options);
  report["noise_scales_mm"] = pattern.scales_mm;
  report["patches"] = pattern.patches.size();
  report["marks_mm"] = Json::array();
  for (const CornerMark& mark : pattern.marks) report["marks_mm"].push_back({mark.centre_mm.x(), mark.centre_mm.y()});
  return {draw_calibration_pattern(pattern, grid.width, grid.height, grid.pixel_mm(), context),
          calibration_pattern_json(pattern), std::nullopt};
}

DrawnPattern draw_coded_marks(const EvidencePatternOptions& options, const PrintGrid& grid, Json& report) {
  DrawnPattern drawn{
      Image(grid.width, grid.height, {255, 255, 255, 255}), {}, make_mark_sheet(mark_sheet_plan(options))};
  const MarkSheet& sheet = *drawn.marks;
  std::size_t board_marks = 0;
  for (const BoardStrip& strip : sheet.strips) board_marks += strip.marks.size();
  report["coded_marks"] = sheet.marks.size();
  report["board_marks"] = board_marks;
  report["board_check_mm"] = sheet.check_mm;
  draw_marks(drawn.picture, grid.pixel_mm(), Vec2(0, 0), sheet.marks);
  drawn.description = mark_sheet_json(sheet);
  return drawn;
}

OperationResult run_pattern(const OperationCall& call, const EvidencePatternOptions& options) {
  Context& context = call.context;
  const ThermoformPrintOptions print = print_options(options);
  const PrintGrid grid = print_grid(print);
  const PageLayout layout = page_layout(print);
  Stopwatch watch;
  context.progress(0, "Drawing the pattern");
  OperationResult result;
  Json& report = result.report;
  const DrawnPattern drawn = options.kind == PatternKind::noise ? draw_noise(options, grid, report, context)
                                                                : draw_coded_marks(options, grid, report);
  const Image& picture = drawn.picture;
  report["sheet_mm"] = {options.sheet_x_mm, options.sheet_y_mm};
  report["picture_pixels"] = {grid.width, grid.height};
  report["dots_per_inch"] = 25.4 / grid.pixel_mm();
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
  if (drawn.marks) add("board.pdf", [&] { return write_board_pdf(*drawn.marks, options.dots_per_inch, context); });
  add("pattern.json", [&] { return to_bytes(drawn.description.dump(1) + "\n"); });
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
      "Makes a pattern to print on a sheet. A scan or photographs of the formed sheet then show where its points moved.";
  operation.outputs = evidence_pattern_outputs();
  operation.report = evidence_pattern_report_fields();
  take_options<EvidencePatternOptions>(operation, run_pattern, [](const EvidencePatternOptions& options) {
    if (options.kind == PatternKind::noise) make_calibration_pattern(options);
    else make_mark_sheet(mark_sheet_plan(options));
  });
  return operation;
}

}  // namespace formwright
