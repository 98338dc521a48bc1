// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/samples/sculpting/locks.h"

#include <algorithm>

namespace formwright::samples {
namespace {

constexpr int steps = 10;

// Shares of the largest width and height at the share t from root to tip.
double width_at(const LockStyle& s, double t) {
  return mix(0.6 + 0.4 * smooth_step(0, 0.35, t), s.tip_width, smooth_step(0.5, 1, t));
}
double height_at(const LockStyle& s, double t) {
  return mix(mix(s.root, 1, smooth_step(0, 0.6, t)), s.tip_height, smooth_step(0.75, 1, t));
}

}  // namespace

void LockLayer::lay(const Sculpture& skin, Point p, Point direction, const LockStyle& style, double phase) {
  std::vector<Joint> joints;
  const double step = style.length / steps;
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    Point n{0, 1, 0};
    for (int k = 0; k < 2; ++k) {
      n = skin.normal_at(p, 0.2);
      p -= n * skin.at(p);
    }
    joints.push_back({p, n, style.width * width_at(style, t), style.height * height_at(style, t)});
    direction = normalized(direction - n * dot(direction, n));
    const double angle = (style.turn + style.curl * t + style.wave * cosine(2 * pi * (style.waves * t) + phase)) * step;
    direction = direction * cosine(angle) + cross(n, direction) * sine(angle);
    p += direction * step;
  }
  add(std::move(joints), style, phase);
}

void LockLayer::lay(const Sculpture& skin, const std::vector<Point>& path, const LockStyle& style, double phase) {
  std::vector<Joint> joints;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(path.size() - 1);
    Point p = path[i], n{0, 1, 0};
    for (int k = 0; k < 3; ++k) {
      n = skin.normal_at(p, 0.2);
      p -= n * skin.at(p);
    }
    joints.push_back({p, n, style.width * width_at(style, t), style.height * height_at(style, t)});
  }
  add(std::move(joints), style, phase);
}

void LockLayer::add(std::vector<Joint> joints, const LockStyle& style, double phase) {
  const int lock = static_cast<int>(locks_.size()), first = static_cast<int>(joints_.size());
  locks_.push_back({style.strands, style.groove, phase, first});
  for (std::size_t i = 0; i + 1 < joints.size(); ++i) {
    const Joint &a = joints[i], &b = joints[i + 1];
    const Point ab = b.p - a.p;
    const double widest = std::max(a.width, b.width);
    const double ball = length(ab) / 2 + 1.81 * widest;  // the tube |flat| < width, |rise| < 1.5 width
    segments_.push_back({(a.p + b.p) / 2, ball * ball, lock, first + static_cast<int>(i), a.p, ab, a.up, b.up - a.up,
                         1 / length2(ab), a.width, b.width - a.width, a.height, b.height - a.height});
    greatest_ = std::max({greatest_, a.height, b.height});
  }
  joints_.insert(joints_.end(), joints.begin(), joints.end());
}

void LockLayer::finish(double softness, double groove_scale) {
  softness_ = softness;
  groove_scale_ = groove_scale;
  greatest_ += softness;
  const Point extent = bounds_.high - bounds_.low;
  cells_[0] = static_cast<int>(extent.x / cell_) + 1;
  cells_[1] = static_cast<int>(extent.y / cell_) + 1;
  cells_[2] = static_cast<int>(extent.z / cell_) + 1;
  const std::size_t count =
      static_cast<std::size_t>(cells_[0]) * static_cast<std::size_t>(cells_[1]) * static_cast<std::size_t>(cells_[2]);
  const double half = cell_ * 0.5, around = cell_ * 0.8661;
  std::vector<std::pair<int, int>> pairs;  // cell, segment
  for (std::size_t s = 0; s < segments_.size(); ++s) {
    const Segment& segment = segments_[s];
    const double ball = std::sqrt(segment.ball2),
                 widest = std::max(segment.width, segment.width + segment.width_change);
    const auto range = [&](double centre, double low, int cells, int& from, int& to) {
      from = std::max(0, static_cast<int>(std::floor((centre - ball - low) / cell_)));
      to = std::min(cells - 1, static_cast<int>(std::floor((centre + ball - low) / cell_)));
    };
    int i0, i1, j0, j1, k0, k1;
    range(segment.middle.x, bounds_.low.x, cells_[0], i0, i1);
    range(segment.middle.y, bounds_.low.y, cells_[1], j0, j1);
    range(segment.middle.z, bounds_.low.z, cells_[2], k0, k1);
    for (int k = k0; k <= k1; ++k)
      for (int j = j0; j <= j1; ++j)
        for (int i = i0; i <= i1; ++i) {
          const Point c = bounds_.low + Point{i * cell_ + half, j * cell_ + half, k * cell_ + half};
          const double t = clamp(dot(c - segment.a, segment.ab) * segment.inverse, 0, 1);
          const Point o = c - segment.a - segment.ab * t;
          const double rise = dot(o, segment.up + segment.up_change * t);
          if (std::fabs(rise) > 1.5 * widest + around ||
              length2(o) - rise * rise > (widest + around) * (widest + around))
            continue;
          pairs.emplace_back((k * cells_[1] + j) * cells_[0] + i, static_cast<int>(s));
        }
  }
  first_.assign(count + 1, 0);
  for (const auto& pair : pairs) ++first_[static_cast<std::size_t>(pair.first) + 1];
  for (std::size_t c = 0; c < count; ++c) first_[c + 1] += first_[c];
  entries_.resize(pairs.size());
  std::vector<int> fill(first_.begin(), first_.end() - 1);
  for (const auto& pair : pairs)
    entries_[static_cast<std::size_t>(fill[static_cast<std::size_t>(pair.first)]++)] = pair.second;
}

double LockLayer::operator()(const Point& p) const {
  const int i = static_cast<int>(std::floor((p.x - bounds_.low.x) / cell_)),
            j = static_cast<int>(std::floor((p.y - bounds_.low.y) / cell_)),
            k = static_cast<int>(std::floor((p.z - bounds_.low.z) / cell_));
  if (i < 0 || j < 0 || k < 0 || i >= cells_[0] || j >= cells_[1] || k >= cells_[2]) return 0;
  const auto cell = static_cast<std::size_t>((k * cells_[1] + j) * cells_[0] + i);
  double thickness = 0;
  int current = -1;
  double best = 1, best_t = 0;
  const Segment* nearest = nullptr;
  const auto flush = [&] {
    if (current < 0 || best >= 1) return;
    const Lock& lock = locks_[static_cast<std::size_t>(current)];
    double h =
        (nearest->height + nearest->height_change * best_t) * (1 - best) * (1 + 0.35 * best);  // a full round section
    if (h <= thickness - softness_) return;
    const double groove = groove_scale_ * lock.groove;
    if (groove > 0) {
      const Point flat = p - nearest->a - nearest->ab * best_t;
      const double width = nearest->width + nearest->width_change * best_t;
      const double side = dot(flat, cross(nearest->ab, nearest->up + nearest->up_change * best_t)) *
                          std::sqrt(nearest->inverse) / width;
      const double along = nearest->joint - lock.first + best_t;
      const double bend = 0.4 * sine(0.9 * along + 3 * lock.phase);
      h *= 1 - groove * (0.5 - 0.5 * cosine(pi * lock.strands * side + lock.phase + bend));
    }
    thickness = smooth_max(thickness, h, softness_);
  };
  for (int e = first_[cell]; e < first_[cell + 1]; ++e) {
    const Segment& s = segments_[static_cast<std::size_t>(entries_[static_cast<std::size_t>(e)])];
    if (distance2(p, s.middle) >= s.ball2) continue;
    const Point ap = p - s.a;
    const double t = clamp(dot(ap, s.ab) * s.inverse, 0, 1);
    const Point o = ap - s.ab * t;
    const double width = s.width + s.width_change * t, inverse_width2 = 1 / (width * width);
    const double rise = dot(o, s.up + s.up_change * t);
    // Far above or below the skin the strip narrows to nothing, so that it does not show elsewhere.
    const double fall2 = rise * rise * inverse_width2 * (1 / 2.25);
    const double ratio = (length2(o) - rise * rise) * inverse_width2 + fall2 * fall2;
    if (ratio >= 1) continue;
    if (s.lock != current) {
      flush();
      current = s.lock;
      best = 1;
    }
    if (ratio < best) {
      best = ratio;
      best_t = t;
      nearest = &s;
    }
  }
  flush();
  return thickness;
}

}  // namespace formwright::samples
