// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Lines and words in millimetres, drawn alike into a picture and onto a page.
#include <string>
#include <vector>

#include "geometry/mesh/triangle_mesh.h"
#include "imaging/picture/image.h"

namespace formwright {

struct Stroke {
  Vec2 from, to;  // mm, y up
  double width_mm = 0.2;
  bool dashed = false;
};

/// One line of plain ASCII; its middle is at `centre`.
struct Label {
  Vec2 centre;
  double height_mm = 3;  // of a capital letter
  std::string text;
};

struct Drawing {
  std::vector<Stroke> strokes;
  std::vector<Label> labels;

  void line(const Vec2& from, const Vec2& to, double width_mm, bool dashed = false) {
    strokes.push_back({from, to, width_mm, dashed});
  }
  void rectangle(const Vec2& lower, const Vec2& upper, double width_mm, bool dashed = false);
  void cross(const Vec2& centre, double arm_mm, double width_mm);
  void label(const Vec2& centre, double height_mm, std::string text) {
    labels.push_back({centre, height_mm, std::move(text)});
  }
};

/// Dash and gap of a dashed stroke, in mm.
inline constexpr double dash_mm = 2;

/// Capitals, digits and - . / + as strokes; other characters leave a gap. Lines are 0.12 of their height wide.
Drawing outlined(const Label& label);

/// Draws in black with smooth edges over opaque pixels. `pixel_mm`: side of a pixel; the drawing's origin is in the
/// middle of the image.
void draw(Image& image, const Drawing& drawing, double pixel_mm);

}  // namespace formwright
