// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Quadric error metrics of uncertain planes: Garland & Heckbert 1997; Trettner & Kobbelt 2020, "Fast and
// Robust QEM Simplification using Probabilistic Quadrics", eq. (7) with isotropic noise in the normal.
#include <cmath>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// q(x) = x^T A x - 2 b^T x + c: the expected squared distance to a set of planes, weighted.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;  // A
  double x = 0, y = 0, z = 0;                             // b
  double c = 0;

  /// The plane through p with unit normal n whose normal is known to a standard deviation of
  /// sqrt(variance): the deviation adds variance * |x - p|^2, which makes A regular, keeps x near p where
  /// the surface is flat, and so spreads vertices evenly.
  static Quadric plane(const Vec3& p, const Vec3& n, double variance, double weight) {
    const double d = n.dot(p), v = variance;
    Quadric q;
    q.xx = weight * (n[0] * n[0] + v);
    q.xy = weight * n[0] * n[1];
    q.xz = weight * n[0] * n[2];
    q.yy = weight * (n[1] * n[1] + v);
    q.yz = weight * n[1] * n[2];
    q.zz = weight * (n[2] * n[2] + v);
    q.x = weight * (d * n[0] + v * p[0]);
    q.y = weight * (d * n[1] + v * p[1]);
    q.z = weight * (d * n[2] + v * p[2]);
    q.c = weight * (d * d + v * p.squaredNorm());
    return q;
  }

  Quadric& operator+=(const Quadric& o) {
    xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz;
    x += o.x, y += o.y, z += o.z;
    c += o.c;
    return *this;
  }
  friend Quadric operator+(Quadric a, const Quadric& b) { return a += b; }

  double operator()(const Vec3& p) const {
    const double ax = xx * p[0] + xy * p[1] + xz * p[2], ay = xy * p[0] + yy * p[1] + yz * p[2],
                 az = xz * p[0] + yz * p[1] + zz * p[2];
    return p[0] * (ax - 2 * x) + p[1] * (ay - 2 * y) + p[2] * (az - 2 * z) + c;
  }

  /// Where q is least, by Cholesky; false when A is singular to round-off.
  bool minimiser(Vec3& p) const {
    const double minimum = 1e-12 * (xx + yy + zz);
    if (!(xx > minimum)) return false;
    const double l10 = xy / xx, l20 = xz / xx;
    const double d1 = yy - l10 * xy, e = yz - l10 * xz;
    if (!(d1 > minimum)) return false;
    const double l21 = e / d1, d2 = zz - l20 * xz - l21 * e;
    if (!(d2 > minimum)) return false;
    const double u = y - l10 * x, w = (z - l20 * x - l21 * u) / d2;
    const double v = u / d1 - l21 * w;
    p = Vec3((x - xy * v - xz * w) / xx, v, w);
    return true;
  }
};

}  // namespace formwright
