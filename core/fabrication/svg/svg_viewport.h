// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Sizes and coordinate systems of SVG's viewports (SVG 1.1, chapter 7).
#include <Eigen/Geometry>
#include <cmath>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "fabrication/svg/svg_reader.h"

namespace formwright {

/// In user units: what per cents are of.
struct ViewportSize {
  double width = 100, height = 100;

  double diagonal() const { return std::sqrt((width * width + height * height) / 2); }  // SVG 2, 8.9
};

struct PageFrame {
  double width_mm = 0, height_mm = 0;
  Eigen::Affine2d to_mm;  // from user units, y down from the upper left corner
  ViewportSize viewport;
};

/// The outermost element's size. Throws Error{invalid_input, "drawing"} when it does not tell a physical one and `unit`
/// does not either.
PageFrame read_page_frame(const pugi::xml_node& root, UserUnit unit, std::vector<std::string>& notes);

/// viewBox and preserveAspectRatio into a viewport of this size, which becomes the viewBox's. False when it shows
/// nothing.
bool apply_view_box(const pugi::xml_node& node, Eigen::Affine2d& to_mm, ViewportSize& viewport);

}  // namespace formwright
