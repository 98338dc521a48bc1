// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "imaging/pdf.h"
#include "job/file_pack.h"
#include "job/model_input.h"
#include "job/zippable_operation.h"
#include "zippable/plan/assembly_sheet.h"
#include "zippable/plan/zippable_plan.h"

namespace formwright {
namespace {

std::vector<InputInfo> inputs() {
  InputInfo design;
  design.name = "design";
  design.label = "Design";
  design.help = "design.json of zippable-design.";
  design.extensions = {"json"};
  return {design};
}

std::vector<OutputInfo> outputs() {
  return {{"plan.svg", "image/svg+xml", "Plan, SVG",
           "All sheets side by side at true size; layers cut, mark, engrave, note.", true},
          {"plan.dxf", "image/vnd.dxf", "Plan, DXF", "The same in mm, DXF R12.", true},
          {"plan.pdf", "application/pdf", "Plan, PDF", "One page a sheet at true size.", true},
          {"sheets.zip", "application/zip", "Sheets", "sheet_1.svg, sheet_1.dxf, ...: a file for every sheet.", true},
          {"tape.pdf", "application/pdf", "Tape template",
           "Lay the zipper on it and copy its numbers: both tapes in rows. Print at 100 %.", true},
          {"tape.svg", "image/svg+xml", "Tape template, SVG", "The same, all pages side by side at true size.", true},
          {"rig.svg", "image/svg+xml", "Rig, SVG",
           "With the rig: its boards side by side at true size; layers as in the plan.", true},
          {"rig.dxf", "image/vnd.dxf", "Rig, DXF", "The same in mm, DXF R12.", true},
          {"rig.pdf", "application/pdf", "Rig, PDF", "One page a board at true size.", true},
          {"assembly.pdf", "application/pdf", "Assembly sheet",
           "What is needed and what is joined to what, step by step with pictures.", true}};
}

std::vector<ReportField> report_fields() {
  return {
      {"zipper_length_mm", "Zipper length", "mm", "of the design; tape needed for each side"},
      {"left_length_mm", "Left side", "mm", "of the flat ribbon with room for the zipper"},
      {"right_length_mm", "Right side", "mm", "the same"},
      {"sides_difference_mm", "Difference of sides", "mm", "left minus right"},
      {"length_error", "Length error", "", "the side that differs more from the zipper, relative to it"},
      {"interval_error_max", "Largest error of an interval", "",
       "between markers, of either side, relative to the zipper"},
      {"interval_difference_max_mm", "Largest difference in an interval", "mm", "between the two sides"},
      {"tape_width_mm", "Tape", "mm", "of one side"},
      {"teeth_width_mm", "Teeth", "mm", "closed"},
      {"gap_mm", "Gap", "mm", "between teeth and fabric"},
      {"offset_mm", "Offset", "mm", "half the teeth and the gap: how far each edge is moved"},
      {"offset_mean_mm", "Mean offset", "mm", "as carried out"},
      {"narrow_places", "Narrow places", "", "corners of the zipper where the edge is moved by less"},
      {"offset_least_mm", "Least offset", "mm", "at the narrowest place"},
      {"binormal_share", "Share along the binormal", "",
       "of the zipper's length; elsewhere along the surface (gluing)"},
      {"sides_made_equal", "Sides made equal", "", "along the whole zipper (gluing)"},
      {"shear_max_mm", "Largest shear", "mm", "of the tape, to make the sides equal (gluing)"},
      {"ribbon_width_mean_mm", "Mean width", "mm", "of the ribbon as designed"},
      {"markers", "Markers", "", "on each side"},
      {"marker_spacing_mm", "Marker spacing", "mm", "along the zipper"},
      {"intervals", "Intervals", "mm", "between markers: zipper, left side, right side"},
      {"tape_runs", "Runs of tape", "",
       "stretches of a tape along one piece: side, piece, from and to on the tape, edge of the cloth, first and last marker"},
      {"seams", "Seams", "", "in the order in which they are made: pieces, letters of a split, markers, lengths"},
      {"zipper_to_cut_mm", "Zipper to cut", "mm", "from the reel, with an end on either side to hold it by"},
      {"assembly_pages", "Assembly pages", "", "of the assembly sheet"},
      {"hook_and_loop_mm_total", "Hook-and-loop tape", "mm",
       "along all cuts; of paper, what is joined there: needed for each side"},
      {"hook_and_loop", "Cuts to close", "", "for every cut its length, numbers on either side, pieces of both sides"},
      {"hook_and_loop_narrow_mm", "Too narrow for the tape", "mm", "of the edges that carry it within"},
      {"tabs", "Tabs", "", "of paper: how many, how many of them less deep, and stretches without"},
      {"tape_rows", "Rows of the template", "", "of the tapes, on its pages"},
      {"tape_row_mm", "Row", "mm", "of the template, along the zipper"},
      {"pieces", "Pieces", "", "area of ribbon, sheet, letters of splits and, of two, which fabric"},
      {"sheet_fabrics", "Fabrics of the sheets", "", "of two colours: 1 or 2 for every sheet"},
      {"splits", "Splits", "", "rulings at which the ribbon is cut"},
      {"crumbs_joined", "Crumbs joined", "", "pieces that were too small and joined to a neighbour"},
      {"crumbs_grown", "Crumbs grown", "", "pieces that were too small and grew at a neighbour's cost"},
      {"sheets", "Sheets", "", "of the bed's size"},
      {"area_before_mm2", "Area before splitting", "mm²", "of the ribbon with room for the zipper"},
      {"area_after_mm2", "Area after splitting", "mm²", "of all pieces without allowances"},
      {"outline_area_mm2", "Area of pieces", "mm²", "with seam allowances, without kerf"},
      {"cut_length_mm", "Cut length", "mm", "of all outlines"},
      {"kerf_mm", "Kerf", "mm", "of which half is added to outlines"},
      {"rig_plates", "Plates of the rig", "", "three for every piece"},
      {"rig_sheets", "Boards for the rig", "", "of the bed's size"},
      {"rig_tracks", "Tracks", "", "of the rig"},
      {"rig_tracks_blind", "Tracks without an opening", "", "into which the tape is laid from above"},
      {"rig_openings", "Openings", "", "where a tape is slid in"},
      {"rig_screws", "Screws", "", "of all pieces, each through three layers"},
      {"rig_track_mm", "Length of tracks", "mm", "along the cloth"},
      {"rig_left_out_mm", "Edges without a track", "mm", "where two tracks would meet"},
      {"rig_markers_hidden", "Markers under the cloth", "", "on the cover, where there is no room beside the track"},
      {"seconds_read", "Reading", "s", "the design"},
      {"seconds_offset", "Room for the zipper", "s", "offsets and markers"},
      {"seconds_split", "Splitting", "s", "pieces and outlines"},
      {"seconds_nest", "Nesting", "s", "pieces onto sheets"},
      {"seconds_write", "Writing", "s", "outputs into their formats"},
      {"peak_memory_mb", "Peak memory", "MB", "of the process"},
      {"notes", "Notes", "", "what to know, in words"}};
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
  report["offset_mm"] = plan.zipper.offset_mm();
  report["offset_mean_mm"] = ribbon.offset_mean_mm;
  report["narrow_places"] = ribbon.narrow_samples;
  report["offset_least_mm"] = ribbon.least_share * plan.zipper.offset_mm();
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
  report["kerf_mm"] = options.kerf_mm;
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

OperationResult run(const OperationCall& call) {
  const auto options = read_parameters<PlanOptions>(call.parameters);
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
    for (const OutputInfo& info : outputs())
      if (info.name == name) result.outputs.push_back(make_output(info, bytes()));
    context.check_cancelled();
  };
  add("plan.svg", [&] { return write_svg(all); });
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
  return result;
}

}  // namespace

Operation zippable_plan_operation() {
  Operation operation;
  operation.name = "zippable-plan";
  operation.title = "Zippable plan";
  operation.summary = "Turns a zippable's design into sheets to cut, with markers for the zipper (thesis section 5.3).";
  operation.inputs = inputs();
  operation.parameters = describe_parameters<PlanOptions>();
  operation.outputs = outputs();
  operation.report = report_fields();
  operation.check = [](const Json& parameters) { read_parameters<PlanOptions>(parameters); };
  operation.run = run;
  return operation;
}

}  // namespace formwright
