// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/zippable_plan.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <tuple>

#include "geometry/planar/plane.h"
#include "base/error.h"
#include "base/format.h"
#include "fabrication/sheet/word_paths.h"
#include "imaging/drawing/pdf.h"

namespace formwright {
namespace {

constexpr const char* plan_title = "Zippable plan";

double area_mm2(const Triangles& F, const std::vector<Vec2>& flat) {
  double twice = 0;
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    const Vec2 a = flat[F(f, 1)] - flat[F(f, 0)], b = flat[F(f, 2)] - flat[F(f, 0)];
    twice += cross(a, b);
  }
  return twice / 2;
}

/// Pieces of one fabric lie on sheets of their own.
void nest_by_fabric(ZippablePlan& plan, const NestingOptions& options, Context& context) {
  plan.nesting.places.resize(plan.pieces.pieces.size());
  for (int fabric = 0; fabric < plan.fabrics; ++fabric) {
    std::vector<std::size_t> numbers;
    std::vector<Polygon> outlines;
    for (std::size_t i = 0; i < plan.pieces.pieces.size(); ++i)
      if (plan.fabric_of_piece[i] == fabric) numbers.push_back(i), outlines.push_back(plan.pieces.pieces[i].cut_mm);
    if (outlines.empty()) continue;
    const auto span =
        context.span(static_cast<double>(fabric) / plan.fabrics, (fabric + 1.0) / plan.fabrics, "Nesting");
    const Nesting nesting = nest(outlines, options, context);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      plan.nesting.places[numbers[i]] = nesting.places[i];
      plan.nesting.places[numbers[i]].sheet += plan.nesting.sheet_count;
    }
    plan.nesting.sheet_count += nesting.sheet_count;
    plan.nesting.cell_mm = nesting.cell_mm;
    plan.fabric_of_sheet.resize(std::size_t(plan.nesting.sheet_count), fabric);
  }
}

/// Which fabric the sheet is cut from, in the lower margin or what there is of it, beside the arrow.
void name_fabric(CutSheet& sheet, int fabric, double margin_mm) {
  std::string words = fabric_name(fabric);
  for (char& c : words) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  const double height = std::clamp(0.6 * margin_mm, 1.0, 6.0), width = words_width_mm(words, height);
  const Vec2 centre(std::max(width / 2 + 1, sheet.width_mm / 2 - 26 - width / 2), std::max(margin_mm, 2.0) / 2);
  for (CutPath& path : word_paths(words, centre, Vec2::UnitX(), height, CutLayer::note))
    sheet.paths.push_back(std::move(path));
}

/// An arrow along the material's grain, in the lower margin or what there is of it.
void draw_grain(CutSheet& sheet, double margin_mm) {
  const double y = margin_mm / 2, from = sheet.width_mm / 2 - 20, to = sheet.width_mm / 2 + 20,
               tip = std::min(1.5, margin_mm / 3);
  sheet.paths.push_back({CutLayer::note, {{from, y}, {to, y}}, false, "grain"});
  sheet.paths.push_back({CutLayer::note, {{to - 2, y - tip}, {to, y}, {to - 2, y + tip}}, false, "grain-tip"});
}

std::vector<CutSheet> lay_out(const ZippablePlan& plan, const PlanOptions& options) {
  const auto& [pieces, nesting] = std::tie(plan.pieces, plan.nesting);
  std::vector<CutSheet> sheets(std::size_t(nesting.sheet_count),
                               CutSheet{plan_title, options.bed_x_mm, options.bed_y_mm, {}, options.kerf_mm});
  for (std::size_t i = 0; i < pieces.pieces.size(); ++i) {
    const PlanPiece& piece = pieces.pieces[i];
    const Nested& place = nesting.places[i];
    auto& paths = sheets[place.sheet].paths;
    const auto add = [&](CutPath path) {
      for (Vec2& point : path.points_mm) point = place(point);
      paths.push_back(std::move(path));
    };
    add({CutLayer::cut, piece.cut_mm, true, "piece-" + piece.name});
    for (const CutPath& path : piece.marks) add(path);
  }
  for (CutSheet& sheet : sheets) draw_grain(sheet, options.margin_mm);
  if (plan.fabrics > 1)
    for (std::size_t i = 0; i < sheets.size(); ++i) {
      sheets[i].title += ", " + fabric_name(plan.fabric_of_sheet[i]);
      name_fabric(sheets[i], plan.fabric_of_sheet[i], options.margin_mm);
    }
  return sheets;
}

/// A sheet is laid out as the cloth lies when it has changed: on what is left of the bed then, and with the cut's
/// whole kerf.
PlanOptions with_room_for_the_cloth(PlanOptions options) {
  options.kerf_mm = std::max(0.0, options.kerf_mm + options.more_kerf_mm);
  if (!options.changes_the_cloth()) return options;
  const Eigen::Matrix2d back = options.cloth_change().inverse();
  // What this rectangle takes on the bed is a parallelogram.
  const double askew = std::abs(back(0, 1));
  Eigen::Matrix2d takes;
  takes << back(0, 0), askew, askew, back(1, 1);
  const Vec2 bed = takes.inverse() * Vec2(options.bed_x_mm, options.bed_y_mm);
  options.bed_x_mm = bed.x(), options.bed_y_mm = bed.y();
  return options;
}

/// From the cloth as it lies in the end to the cloth as it is cut. The bed keeps its size.
void make_up_for_the_cloth(std::vector<CutSheet>& sheets, const PlanOptions& given) {
  if (!given.changes_the_cloth()) return;
  const Eigen::Matrix2d back = given.cloth_change().inverse();
  for (CutSheet& sheet : sheets) {
    const Vec2 shift(std::max(0.0, -back(0, 1)) * sheet.height_mm, std::max(0.0, -back(1, 0)) * sheet.width_mm);
    for (CutPath& path : sheet.paths)
      for (Vec2& point : path.points_mm) point = back * point + shift;
    sheet.width_mm = given.bed_x_mm, sheet.height_mm = given.bed_y_mm;
  }
}

/// How wide a tape may be that lies flat behind the ribbon and stays off the seam of the other edge's tape.
double tape_room_mm(const ZippablePlan& plan) {
  constexpr double seam_mm = 3;  // from the cloth's edge to behind the stitches
  return plan.width_mean_mm - plan.zipper.teeth_width_mm - plan.zipper.gap_mm - seam_mm;
}
constexpr double min_tape_mm = 5;    // less cannot be sewn
constexpr double min_tab_mm = 2;     // less does not hold
constexpr double min_text_mm = 1.5;  // less cannot be read on cloth

/// What a plan differs by from one without errors of making; empty where nothing is made up for.
std::string corrections_in_words(const PlanOptions& given) {
  std::string text;
  const MakingErrors none, &own = given;
  const Json values = write_parameters(own), usual = write_parameters(none);
  for (const ParameterInfo& info : describe_parameters<MakingErrors>())
    if (values[info.name] != usual[info.name])
      text += (text.empty() ? "" : ", ") + info.label + " (" + with_digits(values[info.name].get<double>(), 3) +
              (info.unit.empty() ? "" : " " + info.unit) + ")";
  return text.empty() ? text : "The plan makes up for: " + text + ".";
}

void say_what_to_know(const FlatDesign& design, const PlanOptions& options, ZippablePlan& plan) {
  const auto plural = [](int count, const std::string& one, const std::string& many) {
    return count == 1 ? "1 " + one : std::to_string(count) + " " + many;
  };
  if (plan.ribbon.narrow_mm > 0) {
    // Where windings turn at a tip the edges are always this tight; more than that is a wrong zipper.
    constexpr double usual_share = 0.05;
    plan.notes.push_back(
        "Along " + with_digits(plan.ribbon.narrow_mm / 10, 2) + " of " + with_digits(design.zipper_mm / 10, 3) +
        " cm of zipper the ribbon's edges turn too tightly to leave all the room that the teeth need: sew slowly there." +
        (plan.ribbon.narrow_mm > usual_share * design.zipper_mm ? " A smaller zipper or a wider ribbon helps." : ""));
    if (options.coil > ZipperCoil::coil_3 && plan.ribbon.narrow_mm > usual_share * design.zipper_mm)
      plan.fixes.push_back({plan.notes.back(),
                            "Use the smallest zipper",
                            {{"coil", EnumNames<ZipperCoil>::names[static_cast<std::size_t>(ZipperCoil::coil_3)]}}});
  }
  if (const double room_mm = tape_room_mm(plan); plan.zipper.tape_width_mm > room_mm) {
    const double missing_mm = plan.zipper.tape_width_mm - room_mm;
    plan.notes.push_back("Behind the ribbon each tape reaches the seam of the other one: trim the tapes by " +
                         with_decimals(missing_mm, 0) + " mm, or make the ribbon " + with_decimals(missing_mm, 0) +
                         " mm wider.");
    const double trimmed_mm = std::floor(room_mm);
    if (trimmed_mm >= min_tape_mm)
      plan.fixes.push_back({plan.notes.back(),
                            "Trim the tapes to " + with_decimals(trimmed_mm, 0) + " mm",
                            {{"tape_width_mm", trimmed_mm}}});
  }
  constexpr double crumb_mm2 = 20;
  const auto crumbs = std::count_if(plan.pieces.pieces.begin(), plan.pieces.pieces.end(),
                                    [](const PlanPiece& piece) { return piece.ribbon_area_mm2 < crumb_mm2; });
  if (crumbs > 0)
    plan.notes.push_back(plural(static_cast<int>(crumbs), "piece is", "pieces are") +
                         " smaller than 20 mm² and may be left out: corners where the ribbon meets itself.");
  if (plan.pieces.shortened_allowances > 0)
    plan.notes.push_back(plural(plan.pieces.shortened_allowances, "seam allowance", "seam allowances") +
                         " would have met their own piece and are shorter or left out.");
  if (plan.pieces.left_out_texts > 0)
    plan.notes.push_back(plural(plan.pieces.left_out_texts, "number or letter", "numbers and letters") +
                         " found no room: lower the text height.");
  if (plan.pieces.left_out_texts > 0 && options.text_height_mm > min_text_mm)
    plan.fixes.push_back({plan.notes.back(),
                          "Print smaller numbers",
                          {{"text_height_mm", std::max(min_text_mm, options.text_height_mm - 1)}}});
  if (plan.tabs && plan.tabs->shortened + plan.tabs->left_out > 0)
    plan.notes.push_back(
        plural(plan.tabs->shortened, "tab is", "tabs are") + " shorter and " +
        plural(plan.tabs->left_out, "is", "are") +
        " left out where paper lies too close beside them. Use a wider ribbon or a smaller tab depth.");
  if (plan.tabs && plan.tabs->shortened + plan.tabs->left_out > 0 && options.tab_depth_mm > min_tab_mm)
    plan.fixes.push_back({plan.notes.back(),
                          "Make the tabs less deep",
                          {{"tab_depth_mm", std::max(min_tab_mm, options.tab_depth_mm - 1)}}});
  const auto whole_mm = [](double mm) { return std::to_string(static_cast<int>(std::lround(mm))) + " mm"; };
  if (plan.closures.narrow_mm > 1)
    plan.notes.push_back(
        "Along " + whole_mm(plan.closures.narrow_mm) +
        " of the edges named HOOK the cloth is narrower than the hook-and-loop tape, whose line ends there: trim the tape.");
  if (plan.closures.shallow_mm > 1)
    plan.notes.push_back("Along " + whole_mm(plan.closures.shallow_mm) + " of the edges named " +
                         (plan.has_tape() ? "LOOP" : "JOIN") +
                         " the allowance would have met its own piece and is less deep.");
  if (plan.rig && plan.rig->blind_tracks > 0)
    plan.notes.push_back(plural(plan.rig->blind_tracks, "track", "tracks") +
                         " of the rig found no room for an opening: lay the tape in before the cover is screwed on.");
  if (plan.rig && plan.rig->left_out_mm > 1)
    plan.notes.push_back("The rig has no track along " +
                         std::to_string(static_cast<int>(std::lround(plan.rig->left_out_mm))) +
                         " mm of the edges, where two tracks would meet: hold the tape there by hand.");
  if (!plan.tabs && options.coil == ZipperCoil::none && plan.zipper.offset_mm() == 0)
    plan.notes.push_back("Without a zipper the edges stay where they are: paper is joined edge to edge.");
}

}  // namespace

std::string fabric_name(int fabric) { return "Colour " + std::to_string(fabric + 1); }

Vec2 paper_size_mm(InstructionPaper paper) {
  return paper == InstructionPaper::a4 ? Vec2(210, 297) : Vec2(215.9, 279.4);
}

PlanRecord record_of(const FlatDesign& design, const ZippablePlan& plan) {
  PlanRecord record;
  record.marker_spacing_mm = plan.marker_spacing_mm;
  for (Eigen::Index f = 0; f < design.F.rows(); ++f) {
    const Eigen::Matrix2d& turn =
        plan.nesting.places[static_cast<std::size_t>(plan.splitting.piece_of_face[static_cast<std::size_t>(f)])].turn;
    record.turn_of_triangle_rad.push_back(std::atan2(turn(1, 0), turn(0, 0)));
  }
  return record;
}

ZippablePlan plan_zippable(const FlatDesign& design, const PlanOptions& given, Context& context) {
  ZippablePlan plan;
  const PlanOptions options = with_room_for_the_cloth(given);
  Stopwatch watch;
  std::vector<Vec2> designed;
  for (const FlatVertex& v : design.boundary) designed.push_back(v.flat_mm);
  plan.width_mean_mm = area_mm2(design.F, designed) / std::max(design.zipper_mm, 1e-300);
  plan.zipper = zipper_model(options);
  const bool tabs = options.edges == PaperEdges::tabs;
  if (tabs && (plan.has_tape() || plan.zipper.offset_mm() > 0))
    throw Error(ErrorCode::invalid_input, "edges",
                "Tabs are for paper models without a zipper: set the zipper to none, or the edges to plain.");
  std::optional<RigSizes> rig;
  if (options.rig) rig = rig_sizes(given, plan.zipper);
  plan.edges_moved_mm = plan.zipper.offset_mm() + 0.5 * options.more_gap_mm - options.seam_take_up_mm;
  plan.ribbon = offset_ribbon(design, options.method, plan.edges_moved_mm);
  plan.area_before_mm2 = area_mm2(design.F, plan.ribbon.flat_mm);
  plan.marker_spacing_mm =
      options.marker_spacing_mm.value_or(options.method == ZipperOffset::sewing && !options.rig ? 30 : 50);
  plan.markers = place_markers(design, plan.ribbon, plan.marker_spacing_mm);
  plan.seconds_offset = watch.lap();

  const NestingOptions nesting{options.bed_x_mm, options.bed_y_mm, options.margin_mm, options.spacing_mm,
                               options.grain == GrainDirection::along_pieces};
  // Allowances, tabs and kerf are added after splitting; nesting needs a few cells to spare.
  ClosureMarkOptions closing{plan.has_tape() ? options.hook_and_loop_mm : 0.0,
                             plan.has_tape() ? options.hook_and_loop_mm
                             : tabs          ? options.tab_depth_mm
                                             : 0.0,
                             tabs ? options.tab_length_mm : 0.0, plan.marker_spacing_mm, options.kerf_mm + 0.1};
  const double beyond = std::max(options.seam_allowance_mm, design.closures.empty() ? 0.0 : closing.flap_mm);
  const double around =
      rig ? std::max(rig_rim_mm(options, *rig), beyond) : std::max(beyond, tabs ? options.tab_depth_mm : 0.0);
  const double reserved = 2 * (options.margin_mm + around + options.kerf_mm) + 4 * nesting_cell_mm(nesting);
  // Between windings there is the kerf; on the rig, a track for each of the two edges and a wall between them.
  const double between = rig ? 2 * rig->offset_mm + rig->track_mm + rig->wall_mm : options.kerf_mm + 0.5;
  const double free_x = options.bed_x_mm - reserved, free_y = options.bed_y_mm - reserved;
  const auto fits = [&](const Polygon& hull) {
    return hull.size() < 2 || !fitting_turns(hull, free_x, free_y, nesting.keep_direction).empty();
  };
  // Smaller pieces than a quarter of the ribbon's width squared are hard to hold.
  const double min_area_mm2 = plan.width_mean_mm * plan.width_mean_mm / 4;
  {
    const auto span = context.span(0, 0.5, "Splitting");
    plan.splitting =
        split_ribbon(design.F, plan.ribbon.flat_mm, fits, between, min_area_mm2, context, design.fabric_of_face);
  }
  plan.fabrics = design.fabrics;
  plan.fabric_of_piece.assign(std::size_t(plan.splitting.piece_count), 0);
  for (std::size_t f = 0; f < design.fabric_of_face.size(); ++f)
    plan.fabric_of_piece[plan.splitting.piece_of_face[f]] = design.fabric_of_face[f];
  plan.runs = tape_runs(design, plan.ribbon, plan.splitting, plan.markers);
  plan.seams = seams_in_order(plan.splitting, plan.ribbon.flat_mm, plan.runs, plan.markers, plan.has_tape());
  if (tabs)
    plan.tabs = make_glue_tabs(design, plan.ribbon.flat_mm, plan.splitting, plan.seams,
                               {options.tab_depth_mm, options.tab_length_mm, options.kerf_mm + 0.1}, context);
  plan.closures = mark_closures(design, plan.ribbon.flat_mm, plan.splitting, closing, context);
  plan.pieces =
      make_pieces(design.F, plan.ribbon.flat_mm, plan.splitting, plan.markers, plan.tabs, options.seam_allowance_mm,
                  options.kerf_mm, options.text_height_mm, {&plan.closures, plan.has_tape()});
  plan.seconds_split = watch.lap();
  {
    const auto span = context.span(0.5, 1, "Nesting");
    nest_by_fabric(plan, nesting, context);
  }
  plan.sheets = lay_out(plan, options);
  make_up_for_the_cloth(plan.sheets, given);
  const Vec2 paper = paper_size_mm(options.paper);
  plan.tape =
      make_tape_template(design, plan.zipper, plan.markers, plan.marker_spacing_mm, plan.runs, paper.y(), paper.x());
  if (rig) plan.rig = make_rig(design, plan.ribbon, plan.markers, plan.pieces, plan.runs, given, *rig, context);
  plan.seconds_nest = watch.lap();
  say_what_to_know(design, options, plan);
  if (std::string text = corrections_in_words(given); !text.empty()) plan.notes.push_back(std::move(text));
  return plan;
}

Bytes write_plan_pdf(const std::vector<CutSheet>& sheets) {
  PdfDocument pdf(plan_title);
  for (const CutSheet& sheet : sheets) {
    pdf.add_page(sheet.width_mm, sheet.height_mm);
    Drawing drawing;
    for (const CutPath& path : sheet.paths) {
      const double width_mm = path.layer == CutLayer::cut ? 0.2 : 0.1;
      for (std::size_t k = 0; k + 1 < path.points_mm.size(); ++k)
        drawing.line(path.points_mm[k], path.points_mm[k + 1], width_mm);
      if (path.closed) drawing.line(path.points_mm.back(), path.points_mm.front(), width_mm);
    }
    pdf.draw(drawing, {}, Vec2::Zero(), Vec2(sheet.width_mm, sheet.height_mm));
  }
  return pdf.finish();
}

}  // namespace formwright
