// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Distance functions, negative inside: exact ones for sphere, round cone, box and torus, an estimate
// whose gradient is near 1 at the surface for ellipsoids. After Hart 1996 (sphere tracing) and the
// well-known closed forms collected by Quilez.
#include "geometry/samples/sculpting/point.h"
#include "geometry/samples/sculpting/portable_math.h"

namespace formwright::samples {

/// Polynomial smooth minimum: differs from min(a, b) only where |a - b| < softness, by softness/4 at most.
inline double smooth_min(double a, double b, double softness) {
  const double gap = std::fabs(a - b);
  const double minimum = a < b ? a : b;
  if (gap >= softness) return minimum;
  const double h = 1 - gap / softness;
  return minimum - h * h * softness * 0.25;
}
inline double smooth_max(double a, double b, double softness) { return -smooth_min(-a, -b, softness); }

inline double sphere(const Point& p, const Point& centre, double radius) { return length(p - centre) - radius; }

/// Axis-aligned ellipsoid about the origin with semi-axes r.
inline double ellipsoid(const Point& p, const Point& r) {
  const Point u{p.x / r.x, p.y / r.y, p.z / r.z};
  const Point w{u.x / r.x, u.y / r.y, u.z / r.z};
  const double k0 = length(u), k1 = length(w);
  if (k1 < 1e-12) return -(r.x < r.y ? (r.x < r.z ? r.x : r.z) : (r.y < r.z ? r.y : r.z));
  return k0 * (k0 - 1) / k1;
}

/// Convex hull of two spheres: exact distance.
struct RoundCone {
  Point a, axis;  // axis = b - a
  double ra, rb, length_squared, slope, slope_rest, inverse;

  RoundCone() = default;
  RoundCone(const Point& from, const Point& to, double radius_from, double radius_to)
      : a(from), axis(to - from), ra(radius_from), rb(radius_to) {
    length_squared = length2(axis);
    slope = ra - rb;
    slope_rest = length_squared - slope * slope;
    inverse = 1 / length_squared;
  }
  double operator()(const Point& p) const {
    if (slope_rest <= 0) {  // one sphere swallows the other
      const double da = length(p - a) - ra, db = length(p - (a + axis)) - rb;
      return da < db ? da : db;
    }
    const Point pa = p - a;
    const double y = dot(pa, axis);
    const double z = y - length_squared;
    const Point q = pa * length_squared - axis * y;
    const double x2 = length2(q);
    const double y2 = y * y * length_squared, z2 = z * z * length_squared;
    const double k = (slope > 0 ? 1.0 : (slope < 0 ? -1.0 : 0.0)) * slope * slope * x2;
    if ((z > 0 ? 1.0 : -1.0) * slope_rest * z2 > k) return std::sqrt(x2 + z2) * inverse - rb;
    if ((y > 0 ? 1.0 : -1.0) * slope_rest * y2 < k) return std::sqrt(x2 + y2) * inverse - ra;
    return (std::sqrt(x2 * slope_rest * inverse) + y * slope) * inverse - ra;
  }
};

inline double round_box(const Point& p, const Point& half, double radius) {
  const Point q{std::fabs(p.x) - half.x + radius, std::fabs(p.y) - half.y + radius, std::fabs(p.z) - half.z + radius};
  const Point out{q.x > 0 ? q.x : 0, q.y > 0 ? q.y : 0, q.z > 0 ? q.z : 0};
  const double inside = q.x > q.y ? (q.x > q.z ? q.x : q.z) : (q.y > q.z ? q.y : q.z);
  return length(out) + (inside < 0 ? inside : 0) - radius;
}

/// A frame to pose primitives: columns u, v, w are orthonormal, origin o.
struct Frame {
  Point o, u{1, 0, 0}, v{0, 1, 0}, w{0, 0, 1};
  Point local(const Point& p) const {
    const Point d = p - o;
    return {dot(d, u), dot(d, v), dot(d, w)};
  }
  Point global(const Point& q) const { return o + u * q.x + v * q.y + w * q.z; }
};
/// Frame at `origin` turned by `yaw` about y, then `pitch` about its x, then `roll` about its z (degrees).
inline Frame posed(const Point& origin, double yaw, double pitch = 0, double roll = 0) {
  const double cy = cosine(yaw * pi / 180), sy = sine(yaw * pi / 180), cp = cosine(pitch * pi / 180),
               sp = sine(pitch * pi / 180), cr = cosine(roll * pi / 180), sr = sine(roll * pi / 180);
  const Point x{cy, 0, -sy}, y{sy * sp, cp, cy * sp}, z{sy * cp, -sp, cy * cp};
  return {origin, x * cr + y * sr, y * cr - x * sr, z};
}

}  // namespace formwright::samples
