// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/booleans/booleans.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "base/error.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "geometry/samples/samples.h"
#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using namespace test;

ExactSolid solid(const TriangleMesh& mesh) {
  Context context;
  return ExactSolid::from_mesh(mesh, "mesh", context);
}
ExactSolid box(const Vec3& lower, const Vec3& size) {
  TriangleMesh mesh = cube();
  for (int k = 0; k < 3; ++k) mesh.V.col(k) = (mesh.V.col(k) * size[k]).array() + lower[k];
  return solid(mesh);
}
TriangleMesh sample(const char* name, int vertices) {
  Context context;
  return make_sample(name, vertices, context).mesh;
}

template <class Body>
std::string refusal(ErrorCode code, Body body) {
  try {
    body();
  } catch (const Error& error) {
    {
      INFO(error.what());
      CHECK(error.code() == code);
    }
    return error.what();
  }
  FAIL_CHECK("should have been refused");
  return "";
}

TEST_CASE("Booleans.CubesByHand") {
  Context context;
  const ExactSolid a = box({0, 0, 0}, {1, 1, 1}), b = box({0.5, 0.25, 0.125}, {1, 1, 1});
  const double common = 0.5 * 0.75 * 0.875;
  CHECK_THAT(intersect(a, b, context).volume_mm3(), WithinAbs(common, 1e-15));
  CHECK_THAT(subtract(a, b, context).volume_mm3(), WithinAbs(1 - common, 1e-15));
  CHECK_THAT(unite(a, b, context).volume_mm3(), WithinAbs(2 - common, 1e-15));
}

TEST_CASE("Booleans.FacesInCommonPlanes") {
  Context context;
  const ExactSolid a = box({0, 0, 0}, {1, 1, 1});
  const ExactSolid stacked = unite(a, box({0, 0, 1}, {1, 1, 1}), context);  // whole faces touch
  CHECK_THAT(stacked.volume_mm3(), WithinAbs(2, 1e-15));
  CHECK_THAT(surface_area(stacked.mesh()), WithinAbs(10, 1e-14));  // nothing is left between them
  const ExactSolid notched = subtract(a, box({0.25, 0.25, 0}, {0.5, 0.5, 0.5}), context);  // flush with the bottom
  CHECK_THAT(notched.volume_mm3(), WithinAbs(1 - 0.125, 1e-15));
  CHECK_THAT(surface_area(notched.mesh()), WithinAbs(6 + 4 * 0.25, 1e-14));
  CHECK(subtract(a, a, context).empty());
  CHECK_THAT(intersect(a, a, context).volume_mm3(), WithinAbs(1, 1e-15));
  CHECK(intersect(a, box({0, 0, 1}, {1, 1, 1}), context).empty());  // regularised: no sheet
}

TEST_CASE("Booleans.ApartAndWithin") {
  Context context;
  const ExactSolid a = box({0, 0, 0}, {1, 1, 1}), far = box({3, 0, 0}, {1, 1, 1}),
                   inner = box({0.25, 0.25, 0.25}, {0.5, 0.5, 0.5});
  CHECK(intersect(a, far, context).empty());
  CHECK(subtract(a, far, context).face_count() == 12);
  CHECK_THAT(unite(a, far, context).volume_mm3(), WithinAbs(2, 1e-15));
  CHECK_THAT(subtract(a, inner, context).volume_mm3(), WithinAbs(1 - 0.125, 1e-15));  // a cavity
  CHECK(subtract(inner, a, context).empty());
  CHECK(subtract(a, ExactSolid(), context).face_count() == 12);
  CHECK(unite(ExactSolid(), a, context).face_count() == 12);
  CHECK(intersect(ExactSolid(), a, context).empty());
}

// |A - B| = |A| - |A n B| and |A u B| = |A| + |B| - |A n B|, for shapes of every kind, one turned against the other.
TEST_CASE("Booleans.VolumesAddUpOverTheSamples") {
  Context context;
  Random random(7);
  for (const char* name : {"pyramid", "hemisphere", "torus", "star", "heart", "t_shape", "octopus", "cat"}) {
    INFO(name);
    const TriangleMesh first = moved(sample(name, 3000), {0, -40, 0});
    const TriangleMesh second = moved(rotated(first, random.direction(), random.uniform(0.2, 3)),
                                      Vec3(random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-5, 5)));
    const ExactSolid a = solid(first), b = solid(second);
    CHECK_THAT(a.volume_mm3(), WithinAbs(signed_volume(first), 1e-12 * signed_volume(first)));
    const ExactSolid common = intersect(a, b, context), rest = subtract(a, b, context), whole = unite(a, b, context);
    REQUIRE(common.volume_mm3() > 0);
    CHECK_THAT(rest.volume_mm3(), WithinAbs(a.volume_mm3() - common.volume_mm3(), 1e-9 * a.volume_mm3()));
    CHECK_THAT(whole.volume_mm3(),
               WithinAbs(a.volume_mm3() + b.volume_mm3() - common.volume_mm3(), 1e-9 * whole.volume_mm3()));
    for (const ExactSolid* result : {&common, &rest, &whole}) CHECK(Adjacency(result->mesh()).is_closed());
  }
}

// What is taken away and what is left make the whole again, exactly: no rounding between operations.
TEST_CASE("Booleans.ChainsStayExact") {
  Context context;
  const ExactSolid a = solid(icosphere(1)), b = solid(moved(rotated(icosphere(1), {1, 2, 3}, 0.7), {0.4, 0.3, 0.2}));
  const ExactSolid again = unite(subtract(a, b, context), intersect(a, b, context), context);
  CHECK(subtract(again, a, context).empty());
  CHECK(subtract(a, again, context).empty());
}

TEST_CASE("Booleans.HalvesAddUp") {
  Context context;
  const ExactSolid torus_solid = solid(sample("torus", 2000)), sphere = solid(moved(icosphere(3), {0.1, 0.2, 0.3}, 10));
  for (const ExactSolid* shape : {&torus_solid, &sphere})
    for (int axis = 0; axis < 3; ++axis)
      for (const double offset : {-3.0, 0.1, 7.25}) {
        const ExactSolid upper = shape->half(axis, offset, true, context),
                         lower = shape->half(axis, offset, false, context);
        CHECK_THAT(upper.volume_mm3() + lower.volume_mm3(),
                   WithinAbs(shape->volume_mm3(), 1e-12 * shape->volume_mm3()));
        CHECK(Adjacency(upper.mesh()).is_closed());
        CHECK(Adjacency(lower.mesh()).is_closed());
        CHECK(upper.mesh().V.col(axis).minCoeff() ==
              std::max(offset, shape->mesh().V.col(axis).minCoeff()));  // on the plane, to the last bit
        // The same part as a boolean with a box.
        Vec3 low(-1000, -1000, -1000);
        low[axis] = offset;
        CHECK_THAT(intersect(*shape, box(low, {2000, 2000, 2000}), context).volume_mm3(),
                   WithinAbs(upper.volume_mm3(), 1e-12 * shape->volume_mm3()));
      }
  CHECK(sphere.half(2, 100, true, context).empty());
  CHECK_THAT(sphere.half(2, -100, true, context).volume_mm3(),
             WithinAbs(sphere.volume_mm3(), 1e-12 * sphere.volume_mm3()));
}

TEST_CASE("Booleans.SectionPrism") {
  Context context;
  const ExactSolid pyramid =
      solid(make_mesh({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {0, 0, 2}},
                      {{{0, 1, 4}}, {{1, 2, 4}}, {{2, 3, 4}}, {{3, 0, 4}}, {{0, 2, 1}}, {{0, 3, 2}}}));
  const ExactSolid prism = pyramid.section_prism(1, -0.5, context);  // 1 x 1 at half the height
  CHECK_THAT(prism.volume_mm3(), WithinAbs(1.5, 1e-15));
  CHECK(Adjacency(prism.mesh()).is_closed());
  CHECK(pyramid.section_prism(2.5, 0, context).empty());
  const ExactSolid ring = solid(moved(rotated(torus(24, 12), {1, 0, 0}, 0.3), {0, 0, 0}));  // a section with two loops
  CHECK(Adjacency(ring.section_prism(0.05, -3, context).mesh()).is_closed());
}

TEST_CASE("Booleans.OverlappingPartsAreUnited") {
  Context context;
  const TriangleMesh pair = joined(cube(), moved(cube(), {0.5, 0.25, 0.125}));
  CHECK_THAT(ExactSolid::above(pair, -1, "mesh", context).volume_mm3(), WithinAbs(2 - 0.5 * 0.75 * 0.875, 1e-15));
  CHECK_THAT(ExactSolid::above(pair, 0.5, "mesh", context).volume_mm3(),
             WithinAbs(0.5 + 0.625 - 0.5 * 0.75 * 0.5, 1e-15));
}

TEST_CASE("Booleans.OpenBelowTheCut") {
  Context context;
  const TriangleMesh open = moved(tube(16, 4), {0, 0, 0}, 2);
  CHECK(refusal(ErrorCode::invalid_input, [&] { solid(open); }).find("watertight") != std::string::npos);
  TriangleMesh cup = open;  // closed at the top
  Triangles F(open.F.rows() + 14, 3);
  F.topRows(open.F.rows()) = open.F;
  for (int i = 2; i < 16; ++i) F.row(open.F.rows() + i - 2) << 64, 64 + i - 1, 64 + i;
  cup.F = F;
  const double section = 0.5 * 16 * std::sin(2 * std::numbers::pi / 16) * 4;
  CHECK_THAT(ExactSolid::above(cup, 0.5, "mesh", context).volume_mm3(), WithinAbs(1.5 * section, 1e-13));
  CHECK_THAT(ExactSolid::above(cup, 0, "mesh", context).volume_mm3(), WithinAbs(2 * section, 1e-13));
  CHECK(refusal(ErrorCode::invalid_input, [&] {
          ExactSolid::above(cup, -0.5, "mesh", context);
        }).find("hole up to 0.5 mm") != std::string::npos);
}

TEST_CASE("Booleans.RefusesWhatIsNoSolid") {
  Context context;
  CHECK(refusal(ErrorCode::invalid_input, [] { solid(reversed(cube())); }).find("inside out") != std::string::npos);
  CHECK(refusal(ErrorCode::invalid_input, [] {
          solid(joined(cube(), moved(cube(), {0.25, 0.25, 0.25}, 0.5)));
        }).find("within another") != std::string::npos);
  TriangleMesh crossing = icosphere(2);
  for (Eigen::Index i = 0; i < crossing.V.rows(); ++i)
    if (crossing.V(i, 0) > 0.6) crossing.V(i, 0) -= 2.4;  // one cap pulled through the other side
  CHECK(refusal(ErrorCode::invalid_input, [&] { solid(crossing); }).find("crosses itself") != std::string::npos);
  // Two cubes that share an edge only.
  const ExactSolid a = box({0, 0, 0}, {1, 1, 1}), b = box({1, 1, 0}, {1, 1, 1});
  CHECK(refusal(ErrorCode::could_not_solve, [&] { unite(a, b, context); }).find("touch") != std::string::npos);
}

TEST_CASE("Booleans.CancelsWithin") {
  int calls = 0;
  Host host;
  host.cancel_requested = [&] { return ++calls > 3; };
  Context context(host);
  Context free;
  const ExactSolid a = ExactSolid::from_mesh(sample("torus", 2000), "mesh", free),
                   b = ExactSolid::from_mesh(moved(sample("torus", 2000), {5, 3, 2}), "mesh", free);
  refusal(ErrorCode::cancelled, [&] { unite(a, b, context); });
}

}  // namespace
}  // namespace formwright
