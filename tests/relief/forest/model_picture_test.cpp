// SPDX-License-Identifier: GPL-3.0-or-later
// A model as its viewpoint sees it, against what is known of a ball.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <numbers>

#include "geometry/test_meshes.h"
#include "imaging/picture/light.h"
#include "relief/forest/forest_picture.h"

namespace formwright::model_picture_tests {
namespace {
using Catch::Matchers::WithinAbs;

ViewFrame far_frame(const TriangleMesh& mesh) {
  ReliefOptions options;
  options.projection = Projection::orthographic;
  return make_view_frame(mesh, options);
}

Image picture_of(const TriangleMesh& mesh, int pixels) {
  Context context;
  return picture_of_model(far_frame(mesh), mesh.F, pixels, context);
}

}  // namespace

TEST_CASE("ModelPicture.ABallIsARoundDiscLitAsItsNormalsSay") {
  const Image picture = picture_of(test::icosphere(5), 200);
  REQUIRE(picture.width == 200);
  REQUIRE(std::abs(picture.height - 200) <= 1);
  const Vec3 light = Vec3(-0.55, 0.6, 0.58).normalized();
  double covered = 0, difference = 0, inside = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const Rgba& pixel = picture.at(x, y);
      CHECK((pixel[3] == 0 || pixel[3] == 255));
      covered += pixel[3] > 0;
      const double right = (x + 0.5) / 100 - 1, up = 1 - (y + 0.5) / (0.5 * picture.height),
                   towards_squared = 1 - right * right - up * up;
      if (towards_squared < 0.1) continue;
      ++inside;
      const double light_level = 0.12 + 0.75 * std::max(0.0, light.dot(Vec3(right, up, std::sqrt(towards_squared))));
      const int expected = byte_of_light()[static_cast<std::size_t>(std::lround(light_level * light_levels))];
      difference += std::abs(expected - pixel[0]);
    }
  CHECK_THAT(covered / (200.0 * picture.height), WithinAbs(std::numbers::pi / 4, 0.003));
  CHECK(difference / inside < 0.5);  // grey levels
}

TEST_CASE("ModelPicture.IsAsHighAsTheModel") {
  TriangleMesh mesh = test::icosphere(3);
  mesh.V.col(1) *= 2.5;
  const Image picture = picture_of(mesh, 80);
  CHECK(picture.width == 80);
  CHECK(std::abs(picture.height - 200) <= 1);
}

}  // namespace formwright::model_picture_tests
