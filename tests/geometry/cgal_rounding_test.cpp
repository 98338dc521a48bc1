// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL's exact predicates filter with interval arithmetic, which rests on directed rounding. WebAssembly
// has none: built without CGAL_ALWAYS_ROUND_TO_NEAREST the predicates are silently wrong there. fw::cgal
// sets what is needed; here every sign is compared with one computed in integers.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <catch2/catch_test_macros.hpp>

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>

#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using test::Random;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Integer = boost::multiprecision::cpp_int;

#if defined(__EMSCRIPTEN__) && !defined(CGAL_ALWAYS_ROUND_TO_NEAREST)
#error "link fw::cgal: exact predicates would be wrong"
#endif

/// A double as an integer number of 2^-80; exact for multiples of that below 2^40.
Integer scaled(double x) {
  int exponent = 0;
  const double mantissa = std::frexp(x, &exponent);
  const Integer digits(static_cast<long long>(std::ldexp(mantissa, 53)));
  return digits << (exponent - 53 + 80);
}
int sign(const Integer& x) { return x.sign(); }
int sign(CGAL::Sign s) { return static_cast<int>(s); }

TEST_CASE("CgalRounding.NearlyCollinearPoints") {
  // The classroom example of Kettner, Mehlhorn, Pion, Schirra, Yap 2008: a grid of one ulp around (1/2, 1/2).
  int wrong = 0, zero = 0;
  const double ulp = std::ldexp(1.0, -53);
  for (const auto& [qx, rx] : {std::pair{12.0, 24.0}, std::pair{17.3, 24.00000000000005}, std::pair{8.8, 12.1}})
    for (int i = 0; i < 64; ++i)
      for (int j = 0; j < 64; ++j) {
        const double px = 0.5 + i * ulp, py = 0.5 + j * ulp;
        const Integer a = scaled(qx) - scaled(px), b = scaled(qx) - scaled(py), c = scaled(rx) - scaled(px),
                      d = scaled(rx) - scaled(py);
        const int expected = sign(Integer(a * d - b * c));
        const int found =
            sign(CGAL::orientation(Kernel::Point_2(px, py), Kernel::Point_2(qx, qx), Kernel::Point_2(rx, rx)));
        wrong += found != expected ? 1 : 0;
        zero += expected == 0 ? 1 : 0;
      }
  CHECK(wrong == 0);
  CHECK(zero > 64);  // the hard cases are there
}

TEST_CASE("CgalRounding.NearlyCocircularPoints") {
  Random random(101);
  int wrong = 0, zero = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    // Four points of a circle with integer coordinates (5-12-13, 3-4-5 triangles), moved by an ulp or none.
    const std::array<std::pair<double, double>, 8> circle{
        {{5, 12}, {-5, 12}, {12, 5}, {12, -5}, {0, 13}, {13, 0}, {-12, -5}, {-13, 0}}};
    std::array<double, 8> p{};
    const double cx = random.uniform(-1, 1), cy = random.uniform(-1, 1), size = std::ldexp(1.0, -random.below(20));
    for (std::size_t i = 0; i < 4; ++i) {
      const auto [x, y] = circle[(static_cast<std::size_t>(trial) + i * 3) % 8];
      p[2 * i] = cx + size * x;
      p[2 * i + 1] = cy + size * y;
    }
    if (trial % 4 == 0)
      for (double& x : p) x = std::round(x * 64) / 64;
    const auto [ax, ay, bx, by, qx, qy, dx, dy] = p;
    const Integer X = scaled(dx), Y = scaled(dy);
    const Integer a = scaled(ax) - X, b = scaled(ay) - Y, c = scaled(bx) - X, d = scaled(by) - Y, e = scaled(qx) - X,
                  f = scaled(qy) - Y;
    const Integer determinant =
        (a * a + b * b) * (c * f - d * e) - (c * c + d * d) * (a * f - b * e) + (e * e + f * f) * (a * d - b * c);
    const int expected = sign(determinant);
    const int found = sign(CGAL::side_of_oriented_circle(Kernel::Point_2(ax, ay), Kernel::Point_2(bx, by),
                                                         Kernel::Point_2(qx, qy), Kernel::Point_2(dx, dy)));
    wrong += found != expected ? 1 : 0;
    zero += expected == 0 ? 1 : 0;
  }
  CHECK(wrong == 0);
  CHECK(zero > 20);
}

TEST_CASE("CgalRounding.NearlyCoplanarPoints") {
  Random random(202);
  int wrong = 0, zero = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    std::array<Vec3, 4> p;
    for (Vec3& point : p) point = random.in_cube();
    if (trial % 3 == 0)
      for (Vec3& point : p) point = (point * 8).array().round().matrix() / 8;
    // The last one into the plane of the others, to round-off.
    const double u = trial % 3 == 0 ? 0.5 : random.uniform(), v = trial % 3 == 0 ? 0.25 : random.uniform();
    p[3] = p[0] + u * (p[1] - p[0]) + v * (p[2] - p[0]);
    std::array<std::array<Integer, 3>, 3> m;
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 3; ++c) {
        const auto k = static_cast<int>(c);
        m[r][c] = scaled(p[r + 1][k]) - scaled(p[0][k]);
      }
    const Integer determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                                m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                                m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    const auto point = [&](std::size_t i) { return Kernel::Point_3(p[i][0], p[i][1], p[i][2]); };
    const int expected = sign(determinant), found = sign(CGAL::orientation(point(0), point(1), point(2), point(3)));
    wrong += found != expected ? 1 : 0;
    zero += expected == 0 ? 1 : 0;
  }
  CHECK(wrong == 0);
  CHECK(zero > 500);
}

}  // namespace
}  // namespace formwright
