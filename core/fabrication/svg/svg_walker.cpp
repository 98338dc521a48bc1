// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/svg/svg_walker.h"

#include <algorithm>

#include "fabrication/svg/style/css_transform.h"
#include "fabrication/svg/drawing_layers.h"
#include "fabrication/svg/grammar/svg_grammar.h"
#include "fabrication/svg/svg_shapes.h"

namespace formwright {
namespace {

bool is_container(std::string_view name) { return name == "g" || name == "a" || name == "switch" || name == "svg"; }

bool is_text(std::string_view name) { return name == "text" || name == "tspan" || name == "flowRoot"; }

std::string_view prefix_of(std::string_view name) {
  const std::size_t colon = name.find(':');
  return colon == std::string_view::npos ? std::string_view() : name.substr(0, colon);
}

std::optional<CutLayer> named_layer(const pugi::xml_node& node) {
  const auto layer = layer_by_name(node.attribute("inkscape:label").value());
  return layer ? layer : layer_by_name(node.attribute("id").value());
}

bool is_set(std::string_view value) { return !value.empty() && !same_word(value, "none"); }

}  // namespace

SvgWalker::SvgWalker(const pugi::xml_node& root, double flatness_mm, DrawingLimits& limits)
    : root_(root), flatness_mm_(flatness_mm), limits_(limits), style_(root, limits) {
  index();
}

void SvgWalker::index() {
  struct Finder : pugi::xml_tree_walker {
    SvgWalker* walker = nullptr;
    bool for_each(pugi::xml_node& node) override {
      if (node.type() != pugi::node_element) return true;
      if (const char* id = node.attribute("id").value(); *id != 0) walker->ids_.emplace(id, node);
      const std::string_view name = svg_local_name(node);
      if (name == "set" || name.starts_with("animate")) ++walker->notes.animations;
      if (name == "script") ++walker->notes.scripts;
      for (const pugi::xml_attribute& attribute : node.attributes())
        // The five entities of XML itself are replaced already; namespaces change nothing.
        if (const std::string_view value = attribute.value();
            value.starts_with('&') && value.ends_with(';') && !std::string_view(attribute.name()).starts_with("xmlns"))
          ++walker->notes.entities;
      return true;
    }
  } finder;
  finder.walker = this;
  pugi::xml_node whole = root_;
  finder.for_each(whole);
  whole.traverse(finder);
  notes.rules = style_.not_followed();
}

void SvgWalker::walk(const PageFrame& page) {
  const auto root_values = style_.values_of(root_);
  const SvgValues& values = *root_values;
  if (same_word(values[SvgProperty::display].text, "none") || read_opacity(values[SvgProperty::opacity].text) == 0)
    return;
  SvgState state;
  state.to_mm = page.to_mm;
  state.viewport = page.viewport;
  state.inherit(values);
  if (!values[SvgProperty::transform].text.empty()) {
    // The outermost element is a box of CSS: its transform is outside of the viewBox and about the middle.
    SvgState outside = state;
    outside.viewport = {page.width_mm * user_units_per_mm, page.height_mm * user_units_per_mm};
    const Eigen::Affine2d own = transform_of(root_, values, outside);
    const bool has_origin = !values[SvgProperty::transform_origin].text.empty();
    const Vec2 middle = has_origin ? Vec2(0, 0) : Vec2(outside.viewport.width / 2, outside.viewport.height / 2);
    state.to_mm = Eigen::Scaling(1 / user_units_per_mm) * Eigen::Translation2d(middle) * own *
                  Eigen::Translation2d(-middle) * Eigen::Scaling(user_units_per_mm) * page.to_mm;
  }
  const std::string_view overflow = values[SvgProperty::overflow].text;
  if (same_word(overflow, "hidden") || same_word(overflow, "scroll") || same_word(overflow, "clip")) {
    const double w = page.width_mm, h = page.height_mm;
    clip_to({{{{{0, 0}, {w, 0}, {w, h}, {0, h}}}, FillRule::nonzero}}, state);
  }
  enter_clip(root_, values, state);
  children(root_, state);
  for (const CutPath& path : paths)
    if (std::any_of(path.points_mm.begin(), path.points_mm.end(), [&](const Vec2& p) {
          constexpr double seen_mm = 0.01;
          return p.x() < -seen_mm || p.y() < -seen_mm || p.x() > page.width_mm + seen_mm ||
                 p.y() > page.height_mm + seen_mm;
        }))
      ++notes.outside;
}

bool SvgWalker::is_svg(const pugi::xml_node& node) const {
  constexpr std::string_view svg_namespace = "http://www.w3.org/2000/svg";
  const std::string_view prefix = prefix_of(node.name());
  if (prefix.empty()) {
    const std::string_view own = node.attribute("xmlns").value();
    return own.empty() || own == svg_namespace;
  }
  if (prefix == "svg" || prefix == prefix_of(root_.name())) return true;
  if (prefix.size() > 100) return false;
  return root_.attribute(("xmlns:" + std::string(prefix)).c_str()).value() == svg_namespace;
}

bool SvgWalker::conditions_hold(const pugi::xml_node& node) {
  if (*node.attribute("requiredExtensions").value() != 0) return false;
  const pugi::xml_attribute language = node.attribute("systemLanguage");
  if (!language) return true;
  if (measured_ == nullptr) ++notes.languages;
  std::string_view languages = language.value();
  limits_.add_steps(languages.size());
  while (!(languages = without_blanks(languages)).empty()) {
    const std::string_view one = take_word(languages);
    if (same_word(one, "en") || (one.size() > 3 && same_word(one.substr(0, 3), "en-"))) return true;
  }
  return false;
}

pugi::xml_node SvgWalker::referenced(const pugi::xml_node& node) {
  std::string_view reference = node.attribute("href").value();
  if (reference.empty()) reference = node.attribute("xlink:href").value();
  if (!reference.empty() && reference.front() != '#') ++notes.other_files;
  if (!reference.starts_with('#')) return {};
  const auto found = ids_.find(reference.substr(1));
  return found == ids_.end() ? pugi::xml_node() : found->second;
}

void SvgWalker::children(const pugi::xml_node& node, const SvgState& state) {
  for (const pugi::xml_node& child : node.children())
    if (child.type() == pugi::node_element) element(child, state);
}

std::unique_ptr<SvgState> SvgWalker::within(const pugi::xml_node& node, const SvgValues& values,
                                            const SvgState& outer) {
  auto result = std::make_unique<SvgState>(outer);
  SvgState& inner = *result;
  if (++inner.depth > max_nested_elements)
    refuse_drawing(
        "The drawing is nested more than 256 levels deep: ungroup it, or look for a <use> that shows itself.");
  inner.inherit(values);
  inner.to_mm = outer.to_mm * transform_of(node, values, inner);
  enter_clip(node, values, inner);
  return result;
}

void SvgWalker::element(const pugi::xml_node& node, const SvgState& outer) {
  limits_.add_steps(64);
  const std::string_view name = svg_local_name(node);
  if (!is_svg(node) || !conditions_hold(node)) return;
  const bool other = is_text(name) || name == "image" || name == "foreignObject";
  if (!is_container(name) && !is_svg_shape(name) && name != "use" && !other) return;
  // A clip is made of shapes and of <use> that shows shapes.
  if (clip_shapes_ != nullptr && !is_svg_shape(name) && name != "use") return;
  const auto values = style_.values_of(node);
  const SvgValues& of = *values;
  if (same_word(of[SvgProperty::display].text, "none")) return;
  const bool drawing = measured_ == nullptr && clip_shapes_ == nullptr;
  if (drawing && read_opacity(of[SvgProperty::opacity].text) == 0) return;
  const auto state = within(node, of, outer);
  if (drawing && state->visible) {
    if (is_set(of[SvgProperty::mask].text)) ++notes.masks;
    if (is_set(of[SvgProperty::filter].text)) ++notes.filters;
    if (is_text(name)) ++notes.words;
    if (name == "image") ++notes.pictures;
    if (name == "foreignObject") ++notes.foreign;
  }
  if (is_container(name)) container(node, name, of, *state);
  else if (name == "use") use(node, of, *state);
  else if (!other) shape(node, of, *state);
}

void SvgWalker::container(const pugi::xml_node& node, std::string_view name, const SvgValues& values, SvgState& state) {
  if (const auto layer = named_layer(node)) state.layer = layer;
  if (name == "svg") return viewport(node, values, nullptr, state);
  if (name != "switch") return children(node, state);
  // The first child whose conditions hold; words about the drawing are no children in this sense.
  for (const pugi::xml_node& child : node.children()) {
    const std::string_view kind = svg_local_name(child);
    if (child.type() != pugi::node_element || !is_svg(child) || kind == "title" || kind == "desc" || kind == "metadata")
      continue;
    limits_.add_steps(8);
    if (conditions_hold(child)) return element(child, state);
  }
}

void SvgWalker::use(const pugi::xml_node& node, const SvgValues& values, SvgState& state) {
  const pugi::xml_node target = referenced(node);
  if (!target) return;
  const std::string_view name = svg_local_name(target);
  if (clip_shapes_ != nullptr && !is_svg_shape(name)) return;
  if (const auto layer = named_layer(node)) state.layer = layer;
  const SvgLengths lengths(node, values, state.viewport, state.font_size, notes.malformed);
  state.to_mm.translate(Vec2(lengths.x(SvgProperty::x), lengths.y(SvgProperty::y)));
  if (name != "symbol" && name != "svg") return element(target, state);
  const auto own = style_.values_of(target);
  if (name == "svg" && same_word((*own)[SvgProperty::display].text, "none")) return;
  if (read_opacity((*own)[SvgProperty::opacity].text) == 0) return;
  const auto inner = within(target, *own, state);
  if (const auto layer = named_layer(target)) inner->layer = layer;
  viewport(target, *own, &values, *inner);
}

void SvgWalker::viewport(const pugi::xml_node& node, const SvgValues& values, const SvgValues* user, SvgState& state) {
  using P = SvgProperty;
  const SvgLengths own(node, values, state.viewport, state.font_size, notes.malformed);
  const SvgLengths users(node, user ? *user : values, state.viewport, state.font_size, notes.malformed);
  const bool symbol = svg_local_name(node) == "symbol";
  const auto size = [&](P property, bool along_x, double whole) {
    const auto of = [&](const SvgLengths& lengths) {
      const double length = along_x ? lengths.x(property, -1) : lengths.y(property, -1);
      return length < 0 ? -1 : length;
    };
    double length = of(users);
    if (length < 0 && !symbol) length = of(own);
    return length < 0 ? whole : length;
  };
  const ViewportSize inner{size(P::width, true, state.viewport.width), size(P::height, false, state.viewport.height)};
  if (!symbol) state.to_mm.translate(Vec2(own.x(P::x), own.y(P::y)));
  state.viewport = inner;
  const std::string_view overflow = values[P::overflow].text;
  if (!same_word(overflow, "visible") && !same_word(overflow, "auto")) clip_to_viewport(state);
  if (apply_view_box(node, state.to_mm, state.viewport)) children(node, state);
}

}  // namespace formwright
