// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/registration/flat_scan.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <functional>

#include "base/error.h"
#include "geometry/samples/samples.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

/// A grid over [-w, w] x [-h, h], each point where `place` puts it; cells that `skip` names are left out.
TriangleMesh grid(double w, double h, int n, const std::function<Vec3(double, double)>& place,
                  const std::function<bool(double, double)>& skip = {}) {
  TriangleMesh mesh;
  std::vector<Eigen::RowVector3i> faces;
  mesh.V.resize((n + 1) * (n + 1), 3);
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) mesh.V.row(j * (n + 1) + i) = place(w * (2.0 * i / n - 1), h * (2.0 * j / n - 1));
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      if (skip && skip(w * (2.0 * i / n - 1), h * (2.0 * j / n - 1))) continue;
      const int a = j * (n + 1) + i;
      faces.emplace_back(a, a + 1, a + n + 2);
      faces.emplace_back(a, a + n + 2, a + n + 1);
    }
  mesh.F.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) mesh.F.row(static_cast<Eigen::Index>(f)) = faces[f];
  return mesh;
}

Vec3 cylinder(double x, double y) { return {30 * std::sin(x / 30), y, 30 * std::cos(x / 30)}; }

TEST_CASE("FlatScan.WhatCanBeUnrolledIsUnrolled") {
  Context context;
  const TriangleMesh mesh = grid(40, 25, 40, cylinder);
  const FlatScan flat = flatten(mesh, 200, context);
  CHECK(flat.flipped == 0);
  CHECK(flat.stretch_rms < 1e-3);
  // Distances across are those of the chords: n = 40 chords of 2 mm arcs on a radius of 30.
  const double across = (flat.place_mm.row(40) - flat.place_mm.row(0)).norm();
  CHECK_THAT(across, WithinAbs(40 * 60 * std::sin(1.0 / 30), 0.1));
}

TEST_CASE("FlatScan.HolesStayHoles") {
  Context context;
  Model model;
  model.mesh = grid(40, 40, 32, cylinder, [](double x, double y) { return std::hypot(x - 8, y + 5) < 9; });
  const ScanPart part = sheet_part(model);
  CHECK(part.holes == 1);
  CHECK(part.other_parts == 0);
  const FlatScan flat = flatten(part.model.mesh, 200, context);
  CHECK(flat.flipped == 0);
  CHECK(flat.stretch_rms < 2e-3);
}

TEST_CASE("FlatScan.MoreStepsComeNearerToRigid") {
  Context context;
  const TriangleMesh mesh =
      grid(50, 50, 40, [](double x, double y) { return Vec3(x, y, 25 * std::exp(-(x * x + y * y) / 500)); });
  double before = 1e9;
  for (const int steps : {0, 1, 3, 30}) {
    const FlatScan flat = flatten(mesh, steps, context);
    {
      INFO(steps);
      CHECK(flat.stretch_rms < before);
    }
    before = flat.stretch_rms;
  }
}

TEST_CASE("FlatScan.TheLargestSheetIsTakenAndSolidsAreRefused") {
  Context context;
  Model model;
  model.mesh = grid(20, 20, 4, cylinder);
  const TriangleMesh more = grid(5, 5, 2, [](double x, double y) { return Vec3(x, y, 100); });
  const int n = model.mesh.vertex_count(), m = model.mesh.face_count();
  model.mesh.V.conservativeResize(n + more.V.rows(), 3);
  model.mesh.V.bottomRows(more.V.rows()) = more.V;
  model.mesh.F.conservativeResize(m + more.F.rows(), 3);
  model.mesh.F.bottomRows(more.F.rows()) = more.F.array() + n;
  const ScanPart part = sheet_part(model);
  CHECK(part.model.mesh.face_count() == m);
  CHECK(part.other_parts == 1);
  REQUIRE(part.notes.size() == 1u);
  try {
    sheet_part(make_sample("bust", 2000, context));
    FAIL();
  } catch (const Error& e) {
    CHECK(e.where() == "scan");
  }
}

}  // namespace
}  // namespace formwright
