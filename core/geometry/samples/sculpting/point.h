// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Three doubles and plain arithmetic: no expression templates, no fused operations, so that results do
// not depend on the target (see portable_math.h).
#include <cmath>

namespace formwright::samples {

struct Point {
  double x = 0, y = 0, z = 0;

  Point operator+(const Point& b) const { return {x + b.x, y + b.y, z + b.z}; }
  Point operator-(const Point& b) const { return {x - b.x, y - b.y, z - b.z}; }
  Point operator*(double s) const { return {x * s, y * s, z * s}; }
  Point operator/(double s) const { return {x / s, y / s, z / s}; }
  Point operator-() const { return {-x, -y, -z}; }
  Point& operator+=(const Point& b) { return *this = *this + b; }
  Point& operator-=(const Point& b) { return *this = *this - b; }
  bool operator==(const Point&) const = default;
};
inline Point operator*(double s, const Point& p) { return p * s; }
inline double dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Point cross(const Point& a, const Point& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length2(const Point& a) { return dot(a, a); }
inline double length(const Point& a) { return std::sqrt(dot(a, a)); }
inline double distance2(const Point& a, const Point& b) { return length2(a - b); }
/// Unit vector, or (0, 0, 1) for a vector too short to have a direction.
inline Point normalized(const Point& a) {
  const double l = length(a);
  return l > 1e-300 ? a / l : Point{0, 0, 1};
}
inline Point mix(const Point& a, const Point& b, double t) { return a + (b - a) * t; }
inline Point mirrored(const Point& p) { return {-p.x, p.y, p.z}; }

struct Box {
  Point low, high;
};

}  // namespace formwright::samples
