// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>

#include "base/error.h"
#include "imaging/drawing/drawing.h"
#include "imaging/picture/light.h"
#include "imaging/drawing/pdf.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

/// Black in square mm, in light: a half covered pixel counts half.
double ink_mm2(const Image& image, double pixel_mm) {
  double sum = 0;
  for (const Rgba& p : image.pixels) sum += 1 - light_of_byte()[p[0]] / light_levels;
  return sum * pixel_mm * pixel_mm;
}

TEST_CASE("Drawing.LinesHaveTheirLengthWidthAndPlace") {
  Image image(400, 300, {255, 255, 255, 255});
  const double pixel_mm = 0.1;
  Drawing drawing;
  drawing.line(Vec2(-10, 5), Vec2(10, 5), 1);
  draw(image, drawing, pixel_mm);
  CHECK_THAT(ink_mm2(image, pixel_mm), WithinAbs(20 + 0.25 * std::acos(-1.0), 0.3));  // round ends
  // y points up: 5 mm above the middle is row 150 - 50.
  CHECK(image.at(200, 100)[0] == 0);
  CHECK(image.at(200, 200)[0] == 255);
}

TEST_CASE("Drawing.DashesLeaveGaps") {
  Image whole(600, 100, {255, 255, 255, 255}), dashed = whole;
  Drawing a, b;
  a.line(Vec2(-20, 0), Vec2(20, 0), 0.5);
  b.line(Vec2(-20, 0), Vec2(20, 0), 0.5, true);
  draw(whole, a, 0.1);
  draw(dashed, b, 0.1);
  CHECK_THAT(ink_mm2(dashed, 0.1) / ink_mm2(whole, 0.1),
             WithinAbs((2 * 0.5 + 0.25 * std::acos(-1.0) * 0.25) / (4 * 0.5), 0.01));  // with their round ends
}

TEST_CASE("Drawing.EveryLetterIsDifferentAndWithinItsHeight") {
  const std::string letters = "ABCDEFGHIJKLMNPQRSTUVWXYZ0123456789-./+";  // O is 0
  std::vector<std::vector<Rgba>> seen;
  for (const char letter : letters) {
    const Label label{Vec2(0, 0), 4, std::string(1, letter)};
    Image image(60, 60, {255, 255, 255, 255});
    draw(image, {{}, {label}}, 0.1);
    {
      INFO(letter);
      CHECK(ink_mm2(image, 0.1) > 0.1);
    }
    for (const auto& other : seen) {
      INFO(letter);
      CHECK(image.pixels != other);
    }
    seen.push_back(image.pixels);
    for (const Stroke& s : outlined(label).strokes)
      for (const Vec2& p : {s.from, s.to}) {
        INFO(letter);
        CHECK(std::abs(p.y()) <= 2.0001);
        CHECK(std::abs(p.x()) <= 1.34);
      }
  }
}

TEST_CASE("Image.MirroredTwiceIsItself") {
  Image image(5, 3, {1, 2, 3, 255});
  image.at(0, 1) = {9, 9, 9, 255};
  Image twice = image;
  mirror_left_right(twice);
  CHECK(twice.at(4, 1) == image.at(0, 1));
  CHECK(twice.pixels != image.pixels);
  mirror_left_right(twice);
  CHECK(twice.pixels == image.pixels);
}

TEST_CASE("Pdf.WritesPagesAndSaysWhenItCannot") {
  PdfDocument pdf("A test");
  const int picture = pdf.add_picture(Image(3, 2, {10, 20, 30, 255}));
  for (int i = 0; i < 3; ++i) {
    pdf.add_page(100, 50);
    pdf.show_picture(picture, 1, {Vec2(50, 25), i == 1}, Vec2(0, 0), Vec2(100, 50));
  }
  const Bytes bytes = pdf.finish();
  CHECK(as_text(bytes).starts_with("%PDF-"));
  CHECK(as_text(bytes).find("/Count 3") != std::string_view::npos);
  CHECK(as_text(bytes).find("/PrintScaling /None") != std::string_view::npos);
  PdfDocument huge("Too large");
  huge.add_page(6000, 50);
  try {
    huge.finish();
    FAIL("6 m are more than a page can be");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::could_not_solve);
    CHECK(error.where() == "print.pdf");
  }
}

}  // namespace
}  // namespace formwright
