// SPDX-License-Identifier: GPL-3.0-or-later
#include "imaging/flow/variational_flow.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/error.h"
#include "base/parallel.h"
#include "imaging/flow/flow_level.h"

namespace formwright {
namespace {

using flow_detail::Plane;

constexpr int coarsest_side_px = 16;

struct Size {
  int width, height;
  bool operator==(const Size&) const = default;
};

/// From coarse to fine; the last is the picture's own.
std::vector<Size> level_sizes(int width, int height, int coarsest_px, const VariationalFlowOptions& options) {
  std::vector<Size> sizes{{width, height}};
  double scale = 1;
  for (;;) {
    const Size& finer = sizes.back();
    scale *= std::max(finer.width, finer.height) > options.fine_above_px ? options.fine_pyramid_factor
                                                                         : options.pyramid_factor;
    const Size size{static_cast<int>(std::lround(width * scale)), static_cast<int>(std::lround(height * scale))};
    if (std::min(size.width, size.height) < coarsest_px) break;
    if (!(size == finer)) sizes.push_back(size);
  }
  std::reverse(sizes.begin(), sizes.end());
  return sizes;
}

/// Pictures halved again and again, from which any level is made by one reduction of less than a half.
class Octaves {
 public:
  Octaves(const WeightedPicture& picture, const Context& context) : context_(context) {
    const WeightedPicture* finest = &picture;
    all_.push_back(finest);
    while (std::min(all_.back()->width, all_.back()->height) >= 2 * coarsest_side_px) {
      halves_.push_back(std::make_unique<WeightedPicture>(
          reduced(*all_.back(), (all_.back()->width + 1) / 2, (all_.back()->height + 1) / 2, context)));
      all_.push_back(halves_.back().get());
    }
  }
  WeightedPicture level(const Size& size) const {
    std::size_t k = all_.size() - 1;
    while (k > 0 && (all_[k]->width < size.width || all_[k]->height < size.height)) --k;
    return reduced(*all_[k], size.width, size.height, context_);
  }

 private:
  const Context& context_;
  std::vector<const WeightedPicture*> all_;
  std::vector<std::unique_ptr<WeightedPicture>> halves_;
};

/// The same displacement on a finer or coarser grid, in its pixels.
Plane resampled(const Plane& from, const Size& size, bool horizontal) {
  Plane to(size.width, size.height);
  const double sx = static_cast<double>(from.width) / size.width, sy = static_cast<double>(from.height) / size.height;
  const float gain = static_cast<float>(horizontal ? 1 / sx : 1 / sy);
  parallel_for(static_cast<std::size_t>(size.height), flow_detail::rows_a_chunk(size.width),
               [&](std::size_t begin, std::size_t end) {
                 for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
                   const float fy =
                       std::clamp(static_cast<float>((y + 0.5) * sy - 0.5), 0.0f, static_cast<float>(from.height - 1));
                   const int y0 = std::min(static_cast<int>(fy), std::max(from.height - 2, 0));
                   const float ty = fy - static_cast<float>(y0);
                   const float *upper = from.row(y0), *lower = from.row(std::min(y0 + 1, from.height - 1));
                   for (int x = 0; x < size.width; ++x) {
                     const float fx =
                         std::clamp(static_cast<float>((x + 0.5) * sx - 0.5), 0.0f, static_cast<float>(from.width - 1));
                     const int x0 = std::min(static_cast<int>(fx), std::max(from.width - 2, 0)),
                               x1 = std::min(x0 + 1, from.width - 1);
                     const float tx = fx - static_cast<float>(x0);
                     const float a = upper[x0] + tx * (upper[x1] - upper[x0]),
                                 b = lower[x0] + tx * (lower[x1] - lower[x0]);
                     to.row(y)[x] = gain * (a + ty * (b - a));
                   }
                 }
               });
  return to;
}

void check(const WeightedPicture& first, const WeightedPicture& second) {
  if (first.width != second.width || first.height != second.height)
    throw Error(ErrorCode::invalid_input, "",
                "The optical flow needs two pictures of the same size: reduce the larger one.");
  if (std::min(first.width, first.height) < coarsest_side_px)
    throw Error(ErrorCode::invalid_input, "",
                "The optical flow needs pictures of at least 16 x 16 pixels: choose a larger picture size.");
}

Flow run(const WeightedPicture& first, const WeightedPicture& second, Plane u, Plane v, int coarsest_px,
         const VariationalFlowOptions& options, Context& context) {
  const Octaves octaves_first(first, context), octaves_second(second, context);
  const std::vector<Size> sizes = level_sizes(first.width, first.height, coarsest_px, options);
  double work = 0, done = 0;
  for (const Size& size : sizes) work += static_cast<double>(size.width) * size.height;
  for (std::size_t level = 0; level < sizes.size(); ++level) {
    const Size& size = sizes[level];
    const WeightedPicture a = octaves_first.level(size), b = octaves_second.level(size);
    u = resampled(u, size, true);
    v = resampled(v, size, false);
    const int warps = std::max(size.width, size.height) > options.fine_above_px ? options.fine_warps : 1;
    for (int k = 0; k < warps; ++k) {
      const flow_detail::MotionTensors tensors =
          flow_detail::motion_tensors(a, b, u, v, options.gradient_weight, context);
      const bool is_second_pass = level + 1 == sizes.size() && k > 0;
      flow_detail::relax(tensors, u, v,
                         is_second_pass ? flow_detail::Smoothed::correction : flow_detail::Smoothed::displacement,
                         options, context);
    }
    done += static_cast<double>(size.width) * size.height;
    context.progress(done / work);
  }
  Flow flow{first.width, first.height, {}, {}};
  for (int y = 0; y < first.height; ++y) {
    flow.u.insert(flow.u.end(), u.row(y), u.row(y) + first.width);
    flow.v.insert(flow.v.end(), v.row(y), v.row(y) + first.width);
  }
  return flow;
}

Plane plane(const std::vector<float>& values, int width, int height) {
  Plane result(width, height);
  for (int y = 0; y < height; ++y)
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(y) * width, width, result.row(y));
  return result;
}

}  // namespace

Flow variational_flow(const WeightedPicture& first, const WeightedPicture& second,
                      const VariationalFlowOptions& options, Context& context) {
  check(first, second);
  return run(first, second, Plane(1, 1), Plane(1, 1), coarsest_side_px, options, context);
}

Flow refined_flow(const WeightedPicture& first, const WeightedPicture& second, const Flow& guess, double reach_px,
                  const VariationalFlowOptions& options, Context& context) {
  check(first, second);
  if (guess.width != first.width || guess.height != first.height)
    throw Error(ErrorCode::invalid_input, "", "The initial displacement must have the size of the pictures.");
  const int side = std::min(first.width, first.height);
  const int coarsest_px = std::clamp(static_cast<int>(side / std::max(1.0, reach_px)), coarsest_side_px, side);
  return run(first, second, plane(guess.u, guess.width, guess.height), plane(guess.v, guess.width, guess.height),
             coarsest_px, options, context);
}

FlowEvidence flow_evidence(const WeightedPicture& first, const WeightedPicture& second, const Flow& flow,
                           const Context& context) {
  const flow_detail::MotionTensors t = flow_detail::motion_tensors(
      first, second, plane(flow.u, flow.width, flow.height), plane(flow.v, flow.width, flow.height), 0, context);
  FlowEvidence evidence;
  const auto flat = [&](const Plane& p) {
    std::vector<float> values;
    values.reserve(flow.u.size());
    for (int y = 0; y < p.height; ++y) values.insert(values.end(), p.row(y), p.row(y) + p.width);
    return values;
  };
  evidence.xx = flat(t.xx);
  evidence.xy = flat(t.xy);
  evidence.yy = flat(t.yy);
  evidence.residual_squared = flat(t.tt);
  evidence.weight = flat(t.weight);
  return evidence;
}

}  // namespace formwright
