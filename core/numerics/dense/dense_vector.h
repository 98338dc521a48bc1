// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Four doubles at once: one AVX register natively, two 128-bit ones in WebAssembly.
#include <cstring>
#if defined(__FMA__)
#include <immintrin.h>
#endif

namespace formwright::dense {

using Vector = double __attribute__((vector_size(32)));

inline Vector load(const double* p) {
  Vector v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
inline void store(double* p, const Vector& v) { std::memcpy(p, &v, sizeof v); }
inline Vector splat(double x) { return Vector{x, x, x, x}; }

/// a b + c, fused where the machine can.
inline Vector multiply_add(const Vector& a, const Vector& b, const Vector& c) {
#if defined(__FMA__)
  return _mm256_fmadd_pd(a, b, c);
#else
  return a * b + c;
#endif
}

}  // namespace formwright::dense
