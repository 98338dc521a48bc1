// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Shapes whose parameterisation, curve and ribbon are known, and designs made of them.
#include <catch2/catch_test_macros.hpp>

#include <string_view>

#include "base/error.h"
#include "geometry/samples/samples.h"
#include "geometry/test_meshes.h"
#include "zippable/design_files.h"
#include "zippable/proposal.h"
#include "zippable/ribbon/ribbon.h"

namespace formwright::test {

/// In one sentence that names the file's input.
inline void expect_segments_refused(const char* text) {
  try {
    read_segments(to_bytes(text));
    FAIL_CHECK("accepted " << text);
  } catch (const Error& error) {
    CHECK(error.where() == "segments");
    CHECK(std::string(error.what()).back() == '.');
  }
}

/// Open at both ends: radius(t) and height(t) for t in [0, 1], `rows` rows of `around` vertices, every other row turned
/// by half a side so that no direction is preferred.
template <class Profile>
TriangleMesh turned(int around, int rows, const Profile& profile) {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> faces;
  for (int j = 0; j <= rows; ++j) {
    const Vec2 rz = profile(static_cast<double>(j) / rows);
    for (int i = 0; i < around; ++i) {
      const double u = 2 * std::numbers::pi * (i + 0.5 * (j % 2)) / around;
      points.emplace_back(rz.x() * std::cos(u), rz.x() * std::sin(u), rz.y());
    }
    if (j == rows) break;
    for (int i = 0; i < around; ++i) {
      const int a = j * around + i, b = j * around + (i + 1) % around, c = a + around, d = b + around;
      if (j % 2 == 0) faces.push_back({a, b, c}), faces.push_back({b, d, c});
      else faces.push_back({a, b, d}), faces.push_back({a, d, c});
    }
  }
  return make_mesh(points, faces);
}

inline TriangleMesh cylinder_side(double radius, double height, int around, int rows) {
  return turned(around, rows, [&](double t) { return Vec2(radius, t * height); });
}

inline Segmentation alone(const TriangleMesh& mesh) {
  return make_segmentation(mesh, std::vector<int>(mesh.face_count(), 0));
}

struct Zipped {
  Segmentation segmentation;
  Parameterisation parameterisation;
  RankedTraversal traversal;
  ZipperCurve curve;
  Ribbon ribbon;
};

inline Zipped zip(Segmentation segmentation, const CurveOptions& options) {
  Context context;
  Zipped z;
  z.segmentation = std::move(segmentation);
  z.parameterisation = parameterise(z.segmentation, {1e-13}, context);
  z.traversal = ranked_traversals(z.segmentation, z.parameterisation, options.width_mm, Context()).at(0);
  const LineTracer tracer(z.segmentation, z.parameterisation);
  z.curve = draw_zipper_curve(z.segmentation, z.parameterisation, tracer, z.traversal.traversal, z.traversal.crossings,
                              options, context);
  z.ribbon = make_ribbon(z.segmentation, z.parameterisation, tracer, z.curve, options, context);
  return z;
}

inline Proposal proposed(std::string_view sample, int vertices, double puncture_radius_mm = 5, int parts_max = 10) {
  Context context;
  return propose_segmentation(make_sample(sample, vertices, context).mesh,
                              {puncture_radius_mm, parts_max, 0.08, {}, {}, {}}, context);
}

}  // namespace formwright::test
