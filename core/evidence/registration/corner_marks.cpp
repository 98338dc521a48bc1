// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/registration/corner_marks.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "geometry/planar/plane.h"
#include "base/error.h"
#include "base/parallel.h"
#include "imaging/opencv/homography.h"

namespace formwright {
namespace {

constexpr double min_similarity = 0.45;  // noise alone reaches 0.3
constexpr double max_distortion = 1.35;  // of distances between marks
constexpr std::size_t candidates_a_mark = 12;
constexpr std::array<double, 5> sizes{0.88, 0.94, 1.0, 1.07, 1.15};

struct Candidate {
  double similarity;
  int x, y;
};

/// What a mark looks like in pixels: offsets and values of mean 0.
struct Stencil {
  std::vector<std::pair<int, int>> offset;
  std::vector<float> value;
  float norm = 0;
};
Stencil stencil(const CornerMark& mark, double radius_px) {
  Stencil s;
  const int reach = static_cast<int>(std::floor(radius_px));
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x) {
      if (std::hypot(x, y) > radius_px) continue;
      double white = 0;
      for (int k = 0; k < 16; ++k)
        white += mark_is_black(mark.code,
                               std::min(1.0, std::hypot(x + (k % 4 - 1.5) / 4, y + (k / 4 - 1.5) / 4) / radius_px))
                     ? 0
                     : 1.0 / 16;
      s.offset.emplace_back(x, y);
      s.value.push_back(static_cast<float>(white));
    }
  float mean = 0;
  for (const float v : s.value) mean += v;
  mean /= static_cast<float>(s.value.size());
  for (float& v : s.value) {
    v -= mean;
    s.norm += v * v;
  }
  s.norm = std::sqrt(s.norm);
  return s;
}

/// Mean over the channels of the correlation; -1 where part of it is not seen.
double similarity(const WeightedPicture& picture, const Stencil& s, int x, int y) {
  Float4 sum{}, sum_squared{}, product{};
  for (std::size_t i = 0; i < s.offset.size(); ++i) {
    const int px = x + s.offset[i].first, py = y + s.offset[i].second;
    if (px < 0 || py < 0 || px >= picture.width || py >= picture.height) return -1;
    const Float4 p = picture.at(px, py);
    if (!(p[3] > 0)) return -1;
    sum += p;
    sum_squared += p * p;
    product += s.value[i] * p;
  }
  const auto n = static_cast<float>(s.offset.size());
  const Float4 variance = sum_squared - sum * sum / n;
  double total = 0;
  for (int c = 0; c < 3; ++c)
    total += variance[c] > 1e-6f * n ? static_cast<double>(product[c] / (std::sqrt(variance[c]) * s.norm)) : 0;
  return total / 3;
}

std::vector<Candidate> best_places(const CornerMark& mark, const WeightedPicture& picture, double pixel_mm,
                                   const Context& context) {
  std::vector<float> map(picture.pixels.size(), -1);
  std::vector<Stencil> stencils;
  for (const double size : sizes) stencils.push_back(stencil(mark, size * mark.radius_mm / pixel_mm));
  parallel_for(static_cast<std::size_t>(picture.height), 8, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < picture.width; ++x) {
        if (!(picture.at(x, y)[3] > 0)) continue;
        double best = similarity(picture, stencils[sizes.size() / 2], x, y);
        if (best > 0.25)  // other sizes only where the middle one is not hopeless
          for (const Stencil& s : stencils) best = std::max(best, similarity(picture, s, x, y));
        map[picture.index(x, y)] = static_cast<float>(best);
      }
  });
  std::vector<Candidate> peaks;
  const int apart = std::max(2, static_cast<int>(mark.radius_mm / pixel_mm));
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      if (map[picture.index(x, y)] > 0.3f) peaks.push_back({map[picture.index(x, y)], x, y});
  std::stable_sort(peaks.begin(), peaks.end(),
                   [](const Candidate& a, const Candidate& b) { return a.similarity > b.similarity; });
  std::vector<Candidate> kept;
  for (const Candidate& p : peaks) {
    const bool is_new = std::none_of(kept.begin(), kept.end(), [&](const Candidate& k) {
      return std::abs(k.x - p.x) <= apart && std::abs(k.y - p.y) <= apart;
    });
    if (is_new) kept.push_back(p);
    if (kept.size() == candidates_a_mark) break;
  }
  return kept;
}

/// Sub-pixel: the middle of the likeness about its peak, at the size that fits best.
Vec2 refined(const WeightedPicture& picture, const CornerMark& mark, const Candidate& at, double pixel_mm) {
  const Stencil* best = nullptr;
  std::vector<Stencil> stencils;
  for (const double size : sizes) stencils.push_back(stencil(mark, size * mark.radius_mm / pixel_mm));
  double maximum = -2;
  for (const Stencil& s : stencils)
    if (const double value = similarity(picture, s, at.x, at.y); value > maximum) {
      maximum = value;
      best = &s;
    }
  const auto peak = [&](double before, double here, double after) {
    const double bend = before - 2 * here + after;
    return before > -1 && after > -1 && bend < -1e-9 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0.0;
  };
  return {at.x + peak(similarity(picture, *best, at.x - 1, at.y), maximum, similarity(picture, *best, at.x + 1, at.y)),
          at.y + peak(similarity(picture, *best, at.x, at.y - 1), maximum, similarity(picture, *best, at.x, at.y + 1))};
}

}  // namespace

FoundMarks find_marks(const CalibrationPattern& pattern, const WeightedPicture& flat, const PlaneFrame& frame,
                      Context& context) {
  std::array<std::vector<Candidate>, 4> candidates;
  for (std::size_t k = 0; k < 4; ++k) {
    candidates[k] = best_places(pattern.marks[k], flat, frame.pixel_mm, context);
    candidates[k].push_back({min_similarity - 0.25, -1, -1});  // out of sight
    context.progress(static_cast<double>(k + 1) / 4);
  }
  double best = -1;
  std::array<std::size_t, 4> chosen{};
  bool mirrored = false;
  const auto place = [&](std::size_t k, std::size_t i) { return frame.place(candidates[k][i].x, candidates[k][i].y); };
  const auto seen = [&](std::size_t k, std::size_t i) { return candidates[k][i].x >= 0; };
  std::array<std::size_t, 4> pick{};
  const auto try_all = [&](const auto& self, std::size_t k, int missing) -> void {
    if (k == 4) {
      std::array<Vec2, 4> p;
      std::array<std::size_t, 3> three{};
      std::size_t count = 0;
      double sum = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        sum += candidates[i][pick[i]].similarity;
        if (!seen(i, pick[i])) continue;
        p[i] = place(i, pick[i]);
        if (count < 3) three[count++] = i;
      }
      if (sum <= best) return;
      const Vec2 a = p[three[1]] - p[three[0]], b = p[three[2]] - p[three[0]];
      const Vec2 c = pattern.marks[three[1]].centre_mm - pattern.marks[three[0]].centre_mm,
                 d = pattern.marks[three[2]].centre_mm - pattern.marks[three[0]].centre_mm;
      best = sum;
      chosen = pick;
      mirrored = cross(a, b) * cross(c, d) < 0;
      return;
    }
    for (std::size_t i = 0; i < candidates[k].size(); ++i) {
      pick[k] = i;
      if (!seen(k, i)) {
        if (missing == 0) self(self, k + 1, 1);
        continue;
      }
      if (candidates[k][i].similarity < min_similarity) continue;
      bool fits = true;
      for (std::size_t j = 0; j < k && fits; ++j) {
        if (!seen(j, pick[j])) continue;
        const double ratio =
            (place(k, i) - place(j, pick[j])).norm() / (pattern.marks[k].centre_mm - pattern.marks[j].centre_mm).norm();
        fits = ratio > 1 / max_distortion && ratio < max_distortion;
      }
      if (fits) self(self, k + 1, missing);
    }
  };
  try_all(try_all, 0, 0);
  if (best < 0)
    throw Error(
        ErrorCode::invalid_input, "corners",
        "Fewer than three corner marks were found in the scan: check that it is in mm, its texture sharp and the pattern the right one, or give the four corners by hand.");
  FoundMarks found;
  found.mirrored = mirrored;
  std::size_t hidden = 4;
  for (std::size_t k = 0; k < 4; ++k) {
    if (!seen(k, chosen[k])) {
      hidden = k;
      continue;
    }
    const Candidate& c = candidates[k][chosen[k]];
    const Vec2 pixel = refined(flat, pattern.marks[k], c, frame.pixel_mm);
    found.place_mm[k] = frame.place(pixel.x(), pixel.y());
    found.similarity[k] = c.similarity;
  }
  // The four are a rectangle on the sheet, so the fourth corner follows from the others.
  if (hidden < 4)
    found.place_mm[hidden] =
        found.place_mm[(hidden + 1) % 4] + found.place_mm[(hidden + 3) % 4] - found.place_mm[(hidden + 2) % 4];
  return found;
}

Eigen::Matrix3d homography(const std::array<Vec2, 4>& from, const std::array<Vec2, 4>& to) {
  const Eigen::Matrix3d m = projective_map(from, to);
  bool sound = m.allFinite() && std::abs(m.determinant()) > 1e-9;
  for (std::size_t k = 0; k < 4 && sound; ++k)
    sound = m.row(2).dot(Vec3(from[k].x(), from[k].y(), 1)) > 0.05 && (mapped(m, from[k]) - to[k]).norm() < 0.01;
  if (!sound)
    throw Error(ErrorCode::invalid_input, "corners",
                "The four corners do not make a quadrilateral: give front left, front right, back right, back left.");
  return m;
}

Vec2 mapped(const Eigen::Matrix3d& h, const Vec2& p) {
  const Vec3 q = h * Vec3(p.x(), p.y(), 1);
  return q.head<2>() / (std::abs(q.z()) < 1e-9 ? 1e-9 : q.z());
}

}  // namespace formwright
