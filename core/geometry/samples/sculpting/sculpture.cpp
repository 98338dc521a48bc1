// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/samples/sculpting/sculpture.h"

#include <algorithm>

namespace formwright::samples {

Sculpture::Sculpture(double unit_mm, const Box& bounds) : unit_mm_(unit_mm), bounds_(bounds) {}

void Sculpture::unite(double softness, const Point& centre, double radius, Field solid) {
  strokes_.push_back({Operation::unite, softness, centre, radius, std::move(solid)});
}
void Sculpture::carve(double softness, const Point& centre, double radius, Field solid) {
  strokes_.push_back({Operation::carve, softness, centre, radius, std::move(solid)});
}
void Sculpture::raise(const Point& centre, double radius, Field height, double greatest) {
  strokes_.push_back({Operation::raise, greatest, centre, radius, std::move(height)});
}

namespace {
double largest(const Point& r) { return std::max({r.x, r.y, r.z}); }
Field with_twin(Field field, bool twin) {
  if (!twin) return field;
  return [field = std::move(field)](const Point& p) { return field(mirrored(p)); };
}
}  // namespace

void Sculpture::add_ellipsoid(double softness, const Frame& frame, const Point& radii, bool twin) {
  const auto solid = [frame, radii](const Point& p) { return ellipsoid(frame.local(p), radii); };
  unite(softness, frame.o, largest(radii), solid);
  if (twin) unite(softness, mirrored(frame.o), largest(radii), with_twin(solid, true));
}
void Sculpture::carve_ellipsoid(double softness, const Frame& frame, const Point& radii, bool twin) {
  const auto solid = [frame, radii](const Point& p) { return ellipsoid(frame.local(p), radii); };
  carve(softness, frame.o, largest(radii), solid);
  if (twin) carve(softness, mirrored(frame.o), largest(radii), with_twin(solid, true));
}
void Sculpture::add_cone(double softness, const Point& a, const Point& b, double ra, double rb, bool twin) {
  const RoundCone cone(a, b, ra, rb);
  const double radius = length(b - a) / 2 + std::max(ra, rb);
  const Point centre = (a + b) / 2;
  unite(softness, centre, radius, cone);
  if (twin) unite(softness, mirrored(centre), radius, with_twin(cone, true));
}
void Sculpture::swell(double height, const Frame& frame, const Point& radii, bool twin) {
  const auto bump = [frame, radii, height](const Point& p) {
    const Point q = frame.local(p);
    const double u =
        1 - (q.x * q.x / (radii.x * radii.x) + q.y * q.y / (radii.y * radii.y) + q.z * q.z / (radii.z * radii.z));
    return u > 0 ? height * u * u * u : 0;
  };
  raise(frame.o, largest(radii), bump);
  if (twin) raise(mirrored(frame.o), largest(radii), with_twin(bump, true));
}
void Sculpture::line(double height, double width, const std::vector<Point>& path, double fade, bool twin) {
  Point centre{0, 0, 0};
  for (const Point& p : path) centre += p / static_cast<double>(path.size());
  double radius = 0;
  for (const Point& p : path) radius = std::max(radius, length(p - centre));
  radius += width;
  std::vector<double> along{0};
  for (std::size_t i = 1; i < path.size(); ++i) along.push_back(along.back() + length(path[i] - path[i - 1]));
  const auto ridge = [path, along, height, width, fade](const Point& p) {
    double best = width * width, where = 0;
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      const Point ab = path[i + 1] - path[i];
      const double t = clamp(dot(p - path[i], ab) / length2(ab), 0, 1);
      const double d2 = length2(p - path[i] - ab * t);
      if (d2 < best) {
        best = d2;
        where = mix(along[i], along[i + 1], t);
      }
    }
    const double u = 1 - best / (width * width);
    if (u <= 0) return 0.0;
    const double s = where / along.back();
    const double ends = fade > 0 ? smooth_step(0, fade, s) * smooth_step(0, fade, 1 - s) : 1;
    return height * u * u * ends;
  };
  raise(centre, radius, ridge);
  if (twin) raise(mirrored(centre), radius, with_twin(ridge, true));
}

std::vector<Point> Sculpture::dropped(std::vector<Point> path) const {
  for (Point& p : path)
    for (int k = 0; k < 6; ++k) p -= normal_at(p, 0.05) * at(p);
  return path;
}

void Sculpture::finish() {
  double softest = 0;
  for (const Stroke& s : strokes_)
    if (s.operation != Operation::raise) softest = std::max(softest, s.softness);
  const Point extent = bounds_.high - bounds_.low;
  const double size = std::max({extent.x, extent.y, extent.z});
  cell_ = size / 40;
  // A stroke that is not listed in a cell is farther than margin + softness from all of it, so below
  // the margin the listed strokes alone give the value of all of them.
  margin_ = std::max(softest, size / 20);
  cells_[0] = static_cast<int>(extent.x / cell_) + 1;
  cells_[1] = static_cast<int>(extent.y / cell_) + 1;
  cells_[2] = static_cast<int>(extent.z / cell_) + 1;
  const std::size_t count =
      static_cast<std::size_t>(cells_[0]) * static_cast<std::size_t>(cells_[1]) * static_cast<std::size_t>(cells_[2]);
  std::vector<std::vector<int>> lists(count);
  for (std::size_t s = 0; s < strokes_.size(); ++s) {
    const Stroke& stroke = strokes_[s];
    const double reach = stroke.radius + (stroke.operation == Operation::raise ? 0 : stroke.softness) +
                         (stroke.operation == Operation::unite ? margin_ : 0);
    const auto range = [&](double centre, double low, int cells, int& from, int& to) {
      from = std::max(0, static_cast<int>(std::floor((centre - reach - low) / cell_)));
      to = std::min(cells - 1, static_cast<int>(std::floor((centre + reach - low) / cell_)));
    };
    int i0, i1, j0, j1, k0, k1;
    range(stroke.centre.x, bounds_.low.x, cells_[0], i0, i1);
    range(stroke.centre.y, bounds_.low.y, cells_[1], j0, j1);
    range(stroke.centre.z, bounds_.low.z, cells_[2], k0, k1);
    for (int k = k0; k <= k1; ++k)
      for (int j = j0; j <= j1; ++j)
        for (int i = i0; i <= i1; ++i) {
          const Point low = bounds_.low + Point{i * cell_, j * cell_, k * cell_};
          const auto gap = [&](double c, double l) { return std::max({l - c, c - l - cell_, 0.0}); };
          const Point g{gap(stroke.centre.x, low.x), gap(stroke.centre.y, low.y), gap(stroke.centre.z, low.z)};
          if (length2(g) > reach * reach) continue;
          lists[static_cast<std::size_t>((k * cells_[1] + j) * cells_[0] + i)].push_back(static_cast<int>(s));
        }
  }
  first_.assign(1, 0);
  entries_.clear();
  for (const auto& list : lists) {
    entries_.insert(entries_.end(), list.begin(), list.end());
    first_.push_back(static_cast<int>(entries_.size()));
  }
}

double Sculpture::apply(const Stroke& stroke, const Point& p, double d) const {
  const double c2 = distance2(p, stroke.centre);
  switch (stroke.operation) {
    case Operation::unite: {
      const double reach = d + stroke.softness + stroke.radius;
      if (reach <= 0 || c2 >= reach * reach) return d;  // too far to matter: smooth_min(d, x) = d
      return smooth_min(d, stroke.field(p), stroke.softness);
    }
    case Operation::carve: {
      const double reach = stroke.radius + stroke.softness - d;
      if (reach <= 0 || c2 >= reach * reach) return d;
      return smooth_max(d, -stroke.field(p), stroke.softness);
    }
    case Operation::raise:
    default:
      if (c2 >= stroke.radius * stroke.radius) return d;
      if (d > 2 * stroke.softness) return d - stroke.softness;  // far outside: a bound will do
      return d - stroke.field(p);
  }
}

double Sculpture::at(const Point& p) const {
  double d = 1e3;
  if (first_.empty()) {
    for (const Stroke& stroke : strokes_) d = apply(stroke, p, d);
    return d;
  }
  const int i = static_cast<int>(std::floor((p.x - bounds_.low.x) / cell_)),
            j = static_cast<int>(std::floor((p.y - bounds_.low.y) / cell_)),
            k = static_cast<int>(std::floor((p.z - bounds_.low.z) / cell_));
  if (i < 0 || j < 0 || k < 0 || i >= cells_[0] || j >= cells_[1] || k >= cells_[2]) return margin_;
  const auto cell = static_cast<std::size_t>((k * cells_[1] + j) * cells_[0] + i);
  d = margin_;
  for (int e = first_[cell]; e < first_[cell + 1]; ++e)
    d = apply(strokes_[static_cast<std::size_t>(entries_[static_cast<std::size_t>(e)])], p, d);
  return std::min(d, margin_);
}

double Sculpture::operator()(const Point& p_mm) const { return unit_mm_ * at(p_mm / unit_mm_); }

Point Sculpture::normal_at(const Point& p, double step) const {
  return normalized(Point{at({p.x + step, p.y, p.z}) - at({p.x - step, p.y, p.z}),
                          at({p.x, p.y + step, p.z}) - at({p.x, p.y - step, p.z}),
                          at({p.x, p.y, p.z + step}) - at({p.x, p.y, p.z - step})});
}

std::vector<Point> curve(const std::vector<Point>& knots, int per_span) {
  std::vector<Point> path;
  const int n = static_cast<int>(knots.size());
  const auto knot = [&](int i) {
    if (i < 0) return knots[0] * 2 - knots[1];
    if (i >= n) return knots[static_cast<std::size_t>(n - 1)] * 2 - knots[static_cast<std::size_t>(n - 2)];
    return knots[static_cast<std::size_t>(i)];
  };
  for (int i = 0; i + 1 < n; ++i)
    for (int s = 0; s < per_span; ++s) {
      const double t = static_cast<double>(s) / per_span;
      const Point a = knot(i - 1), b = knot(i), c = knot(i + 1), d = knot(i + 2);
      path.push_back(b + (c - a) * (0.5 * t) + (a * 2 - b * 5 + c * 4 - d) * (0.5 * t * t) +
                     (b * 3 - a - c * 3 + d) * (0.5 * t * t * t));
    }
  path.push_back(knots.back());
  return path;
}

double Tube::operator()(const Point& p) const {
  double best = 1e30, lateral = 0, along = 0, local_radius = 1;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Point ab = path[i + 1] - path[i];
    const double t = clamp(dot(p - path[i], ab) / length2(ab), 0, 1);
    Point o = p - path[i] - ab * t;
    const double r = mix(radius[i], radius[i + 1], t);
    double side = 0;
    if (!up.empty()) {
      const Point n = mix(up[i], up[i + 1], t);
      const double height = dot(o, n);
      if (strands > 0) side = dot(o, normalized(cross(ab, n)));
      o += n * (height * (1 / flatness - 1));
    }
    const double d = length(o) - r;
    if (d < best) {
      best = d;
      lateral = side;
      along = static_cast<double>(i) + t;
      local_radius = r;
    }
  }
  if (strands > 0 && best < local_radius) {
    const double wave = cosine(pi * strands * lateral / local_radius + phase + 0.35 * sine(along * 1.1 + phase * 3));
    best += groove * local_radius * (0.5 - 0.5 * wave);
  }
  return best * (flatness < 1 ? mix(flatness, 1, 0.35) : 1);
}

void Tube::enclose(Point& centre, double& ball_radius) const {
  Box box{path[0], path[0]};
  for (const Point& p : path) {
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
  }
  centre = (box.low + box.high) / 2;
  ball_radius = 0;
  for (std::size_t i = 0; i < path.size(); ++i)
    ball_radius = std::max(ball_radius, length(path[i] - centre) + radius[i]);
}

}  // namespace formwright::samples
