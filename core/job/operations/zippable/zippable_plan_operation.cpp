// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "imaging/drawing/pdf.h"
#include "job/contract/file_pack.h"
#include "job/contract/model_input.h"
#include "job/contract/operation_options.h"
#include "job/operations/zippable/zippable_operation.h"
#include "job/operations/zippable/zippable_inputs.h"
#include "zippable/plan/assembly_sheet.h"
#include "zippable/plan/zippable_plan.h"

namespace formwright {
namespace {

std::vector<OutputInfo> zippable_plan_outputs() {
  return {
      {"plan.svg", "image/svg+xml", "Plan, SVG",
       "All sheets side by side at true size, with the layers cut, mark, engrave and note.", true},
      {"plan.dxf", "image/vnd.dxf", "Plan, DXF", "The plan in mm as DXF R12.", true},
      {"plan.pdf", "application/pdf", "Plan, PDF", "The sheets at true size, one page for each.", true},
      {"sheets.zip", "application/zip", "Sheets",
       "One SVG and one DXF file for every sheet: sheet_1.svg, sheet_1.dxf, ...", true},
      {"tape.pdf", "application/pdf", "Tape template",
       "Template for marking both zipper tapes: lay the zipper on it and copy the numbers. Print at 100 %.", true},
      {"tape.svg", "image/svg+xml", "Tape template, SVG",
       "Template for marking both zipper tapes, all pages side by side at true size.", true},
      {"rig.svg", "image/svg+xml", "Rig, SVG",
       "The boards of the fastening rig side by side at true size, with the same layers as the plan. Only with the rig switched on.",
       true},
      {"rig.dxf", "image/vnd.dxf", "Rig, DXF", "The boards of the fastening rig in mm as DXF R12.", true},
      {"rig.pdf", "application/pdf", "Rig, PDF", "The boards of the fastening rig at true size, one page for each.",
       true},
      {"assembly.pdf", "application/pdf", "Assembly sheet",
       "Instructions with pictures: what is needed and what is joined to what, step by step.", true},
      {"plan.json", "application/json", "For measuring",
       "How each piece was turned on its sheet, and the spacing of the marks: keep it beside the design to diagnose what was sewn.",
       true}};
}

std::vector<ReportField> zippable_plan_report_fields() {
  return {
      {"zipper_length_mm", "Zipper length", "mm",
       "Length of the zipper in the design; that much tape is needed for each side."},
      {"left_length_mm", "Left side", "mm", "Length of the left edge of the flat ribbon, with room for the zipper."},
      {"right_length_mm", "Right side", "mm", "Length of the right edge of the flat ribbon, with room for the zipper."},
      {"sides_difference_mm", "Difference of sides", "mm", "Length of the left edge minus length of the right edge."},
      {"length_error", "Length error", "",
       "Largest relative difference between the length of an edge and the length of the zipper."},
      {"interval_error_max", "Largest error of an interval", "",
       "Largest relative difference between edge and zipper in the interval between two markers."},
      {"interval_difference_max_mm", "Largest difference in an interval", "mm",
       "Largest difference between left and right edge in the interval between two markers."},
      {"tape_width_mm", "Tape width", "mm", "Width of the zipper tape on one side."},
      {"teeth_width_mm", "Teeth width", "mm", "Width of the closed row of teeth."},
      {"gap_mm", "Gap", "mm", "Distance between teeth and fabric."},
      {"offset_mm", "Offset", "mm",
       "How far each edge is moved inwards: half the teeth plus the gap, and what makes up for errors of making."},
      {"offset_mean_mm", "Mean offset", "mm", "Mean distance by which the edges were moved."},
      {"narrow_places", "Narrow places", "",
       "Number of corners where the ribbon is too narrow to move the edge as far as the zipper needs."},
      {"min_offset_mm", "Smallest offset", "mm", "Distance by which the edge was moved at the narrowest place.",
       "offset_least_mm"},
      {"binormal_share", "Share along the binormal", "",
       "Fraction of the zipper's length moved along its binormal; the rest is moved along the surface. For gluing only."},
      {"sides_made_equal", "Sides made equal", "",
       "Whether both edges could be made equally long along the whole zipper. For gluing only."},
      {"shear_max_mm", "Largest shear", "mm",
       "Largest shift of the tape along the zipper that makes both edges equally long. For gluing only."},
      {"ribbon_width_mean_mm", "Mean width", "mm", "Mean width of the ribbon as designed."},
      {"markers", "Markers", "", "Number of markers on each edge."},
      {"marker_spacing_mm", "Marker spacing", "mm", "Distance between markers along the zipper."},
      {"intervals", "Intervals", "mm",
       "Lengths between neighbouring markers on the zipper, the left edge and the right edge."},
      {"tape_runs", "Stretches of tape", "",
       "Every stretch of tape along one piece: side, piece, start and end on the tape, edge of the cloth, first and last marker."},
      {"seams", "Seams", "",
       "Every seam in the order in which they are made: its pieces, letters, markers and lengths."},
      {"zipper_to_cut_mm", "Zipper to cut", "mm",
       "Length to cut from the zipper reel, including a spare end on either side to hold it by."},
      {"assembly_pages", "Assembly pages", "", "Number of pages of the assembly sheet."},
      {"hook_and_loop_mm_total", "Hook-and-loop tape", "mm",
       "Length of tape needed for each side to close all cuts; for a paper model, the length that is joined there."},
      {"hook_and_loop", "Cuts to close", "",
       "Every cut to close: its length, the numbers on either side and the pieces it joins."},
      {"hook_and_loop_narrow_mm", "Too narrow for the tape", "mm",
       "Length of edges that are too narrow to carry the hook-and-loop tape."},
      {"tabs", "Tabs", "",
       "Glue tabs of a paper model: their number, how many are less deep, and the stretches without tabs."},
      {"tape_rows", "Rows of the template", "", "Number of rows in the printed tape template."},
      {"tape_row_mm", "Length of a row", "mm", "Length along the zipper of one row of the tape template."},
      {"pieces", "Pieces", "",
       "Every piece with its area, sheet, letters where it is joined and, for two fabrics, its fabric."},
      {"sheet_fabrics", "Fabrics of the sheets", "", "For two fabrics: fabric 1 or 2 for every sheet."},
      {"splits", "Splits", "", "Number of places where the ribbon is cut across so that its pieces fit the sheets."},
      {"crumbs_joined", "Small pieces joined", "",
       "Number of pieces that were too small and were joined to a neighbour."},
      {"crumbs_grown", "Small pieces enlarged", "",
       "Number of pieces that were too small and took area from a neighbour."},
      {"sheets", "Sheets", "", "Number of sheets needed."},
      {"area_before_mm2", "Area before splitting", "mm²",
       "Area of the ribbon with room for the zipper, before it is split."},
      {"area_after_mm2", "Area after splitting", "mm²", "Total area of the pieces without allowances."},
      {"outline_area_mm2", "Area of pieces", "mm²", "Total area of the pieces with seam allowances, without kerf."},
      {"cut_length_mm", "Cut length", "mm", "Total length of all outlines to cut."},
      {"kerf_mm", "Kerf", "mm", "Width that the cut removes; outlines were enlarged by half of it."},
      {"rig_plates", "Plates of the rig", "", "Number of plates of the rig: three for every piece."},
      {"rig_sheets", "Boards for the rig", "", "Number of boards needed to cut the rig."},
      {"rig_tracks", "Tracks", "", "Number of tracks for zipper tape in the rig."},
      {"rig_tracks_blind", "Tracks without an opening", "",
       "Number of tracks without an opening; their tape is laid in from above."},
      {"rig_openings", "Openings", "", "Number of openings in the rig where a tape is slid in."},
      {"rig_screws", "Screws", "", "Number of screws for the rig, each through three layers."},
      {"rig_track_mm", "Length of tracks", "mm", "Total length of the tracks along the cloth."},
      {"rig_left_out_mm", "Edges without a track", "mm",
       "Length of edges without a track, because two tracks would meet there."},
      {"rig_markers_hidden", "Markers under the cloth", "",
       "Number of markers that lie under the cloth because there is no room beside the track."},
      {"seconds_read", "Reading", "s", "Time for reading the design."},
      {"seconds_offset", "Room for the zipper", "s", "Time for moving the edges and placing markers."},
      {"seconds_split", "Splitting", "s", "Time for splitting the ribbon into pieces with outlines."},
      {"seconds_nest", "Nesting", "s", "Time for placing the pieces on sheets."},
      {"seconds_write", "Writing", "s", "Time for writing the output files."},
      {"peak_memory_mb", "Peak memory", "MB", "Largest amount of memory that the process used."},
      {"notes", "Notes", "", "What to know about the result, as sentences."},
      {"fixes", "Fixes", "", std::string(fixes_help)}};
}

void report_lengths(Json& report, const FlatDesign& design, const ZippablePlan& plan) {
  const OffsetRibbon& ribbon = plan.ribbon;
  const auto relative = [&](double side_mm, double zipper_mm) {
    return zipper_mm > 1e-9 ? (side_mm - zipper_mm) / zipper_mm : 0.0;
  };
  report["zipper_length_mm"] = design.zipper_mm;
  report["left_length_mm"] = ribbon.left_mm;
  report["right_length_mm"] = ribbon.right_mm;
  report["sides_difference_mm"] = ribbon.left_mm - ribbon.right_mm;
  const double left = relative(ribbon.left_mm, design.zipper_mm), right = relative(ribbon.right_mm, design.zipper_mm);
  report["length_error"] = std::abs(left) > std::abs(right) ? left : right;
  double error = 0, difference_mm = 0;
  Json intervals = Json::array();
  for (const MarkerInterval& interval : plan.markers.intervals) {
    error = std::max({error, std::abs(relative(interval.left_mm, interval.zipper_mm)),
                      std::abs(relative(interval.right_mm, interval.zipper_mm))});
    difference_mm = std::max(difference_mm, std::abs(interval.left_mm - interval.right_mm));
    intervals.push_back({interval.zipper_mm, interval.left_mm, interval.right_mm});
  }
  report["interval_error_max"] = error;
  report["interval_difference_max_mm"] = difference_mm;
  report["tape_width_mm"] = plan.zipper.tape_width_mm;
  report["teeth_width_mm"] = plan.zipper.teeth_width_mm;
  report["gap_mm"] = plan.zipper.gap_mm;
  report["offset_mm"] = plan.edges_moved_mm;
  report["offset_mean_mm"] = ribbon.offset_mean_mm;
  report["narrow_places"] = ribbon.narrow_samples;
  report["min_offset_mm"] = ribbon.min_share * plan.edges_moved_mm;
  report["binormal_share"] = ribbon.binormal_share;
  report["sides_made_equal"] = ribbon.sides_made_equal;
  report["shear_max_mm"] = ribbon.shear_max_mm;
  report["ribbon_width_mean_mm"] = plan.width_mean_mm;
  report["markers"] = plan.markers.markers.size();
  report["marker_spacing_mm"] = plan.marker_spacing_mm;
  report["intervals"] = intervals;
}

void report_tape(Json& report, const FlatDesign& design, const ZippablePlan& plan) {
  Json runs = Json::array();
  for (const TapeRun& run : plan.runs)
    runs.push_back({{"side", run.left ? "left" : "right"},
                    {"piece", plan.pieces.pieces[run.piece].name},
                    {"from_mm", run.from_mm},
                    {"to_mm", run.to_mm},
                    {"cloth_mm", run.cloth_mm},
                    {"first_marker", run.first_marker},
                    {"last_marker", run.last_marker}});
  report["tape_runs"] = runs;
  Json seams = Json::array();
  for (std::size_t i = 0; i < plan.seams.size(); ++i) {
    const Seam& seam = plan.seams[i];
    constexpr const char* kinds[] = {"join", "tape", "edge"};
    seams.push_back({{"number", i + 1},
                     {"kind", kinds[static_cast<int>(seam.kind)]},
                     {"letters", seam.letters},
                     {"pieces", {plan.pieces.pieces[seam.piece].name, plan.pieces.pieces[seam.other_piece].name}},
                     {"side", seam.kind != SeamKind::tape ? ""
                              : seam.left                 ? "left"
                                                          : "right"},
                     {"length_mm", seam.kind == SeamKind::join ? seam.cloth_mm : seam.tape_mm()},
                     {"cloth_mm", seam.cloth_mm},
                     {"first_marker", seam.first_marker},
                     {"last_marker", seam.last_marker}});
  }
  report["seams"] = seams;
  if (plan.tabs) report["tabs"] = {plan.tabs->tabs.size(), plan.tabs->shortened, plan.tabs->left_out};
  report["zipper_to_cut_mm"] = zipper_to_cut_mm(design, plan);
  report["tape_rows"] = plan.tape.rows;
  report["tape_row_mm"] = plan.tape.row_mm;
}

void report_pieces(Json& report, const ZippablePlan& plan, const PlanOptions& options) {
  Json pieces = Json::array();
  double area = 0, outline_area = 0, cut_mm = 0;
  for (std::size_t i = 0; i < plan.pieces.pieces.size(); ++i) {
    const PlanPiece& piece = plan.pieces.pieces[i];
    Json letters = Json::array();
    for (std::size_t s = 0; s < plan.splitting.splits.size(); ++s)
      if (const RibbonSplit& split = plan.splitting.splits[s];
          split.left == static_cast<int>(i) || split.right == static_cast<int>(i))
        letters.push_back(split_letters(static_cast<int>(s)));
    pieces.push_back({{"name", piece.name},
                      {"sheet", plan.nesting.places[i].sheet + 1},
                      {"ribbon_area_mm2", piece.ribbon_area_mm2},
                      {"splits", letters}});
    if (plan.fabrics > 1) pieces.back()["fabric"] = plan.fabric_of_piece[i] + 1;
    area += piece.ribbon_area_mm2;
    outline_area += signed_area_mm2(piece.outline_mm);
    for (std::size_t k = 0; k < piece.cut_mm.size(); ++k)
      cut_mm += (piece.cut_mm[(k + 1) % piece.cut_mm.size()] - piece.cut_mm[k]).norm();
  }
  report["pieces"] = pieces;
  if (plan.fabrics > 1) {
    Json fabrics = Json::array();
    for (const int fabric : plan.fabric_of_sheet) fabrics.push_back(fabric + 1);
    report["sheet_fabrics"] = fabrics;
  }
  report["splits"] = plan.splitting.splits.size();
  report["crumbs_joined"] = plan.splitting.merged_crumbs;
  report["crumbs_grown"] = plan.splitting.moved_splits;
  report["sheets"] = plan.sheets.size();
  report["area_before_mm2"] = plan.area_before_mm2;
  report["area_after_mm2"] = area;
  report["outline_area_mm2"] = outline_area;
  report["cut_length_mm"] = cut_mm;
  report["kerf_mm"] = plan.sheets.empty() ? options.kerf_mm : plan.sheets.front().kerf_mm;
}

void report_closures(Json& report, const ZippablePlan& plan) {
  const ClosureMarks& closures = plan.closures;
  Json cuts = Json::array();
  for (std::size_t c = 0; c < closures.length_mm.size(); ++c) {
    const int cut = static_cast<int>(c) + 1;
    Json numbers = Json::array(), pieces = {Json::array(), Json::array()};
    for (const ClosureMarker& marker : closures.markers)
      if (marker.cut == cut) numbers.push_back(marker.number);
    for (const ClosureStretch& stretch : closures.stretches)
      if (stretch.cut == cut)
        pieces[static_cast<std::size_t>(stretch.side)].push_back(plan.pieces.pieces[stretch.piece].name);
    cuts.push_back({{"length_mm", closures.length_mm[c]}, {"numbers", numbers}, {"pieces", pieces}});
  }
  report["hook_and_loop_mm_total"] = closures.total_mm();
  report["hook_and_loop"] = cuts;
  report["hook_and_loop_narrow_mm"] = closures.narrow_mm;
}

void report_rig(Json& report, const Rig& rig) {
  report["rig_plates"] = rig.plates.size();
  report["rig_sheets"] = rig.sheets.size();
  report["rig_tracks"] = rig.tracks;
  report["rig_tracks_blind"] = rig.blind_tracks;
  report["rig_openings"] = rig.openings;
  report["rig_screws"] = rig.screws;
  report["rig_track_mm"] = rig.track_mm;
  report["rig_left_out_mm"] = rig.left_out_mm;
  report["rig_markers_hidden"] = rig.hidden_markers;
}

Bytes sheets_zip(const ZippablePlan& plan, const Context& context) {
  std::map<std::string, Bytes> files;
  for (std::size_t i = 0; i < plan.sheets.size(); ++i) {
    const std::string stem = "sheet_" + std::to_string(i + 1);
    files[stem + ".svg"] = write_svg(plan.sheets[i]);
    files[stem + ".dxf"] = write_dxf(plan.sheets[i]);
  }
  std::map<std::string, ByteView> views;
  for (const auto& [name, bytes] : files) views.emplace(name, bytes);
  return pack_files(views, context);
}

OperationResult run_zippable_plan(const OperationCall& call, const Json& given) {
  const auto options = read_parameters<PlanOptions>(with_making_profile(call, given));
  Context& context = call.context;
  Stopwatch watch;
  context.progress(0, "Reading the design");
  const FlatDesign design = read_flat_design(*call.inputs.at("design").bytes);
  const double seconds_read = watch.lap();
  ZippablePlan plan;
  {
    const auto span = context.span(0.1, 0.9, "Planning");
    plan = plan_zippable(design, options, context);
  }
  context.progress(0.9, "Writing");
  watch.lap();
  OperationResult result;
  const CutSheet all = side_by_side(plan.sheets, 20);
  const auto add = [&](const char* name, auto&& bytes) {
    if (!call.wants(name)) return;
    for (const OutputInfo& info : zippable_plan_outputs())
      if (info.name == name) result.outputs.push_back(make_output(info, bytes()));
    context.check_cancelled();
  };
  add("plan.svg", [&] { return write_svg(all); });
  add("plan.json", [&] { return to_bytes(write_plan_record(record_of(design, plan))); });
  add("plan.dxf", [&] { return write_dxf(all); });
  // What is longer than any PDF page is still a job for a roll cutter.
  const bool pages_fit = std::max(options.bed_x_mm, options.bed_y_mm) <= longest_pdf_page_mm;
  if (pages_fit) add("plan.pdf", [&] { return write_plan_pdf(plan.sheets); });
  else plan.notes.push_back("There is no PDF of the sheets: its pages end at 5.08 m. Use the SVG or the DXF.");
  add("sheets.zip", [&] { return sheets_zip(plan, context); });
  add("assembly.pdf", [&] {
    AssemblySheet sheet = write_assembly_sheet(design, plan, options, context);
    result.report["assembly_pages"] = sheet.pages;
    return std::move(sheet.pdf);
  });
  if (!plan.tape.sheets.empty()) {
    add("tape.pdf", [&] { return write_plan_pdf(plan.tape.sheets); });
    add("tape.svg", [&] { return write_svg(side_by_side(plan.tape.sheets, 20)); });
  }
  if (plan.rig) {
    const CutSheet boards = side_by_side(plan.rig->sheets, 20);
    add("rig.svg", [&] { return write_svg(boards); });
    add("rig.dxf", [&] { return write_dxf(boards); });
    if (pages_fit) add("rig.pdf", [&] { return write_plan_pdf(plan.rig->sheets); });
    report_rig(result.report, *plan.rig);
  }
  report_lengths(result.report, design, plan);
  report_tape(result.report, design, plan);
  report_pieces(result.report, plan, options);
  if (!plan.closures.length_mm.empty()) report_closures(result.report, plan);
  result.report["seconds_read"] = seconds_read;
  result.report["seconds_offset"] = plan.seconds_offset;
  result.report["seconds_split"] = plan.seconds_split;
  result.report["seconds_nest"] = plan.seconds_nest;
  result.report["seconds_write"] = watch.seconds();
  result.report["notes"] = plan.notes;
  result.report["fixes"] = fixes_json(plan.fixes);
  return result;
}

}  // namespace

Operation zippable_plan_operation() {
  Operation operation;
  operation.name = "zippable-plan";
  operation.title = "Zippable plan";
  operation.summary =
      "Turns the design of a zippable into sheets to cut, with numbered markers for attaching the zipper.";
  operation.inputs = {flat_design_info(), making_profile_info()};
  operation.outputs = zippable_plan_outputs();
  operation.report = zippable_plan_report_fields();
  take_mergeable_options<PlanOptions>(operation, run_zippable_plan);
  return operation;
}

}  // namespace formwright
