// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What an SVG element has from those around it.
#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string_view>

#include "fabrication/sheet/cut_sheet.h"
#include "fabrication/svg/clip_region.h"
#include "fabrication/svg/style/svg_style.h"
#include "fabrication/svg/svg_viewport.h"

namespace formwright {

/// Clips around an element, the innermost first.
struct SvgClip {
  std::shared_ptr<const ClipRegion> region;
  std::shared_ptr<const SvgClip> around;
};

/// Texts are views into the document.
struct SvgState {
  Eigen::Affine2d to_mm;  // y down
  ViewportSize viewport;
  std::shared_ptr<const SvgClip> clip;
  std::optional<CutLayer> layer;
  std::string_view colour = "black", stroke = "none", fill = "black", stroke_width = "1", stroke_opacity, fill_opacity;
  std::string_view dashes, dash_offset, fill_rule, clip_rule, marker_start, marker_mid, marker_end;
  double font_size = 16;
  bool visible = true;
  int depth = 0;

  /// Takes over the inherited properties that an element sets.
  void inherit(const SvgValues& values);
};

}  // namespace formwright
