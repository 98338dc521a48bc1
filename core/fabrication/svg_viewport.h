// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Sizes and coordinate systems of SVG's viewports (SVG 1.1, chapter 7).
#include <Eigen/Geometry>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "fabrication/svg_reader.h"

namespace formwright {

/// In user units: what per cents are of.
struct ViewportSize {
  double width = 100, height = 100;
};

struct PageFrame {
  double width_mm = 0, height_mm = 0;
  Eigen::Affine2d to_mm;  // from user units, y down from the upper left corner
  ViewportSize viewport;
};

/// Without the prefix of its namespace.
std::string svg_local_name(const pugi::xml_node& node);

/// The outermost element's size. Throws Error{invalid_input, "drawing"} when it does not tell a physical one and `unit`
/// does not either.
PageFrame read_page_frame(const pugi::xml_node& root, UserUnit unit, std::vector<std::string>& notes);

/// A nested <svg>: its place and its viewBox; `viewport` is the outer one before and its own afterwards.
void enter_viewport(const pugi::xml_node& node, Eigen::Affine2d& to_mm, ViewportSize& viewport);

/// viewBox and preserveAspectRatio into a viewport of this size, which becomes the viewBox's.
void apply_view_box(const pugi::xml_node& node, Eigen::Affine2d& to_mm, ViewportSize& viewport);

}  // namespace formwright
