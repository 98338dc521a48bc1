// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch_test_macros.hpp>

#include <Eigen/Geometry>
#include <random>

#include "base/error.h"
#include "evidence/registration/corner_marks.h"
#include "evidence/registration/small_pattern.h"

namespace formwright {
namespace {
using test::small_pattern;

TEST_CASE("CalibrationPattern.ItsDescriptionDrawsItAgain") {
  const CalibrationPattern pattern = small_pattern();
  const std::string text = calibration_pattern_json(pattern).dump();
  const CalibrationPattern again = read_calibration_pattern(as_bytes(text));
  CHECK(draw_calibration_pattern(pattern, 300, 325, 0.4, Context()).pixels ==
        draw_calibration_pattern(again, 300, 325, 0.4, Context()).pixels);
  CHECK(calibration_pattern_json(again) == calibration_pattern_json(pattern));
}

TEST_CASE("CalibrationPattern.EverythingLiesWithinTheOpeningAndApart") {
  const CalibrationPattern pattern = small_pattern();
  for (const CornerMark& m : pattern.marks) {
    INFO(m.name);
    CHECK((m.centre_mm.cwiseAbs() + Vec2::Constant(m.radius_mm) - pattern.opening_mm / 2).maxCoeff() <= 1e-9);
  }
  for (std::size_t i = 0; i < pattern.patches.size(); ++i) {
    const ColourPatch& p = pattern.patches[i];
    CHECK((p.centre_mm.cwiseAbs() + Vec2::Constant(p.side_mm / 2) - pattern.opening_mm / 2).maxCoeff() <= 1e-9);
    for (std::size_t j = 0; j < i; ++j)
      CHECK((p.centre_mm - pattern.patches[j].centre_mm).cwiseAbs().maxCoeff() >= p.side_mm - 1e-9);
    for (const CornerMark& m : pattern.marks)
      CHECK((p.centre_mm - m.centre_mm).cwiseAbs().maxCoeff() >= p.side_mm / 2 + m.radius_mm - 1e-9);
  }
}

TEST_CASE("CalibrationPattern.RefusesWhatDoesNotFitWithTheNameOfTheKey") {
  CalibrationPatternOptions options;
  options.clamp_opening_x_mm = 250;
  CHECK_THROWS_AS(make_calibration_pattern(options), Error);
  options = {};
  options.margin_mm = 90;
  CHECK_THROWS_AS(make_calibration_pattern(options), Error);
  for (const char* key : {"seed", "marks", "noise_scales_mm", "sheet_mm", "patches"}) {
    Json json = calibration_pattern_json(small_pattern());
    json.erase(key);
    try {
      read_calibration_pattern(as_bytes(json.dump()));
      FAIL_CHECK(key);
    } catch (const Error& e) {
      CHECK(e.where() == "pattern");
      INFO(e.what());
      CHECK(std::string(e.what()).find(key) != std::string::npos);
    }
  }
  CHECK_THROWS_AS(read_calibration_pattern(as_bytes("not json")), Error);
}

/// The pattern as linear light, turned by `angle` about its middle and stretched; mirrored where asked for.
WeightedPicture turned(const CalibrationPattern& pattern, const PlaneFrame& frame, const Eigen::Matrix2d& linear,
                       const Vec2& shift, double noise) {
  const double pixel_mm = 0.25;
  const WeightedPicture print = weighted_picture(draw_calibration_pattern(pattern, 480, 520, pixel_mm, Context()));
  WeightedPicture picture(frame.width, frame.height);
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  const Eigen::Matrix2d inverse = linear.inverse();
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x) {
      const Vec2 s = inverse * (frame.place(x, y) - shift);
      if (std::abs(s.x()) > 59 || std::abs(s.y()) > 64) continue;
      Float4 c = bilinear(print, static_cast<float>(240 + s.x() / pixel_mm - 0.5),
                          static_cast<float>(260 - s.y() / pixel_mm - 0.5)) /
                 255.0f;
      for (int k = 0; k < 3; ++k)
        c[k] = c[k] * c[k] * (0.4f + 0.2f * static_cast<float>(k)) + 0.02f + static_cast<float>(noise) * normal(random);
      c[3] = 1;
      picture.at(x, y) = c;
    }
  return picture;
}

TEST_CASE("CornerMarks.AreFoundHoweverTheScanLies") {
  const CalibrationPattern pattern = small_pattern();
  PlaneFrame frame{300, 300, pattern.marks[0].radius_mm / 12, {0, 0}};
  Context context;
  for (const double angle : {0.0, 0.7, 1.9, -2.8})
    for (const bool mirror : {false, true}) {
      Eigen::Matrix2d linear =
          Eigen::Rotation2Dd(angle).toRotationMatrix() * Eigen::Vector2d(mirror ? -1.04 : 1.04, 0.96).asDiagonal();
      const Vec2 shift(4, -7);
      const FoundMarks found = find_marks(pattern, turned(pattern, frame, linear, shift, 0.02), frame, context);
      CHECK(found.mirrored == mirror);
      for (std::size_t k = 0; k < 4; ++k) {
        {
          INFO(angle << " " << mirror << " " << k);
          CHECK((found.place_mm[k] - (linear * pattern.marks[k].centre_mm + shift)).norm() < 0.3);
        }
        CHECK(found.similarity[k] > 0.6);
      }
    }
}

TEST_CASE("CornerMarks.OneMayBeHiddenButNotTwo") {
  const CalibrationPattern pattern = small_pattern();
  PlaneFrame frame{240, 260, pattern.marks[0].radius_mm / 12, {0, 0}};
  Context context;
  WeightedPicture picture = turned(pattern, frame, Eigen::Matrix2d::Identity(), Vec2(0, 0), 0.02);
  const auto hide = [&](std::size_t k) {
    const Vec2 p = frame.pixel(pattern.marks[k].centre_mm);
    for (int y = -14; y <= 14; ++y)
      for (int x = -14; x <= 14; ++x)
        picture.at(static_cast<int>(p.x()) + x, static_cast<int>(p.y()) + y) = Float4{0.3f, 0.3f, 0.3f, 1};
  };
  hide(2);
  const FoundMarks found = find_marks(pattern, picture, frame, context);
  CHECK(found.similarity[2] == 0);
  CHECK((found.place_mm[2] - pattern.marks[2].centre_mm).norm() < 0.6);
  hide(0);
  try {
    find_marks(pattern, picture, frame, context);
    FAIL();
  } catch (const Error& e) {
    CHECK(e.where() == "corners");
  }
}

TEST_CASE("CornerMarks.HomographiesAreExact") {
  const std::array<Vec2, 4> from{Vec2(-50, -60), Vec2(55, -58), Vec2(48, 66), Vec2(-52, 61)},
      to{Vec2(-40, -50), Vec2(40, -50), Vec2(40, 50), Vec2(-40, 50)};
  const Eigen::Matrix3d h = homography(from, to);
  for (std::size_t k = 0; k < 4; ++k) CHECK((mapped(h, from[k]) - to[k]).norm() < 1e-10);
  // Lines stay lines: the diagonals' crossing goes to the middle.
  const Vec2 d1 = from[2] - from[0], d2 = from[3] - from[1], gap = from[1] - from[0];
  const double t = (gap.x() * d2.y() - gap.y() * d2.x()) / (d1.x() * d2.y() - d1.y() * d2.x());
  CHECK(mapped(h, from[0] + t * d1).norm() < 1e-10);
  CHECK_THROWS_AS(homography({Vec2(0, 0), Vec2(1, 0), Vec2(2, 0), Vec2(0, 1)}, to), Error);
}

}  // namespace
}  // namespace formwright
