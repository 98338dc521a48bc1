// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Elementary functions out of +, -, *, / and sqrt alone. IEEE 754 fixes those to the last bit, libm
// does not fix sin or exp, and a mesh generator decides by comparisons: with these a sample is the same
// natively and in WASM, to the last bit. Accurate to about 1e-15 relative or absolute, whichever is larger.
#include <cmath>
#include <cstdint>
#include <cstring>

namespace formwright::samples {

inline constexpr double pi = 3.14159265358979323846;

namespace detail {
// Taylor series on |x| <= pi/4; the first term left out is below 1e-17.
inline double sine_kernel(double x) {
  const double z = x * x;
  return x * (1 + z * (-1.0 / 6 +
                       z * (1.0 / 120 +
                            z * (-1.0 / 5040 +
                                 z * (1.0 / 362880 + z * (-1.0 / 39916800 +
                                                          z * (1.0 / 6227020800.0 + z * (-1.0 / 1307674368000.0))))))));
}
inline double cosine_kernel(double x) {
  const double z = x * x;
  return 1 + z * (-1.0 / 2 +
                  z * (1.0 / 24 +
                       z * (-1.0 / 720 +
                            z * (1.0 / 40320 + z * (-1.0 / 3628800 +
                                                    z * (1.0 / 479001600.0 + z * (-1.0 / 87178291200.0 +
                                                                                  z * (1.0 / 20922789888000.0))))))));
}
}  // namespace detail

/// sin of x radians, |x| < 1e6.
inline double sine(double x) {
  const double quarter = std::floor(x * (2 / pi) + 0.5);
  const double r = (x - quarter * 1.57079632673412561417) - quarter * 6.07710050650619224932e-11;
  switch (static_cast<std::int64_t>(quarter) & 3) {
    case 0: return detail::sine_kernel(r);
    case 1: return detail::cosine_kernel(r);
    case 2: return -detail::sine_kernel(r);
    default: return -detail::cosine_kernel(r);
  }
}
inline double cosine(double x) { return sine(x + pi / 2); }

/// e^x; 0 below -700, capped above 700.
inline double exponential(double x) {
  if (x < -700) return 0;
  if (x > 700) x = 700;
  const double n = std::floor(x * 1.44269504088896340736 + 0.5);
  const double r = (x - n * 0.693147180369123816490) - n * 1.90821492927058770002e-10;
  double term = 1, sum = 1;
  for (int k = 1; k <= 14; ++k) {
    term *= r / k;
    sum += term;
  }
  const std::uint64_t bits = static_cast<std::uint64_t>(1023 + static_cast<std::int64_t>(n)) << 52;
  double power;
  std::memcpy(&power, &bits, sizeof power);
  return sum * power;
}

/// arctan(y / x) in the right quadrant, -pi to pi; 0 at the origin.
inline double arc_tangent(double y, double x) {
  const double ay = std::fabs(y), ax = std::fabs(x);
  const double larger = ax > ay ? ax : ay, smaller = ax > ay ? ay : ax;
  if (larger == 0) return 0;
  double t = smaller / larger, offset = 0;
  // Two half-angle steps bring t below tan(pi/16) and the series to 1e-16 in ten terms.
  double scale = 1;
  for (int k = 0; k < 2; ++k) {
    t = t / (1 + std::sqrt(1 + t * t));
    scale *= 2;
  }
  const double z = t * t;
  double series = 0;
  for (int k = 11; k >= 0; --k) series = (k % 2 == 0 ? 1.0 : -1.0) / (2 * k + 1) + z * series;
  double angle = offset + scale * t * series;
  if (ay > ax) angle = pi / 2 - angle;
  if (x < 0) angle = pi - angle;
  return y < 0 ? -angle : angle;
}

inline double clamp(double x, double low, double high) { return x < low ? low : (x > high ? high : x); }
inline double mix(double a, double b, double t) { return a + (b - a) * t; }
/// 0 below `from`, 1 above `to`, cubic between.
inline double smooth_step(double from, double to, double x) {
  const double t = clamp((x - from) / (to - from), 0, 1);
  return t * t * (3 - 2 * t);
}
/// Bell of compact support: 1 at 0, 0 with two derivatives at |x| >= 1.
inline double bell(double x) {
  const double u = 1 - x * x;
  return u > 0 ? u * u * u : 0;
}

}  // namespace formwright::samples
