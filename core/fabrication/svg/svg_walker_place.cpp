// SPDX-License-Identifier: GPL-3.0-or-later
// Where an element is and what of it is seen: transforms, boxes and clips.
#include <cmath>

#include "fabrication/svg/style/css_transform.h"
#include "fabrication/svg/grammar/svg_grammar.h"
#include "fabrication/svg/svg_shapes.h"
#include "fabrication/svg/svg_walker.h"

namespace formwright {
namespace {

bool leaves_as_it_is(std::string_view value) {
  return same_word(value, "initial") || same_word(value, "unset") || same_word(value, "revert");
}

/// Sets a variable and sets it back.
template <class T>
class Meanwhile {
 public:
  Meanwhile(T& variable, T value) : variable_(variable), before_(std::exchange(variable, std::move(value))) {}
  Meanwhile(const Meanwhile&) = delete;
  Meanwhile& operator=(const Meanwhile&) = delete;
  ~Meanwhile() { variable_ = std::move(before_); }

 private:
  T& variable_;
  T before_;
};

}  // namespace

Eigen::AlignedBox2d SvgWalker::box_of(const pugi::xml_node& node, const SvgValues& values, const SvgState& state) {
  Eigen::AlignedBox2d box;
  const double scale = std::sqrt(std::abs(state.to_mm.linear().determinant()));
  if (!(scale > 1e-9 && scale < 1e9)) return box;
  // Lines in the element's own units, as finely broken as they are when drawn.
  const auto local = std::make_unique<SvgState>(state);
  local->to_mm = Eigen::Affine2d(Eigen::Scaling(scale));
  local->clip = nullptr;
  const SvgNotes before = notes;
  {
    const Meanwhile measuring(measured_, &box);
    const Meanwhile<std::vector<ClipRegion::Shape>*> no_clip(clip_shapes_, nullptr);
    const std::string_view name = svg_local_name(node);
    if (is_svg_shape(name)) shape(node, values, *local);
    else if (name == "use") use(node, values, *local);
    else if (name == "g" || name == "a" || name == "switch" || name == "svg") container(node, name, values, *local);
  }
  notes = before;
  if (box.isEmpty()) return box;
  return {box.min() / scale, box.max() / scale};
}

Eigen::Affine2d SvgWalker::transform_of(const pugi::xml_node& node, const SvgValues& values, const SvgState& state) {
  using P = SvgProperty;
  const SvgValues::Value& value = values[P::transform];
  const std::string_view translate = values[P::translate].text, rotate = values[P::rotate].text,
                         scale = values[P::scale].text, origin_text = values[P::transform_origin].text;
  Eigen::Affine2d map = Eigen::Affine2d::Identity();
  if (value.text.empty() && translate.empty() && rotate.empty() && scale.empty()) return map;
  TransformBox box{0, 0, state.viewport.width, state.viewport.height, state.font_size};
  const std::string_view of_box = values[P::transform_box].text;
  if (!of_box.empty() && !same_word(of_box, "view-box") && !leaves_as_it_is(of_box)) {
    const Eigen::AlignedBox2d own = box_of(node, values, state);
    if (!own.isEmpty()) box = {own.min().x(), own.min().y(), own.sizes().x(), own.sizes().y(), state.font_size};
  }
  const auto from_attribute = [&] {
    const std::string_view text = node.attribute("transform").value();
    limits_.add_steps(4 * text.size());
    if (const auto read = read_transform(text)) return *read;
    ++notes.malformed;
    return Eigen::Affine2d(Eigen::Affine2d::Identity());
  };
  if (value.attribute || value.text.empty()) {
    map = from_attribute();
  } else if (!leaves_as_it_is(value.text)) {
    limits_.add_steps(4 * value.text.size());
    if (const auto read = read_css_transform(value.text, box)) {
      map = *read;
    } else {
      ++notes.malformed;
      map = from_attribute();
    }
  }
  if (const auto single = read_single_transforms(translate, rotate, scale, box)) {
    map = *single * map;
  } else {
    ++notes.malformed;
  }
  Vec2 origin(box.x, box.y);
  if (!origin_text.empty() && !leaves_as_it_is(origin_text)) {
    if (const auto read = read_transform_origin(origin_text, box)) origin = *read;
    else ++notes.malformed;
  }
  if (origin == Vec2(0, 0)) return map;
  return Eigen::Translation2d(origin) * map * Eigen::Translation2d(-origin);
}

void SvgWalker::clip_to(std::vector<ClipRegion::Shape> shapes, SvgState& state) {
  state.clip =
      std::make_shared<SvgClip>(SvgClip{std::make_shared<const ClipRegion>(std::move(shapes), limits_), state.clip});
}

void SvgWalker::clip_to_viewport(SvgState& state) {
  if (measured_ != nullptr || !state.to_mm.matrix().allFinite()) return;
  const auto [w, h] = state.viewport;
  Polygon rectangle;
  for (const Vec2& corner : {Vec2(0, 0), Vec2(w, 0), Vec2(w, h), Vec2(0, h)}) {
    const Vec2 mm = state.to_mm * corner;
    if (!(mm.cwiseAbs().maxCoeff() <= max_coordinate_mm)) return;  // all that may be drawn is inside
    rectangle.push_back(mm);
  }
  clip_to({{{rectangle}, FillRule::nonzero}}, state);
}

std::vector<ClipRegion::Shape> SvgWalker::clip_shapes(const pugi::xml_node& clip, const SvgState& user) {
  std::vector<ClipRegion::Shape> shapes;
  // What a clip is made of inherits from around the clip, not from who uses it.
  const auto state = std::make_unique<SvgState>();
  state->to_mm = user.to_mm;
  state->viewport = user.viewport;
  state->font_size = user.font_size;
  state->depth = user.depth;
  const auto inner = within(clip, *style_.values_of(clip), *state);
  const Meanwhile gathering(clip_shapes_, &shapes);
  children(clip, *inner);
  return shapes;
}

void SvgWalker::enter_clip(const pugi::xml_node& node, const SvgValues& values, SvgState& state) {
  const std::string_view text = values[SvgProperty::clip_path].text;
  if (text.empty() || same_word(text, "none") || measured_ != nullptr || !state.to_mm.matrix().allFinite()) return;
  const auto found = ids_.find(url_id(text));
  if (found == ids_.end() || svg_local_name(found->second) != "clipPath") {
    // A reference to nothing clips nothing; shapes of CSS are not followed.
    if (!same_word(text.substr(0, 4), "url(")) ++notes.clips;
    return;
  }
  const pugi::xml_node clip = found->second;
  for (const pugi::xml_node& child : clip.children())
    if (svg_local_name(child) == "text") {
      ++notes.clips;
      return;
    }
  const auto user = std::make_unique<SvgState>(state);
  const bool of_box = std::string_view(clip.attribute("clipPathUnits").value()) == "objectBoundingBox";
  if (of_box) {
    const Eigen::AlignedBox2d box = box_of(node, values, state);
    if (box.isEmpty()) return;
    user->to_mm = user->to_mm * Eigen::Translation2d(box.min()) * Eigen::Scaling(Vec2(box.sizes()));
  }
  const auto kept = clips_.find(clip.internal_object());
  if (!of_box && kept != clips_.end() && kept->second.to_mm == user->to_mm.matrix() &&
      kept->second.viewport.width == user->viewport.width && kept->second.viewport.height == user->viewport.height) {
    state.clip = std::make_shared<SvgClip>(SvgClip{kept->second.region, state.clip});
    return;
  }
  clip_to(clip_shapes(clip, *user), state);
  if (!of_box)
    clips_.insert_or_assign(clip.internal_object(), KeptClip{user->to_mm.matrix(), user->viewport, state.clip->region});
}

}  // namespace formwright
