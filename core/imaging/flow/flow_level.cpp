// SPDX-License-Identifier: GPL-3.0-or-later
#include "imaging/flow/flow_level.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace formwright::flow_detail {
namespace {

constexpr float over_relaxation = 1.9f;
// Of pictures with 2 grey levels of noise and the usual gradient weight: what the smoothness is chosen for.
constexpr double usual_mismatch_levels = 20.6;
constexpr double min_smoothness_share = 0.5;

float sum3(const Float4& p) { return p[0] + p[1] + p[2]; }

/// The linear system of one inner iteration: at every pixel a 2 x 2 block, already inverted, and the links to the right
/// and below.
struct System {
  Plane inverse_xx, inverse_xy, inverse_yy, right_x, right_y, link_right, link_below;
  System(int w, int h)
      : inverse_xx(w, h),
        inverse_xy(w, h),
        inverse_yy(w, h),
        right_x(w, h),
        right_y(w, h),
        link_right(w, h),
        link_below(w, h) {}
};

/// `diffusivity`: alpha Psi' of the squared change of (u, v).
void find_diffusivity(const Plane& u, const Plane& v, const VariationalFlowOptions& options, Plane& diffusivity,
                      const Context& context) {
  const int w = u.width, h = u.height;
  const float epsilon_squared = static_cast<float>(options.smoothness_epsilon * options.smoothness_epsilon),
              alpha = static_cast<float>(options.smoothness);
  parallel_for(static_cast<std::size_t>(h), rows_a_chunk(w), [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      const int above = std::max(y - 1, 0), below = std::min(y + 1, h - 1);
      const float *u0 = u.row(y), *ua = u.row(above), *ub = u.row(below), *v0 = v.row(y), *va = v.row(above),
                  *vb = v.row(below);
      float* __restrict out = diffusivity.row(y);
      const auto value = [&](int x, int left, int right) {
        const float ux = 0.5f * (u0[right] - u0[left]), uy = 0.5f * (ub[x] - ua[x]), vx = 0.5f * (v0[right] - v0[left]),
                    vy = 0.5f * (vb[x] - va[x]);
        return alpha / std::sqrt(ux * ux + uy * uy + vx * vx + vy * vy + epsilon_squared);
      };
      out[0] = value(0, 0, std::min(1, w - 1));
      for (int x = 1; x < w - 1; ++x) out[x] = value(x, x - 1, x + 1);
      out[w - 1] = value(w - 1, std::max(w - 2, 0), w - 1);
    }
  });
}

void find_links(const Plane& diffusivity, System& system, const Context& context) {
  const int w = diffusivity.width, h = diffusivity.height;
  parallel_for(static_cast<std::size_t>(h), rows_a_chunk(w), [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      const float *here = diffusivity.row(y), *below = diffusivity.row(y + 1);
      float* __restrict right = system.link_right.row(y), * __restrict down = system.link_below.row(y);
      for (int x = 0; x + 1 < w; ++x) right[x] = 0.5f * (here[x] + here[x + 1]);
      if (y + 1 < h)
        for (int x = 0; x < w; ++x) down[x] = 0.5f * (here[x] + below[x]);
    }
  });
}

/// What the links pull a pixel of `p` by, were they alone: the divergence of the diffusivity times the gradient.
float pull(const System& system, const Plane& p, int x, int y) {
  const float *right = system.link_right.row(y), *below = system.link_below.row(y),
              *above = system.link_below.row(y - 1);
  const float *here = p.row(y), *pa = p.row(y - 1), *pb = p.row(y + 1);
  return right[x] * (here[x + 1] - here[x]) + right[x - 1] * (here[x - 1] - here[x]) + below[x] * (pb[x] - here[x]) +
         above[x] * (pa[x] - here[x]);
}

/// `u0`, `v0`: where the tensors were taken.
void assemble(const MotionTensors& t, const Plane& u0, const Plane& v0, const Plane& u, const Plane& v,
              Smoothed smoothed, const VariationalFlowOptions& options, System& system, const Context& context) {
  const int w = u.width, h = u.height;
  const float epsilon_squared = static_cast<float>(options.data_epsilon * options.data_epsilon);
  parallel_for(static_cast<std::size_t>(h), rows_a_chunk(w), [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      const float *xx = t.xx.row(y), *xy = t.xy.row(y), *yy = t.yy.row(y), *xt = t.xt.row(y), *yt = t.yt.row(y),
                  *tt = t.tt.row(y);
      const float *uu = u.row(y), *vv = v.row(y), *uo = u0.row(y), *vo = v0.row(y);
      const float *right = system.link_right.row(y), *below = system.link_below.row(y),
                  *above = system.link_below.row(y - 1);
      float *__restrict ixx = system.inverse_xx.row(y), *__restrict ixy = system.inverse_xy.row(y), *__restrict iyy = system.inverse_yy.row(y),
            *__restrict bx = system.right_x.row(y), *__restrict by = system.right_y.row(y);
      for (int x = 0; x < w; ++x) {
        const float du = uu[x] - uo[x], dv = vv[x] - vo[x];
        const float gx = xx[x] * du + xy[x] * dv, gy = xy[x] * du + yy[x] * dv;
        const float mismatch_squared = tt[x] + (gx + 2 * xt[x]) * du + (gy + 2 * yt[x]) * dv;
        const float robust = 1 / std::sqrt((mismatch_squared > 0 ? mismatch_squared : 0) + epsilon_squared);
        const float links = right[x] + right[x - 1] + below[x] + above[x];
        const float axx = robust * xx[x] + links, axy = robust * xy[x], ayy = robust * yy[x] + links;
        const float scale = 1 / (axx * ayy - axy * axy);
        ixx[x] = ayy * scale;
        ixy[x] = -axy * scale;
        iyy[x] = axx * scale;
        bx[x] = robust * (xx[x] * uo[x] + xy[x] * vo[x] - xt[x]);
        by[x] = robust * (xy[x] * uo[x] + yy[x] * vo[x] - yt[x]);
        if (smoothed == Smoothed::correction) {
          bx[x] -= pull(system, u0, x, y);
          by[x] -= pull(system, v0, x, y);
        }
      }
    }
  });
}

/// One row's pixels of one colour. `pace[x]` is the over-relaxation there, 0 for the other colour, `new_u`, `new_v`
/// room for a row.
void sweep_row(const System& system, Plane& u, Plane& v, int y, const float* pace, float* __restrict new_u,
               float* __restrict new_v) {
  const int w = u.width;
  const float *ixx = system.inverse_xx.row(y), *ixy = system.inverse_xy.row(y), *iyy = system.inverse_yy.row(y),
              *bx = system.right_x.row(y), *by = system.right_y.row(y);
  const float *right = system.link_right.row(y), *below = system.link_below.row(y),
              *above = system.link_below.row(y - 1);
  float *u0 = u.row(y), *v0 = v.row(y);
  const float *ua = u.row(y - 1), *ub = u.row(y + 1), *va = v.row(y - 1), *vb = v.row(y + 1);
  for (int x = 0; x < w; ++x) {
    const float rx = bx[x] + right[x] * u0[x + 1] + right[x - 1] * u0[x - 1] + below[x] * ub[x] + above[x] * ua[x];
    const float ry = by[x] + right[x] * v0[x + 1] + right[x - 1] * v0[x - 1] + below[x] * vb[x] + above[x] * va[x];
    new_u[x] = u0[x] + pace[x] * (ixx[x] * rx + ixy[x] * ry - u0[x]);
    new_v[x] = v0[x] + pace[x] * (ixy[x] * rx + iyy[x] * ry - v0[x]);
  }
  std::copy(new_u, new_u + w, u0);
  std::copy(new_v, new_v + w, v0);
}

/// Both colours in one pass over memory: a black row follows two rows behind the red ones it depends on. Black rows at
/// the ends of a chunk wait until all chunks are through, so that the result is that of a plain red-black sweep.
void sweep(const System& system, Plane& u, Plane& v, const std::vector<float>& pace, const Context& context) {
  const int w = u.width, h = u.height;
  const std::size_t grain = rows_a_chunk(w);
  const auto pace_of = [&](int y, int colour) { return pace.data() + ((y + colour) & 1); };
  parallel_for(static_cast<std::size_t>(h), grain, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    std::vector<float> room(2 * static_cast<std::size_t>(w));
    const int first = static_cast<int>(begin), last = static_cast<int>(end) - 1;
    for (int y = first; y <= last; ++y) {
      sweep_row(system, u, v, y, pace_of(y, 0), room.data(), room.data() + w);
      if (y - 1 > first) sweep_row(system, u, v, y - 1, pace_of(y - 1, 1), room.data(), room.data() + w);
    }
  });
  std::vector<float> room(2 * static_cast<std::size_t>(w));
  for (std::size_t begin = 0; begin < static_cast<std::size_t>(h); begin += grain) {
    const int first = static_cast<int>(begin),
              last = static_cast<int>(std::min(begin + grain, static_cast<std::size_t>(h))) - 1;
    sweep_row(system, u, v, first, pace_of(first, 1), room.data(), room.data() + w);
    if (last > first) sweep_row(system, u, v, last, pace_of(last, 1), room.data(), room.data() + w);
  }
}

/// Mean over the pixels that count of the root of the squared mismatch, in grey levels: how noisy the pictures are.
double mean_mismatch(const MotionTensors& tensors, const Context& context) {
  const int w = tensors.tt.width, h = tensors.tt.height;
  std::vector<double> mismatch(static_cast<std::size_t>(h), 0), weight(mismatch);
  parallel_for(static_cast<std::size_t>(h), rows_a_chunk(w), [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (std::size_t y = begin; y < end; ++y) {
      const float *tt = tensors.tt.row(static_cast<int>(y)), *trust = tensors.weight.row(static_cast<int>(y));
      for (int x = 0; x < w; ++x) {
        mismatch[y] += static_cast<double>(std::sqrt(trust[x] * tt[x]));
        weight[y] += static_cast<double>(trust[x]);
      }
    }
  });
  double sum = 0, count = 0;
  for (std::size_t y = 0; y < mismatch.size(); ++y) {
    sum += mismatch[y];
    count += weight[y];
  }
  return count > 0 ? sum / count : usual_mismatch_levels;
}

Plane difference(const Plane& a, const Plane& b) {
  Plane result = a;
  for (std::size_t i = 0; i < result.values.size(); ++i) result.values[i] -= b.values[i];
  return result;
}

}  // namespace

std::size_t rows_a_chunk(int width) { return std::max<std::size_t>(16, 131072 / static_cast<std::size_t>(width)); }

MotionTensors motion_tensors(const WeightedPicture& first, const WeightedPicture& second, const Plane& u,
                             const Plane& v, double gradient_weight, const Context& context) {
  const int w = first.width, h = first.height;
  WeightedPicture sum(w, h), difference(w, h);  // lane 3 of the sum is the common weight
  parallel_for(static_cast<std::size_t>(h), rows_a_chunk(w), [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      const float *uu = u.row(y), *vv = v.row(y);
      for (int x = 0; x < w; ++x) {
        const Float4 a = first.at(x, y),
                     b = bicubic(second, static_cast<float>(x) + uu[x], static_cast<float>(y) + vv[x]);
        difference.at(x, y) = b - a;
        Float4 both = a + b;
        both[3] = a[3] * b[3];
        sum.at(x, y) = both;
      }
    }
  });
  MotionTensors t(w, h);
  const float gamma = static_cast<float>(gradient_weight);
  parallel_for(static_cast<std::size_t>(h), rows_a_chunk(w), [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      const int ya = std::max(y - 1, 0), yb = std::min(y + 1, h - 1);
      const Float4 *s0 = &sum.at(0, y), *sa = &sum.at(0, ya), *sb = &sum.at(0, yb);
      const Float4 *d0 = &difference.at(0, y), *da = &difference.at(0, ya), *db = &difference.at(0, yb);
      float *xx = t.xx.row(y), *xy = t.xy.row(y), *yy = t.yy.row(y), *xt = t.xt.row(y), *yt = t.yt.row(y),
            *tt = t.tt.row(y), *weight = t.weight.row(y);
      for (int x = 0; x < w; ++x) {
        const int l = std::max(x - 1, 0), r = std::min(x + 1, w - 1);
        // Weights of neighbours that differences reach to: a known pixel beside an unknown one has no derivative.
        const float trust = std::min(std::min(s0[x][3], std::min(s0[l][3], s0[r][3])), std::min(sa[x][3], sb[x][3]));
        weight[x] = trust;
        if (!(trust > 0)) continue;  // planes begin as 0
        const Float4 ix = 0.25f * (s0[r] - s0[l]), iy = 0.25f * (sb[x] - sa[x]), it = d0[x];
        Float4 jxx = ix * ix, jxy = ix * iy, jyy = iy * iy, jxt = ix * it, jyt = iy * it, jtt = it * it;
        if (gamma > 0) {
          const Float4 ixx = 0.5f * (s0[r] + s0[l] - 2.0f * s0[x]), iyy = 0.5f * (sb[x] + sa[x] - 2.0f * s0[x]),
                       ixy = 0.125f * (sb[r] - sb[l] - sa[r] + sa[l]);
          const Float4 ixt = 0.5f * (d0[r] - d0[l]), iyt = 0.5f * (db[x] - da[x]);
          jxx += gamma * (ixx * ixx + ixy * ixy);
          jxy += gamma * (ixy * (ixx + iyy));
          jyy += gamma * (ixy * ixy + iyy * iyy);
          jxt += gamma * (ixx * ixt + ixy * iyt);
          jyt += gamma * (ixy * ixt + iyy * iyt);
          jtt += gamma * (ixt * ixt + iyt * iyt);
        }
        xx[x] = trust * sum3(jxx);
        xy[x] = trust * sum3(jxy);
        yy[x] = trust * sum3(jyy);
        xt[x] = trust * sum3(jxt);
        yt[x] = trust * sum3(jyt);
        tt[x] = trust * sum3(jtt);
      }
    }
  });
  return t;
}

void relax(const MotionTensors& tensors, Plane& u, Plane& v, Smoothed smoothed, const VariationalFlowOptions& given,
           const Context& context) {
  const int w = u.width, h = u.height;
  const Plane u0 = u, v0 = v;
  VariationalFlowOptions options = given;
  if (std::max(w, h) > options.fine_above_px)
    options.smoothness *= std::max(min_smoothness_share, mean_mismatch(tensors, context) / usual_mismatch_levels);
  Plane diffusivity(w, h);
  System system(w, h);
  std::vector<float> pace(static_cast<std::size_t>(w) + 2);
  for (std::size_t i = 0; i < pace.size(); i += 2) pace[i] = over_relaxation;
  for (int i = 0; i < options.inner_iterations; ++i) {
    if (smoothed == Smoothed::displacement) find_diffusivity(u, v, options, diffusivity, context);
    else find_diffusivity(difference(u, u0), difference(v, v0), options, diffusivity, context);
    find_links(diffusivity, system, context);
    assemble(tensors, u0, v0, u, v, smoothed, options, system, context);
    for (int k = 0; k < options.sweeps; ++k) sweep(system, u, v, pace, context);
  }
}

}  // namespace formwright::flow_detail
