// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/svg/svg_state.h"

#include "fabrication/svg/grammar/svg_grammar.h"

namespace formwright {

void SvgState::inherit(const SvgValues& values) {
  const SvgState first;
  const auto take = [&](SvgProperty property, std::string_view SvgState::*member) {
    const std::string_view own = values[property].text;
    if (own.empty() || same_word(own, "inherit") || same_word(own, "unset") || same_word(own, "revert")) return;
    this->*member = same_word(own, "initial") ? first.*member : own;
  };
  using P = SvgProperty;
  if (const auto size = read_length(values[P::font_size].text); size && size->value > 0)
    font_size = LengthBase{font_size, font_size}.of(*size);
  // currentColor as a colour's own value is the one around it.
  if (!same_word(values[P::color].text, "currentcolor")) take(P::color, &SvgState::colour);
  take(P::stroke, &SvgState::stroke);
  take(P::fill, &SvgState::fill);
  take(P::stroke_width, &SvgState::stroke_width);
  take(P::stroke_opacity, &SvgState::stroke_opacity);
  take(P::fill_opacity, &SvgState::fill_opacity);
  take(P::stroke_dasharray, &SvgState::dashes);
  take(P::stroke_dashoffset, &SvgState::dash_offset);
  take(P::fill_rule, &SvgState::fill_rule);
  take(P::clip_rule, &SvgState::clip_rule);
  for (const auto& [property, member] :
       {std::pair(P::marker_start, &SvgState::marker_start), std::pair(P::marker_mid, &SvgState::marker_mid),
        std::pair(P::marker_end, &SvgState::marker_end)}) {
    take(P::marker, member);
    take(property, member);
  }
  std::string_view visibility = values[P::visibility].text;
  if (same_word(visibility, "initial")) visibility = "visible";
  if (same_word(visibility, "visible")) visible = true;
  if (same_word(visibility, "hidden") || same_word(visibility, "collapse")) visible = false;
}

}  // namespace formwright
