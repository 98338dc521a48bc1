// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// One level of the pyramid of variational_flow.h: motion tensors after a warp, and the system that is swept.
#include <vector>

#include "imaging/flow/variational_flow.h"

namespace formwright::flow_detail {

/// A plane of floats with a border of one pixel of zeros, so that neighbours need no questions.
struct Plane {
  int width = 0, height = 0;
  std::size_t stride = 0;
  std::vector<float> values;

  Plane() = default;
  Plane(int w, int h)
      : width(w),
        height(h),
        stride(static_cast<std::size_t>(w) + 2),
        values(stride * (static_cast<std::size_t>(h) + 2), 0.0f) {}
  float* row(int y) { return values.data() + (static_cast<std::size_t>(y) + 1) * stride + 1; }
  const float* row(int y) const { return values.data() + (static_cast<std::size_t>(y) + 1) * stride + 1; }
};

/// (du, dv, 1) J (du, dv, 1)^T is the squared mismatch after a further step of (du, dv), to first order.
struct MotionTensors {
  Plane xx, xy, yy, xt, yt, tt;
  Plane weight;  // of both pictures
  MotionTensors(int w, int h) : xx(w, h), xy(w, h), yy(w, h), xt(w, h), yt(w, h), tt(w, h), weight(w, h) {}
};

/// Warps `second` by (u, v). Derivatives are means of those of both pictures, by central differences.
MotionTensors motion_tensors(const WeightedPicture& first, const WeightedPicture& second, const Plane& u,
                             const Plane& v, double gradient_weight, const Context& context);

/// What smoothness asks of: the displacement, or only what this warp adds to it. Smoothing a second time, and only the
/// correction, gives back detail that the first smoothing took (Tukey's twicing).
enum class Smoothed { displacement, correction };

/// Improves (u, v): options.inner_iterations times new robust weights, then options.sweeps of red-black successive
/// over-relaxation, both components of a pixel at once.
void relax(const MotionTensors& tensors, Plane& u, Plane& v, Smoothed smoothed, const VariationalFlowOptions& options,
           const Context& context);

/// Rows that one thread takes at a time; small pictures stay on one.
std::size_t rows_a_chunk(int width);

}  // namespace formwright::flow_detail
