// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/svg/svg_viewport.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/data/number_list.h"
#include "fabrication/svg/grammar/drawing_limits.h"
#include "fabrication/svg/grammar/svg_grammar.h"

namespace formwright {
namespace {

struct ViewBox {
  double x, y, width, height;
};

std::optional<std::vector<double>> view_box_numbers(const pugi::xml_node& node) {
  std::string text = node.attribute("viewBox").value();
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\t' || c == '\r'; }, ' ');
  constexpr std::size_t max_bytes = 1000;
  return text.size() > max_bytes ? std::nullopt : read_number_list(text);
}

std::optional<ViewBox> view_box_of(const pugi::xml_node& node) {
  const auto numbers = view_box_numbers(node);
  if (!numbers || numbers->size() != 4 || (*numbers)[2] <= 0 || (*numbers)[3] <= 0) return std::nullopt;
  return ViewBox{(*numbers)[0], (*numbers)[1], (*numbers)[2], (*numbers)[3]};
}

/// preserveAspectRatio: the share of the free room that lies before the picture, in x and y.
Eigen::Affine2d fit(const ViewBox& box, double width, double height, std::string_view preserve) {
  Vec2 scale(width / box.width, height / box.height);
  Vec2 before(0.5, 0.5);
  if (preserve.find("none") == std::string_view::npos) {
    const bool slice = preserve.find("slice") != std::string_view::npos;
    scale.setConstant(slice ? scale.maxCoeff() : scale.minCoeff());
    if (preserve.find("xMin") != std::string_view::npos) before.x() = 0;
    if (preserve.find("xMax") != std::string_view::npos) before.x() = 1;
    if (preserve.find("YMin") != std::string_view::npos) before.y() = 0;
    if (preserve.find("YMax") != std::string_view::npos) before.y() = 1;
  }
  const Vec2 room(width - scale.x() * box.width, height - scale.y() * box.height);
  return Eigen::Translation2d(before.cwiseProduct(room)) * Eigen::Scaling(scale.x(), scale.y()) *
         Eigen::Translation2d(-box.x, -box.y);
}

void check_size(const PageFrame& page) {
  if (!(page.width_mm <= max_reach_mm && page.height_mm <= max_reach_mm))
    refuse_drawing("The drawing is larger than 20 m: check its units.");
}

}  // namespace

PageFrame read_page_frame(const pugi::xml_node& root, UserUnit unit, std::vector<std::string>& notes) {
  const auto box = view_box_of(root);
  const auto width = read_length(root.attribute("width").value()),
             height = read_length(root.attribute("height").value());
  const auto size_of = [](const std::optional<SvgLength>& length) {
    return length && !length->percent() && length->value > 0 ? LengthBase().of(*length) : 0;
  };
  double width_px = size_of(width), height_px = size_of(height);
  PageFrame page;
  if (unit != UserUnit::as_in_file) {
    constexpr double unit_mm[] = {0, 1 / user_units_per_mm, 1, 25.4 / 72, 25.4};
    const double mm = unit_mm[static_cast<int>(unit)];
    const ViewBox whole = box.value_or(ViewBox{0, 0, width_px > 0 ? width_px : 100, height_px > 0 ? height_px : 100});
    page.to_mm = Eigen::Scaling(mm) * Eigen::Translation2d(-whole.x, -whole.y);
    page.viewport = {whole.width, whole.height};
    page.width_mm = mm * whole.width;
    page.height_mm = mm * whole.height;
    check_size(page);
    return page;
  }
  const auto says_px = [&](const char* name) {
    return std::string_view(root.attribute(name).value()).find("px") != std::string_view::npos;
  };
  const bool pixels = says_px("width") || says_px("height");
  const bool absolute = (width && width->absolute) || (height && height->absolute);
  if (!absolute && !pixels) {
    const bool bare = (width && width->unitless) || (height && height->unitless);
    const bool share = (width && width->percent()) || (height && height->percent());
    const std::string what = bare    ? "The drawing's width and height have no unit"
                             : share ? "The drawing's width and height are percentages"
                                     : "The drawing does not state its size in millimetres";
    refuse_drawing(
        what +
        ": save it with a width and height such as 200mm, or set user_unit (px: 96 an inch, as browsers and Inkscape have it; pt: 72 an inch, as Illustrator has it; or mm).");
  }
  // One of the two follows from the other and the viewBox.
  if (box && height_px <= 0) height_px = width_px * box->height / box->width;
  if (box && width_px <= 0) width_px = height_px * box->width / box->height;
  if (width_px <= 0) width_px = height_px;
  if (height_px <= 0) height_px = width_px;
  if (!absolute) notes.push_back("The drawing's size is in pixels; they are taken as 96 to the inch, as SVG says.");
  const auto in_mm = [](double px) { return std::round(1e9 * px / user_units_per_mm) / 1e9; };
  page.width_mm = in_mm(width_px);
  page.height_mm = in_mm(height_px);
  check_size(page);
  page.viewport = {width_px, height_px};
  page.to_mm = Eigen::Affine2d::Identity();
  if (box) {
    // Straight into mm: scales such as 1 stay exactly that.
    page.to_mm = fit(*box, page.width_mm, page.height_mm, root.attribute("preserveAspectRatio").value());
    page.viewport = {box->width, box->height};
  } else {
    page.to_mm = Eigen::Affine2d(Eigen::Scaling(1 / user_units_per_mm));
  }
  return page;
}

bool apply_view_box(const pugi::xml_node& node, Eigen::Affine2d& to_mm, ViewportSize& viewport) {
  if (viewport.width <= 0 || viewport.height <= 0) return false;
  const auto numbers = view_box_numbers(node);
  if (numbers && numbers->size() == 4 && ((*numbers)[2] == 0 || (*numbers)[3] == 0)) return false;
  const auto box = view_box_of(node);
  if (!box) return true;
  to_mm = to_mm * fit(*box, viewport.width, viewport.height, node.attribute("preserveAspectRatio").value());
  viewport = {box->width, box->height};
  return true;
}

}  // namespace formwright
