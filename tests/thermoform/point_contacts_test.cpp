// SPDX-License-Identifier: GPL-3.0-or-later
// Sharp points against moving triangles: what is remembered from step to step must not let any through.
#include "thermoform/contact/point_contacts.h"

#include <catch2/catch_test_macros.hpp>

#include <algorithm>
#include <random>
#include <set>

#include "geometry/queries/point_distance.h"
#include "thermoform/sheet_fixture.h"

namespace formwright {
namespace {

using namespace thermoform_test;

constexpr double tolerance_mm = 0.01, near_mm = 0.4;

/// Distance of a point from a face at a moment of the step.
double distance(const Triangles& F, int face, const Positions& from, const Positions& to, double t, const Vec3& q) {
  const auto corner = [&](int k) -> Vec3 {
    return (from.row(F(face, k)) + t * (to.row(F(face, k)) - from.row(F(face, k)))).transpose();
  };
  return nearest_on_triangle(q, corner(0), corner(1), corner(2)).distance;
}

/// A sheet sinks, waving, through a cloud of points, with steps from a hair to several edges, some of them tried in
/// vain.
void expect_every_point_met(unsigned seed, bool bounds_known) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const SheetMesh sheet = make_sheet_mesh(Vec2(24, 24), 72);
  const auto faces = static_cast<std::size_t>(sheet.F.rows());
  std::vector<Vec3> points;
  for (int i = 0; i < 120; ++i) points.emplace_back(30 * unit(random) - 15, 30 * unit(random) - 15, 24 * unit(random));
  PointContacts contacts(points, 4, 1);
  const HeldVertices held(static_cast<std::size_t>(sheet.flat_mm.rows()), 0);
  const std::vector<double> radius(faces, near_mm);
  Positions from = shaken(sheet, 0.1, seed);
  from.col(2).array() += 27;
  const auto clear = [&](int v) {
    double minimum = 0;
    if (bounds_known) {
      minimum = 1e300;
      for (const Vec3& q : points) minimum = std::min(minimum, (q - from.row(v).transpose()).norm());
    }
    return minimum;
  };
  const double sinks_mm[] = {0.02, 0.3, 1.0, 0.1, 7.0, 0.5};
  std::set<int> met;
  for (int step = 0; step < 28; ++step) {
    Positions to = from;
    const double sink = sinks_mm[step % 6];
    for (Eigen::Index i = 0; i < to.rows(); ++i)
      to.row(i) += Vec3(0.2 * unit(random), -0.2 * unit(random), -sink * (0.5 + unit(random))).transpose();
    if (step % 4 == 1) {  // tried in vain
      const std::size_t before = contacts.contacts().size();
      contacts.find(sheet.F, from, to + (to - from), radius, held, tolerance_mm, clear);
      contacts.roll_back(before);
    }
    const std::size_t before = contacts.contacts().size();
    contacts.find(sheet.F, from, to, radius, held, tolerance_mm, clear);
    for (std::size_t c = before; c < contacts.contacts().size(); ++c) {
      const PointContact& contact = contacts.contacts()[c];
      {
        INFO("a point met twice");
        CHECK(met.insert(contact.point).second);
      }
      CHECK(distance(sheet.F, contact.face, from, to, contact.fraction,
                     points[static_cast<std::size_t>(contact.point)]) < near_mm + tolerance_mm + 1e-9);
    }
    for (int p = 0; p < static_cast<int>(points.size()); ++p) {
      if (met.count(p)) continue;
      for (int f = 0; f < static_cast<int>(faces); ++f)
        for (int k = 0; k <= 20; ++k) {
          INFO("step " << step << ", point " << p << ", face " << f);
          REQUIRE(distance(sheet.F, f, from, to, 0.05 * k, points[static_cast<std::size_t>(p)]) >= near_mm);
        }
    }
    from = to;
  }
  CHECK(met.size() > 40u);
  CHECK(from.col(2).maxCoeff() < 0);  // all the way through
}

TEST_CASE("PointContacts.none_slips_through_whatever_the_steps") {
  for (unsigned seed = 1; seed <= 3; ++seed)
    for (const bool bounds_known : {false, true}) expect_every_point_met(seed, bounds_known);
}

}  // namespace
}  // namespace formwright
