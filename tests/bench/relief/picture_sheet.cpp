// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/relief/picture_sheet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "imaging/drawing/drawing.h"
#include "imaging/picture/png_writer.h"

namespace formwright::test {
namespace {

constexpr double uncovered_level = 0.18;

Vec3 normal_at(const NormalPicture& picture, std::size_t p) {
  return {static_cast<double>(picture.x[p]), static_cast<double>(picture.y[p]), static_cast<double>(picture.z[p])};
}

std::uint8_t byte_of(double level) { return static_cast<std::uint8_t>(std::lround(255 * level)); }

Rgba background() {
  const std::uint8_t grey = byte_of(std::sqrt(uncovered_level));
  return {grey, grey, grey, 255};
}

/// Five colours of viridis (van der Walt and Smith 2015), whose lightness grows evenly; `share` from 0 to 1.
Rgba colour_of(double share) {
  constexpr std::array<std::array<double, 3>, 5> colours{
      {{68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}}};
  const double at = std::clamp(share, 0.0, 1.0) * (colours.size() - 1);
  const std::size_t first = std::min(static_cast<std::size_t>(at), colours.size() - 2);
  const double part = at - static_cast<double>(first);
  Rgba colour{0, 0, 0, 255};
  for (std::size_t k = 0; k < 3; ++k)
    colour[k] = byte_of(((1 - part) * colours[first][k] + part * colours[first + 1][k]) / 255);
  return colour;
}

}  // namespace

void shade_into(Image& sheet, const NormalPicture& picture, SheetPlace place) {
  const Vec3 light = Vec3(-0.5, 0.6, 0.75).normalized();
  for (int y = 0; y < picture.grid.rows; ++y)
    for (int x = 0; x < picture.grid.columns; ++x) {
      const std::size_t p = picture.at(y, x);
      double level = uncovered_level;
      if (picture.covered[p]) level = std::max(0.0, light.dot(normal_at(picture, p)));
      const auto grey = static_cast<std::uint8_t>(255 * std::sqrt(std::min(1.0, level)));
      sheet.at(place.left + x, place.top + picture.grid.rows - 1 - y) = Rgba{grey, grey, grey, 255};
    }
}

void colour_angles_into(Image& sheet, const NormalPicture& model, const NormalPicture& relief, double max_angle_deg,
                        SheetPlace place) {
  for (int y = 0; y < model.grid.rows; ++y)
    for (int x = 0; x < model.grid.columns; ++x) {
      const std::size_t p = model.at(y, x);
      Rgba colour = background();
      if (model.covered[p] && relief.covered[p]) {
        const double cosine = std::clamp(normal_at(model, p).dot(normal_at(relief, p)), -1.0, 1.0);
        colour = colour_of(std::acos(cosine) * 180 / std::numbers::pi / max_angle_deg);
      }
      sheet.at(place.left + x, place.top + model.grid.rows - 1 - y) = colour;
    }
}

void colour_scale_into(Image& sheet, double max_angle_deg, SheetPlace place, int width, int height) {
  const int bar_width = width / 10, bar_height = height / 2;
  const int bar_left = place.left + width / 2 - bar_width, bar_top = place.top + (height - bar_height) / 2;
  for (int y = 0; y < bar_height; ++y)
    for (int x = 0; x < bar_width; ++x) sheet.at(bar_left + x, bar_top + y) = colour_of(1 - (y + 0.5) / bar_height);
  Drawing drawing;
  constexpr int marks = 3;
  const double letter_pixels = 14;
  for (int k = 0; k <= marks; ++k) {
    const double from_bar = bar_width + 2.5 * letter_pixels, y = bar_top + bar_height * (1 - k / double(marks));
    drawing.label(Vec2(bar_left + from_bar - 0.5 * sheet.width, 0.5 * sheet.height - y), letter_pixels,
                  std::to_string(static_cast<int>(std::lround(max_angle_deg * k / marks))));
  }
  draw(sheet, drawing, 1);
}

void write_sheet(const Image& sheet, const std::string& folder, const std::string& name, const Context& context) {
  std::filesystem::create_directories(folder);
  const Bytes png = write_png(sheet, 0, context);
  std::ofstream(std::filesystem::path(folder) / (name + ".png"), std::ios::binary)
      .write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
}

}  // namespace formwright::test
