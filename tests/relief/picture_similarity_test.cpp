// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/seen/picture_similarity.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "base/parallel.h"

namespace formwright::picture_similarity_tests {
namespace {
using Catch::Matchers::WithinAbs;

/// A picture 1 wide from the slopes of a surface towards the viewer, where there are any.
NormalPicture picture_of(int columns, int rows, const std::function<std::optional<Vec2>(double x, double y)>& slope) {
  NormalPicture picture;
  picture.grid = {columns, rows, 1.0 / columns, 1};
  const std::size_t count = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  picture.x.assign(count, 0);
  picture.y.assign(count, 0);
  picture.z.assign(count, 0);
  picture.covered.assign(count, 0);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const auto g = slope((column + 0.5 - 0.5 * columns) / columns, (row + 0.5 - 0.5 * rows) / columns);
      if (!g) continue;
      const Vec3 normal = Vec3(-g->x(), -g->y(), 1).normalized();
      const std::size_t p = picture.at(row, column);
      picture.x[p] = static_cast<float>(normal.x());
      picture.y[p] = static_cast<float>(normal.y());
      picture.z[p] = static_cast<float>(normal.z());
      picture.covered[p] = 1;
    }
  return picture;
}

NormalPicture waves(double height) {
  return picture_of(120, 96, [&](double x, double y) {
    return Vec2(height * 0.9 * std::cos(25 * x + 3 * y), height * 0.7 * std::sin(19 * y));
  });
}

/// A cap of a ball, its depth scaled.
NormalPicture cap(int columns, int rows, double scale) {
  return picture_of(columns, rows, [&](double x, double y) -> std::optional<Vec2> {
    constexpr double radius = 0.38;
    const double z2 = radius * radius - x * x - y * y;
    if (x * x + y * y >= 0.95 * 0.95 * radius * radius) return std::nullopt;
    return Vec2(-scale * x / std::sqrt(z2), -scale * y / std::sqrt(z2));
  });
}

NormalPicture plane(double tilt_deg) {
  return picture_of(40, 30, [&](double, double) { return Vec2(std::tan(tilt_deg * std::numbers::pi / 180), 0); });
}

/// Two planes that meet in the middle under `angle_deg`.
NormalPicture crease(double angle_deg) {
  return picture_of(100, 60, [&](double x, double) {
    return Vec2(std::copysign(std::tan(0.5 * angle_deg * std::numbers::pi / 180), x), 0);
  });
}

double similarity(const NormalPicture& a, const NormalPicture& b) {
  Context context;
  return picture_similarity(a, b, light_directions(usual_light_count), context);
}

double false_edges(const NormalPicture& model, const NormalPicture& relief) {
  Context context;
  return false_edges_percent(model, relief, context);
}

TEST_CASE("PictureSimilarity.OfEqualPicturesIsOne") {
  for (const NormalPicture& picture : {waves(1), cap(120, 96, 1), plane(30)}) {
    CHECK(similarity(picture, picture) == 1);
    CHECK(false_edges(picture, picture) == 0);
  }
}

TEST_CASE("PictureSimilarity.OfPlanesIsTheirBrightnessAlone") {
  // Without contrast only the first factor of the similarity is left: (2 a b + c1) / (a^2 + b^2 + c1).
  const double tilt = 35, c1 = 1e-4;
  double expected = 0;
  for (const Vec3& light : light_directions(usual_light_count)) {
    const double angle = tilt * std::numbers::pi / 180;
    const double a = std::max(0.0, light.z()), b = std::max(0.0, light.dot(Vec3(-std::sin(angle), 0, std::cos(angle))));
    expected += (2 * a * b + c1) / (a * a + b * b + c1) / usual_light_count;
  }
  CHECK_THAT(similarity(plane(0), plane(tilt)), WithinAbs(expected, 2e-4));  // single precision against c2
}

TEST_CASE("PictureSimilarity.AgreesWithAnIndependentComputation") {
  // By NumPy 2 from the same formulas: masked sums of scipy.signal.convolve2d, which agree with scikit-image's
  // structural_similarity to 2e-12 where no border is near.
  CHECK_THAT(similarity(waves(1), waves(0.3)), WithinAbs(0.5783211950, 1e-5));
  CHECK_THAT(similarity(cap(120, 96, 1), cap(120, 96, 0.1)), WithinAbs(0.4438785635, 1e-5));
  CHECK_THAT(similarity(cap(120, 96, 1), cap(120, 96, 0.5)), WithinAbs(0.7947587688, 1e-5));
}

TEST_CASE("PictureSimilarity.DoesNotDependOnTheOrderOrTheThreads") {
  const NormalPicture a = cap(120, 96, 1), b = cap(120, 96, 0.2);
  const double reference = similarity(a, b);
  CHECK_THAT(similarity(b, a), WithinAbs(reference, 1e-6));
  const ThreadLimit one(1);
  CHECK(similarity(a, b) == reference);
}

TEST_CASE("PictureSimilarity.HardlyChangesWhenTheLightsTurn") {
  const NormalPicture a = cap(120, 96, 1), b = cap(120, 96, 0.2);
  const double reference = similarity(a, b);
  Context context;
  for (const double angle : {0.3, 1.1, 2.0}) {
    std::vector<Vec3> lights = light_directions(usual_light_count);
    for (Vec3& light : lights)
      light = Vec3(std::cos(angle) * light.x() - std::sin(angle) * light.y(),
                   std::sin(angle) * light.x() + std::cos(angle) * light.y(), light.z());
    CHECK_THAT(picture_similarity(a, b, lights, context), WithinAbs(reference, 0.01));
  }
  INFO("and 32 stand for all");
  CHECK_THAT(picture_similarity(a, b, light_directions(2000), context), WithinAbs(reference, 0.01));
}

TEST_CASE("PictureSimilarity.FallsWithTheDepth") {
  double previous = 1;
  for (const double scale : {0.8, 0.5, 0.2, 0.05}) {
    const double now = similarity(cap(120, 96, 1), cap(120, 96, scale));
    CHECK(now < previous);
    previous = now;
  }
}

TEST_CASE("PictureSimilarity.LightsAreSpreadEvenly") {
  // Over a half sphere the mean of l is (0, 0, 1/2) and that of l l^T a third of the identity.
  Vec3 mean = Vec3::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (const Vec3& light : light_directions(usual_light_count)) {
    CHECK_THAT(light.norm(), WithinAbs(1, 1e-14));
    CHECK(light.z() > 0);
    mean += light / usual_light_count;
    second += light * light.transpose() / usual_light_count;
  }
  CHECK((mean - Vec3(0, 0, 0.5)).norm() < 0.03);
  CHECK((second - Eigen::Matrix3d::Identity() / 3).norm() < 0.03);
}

TEST_CASE("FalseEdges.AreCreasesThatOnlyTheReliefHas") {
  const NormalPicture flat = crease(0);
  INFO("from 30 degrees on");
  CHECK(false_edges(flat, crease(27)) == 0);
  // A crease of 50 degrees, smoothed by s = 3 pixels, is as steep as one of 30 up to
  // s sqrt(2 ln(sin 25 / sin 15)) = 2.97 pixels from it: the middles of three pixels on either side.
  CHECK_THAT(false_edges(flat, crease(50)), WithinAbs(6, 1e-12));
  INFO("those of the model are not false, also when the relief sharpens them");
  CHECK(false_edges(crease(50), crease(50)) == 0);
  CHECK(false_edges(crease(20), crease(50)) == 0);
  CHECK(false_edges(crease(50), flat) == 0);
}

TEST_CASE("PictureSimilarity.WithoutAPixelIsOne") {
  const NormalPicture nothing = picture_of(10, 10, [](double, double) { return std::nullopt; });
  CHECK(similarity(nothing, nothing) == 1);
  CHECK(similarity(nothing, plane(3)) == 1);
  CHECK(false_edges(nothing, nothing) == 0);
}

}  // namespace
}  // namespace formwright::picture_similarity_tests
