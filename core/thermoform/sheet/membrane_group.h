// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Four triangles of a Membrane at a time: their state, and the strain and flow that forces and steps share.
#include <cmath>

#include "thermoform/sheet/membrane.h"

#pragma GCC diagnostic ignored "-Wpsabi"  // 32-byte vectors stay within inlined functions

namespace formwright {

struct alignas(32) Membrane::Group {
  // Inverse of [rest edge 1, rest edge 2] (2 x 2): of the present rest state, and of the flat sheet.
  Double4 b00, b01, b10, b11, flat00, flat01, flat10, flat11;
  Double4 volume;                  // mm^3
  Double4 stiffness;               // times the material's modulus, where the sheet was flat
  Double4 chill;                   // times the same, now: what touches cold grows stiff
  Double4 weight;                  // rest area times thickness, of this step
  Double4 network_weight;          // the flat sheet's area times thickness, of this step
  Double4 creep;                   // 1/s, of this step: 0 where nothing may flow
  Double4 past00, past01, past11;  // strain at the start of the step
  std::array<std::array<int, 4>, 3> vertex;
  int first_face = 0, lanes = 4;
  int min_vertex = 0, max_vertex = 0;
};

namespace membrane_detail {

struct Strain {
  Double4 e00, e01, e11;
};

/// Inverse of [rest edge 1, rest edge 2].
struct RestFrame {
  const Double4 &b00, &b01, &b10, &b11;
};

/// Deformation of four triangles: f0, f1 are the images of the rest frame's axes.
struct Deformation {
  Double4 f0[3], f1[3];
  Strain strain;
};

inline void gather(const Positions& x, const std::array<int, 4>& vertex, Double4 (&out)[3]) {
  for (int k = 0; k < 3; ++k)
    out[k] = Double4{x.data()[3 * vertex[0] + k], x.data()[3 * vertex[1] + k], x.data()[3 * vertex[2] + k],
                     x.data()[3 * vertex[3] + k]};
}

inline Double4 root(const Double4& a) {
  return Double4{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
}
inline Double4 maximum(const Double4& a, const Double4& b) { return a > b ? a : b; }

/// Green strain, eq. (4.1), in an orthonormal frame of the rest triangle: (F^T F - 1)/2.
template <class G>
inline void deform(const G& g, const Positions& x, bool from_flat, Deformation& d) {
  Double4 x0[3], x1[3], x2[3];
  gather(x, g.vertex[0], x0);
  gather(x, g.vertex[1], x1);
  gather(x, g.vertex[2], x2);
  const Double4 &b00 = from_flat ? g.flat00 : g.b00, &b01 = from_flat ? g.flat01 : g.b01;
  const Double4 &b10 = from_flat ? g.flat10 : g.b10, &b11 = from_flat ? g.flat11 : g.b11;
  Double4 c00{}, c01{}, c11{};
  for (int k = 0; k < 3; ++k) {
    const Double4 edge1 = x1[k] - x0[k], edge2 = x2[k] - x0[k];
    d.f0[k] = edge1 * b00 + edge2 * b10;
    d.f1[k] = edge1 * b01 + edge2 * b11;
    c00 += d.f0[k] * d.f0[k];
    c01 += d.f0[k] * d.f1[k];
    c11 += d.f1[k] * d.f1[k];
  }
  d.strain = {0.5 * (c00 - 1.0), 0.5 * c01, 0.5 * (c11 - 1.0)};
}

inline Double4 norm(const Strain& e) { return root(e.e00 * e.e00 + 2.0 * e.e01 * e.e01 + e.e11 * e.e11); }

/// How much of the trial strain stays elastic when the step's creep is solved implicitly:
///   total strain:   eps (1 + a) = trial,                      a = dt c_creep
///   elastic excess: |eps| + a (|eps| - c_yield) = |trial|     (only the excess flows)
/// and, for the tangent, how much of that falls away along the strain itself.
struct Flow {
  Double4 kept, lost;
};
inline void flow(const Strain& trial, const Double4& creep, double dt_s, YieldRule rule, double yield_strain,
                 Flow& result) {
  const Double4 one = Double4{} + 1.0, zero{};
  if (!std::isfinite(dt_s)) {
    result = {one, zero};
    return;
  }
  const Double4 a = creep * dt_s;
  if (rule == YieldRule::total_strain) {
    result = {one / (one + a), zero};
    return;
  }
  const Double4 size = maximum(norm(trial), Double4{} + 1e-30);
  const Double4 threshold = a * yield_strain / ((one + a) * size);
  const auto yields = size > Double4{} + yield_strain;
  result.kept = yields ? one / (one + a) + threshold : one;
  result.lost = yields ? threshold : zero;
}

inline double lane_sum(const Double4& a, int lanes) {
  double sum = 0;
  for (int l = 0; l < lanes; ++l) sum += a[l];
  return sum;
}

}  // namespace membrane_detail

}  // namespace formwright
