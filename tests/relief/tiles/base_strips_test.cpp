// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/base/base_strips.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include <cmath>
#include <numbers>

#include "geometry/test_meshes.h"
#include "relief/base/base_shape.h"
#include "relief/base/base_surface.h"

namespace formwright {
namespace {
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::WithinAbs;

ReliefOptions folded(double fold_deg, int strips, BaseBend bend = BaseBend::bay,
                     Projection projection = Projection::perspective) {
  ReliefOptions options;
  options.width_mm = 100;
  options.base = BaseShape::strips;
  options.base_steps = strips;
  options.base_fold_deg = fold_deg;
  options.base_bend = bend;
  options.projection = projection;
  return options;
}

TEST_CASE("BaseStrips.AStraightOnBayIsInClosedForm") {
  // Three strips of width w at -30, 0 and 30 degrees: w (1 + 2 cos 30) = 1, and the outer ends w sin 30 behind.
  const ReliefOptions options = folded(30, 3, BaseBend::bay, Projection::orthographic);
  const BaseStrips strips = base_strips(options, make_view_frame(test::icosphere(2), options), 0.5, 0);
  const double w = 1 / (1 + std::sqrt(3.0));
  const double t[] = {-0.5, -0.5 * w, 0.5 * w, 0.5}, z[] = {0.5 * w, 0, 0, 0.5 * w};
  REQUIRE(strips.t.size() == 4);
  for (std::size_t k = 0; k < 4; ++k) {
    CHECK_THAT(strips.t[k], WithinAbs(t[k], 1e-15));
    CHECK_THAT(strips.z[k], WithinAbs(z[k], 1e-15));
  }
}

TEST_CASE("BaseStrips.AreEquallyWideFoldedByTheAngleAndFillThePicture") {
  for (const BaseBend bend : {BaseBend::bay, BaseBend::zigzag})
    for (const double fold : {22.5, -15.0, 40.0})
      for (const int count : {2, 4}) {
        INFO("bend " << static_cast<int>(bend) << ", fold " << fold << ", " << count << " strips");
        const ReliefOptions options = folded(fold, count, bend);
        const ViewFrame frame = make_view_frame(test::icosphere(2), options);
        const BaseStrips strips = base_strips(options, frame, 0.5, 0);
        const auto side = [&](std::size_t k) {
          return Vec2(strips.t[k + 1] - strips.t[k], strips.z[k + 1] - strips.z[k]);
        };
        for (std::size_t k = 0; k + 1 < strips.t.size(); ++k)
          CHECK_THAT(side(k).norm(), WithinAbs(side(0).norm(), 1e-14));
        for (std::size_t k = 0; k + 2 < strips.t.size(); ++k) {
          const double angle = (std::atan2(side(k + 1).y(), side(k + 1).x()) - std::atan2(side(k).y(), side(k).x())) *
                               180 / std::numbers::pi;
          CHECK_THAT(angle, WithinAbs(bend == BaseBend::zigzag && k % 2 == 1 ? -fold : fold, 1e-11));
        }
        CHECK(*std::ranges::min_element(strips.z) == 0);
        // The ends are seen at the ends of the plate.
        CHECK_THAT(strips.t.front() / (1 + frame.kappa * strips.z.front()), WithinAbs(-0.5, 1e-14));
        CHECK_THAT(strips.t.back() / (1 + frame.kappa * strips.z.back()), WithinAbs(0.5, 1e-14));
        // Neighbours meet at their fold.
        for (int k = 0; k + 1 < count; ++k) {
          const double t = strips.bands.border()[static_cast<std::size_t>(k)];
          CHECK_THAT(strips.bands.depth(k, t), WithinAbs(strips.bands.depth(k + 1, t), 1e-14));
        }
      }
}

TEST_CASE("BaseStrips.RaysMeetThemWhereTheirMeshIs") {
  for (const BaseBend bend : {BaseBend::bay, BaseBend::zigzag}) {
    ReliefOptions options = folded(22.5, 5, bend);
    options.base_turn_deg = 20;
    const ViewFrame frame = make_view_frame(test::icosphere(3), options);
    const TriangleMesh mesh = base_shape(options, frame);
    const BaseSurface rays(mesh), strips(mesh, base_bands(options, frame));
    for (Eigen::Index i = 0; i < frame.P.rows(); ++i)
      CHECK_THAT(strips.depth_on_ray(frame, i, 0).value(), WithinAbs(rays.depth_on_ray(frame, i, 0).value(), 1e-12));
  }
}

TEST_CASE("BaseStrips.AShiftIsMeasuredAlongTheStripsNormal") {
  const ReliefOptions options = folded(22.5, 5);
  const ViewFrame frame = make_view_frame(test::icosphere(3), options);
  const BaseBands bands = *base_bands(options, frame);
  for (Eigen::Index i = 0; i < frame.P.rows(); i += 7) {
    const Vec3 p = frame.P.row(i).transpose();
    const int band = bands.of_ray(frame, p);
    const double slope = bands.slope(band);
    for (const double shift : {-0.02, 0.05}) {
      const double z = bands.depth_on_ray(frame, band, p, shift), t = bands.on_plate(frame, p) * (1 + frame.kappa * z);
      // Distance of (t, z) from the line z = depth + slope t.
      CHECK_THAT((z - bands.depth(band) - slope * t) / std::hypot(1, slope), WithinAbs(shift, 1e-13));
    }
  }
}

TEST_CASE("BaseStrips.RefusesStripsSeenFromTheirEdge") {
  const ViewFrame frame = make_view_frame(test::icosphere(2), folded(22.5, 5));
  CHECK_THROWS_WITH(base_strips(folded(30, 7), frame, 0.5, 0),
                    ContainsSubstring("Strip 1 would be seen from its edge"));
  CHECK_THROWS_AS(base_strips(folded(22.5, 40), frame, 0.5, 0), Error);
  CHECK_NOTHROW(base_strips(folded(22.5, 40, BaseBend::zigzag), frame, 0.5, 0));
}

}  // namespace
}  // namespace formwright
