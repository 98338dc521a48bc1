// SPDX-License-Identifier: GPL-3.0-or-later
// A shape's lines: whether they are painted, on which layer, dashed and clipped.
#include <algorithm>
#include <cctype>
#include <numeric>

#include "fabrication/svg/dashes.h"
#include "fabrication/svg/drawing_layers.h"
#include "fabrication/svg/grammar/svg_grammar.h"
#include "fabrication/svg/svg_shapes.h"
#include "fabrication/svg/svg_walker.h"

namespace formwright {
namespace {

FillRule rule_of(std::string_view text) { return same_word(text, "evenodd") ? FillRule::evenodd : FillRule::nonzero; }

}  // namespace

SvgPaint SvgWalker::stroke_of(const SvgState& state) {
  SvgPaint paint = read_paint(state.stroke, state.colour, read_opacity(state.stroke_opacity), ids_);
  const auto width = read_length(state.stroke_width);
  if (paint.painted && width && width->value <= 0) {
    ++notes.hairlines;
    paint.painted = false;
  }
  return paint;
}

CutLayer SvgWalker::layer_of(const SvgPaint& paint, const SvgState& state) {
  if (state.layer) return *state.layer;
  if (paint.server) ++notes.paint_servers;
  else if (!paint.colour) ++notes.unknown_colours;
  const auto layer = paint.colour ? layer_by_colour(paint.colour->rgb) : std::nullopt;
  if (paint.colour && !layer) ++notes.other_colours;
  return layer.value_or(CutLayer::note);
}

std::vector<SvgWalker::Subpath> SvgWalker::dashed(const pugi::xml_node& node, const SvgValues& values,
                                                  const SvgState& state, std::vector<Subpath> subpaths) {
  if (state.dashes.empty() || same_word(state.dashes, "none")) return subpaths;
  limits_.add_steps(4 * state.dashes.size());
  const auto lengths = read_lengths(state.dashes);
  if (!lengths) {
    ++notes.malformed;
    return subpaths;
  }
  const LengthBase base{state.viewport.diagonal(), state.font_size};
  DashPattern pattern;
  for (const SvgLength& length : *lengths) pattern.lengths.push_back(base.of(length));
  if (const auto offset = read_length(state.dash_offset)) pattern.offset = base.of(*offset);
  if (pattern.lengths.size() % 2 != 0) {
    const std::vector<double> again = pattern.lengths;
    pattern.lengths.insert(pattern.lengths.end(), again.begin(), again.end());
  }
  // Browsers paint the whole line for such patterns.
  const double period = std::accumulate(pattern.lengths.begin(), pattern.lengths.end(), 0.0);
  if (!(period > 0) || std::any_of(pattern.lengths.begin(), pattern.lengths.end(), [](double l) { return l < 0; }))
    return subpaths;
  Eigen::Matrix2d measure = Eigen::Matrix2d::Identity() * user_units_per_mm;
  if (!same_word(values[SvgProperty::vector_effect].text, "non-scaling-stroke"))
    measure = state.to_mm.linear().inverse();
  if (!measure.allFinite()) return subpaths;
  if (const auto declared = read_length(node.attribute("pathLength").value()); declared && declared->value > 0) {
    double whole = 0;
    for (const Subpath& subpath : subpaths)
      for (std::size_t i = subpath.closed ? 0 : 1; i < subpath.points_mm.size(); ++i) {
        const Vec2& before = i == 0 ? subpath.points_mm.back() : subpath.points_mm[i - 1];
        whole += (measure * (subpath.points_mm[i] - before)).norm();
      }
    for (double& length : pattern.lengths) length *= whole / declared->value;
    pattern.offset *= whole / declared->value;
  }
  for (std::size_t i = 0; i < pattern.lengths.size(); i += 2)
    if (pattern.lengths[i] == 0) {
      ++notes.dots;
      break;
    }
  std::vector<Subpath> pieces;
  for (const Subpath& subpath : subpaths)
    for (Subpath& piece : break_into_dashes(subpath, pattern, measure, limits_)) pieces.push_back(std::move(piece));
  return pieces;
}

void SvgWalker::shape(const pugi::xml_node& node, const SvgValues& values, const SvgState& state) {
  if ((!state.visible && measured_ == nullptr) || !state.to_mm.matrix().allFinite()) return;
  CurveFlattener flattener(state.to_mm, flatness_mm_, limits_);
  const SvgLengths lengths(node, values, state.viewport, state.font_size, notes.malformed);
  const auto draw = [&] {
    if (!draw_svg_shape(node, values, lengths, flattener, limits_)) ++notes.malformed;
    return flattener.take();
  };
  if (measured_ != nullptr) {
    for (const Subpath& subpath : draw())
      for (const Vec2& p : subpath.points_mm) measured_->extend(p);
    return;
  }
  if (clip_shapes_ != nullptr) {
    const FillRule rule = rule_of(state.clip_rule);
    std::vector<Subpath> subpaths = draw();
    for (const SvgClip* clip = state.clip.get(); clip != nullptr; clip = clip->around.get())
      subpaths = clip->region->areas_inside(std::move(subpaths), rule);
    ClipRegion::Shape area{{}, rule};
    for (Subpath& subpath : subpaths) area.rings.push_back(std::move(subpath.points_mm));
    clip_shapes_->push_back(std::move(area));
    return;
  }
  const SvgPaint stroke = stroke_of(state),
                 fill = read_paint(state.fill, state.colour, read_opacity(state.fill_opacity), ids_);
  if (!stroke.painted && !fill.painted) return;
  const std::string_view name = svg_local_name(node);
  std::vector<Subpath> subpaths = draw();
  if (stroke.painted) {
    subpaths = dashed(node, values, state, std::move(subpaths));
    for (const SvgClip* clip = state.clip.get(); clip != nullptr; clip = clip->around.get()) {
      std::vector<Subpath> seen;
      for (Subpath& subpath : subpaths)
        for (Subpath& piece : clip->region->lines_inside(std::move(subpath))) seen.push_back(std::move(piece));
      subpaths = std::move(seen);
    }
  } else {
    // A fill reaches to the straight line from its last point to its first; two points enclose nothing.
    const std::size_t all = subpaths.size();
    std::erase_if(subpaths, [](const Subpath& subpath) { return subpath.points_mm.size() < 3; });
    if (subpaths.size() < all) ++notes.unstroked;
    for (Subpath& subpath : subpaths) subpath.closed = true;
    for (const SvgClip* clip = state.clip.get(); clip != nullptr; clip = clip->around.get())
      subpaths = clip->region->areas_inside(std::move(subpaths), rule_of(state.fill_rule));
  }
  if (subpaths.empty()) return;
  const bool has_vertices = name == "path" || name == "line" || name == "polyline" || name == "polygon";
  if (has_vertices && (ids_.contains(url_id(state.marker_start)) || ids_.contains(url_id(state.marker_mid)) ||
                       ids_.contains(url_id(state.marker_end))))
    ++notes.markers;
  keep(std::move(subpaths), layer_of(stroke.painted ? stroke : fill, state), node.attribute("id").value());
}

void SvgWalker::keep(std::vector<Subpath> subpaths, CutLayer layer, const std::string& id) {
  constexpr std::size_t max_name = 100;
  std::string name;
  for (const char c : id.substr(0, max_name))
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_') name += c == '_' ? '-' : c;
  for (Subpath& subpath : subpaths) {
    for (const Vec2& p : subpath.points_mm)
      if (!p.allFinite() || p.cwiseAbs().maxCoeff() > max_reach_mm)
        refuse_drawing("The drawing reaches farther than 20 m: check its units and its transforms.");
    std::string unique = name;
    if (!name.empty())
      if (const int count = ++names_[name]; count > 1) unique += "-" + std::to_string(count);
    limits_.add_points(unique.size() / 16);
    subpath.points_mm.shrink_to_fit();
    paths.push_back({layer, std::move(subpath.points_mm), subpath.closed, std::move(unique)});
  }
}

}  // namespace formwright
