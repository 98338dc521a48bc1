// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/zippable_design.h"

#include <algorithm>
#include <numbers>

#include "base/format.h"
#include "base/error.h"
#include "base/data/number_list.h"
#include "geometry/mesh/measures.h"

namespace formwright {
namespace {

void check_width(double size_mm, const ZippableOptions& options) {
  if (options.width_mm > 0.5 * size_mm)
    throw Error(
        ErrorCode::invalid_input, "width_mm",
        "The model is too small for this ribbon, which is wider than half of it: choose a narrower ribbon or a larger size.");
  if (options.width_mm < 1e-3 * size_mm)
    throw Error(
        ErrorCode::invalid_input, "width_mm",
        "The ribbon is narrower than a thousandth of the model's size: choose a wider ribbon or a smaller size.");
}

/// Per part, 0 where nothing was said.
std::vector<double> part_windings(const std::string& text, int part_count) {
  const auto given = read_number_list(text);
  const auto count = static_cast<std::size_t>(part_count);
  if (!given ||
      std::any_of(given->begin(), given->end(), [](double windings) { return windings < 0 || windings > 1000; }))
    throw Error(ErrorCode::invalid_input, "part_windings",
                "Windings per part must be numbers from 0 to 1000, separated by spaces, such as “3 0 2.5”.");
  if (given->size() > count)
    throw Error(ErrorCode::invalid_input, "part_windings",
                "There are only " + std::to_string(part_count) + " parts: give windings for these.");
  std::vector<double> windings = *given;
  windings.resize(count, 0);
  return windings;
}

FeatureOptions features_asked_for(const TriangleMesh& mesh, const ZippableOptions& options) {
  return {feature_scale_mm(mesh, options.width_mm, options.crease_mm.value_or(0)),
          options.crease_degrees * std::numbers::pi / 180};
}

/// Those that begin and end where they should, the even ones first.
std::vector<RankedTraversal> orders_asked_for(const ParameterisedModel& model, const ZippableOptions& options,
                                              const Context& context) {
  const Segmentation& s = model.proposal.segmentation;
  std::vector<RankedTraversal> ranked = ranked_traversals(s, model.parameterisation, options.width_mm, context);
  if (ranked.empty())
    throw Error(ErrorCode::invalid_input, "mesh",
                "No order visits every part once: join or move parts so that they form a chain.");
  const auto keep = [&](int part, const char* where, const auto& end_of) {
    if (part > s.part_count())
      throw Error(ErrorCode::invalid_input, where,
                  "There are only " + std::to_string(s.part_count()) + " parts: choose one of them.");
    if (part > 0) std::erase_if(ranked, [&](const RankedTraversal& r) { return end_of(r.traversal) != part - 1; });
    if (ranked.empty())
      throw Error(ErrorCode::invalid_input, where,
                  "No order that visits every part once has its ends there: choose another part.");
  };
  const auto front = [](const Traversal& t) { return t.parts.front(); };
  const auto back = [](const Traversal& t) { return t.parts.back(); };
  // A number given now goes before a point in segments.json.
  options.start_part > 0 ? keep(options.start_part, "start_part", front) : keep(model.start_part, "segments", front);
  options.end_part > 0 ? keep(options.end_part, "end_part", back) : keep(model.end_part, "segments", back);
  if (options.traversal > static_cast<int>(ranked.size()))
    throw Error(ErrorCode::invalid_input, "traversal",
                "There are only " + std::to_string(ranked.size()) + " orders of these parts: choose one of them.");
  return ranked;
}

void say_how_it_bends(ZippableDesign& design, const ZippableOptions& options) {
  if (!design.bend) return;
  if (design.bend->radius_mm < *options.min_radius_mm)
    design.notes.push_back(
        "The ribbon's centre line bends to a radius of " + with_digits(design.bend->radius_mm, 3) + " mm, less than " +
        with_digits(*options.min_radius_mm, 3) +
        " mm, in every order of the parts. Use a narrower ribbon, larger holes at the tips or other borders of the parts.");
  else if (design.traversal_number != options.traversal)
    design.notes.push_back("Order " + std::to_string(design.traversal_number) +
                           " was chosen, the first one that keeps the smallest radius.");
}

}  // namespace

double automatic_size_mm(double size_in_file) {
  // Files know no unit. An object of sewn fabric has a size between these; other numbers are metres, inches or units.
  constexpr double min_mm = 50, max_mm = 3000, usual_mm = 300;
  return size_in_file >= min_mm && size_in_file <= max_mm ? size_in_file : usual_mm;
}

ParameterisedModel divide_model(const TriangleMesh& given, const ZippableParts& parts, const ZippableOptions& options,
                                Context& context) {
  ParameterisedModel model;
  const double size = bounding_box(given).size().maxCoeff();
  if (!(size > 0)) throw Error(ErrorCode::invalid_input, "mesh", "The model has no extent: choose another file.");
  model.scale = options.size_mm.value_or(automatic_size_mm(size)) / size;
  model.mesh = {given.V * model.scale, given.F};
  check_width(size * model.scale, options);
  Stopwatch watch;
  ProposalOptions proposal;
  proposal.puncture_radius_mm = 0.5 * options.hole_mm();
  proposal.parts_max = options.parts_max;
  proposal.prominence = 0.01 * options.prominence_percent;
  proposal.accept_all_parts = options.check_parts;
  proposal.follow_creases = options.borders == PartBorders::creases;
  proposal.features = features_asked_for(model.mesh, options);
  proposal.snap_reach_mm = 0.5 * options.width_mm;
  for (const Vec3& tip : parts.punctures) proposal.tips_mm.push_back(model.scale * tip);
  proposal.curves = parts.curves;
  for (DrawnCurve& curve : proposal.curves)
    for (Vec3& point : curve.points) point *= model.scale;
  proposal.cuts_mm = parts.cuts;
  for (auto& cut : proposal.cuts_mm)
    for (Vec3& point : cut) point *= model.scale;
  model.proposal = propose_segmentation(model.mesh, proposal, context);
  if (!options.size_mm && model.scale != 1)
    model.proposal.notes.insert(model.proposal.notes.begin(),
                                "The file does not tell the size in mm (its largest dimension is " +
                                    with_digits(size, 3) + "), so the object is made " +
                                    with_digits(size * model.scale, 3) + " mm large: set the size for another.");
  const auto part_at = [&](const std::optional<Vec3>& point) {
    if (!point) return 0;
    const Segmentation& s = model.proposal.segmentation;
    return 1 + s.face_segment[PointDistance(s.mesh).nearest(model.scale * *point)->face];
  };
  model.start_part = part_at(parts.start), model.end_part = part_at(parts.end);
  model.seconds_parts = watch.lap();
  return model;
}

ParameterisedModel parameterise_model(const TriangleMesh& given, const ZippableParts& parts,
                                      const ZippableOptions& options, Context& context) {
  ParameterisedModel model;
  {
    const auto span = context.span(0, 0.25, "Looking for limbs");
    model = divide_model(given, parts, options, context);
  }
  Stopwatch watch;
  {
    const auto span = context.span(0.25, 1, "Parameterising");
    model.parameterisation = parameterise(model.proposal.segmentation, {}, context);
  }
  if (options.winding_course == WindingCourse::creases) {
    const TriangleMesh& mesh = model.proposal.segmentation.mesh;
    model.crease_system = std::make_shared<CreaseSystem>(model.proposal.segmentation, context);
    model.features =
        find_features(mesh, model.crease_system->adjacency(), features_asked_for(model.mesh, options), context);
  }
  model.seconds_parameterisation = watch.lap();
  return model;
}

std::string parameterisation_key(const ZippableOptions& options, const ZippableParts& parts) {
  ZippableOptions relevant;
  relevant.size_mm = options.size_mm;
  relevant.parts_max = options.parts_max;
  relevant.prominence_percent = options.prominence_percent;
  relevant.puncture_mm = options.hole_mm();
  // Creases count at the ribbon's scale.
  relevant.borders = options.borders, relevant.winding_course = options.winding_course;
  const auto snaps = [](const DrawnCurve& curve) { return curve.snap.value_or(false); };
  const bool creases = options.winding_course == WindingCourse::creases || options.borders == PartBorders::creases ||
                       std::any_of(parts.curves.begin(), parts.curves.end(), snaps);
  if (creases)
    relevant.width_mm = options.width_mm, relevant.crease_mm = options.crease_mm,
    relevant.crease_degrees = options.crease_degrees;
  return write_parameters(relevant).dump();
}

ZippableDesign design_zippable(const ParameterisedModel& model, const ZippableOptions& options, Context& context) {
  const double size_mm = bounding_box(model.mesh).size().maxCoeff();
  check_width(size_mm, options);
  ZippableDesign design;
  const Segmentation& s = model.proposal.segmentation;
  design.notes = model.proposal.notes;
  Stopwatch watch;
  context.progress(0, "Drawing the curve");
  const std::vector<RankedTraversal> ranked = orders_asked_for(model, options, context);
  design.traversal_count = static_cast<int>(ranked.size());
  CurveOptions curve;
  curve.width_mm = options.width_mm;
  curve.windings = options.windings;
  curve.part_windings = part_windings(options.part_windings, s.part_count());
  curve.sample_mm = options.sample_mm.value_or(0.2 * options.width_mm);
  // The order that was chosen, and where it bends too tightly those after it.
  constexpr std::size_t max_tries = 24;
  const std::size_t first = static_cast<std::size_t>(options.traversal - 1),
                    end = options.min_radius_mm ? std::min(ranked.size(), first + max_tries) : first + 1;
  std::optional<LineTracer> tracer;  // one for all orders where windings are even
  if (!model.features) tracer.emplace(s, model.parameterisation);
  for (std::size_t i = first; i < end; ++i) {
    ZippableDesign candidate;
    candidate.traversal = ranked[i];
    if (model.features) {
      ZipperCurve placed;
      const auto lines =
          place_lines(s, model.parameterisation, ranked[i].traversal, ranked[i].crossings, curve, placed);
      candidate.alignment =
          align_to_creases(s, model.parameterisation, *model.crease_system, *model.features, lines, {}, context);
    }
    const Parameterisation& chart =
        candidate.alignment ? candidate.alignment->parameterisation : model.parameterisation;
    if (candidate.alignment) tracer.emplace(s, chart);
    candidate.curve = draw_zipper_curve(s, chart, *tracer, ranked[i].traversal, ranked[i].crossings, curve, context);
    design.seconds_curve += watch.lap();
    if (i == first) context.progress(0.3, "Unfolding the ribbon");
    candidate.ribbon = make_ribbon(s, chart, *tracer, candidate.curve, curve, context, model.proposal.taped_cuts);
    candidate.bend = tightest_bend(candidate.ribbon, options.width_mm);
    design.seconds_ribbon += watch.lap();
    if (i == first || (candidate.bend && design.bend && candidate.bend->radius_mm > design.bend->radius_mm)) {
      design.traversal = std::move(candidate.traversal);
      design.curve = std::move(candidate.curve);
      design.alignment = std::move(candidate.alignment);
      design.ribbon = std::move(candidate.ribbon);
      design.bend = candidate.bend;
      design.traversal_number = static_cast<int>(i) + 1;
    }
    if (!design.bend || design.bend->radius_mm >= options.min_radius_mm.value_or(0)) break;
  }
  design.notes.insert(design.notes.end(), design.curve.notes.begin(), design.curve.notes.end());
  if (design.alignment && design.alignment->crease_mm == 0)
    design.notes.push_back(
        "No crease runs in nearly the same direction as the windings, so they stay even. Lower the smallest crease angle, or divide the model into other parts.");
  if (options.min_radius_mm) say_how_it_bends(design, options);
  if (options.fabrics == RibbonFabrics::two) {
    design.fabrics = two_fabrics(design.ribbon, options.width_mm);
    if (!design.fabrics->has_bands)
      design.notes.push_back(
          "The colours meet at one seam only: they interleave in parts that the zipper enters and leaves, and there is none that is "
          "large enough. More parts, or another order of them, mend it.");
  }
  design.seconds_ribbon += watch.lap();
  if (!options.measure_distances) return design;
  context.progress(0.5, "Comparing with the model");
  // A few points across the ribbon and all corners: long triangles of narrow ribbons would else be sampled by the
  // million.
  const double spacing = std::max(0.25 * options.width_mm, 5e-3 * size_mm);
  const TriangleMesh formed = design.ribbon.formed();
  design.ribbon_to_model = surface_distance(formed, PointDistance(model.mesh), spacing, context);
  design.model_to_ribbon = surface_distance(model.mesh, PointDistance(formed), spacing, context);
  design.seconds_distance = watch.lap();
  return design;
}

}  // namespace formwright
