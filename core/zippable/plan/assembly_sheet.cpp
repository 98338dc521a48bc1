// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/assembly_sheet.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "imaging/flow/page_flow.h"
#include "zippable/plan/piece_picture.h"

namespace formwright {
namespace {

std::string count(std::size_t n, const std::string& one) { return std::to_string(n) + " " + one + (n == 1 ? "" : "s"); }

constexpr double below_pictures_mm = 4;

class AssemblyWriter {
 public:
  AssemblyWriter(const FlatDesign& design, const ZippablePlan& plan, const PlanOptions& options, const Context& context)
      : design_(design),
        plan_(plan),
        options_(options),
        context_(context),
        pdf_("Zippable assembly"),
        flow_(pdf_, paper_size_mm(options.paper), 15) {}

  AssemblySheet write() {
    title();
    material();
    overview();
    flow_.heading(step("Cut"));
    flow_.paragraph(
        "Cut the red lines of plan.svg, plan.dxf or sheets.zip; draw the blue and black ones. Without a machine, print "
        "plan.pdf at 100 % "
        "and cut along it. Arrows show the grain. The side with the numbers becomes the outside: draw on cloth with a "
        "pen that washes out.");
    joins();
    if (plan_.rig) rig();
    if (plan_.has_tape()) tapes();
    else edges();
    if (!plan_.closures.length_mm.empty()) cuts();
    AssemblySheet sheet;
    sheet.pages = flow_.finish();
    sheet.pdf = pdf_.finish();
    return sheet;
  }

 private:
  std::string step(const std::string& what) { return std::to_string(++steps_) + ". " + what; }
  const std::string& name(int piece) const { return plan_.pieces.pieces[piece].name; }
  bool sewn() const { return options_.method == ZipperOffset::sewing; }

  static std::string marks(const Seam& seam) {
    if (seam.first_marker > seam.last_marker) return "no number on it";
    if (seam.first_marker == seam.last_marker) return "number " + std::to_string(seam.first_marker);
    return "numbers " + std::to_string(seam.first_marker) + " to " + std::to_string(seam.last_marker);
  }

  void title() {
    flow_.heading(plan_.has_tape() ? "Assembly of a zippable" : "Assembly of a paper model");
    flow_.paragraph(count(plan_.pieces.pieces.size(), "piece") + ", " + count(plan_.seams.size(), "seam") +
                    ". Print at 100 %: the bar from 0 to 100 must measure 100 mm.");
    const Vec2 corner = flow_.room(14);
    const double y = corner.y() + 9;
    Drawing& d = flow_.drawing();
    d.line({corner.x() + 5, y}, {corner.x() + 105, y}, 0.2);
    for (int mm = 0; mm <= 100; mm += 10)
      d.line({corner.x() + 5 + mm, y}, {corner.x() + 5 + mm, y + (mm % 50 == 0 ? 3 : 1.5)}, 0.2);
    for (const int mm : {0, 100}) d.label({corner.x() + 5 + mm, y - 3}, 2.6, std::to_string(mm));
  }

  void material() {
    flow_.heading("What you need");
    for (int fabric = 0; fabric < plan_.fabrics; ++fabric) {
      double area = 0;
      for (std::size_t i = 0; i < plan_.pieces.pieces.size(); ++i)
        if (plan_.fabric_of_piece[i] == fabric) area += signed_area_mm2(plan_.pieces.pieces[i].outline_mm);
      const auto sheets = std::count(plan_.fabric_of_sheet.begin(), plan_.fabric_of_sheet.end(), fabric);
      const std::string colour = plan_.fabrics > 1 ? ", " + fabric_name(fabric) : "";
      flow_.paragraph("- " + std::string(plan_.has_tape() ? "Cloth" : "Paper or card") + colour + ": " +
                      count(static_cast<std::size_t>(sheets), "sheet") + " of " + with_decimals(options_.bed_x_mm, 0) +
                      " by " + with_decimals(options_.bed_y_mm, 0) + " mm; the pieces take " +
                      with_decimals(area / 100, 0) + " square centimetres of it" + pieces_of(fabric) + ".");
    }
    if (plan_.has_tape()) {
      const std::string coil =
          options_.coil == ZipperCoil::none
              ? ""
              : ", size " + std::string(EnumNames<ZipperCoil>::names[static_cast<std::size_t>(options_.coil)]);
      flow_.paragraph(
          "- Zipper: " + with_decimals(zipper_to_cut_mm(design_, plan_) / 1000, 2) + " m of coil zipper from the reel" +
          coil + " (" + with_decimals(design_.zipper_mm, 0) + " mm and " + with_decimals(zipper_end_mm, 0) +
          " mm at each end to hold), each tape " + with_decimals(plan_.zipper.tape_width_mm, 1) + " mm wide, teeth " +
          with_decimals(plan_.zipper.teeth_width_mm, 1) + " mm; one slider, put on at the end with number 0.");
      flow_.paragraph(sewn() ? "- Thread, a sewing machine with a zipper foot, pins."
                             : "- Contact glue for cloth, clips.");
      flow_.paragraph("- tape.pdf, printed at 100 %, and a pen for the zipper.");
      for (const double mm : plan_.closures.length_mm)
        flow_.paragraph("- Hook-and-loop tape, " + with_decimals(options_.hook_and_loop_mm, 0) + " mm wide: 2 x " +
                        with_decimals(mm, 0) + " mm.");
    } else {
      flow_.paragraph("- Glue that sets quickly" + std::string(plan_.tabs
                                                                   ? "; a blunt knife to score the folds of the tabs."
                                                                   : ", or adhesive tape behind the seams."));
    }
  }

  /// ": P1, P3" where there is more than one fabric.
  std::string pieces_of(int fabric) const {
    std::string names;
    if (plan_.fabrics > 1)
      for (std::size_t i = 0; i < plan_.pieces.pieces.size(); ++i)
        if (plan_.fabric_of_piece[i] == fabric) names += (names.empty() ? ": " : ", ") + plan_.pieces.pieces[i].name;
    return names;
  }

  void overview() {
    flow_.heading("How to read the pieces");
    flow_.paragraph(
        "Numbers stand every " + with_decimals(plan_.marker_spacing_mm, 0) +
        " mm along the edges, from 0 where the zipper begins; the same number stands once on a left edge and "
        "once on a right edge, and these two places meet. Letters stand where the ribbon was split; the same letter "
        "stands on two pieces. "
        "In the pictures left edges are thick, right edges thin, splits dashed; circles hold the numbers of the "
        "seams.");
    constexpr double height = 90;
    const Vec2 corner = flow_.room(height);
    // The whole ribbon, which may lie over itself.
    Vec2 lower = Vec2::Constant(1e300), upper = -lower;
    for (const Vec2& p : plan_.ribbon.flat_mm) lower = lower.cwiseMin(p), upper = upper.cwiseMax(p);
    const Vec2 extent = (upper - lower).cwiseMax(1e-9);
    const double scale = std::min({1.0, (flow_.width_mm() - 10) / extent.x(), (height - 10) / extent.y()});
    const auto at = [&](const Vec2& p) {
      return Vec2(corner + Vec2(flow_.width_mm(), height) / 2 + scale * (p - (lower + upper) / 2));
    };
    Drawing& d = flow_.drawing();
    for (int v = 0; v < design_.vertex_count(); ++v)
      d.line(at(plan_.ribbon.flat_mm[v]), at(plan_.ribbon.flat_mm[design_.next(v)]),
             design_.zipper_edge(v) && design_.boundary[v].left ? left_edge_stroke_mm : right_edge_stroke_mm);
    for (const RibbonSplit& split : plan_.splitting.splits)
      d.line(at(plan_.ribbon.flat_mm[split.from]), at(plan_.ribbon.flat_mm[split.to]), 0.3, true);
    std::vector<std::pair<double, Vec2>> widest(plan_.pieces.pieces.size(), {-1, Vec2::Zero()});
    for (Eigen::Index f = 0; f < design_.F.rows(); ++f) {
      const Vec2 &a = plan_.ribbon.flat_mm[design_.F(f, 0)], &b = plan_.ribbon.flat_mm[design_.F(f, 1)],
                 &c = plan_.ribbon.flat_mm[design_.F(f, 2)];
      auto& best = widest[plan_.splitting.piece_of_face[f]];
      if (const double area = signed_area_mm2({a, b, c}); area > best.first) best = {area, (a + b + c) / 3};
    }
    for (std::size_t i = 0; i < widest.size(); ++i) d.label(at(widest[i].second), 2.6, name(static_cast<int>(i)));
    flow_.paragraph("The whole ribbon, scale 1 : " + with_decimals(1 / scale, 1) +
                    ". Where it lies over itself it has been split.");
  }

  void joins() {
    const bool any = !plan_.seams.empty() && plan_.seams.front().kind == SeamKind::join;
    if (!any) return;
    flow_.heading(step("Join the pieces"));
    if (plan_.has_tape())
      flow_.paragraph(
          sewn() ? "Sew flat, with the numbers inside, along the line beside the letter: " +
                       with_decimals(options_.seam_allowance_mm, 0) + " mm from the edge. Press the allowances apart."
                 : "Glue one allowance over the other so that the lines beside the letters lie on each other.");
    else
      flow_.paragraph(
          plan_.tabs ? "Fold the tab at the letter and glue it behind the edge with the same letter."
                     : "Glue one allowance over the other so that the lines beside the letters lie on each other.");
    for (std::size_t i = 0; i < plan_.seams.size() && plan_.seams[i].kind == SeamKind::join; ++i) {
      const Seam& seam = plan_.seams[i];
      context_.check_cancelled();
      constexpr double height = 62;
      const Vec2 corner = flow_.room(height + 6 + below_pictures_mm) + Vec2(0, below_pictures_mm),
                 size(flow_.width_mm() / 2 - 4, height);
      const std::string words = "Seam " + std::to_string(i + 1) + ": letter " + seam.letters + ", " + name(seam.piece) +
                                " to " + name(seam.other_piece) + ", " + with_decimals(seam.cloth_mm, 1) + " mm long.";
      flow_.drawing().label(corner + Vec2(pdf_.text_width_mm(words, 2.6) / 2, height + 4), 2.6, words);
      show(seam.piece, corner, size, seam.letters, {});
      show(seam.other_piece, corner + Vec2(size.x() + 8, 0), size, seam.letters, {});
    }
  }

  void show(int piece, const Vec2& corner, const Vec2& size, const std::string& letters,
            const std::vector<SeamTag>& tags) {
    const PiecePicture picture = picture_of_piece(design_, plan_, piece, size, letters, tags);
    Drawing& d = flow_.drawing();
    d.rectangle(corner, corner + size, outline_stroke_mm);
    for (Stroke s : picture.drawing.strokes) s.from += corner, s.to += corner, d.strokes.push_back(s);
    for (Label l : picture.drawing.labels) l.centre += corner, d.labels.push_back(std::move(l));
  }

  void pieces_with_seams() {
    flow_.paragraph("The pieces with the numbers of their seams:");
    constexpr double height = 74;
    const Vec2 size(flow_.width_mm() / 2 - 4, height);
    Vec2 corner(0, 0);
    for (std::size_t p = 0; p < plan_.pieces.pieces.size(); ++p) {
      context_.check_cancelled();
      if (p % 2 == 0) corner = flow_.room(height + below_pictures_mm) + Vec2(0, below_pictures_mm);
      std::vector<SeamTag> tags;
      for (std::size_t i = 0; i < plan_.seams.size(); ++i) {
        const Seam& seam = plan_.seams[i];
        const double middle = (seam.from_mm + seam.to_mm) / 2;
        const int n = static_cast<int>(i) + 1, piece = static_cast<int>(p);
        if (seam.kind == SeamKind::tape && seam.piece == piece) tags.push_back({n, seam.left, middle});
        if (seam.kind == SeamKind::edge && seam.piece == piece) tags.push_back({n, true, middle});
        if (seam.kind == SeamKind::edge && seam.other_piece == piece) tags.push_back({n, false, middle});
      }
      show(static_cast<int>(p), corner + Vec2(p % 2 == 0 ? 0 : size.x() + 8, 0), size, "", tags);
    }
  }

  void rig() {
    const Rig& rig = *plan_.rig;
    flow_.heading(step("Screw the rigs together"));
    flow_.paragraph(
        "Cut rig.svg, rig.dxf or rig.pdf from board or acrylic glass: for every piece a base, a layer with tracks " +
        with_decimals(options_.track_width_mm, 1) + " mm wide, as thick as the teeth, and a cover. " +
        count(static_cast<std::size_t>(rig.screws), "screw") + " of " + with_decimals(options_.screw_mm, 1) +
        " mm hold them; a piece whose rig is done lends its screws to the next.");
    flow_.paragraph(
        "Slide each tape in at an opening, teeth into the track, tape up through the slot, until its numbers stand at those of the cover. "
        "Lay the piece into its outline, put glue on the tape, press it flat behind the cloth, and let it set before it leaves the rig. Cut "
        "into the tape every few centimetres so that it lies flat on curves.");
  }

  void tapes() {
    flow_.heading(step("Mark the zipper"));
    flow_.paragraph(
        "Close the zipper and lay it on tape.pdf row by row; copy the strokes and numbers onto both tapes. Row by row "
        "the last number is the next row's first. "
        "Then take the slider off and part the two tapes.");
    for (const bool left : {true, false}) {
      flow_.heading(step(left ? "Attach the left tape" : "Attach the right tape"));
      if (left) {
        flow_.paragraph(
            "Lay the tape behind the cloth, teeth outwards, with " + with_decimals(plan_.zipper.gap_mm, 1) +
            " mm between the teeth and the edge, number on number; pin or clip it number by number and then " +
            (sewn() ? "sew" : "glue") +
            " it. On curves cut into the tape every few centimetres, not into its teeth, so that it bends.");
        pieces_with_seams();
      }
      for (std::size_t i = 0; i < plan_.seams.size(); ++i)
        if (const Seam& seam = plan_.seams[i]; seam.kind == SeamKind::tape && seam.left == left) {
          const double longer = seam.cloth_mm - seam.tape_mm();
          std::string words = "Seam " + std::to_string(i + 1) + ": along " + name(seam.piece) + ", " + marks(seam) +
                              ", " + with_decimals(seam.tape_mm(), 0) + " mm";
          if (std::abs(longer) >= 1)
            words += "; the cloth is " + with_decimals(std::abs(longer), 1) + " mm " +
                     (longer > 0 ? "longer: ease it in" : "shorter: ease the tape in");
          flow_.paragraph(words + ".", 4);
        }
    }
    flow_.heading(step("Zip it up"));
    flow_.paragraph(
        "Lay both ends with number 0 side by side, put the slider on, and pull it along: the model takes shape by "
        "itself. Cut off what the zipper is too long.");
  }

  void edges() {
    flow_.heading(step(plan_.tabs ? "Score, fold and glue the tabs" : "Glue edge to edge"));
    flow_.paragraph(
        plan_.tabs
            ? "Score the blue lines at the feet of the tabs and fold them back. Begin at number 0 and go on number by "
              "number: every tab goes behind the edge that carries the same numbers."
            : "Begin at number 0 and go on number by number: the left edge meets the right edge with the same number.");
    pieces_with_seams();
    for (std::size_t i = 0; i < plan_.seams.size(); ++i)
      if (const Seam& seam = plan_.seams[i]; seam.kind == SeamKind::edge)
        flow_.paragraph("Seam " + std::to_string(i + 1) + ": left edge of " + name(seam.piece) + " to right edge of " +
                            name(seam.other_piece) + ", " + marks(seam) + ", " + with_decimals(seam.tape_mm(), 0) +
                            " mm.",
                        4);
  }

  /// What the zipper does not close: which pieces, and how.
  void cuts() {
    const std::size_t count_of = plan_.closures.length_mm.size();
    const bool tape = plan_.has_tape();
    flow_.heading(step(count_of == 1 ? "Close the cut" : "Close the cuts"));
    if (tape)
      flow_.paragraph(
          std::string(sewn() ? "Sew" : "Glue") +
          " the hook tape behind the edges named HOOK, between the edge and the line beside it, and the loop tape " +
          "onto the front of the allowance beyond the edges named LOOP, up to the line; both before the zipper is attached, as long as the cloth is flat. "
          "When it is zipped up lay the HOOK edge onto the line of the LOOP edge, same numbers on each other, and press.");
    else
      flow_.paragraph(
          plan_.tabs
              ? "The zipped edges leave a cut. Fold the tabs of one of its edges named JOIN back and glue them behind the other, same numbers on each other."
              : "The joined edges leave a cut. Its edges named JOIN meet edge to edge, same numbers on each other: put adhesive tape behind them.");
    for (std::size_t c = 0; c < count_of; ++c) {
      const int cut = static_cast<int>(c) + 1;
      const auto pieces = [&](ClosureSide side) {
        std::string names;
        for (const ClosureStretch& stretch : plan_.closures.stretches)
          if (stretch.cut == cut && stretch.side == side && names.find(name(stretch.piece) + ",") == std::string::npos)
            names += name(stretch.piece) + ", ";
        return names.substr(0, names.size() - 2);
      };
      const auto markers = std::count_if(plan_.closures.markers.begin(), plan_.closures.markers.end(),
                                         [&](const ClosureMarker& m) { return m.cut == cut; });
      flow_.paragraph("Cut " + std::to_string(cut) + ", " + with_decimals(plan_.closures.length_mm[c], 0) +
                          " mm: " + closure_words(cut, ClosureSide::hook, tape) + " on " + pieces(ClosureSide::hook) +
                          " and " + closure_words(cut, ClosureSide::loop, tape) + " on " + pieces(ClosureSide::loop) +
                          ", " + count(static_cast<std::size_t>(markers), "number") + " on either, every " +
                          with_decimals(plan_.marker_spacing_mm, 0) + " mm, from " + std::to_string(cut) +
                          "-0 where the zipper meets it.",
                      4);
    }
  }

  const FlatDesign& design_;
  const ZippablePlan& plan_;
  const PlanOptions& options_;
  const Context& context_;
  PdfDocument pdf_;
  PageFlow flow_;
  int steps_ = 0;
};

}  // namespace

double zipper_to_cut_mm(const FlatDesign& design, const ZippablePlan& plan) {
  return plan.has_tape() ? 10 * std::ceil((design.zipper_mm + 2 * zipper_end_mm) / 10) : 0;
}

AssemblySheet write_assembly_sheet(const FlatDesign& design, const ZippablePlan& plan, const PlanOptions& options,
                                   const Context& context) {
  return AssemblyWriter(design, plan, options, context).write();
}

}  // namespace formwright
