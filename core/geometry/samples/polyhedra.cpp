// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes with known answers: pyramid, T, hemisphere. Their vertices lie on them to the last bits.
#include <algorithm>
#include <cstdlib>

#include "geometry/samples/shapes.h"

namespace formwright::samples {
namespace {

Model plain(const Surface& surface) {
  Model model;
  model.mesh.V.resize(static_cast<Eigen::Index>(surface.points.size()), 3);
  model.mesh.F.resize(static_cast<Eigen::Index>(surface.triangles.size()), 3);
  for (std::size_t v = 0; v < surface.points.size(); ++v)
    model.mesh.V.row(static_cast<Eigen::Index>(v)) << surface.points[v].x, surface.points[v].y, surface.points[v].z;
  for (std::size_t f = 0; f < surface.triangles.size(); ++f)
    model.mesh.F.row(static_cast<Eigen::Index>(f)) << surface.triangles[f][0], surface.triangles[f][1],
        surface.triangles[f][2];
  return model;
}

// ---- pyramid -------------------------------------------------------------------------------------

// Sides: n rows of triangles similar to the side itself. Base: n x n squares, each cut in two, and in four in the
// middle k x k of them, which is what makes any vertex count reachable without losing the symmetry.
struct PyramidGrid {
  int n = 0, k = 0;
  int vertex_count() const { return 2 * n * (n + 1) + 1 + (n - 1) * (n - 1) + k * k; }
};

PyramidGrid pyramid_grid(int vertices) {
  PyramidGrid best;
  double gap = 1e30;
  for (int n = 4; n < 900; ++n)
    for (int k = n % 2; k <= n; k += 2) {
      const PyramidGrid grid{n, k};
      // Even n is fully symmetric: let it win unless it is off by more than a percent.
      const double off =
          std::fabs(grid.vertex_count() - static_cast<double>(vertices)) / vertices + (n % 2 == 0 ? 0 : 0.01);
      if (off < gap) {
        gap = off;
        best = grid;
      }
    }
  return best;
}

Surface pyramid(const PyramidGrid& grid) {
  constexpr double half = 50, height = 60;
  const int n = grid.n;
  Surface s;
  // Ring j of 4 (n - j) vertices, from the corner (-, -) anticlockwise seen from above: +x side last.
  std::vector<int> first;
  for (int j = 0; j < n; ++j) {
    first.push_back(static_cast<int>(s.points.size()));
    const int m = n - j;
    const double y = height * j / n, r = half * m / n;
    for (int side = 0; side < 4; ++side)
      for (int i = 0; i < m; ++i) {
        const double t = half * (2 * i - m) / n;
        if (side == 0) s.points.push_back({t, y, r});
        if (side == 1) s.points.push_back({r, y, -t});
        if (side == 2) s.points.push_back({-t, y, -r});
        if (side == 3) s.points.push_back({-r, y, t});
      }
  }
  const int apex = static_cast<int>(s.points.size());
  s.points.push_back({0, height, 0});
  const auto ring = [&](int j, int side, int i) {
    if (j == n) return apex;
    const int m = n - j;
    return first[static_cast<std::size_t>(j)] + (side * m + i) % (4 * m);
  };
  for (int j = 0; j < n; ++j)
    for (int side = 0; side < 4; ++side)
      for (int i = 0; i < n - j; ++i) {
        s.triangles.push_back({ring(j, side, i), ring(j, side, i + 1), ring(j + 1, side, i)});
        if (i + 1 < n - j)
          s.triangles.push_back({ring(j, side, i + 1), ring(j + 1, side, i + 1), ring(j + 1, side, i)});
      }
  // Base, seen from below.
  const int inner = static_cast<int>(s.points.size());
  for (int b = 1; b < n; ++b)
    for (int a = 1; a < n; ++a) s.points.push_back({half * (2 * a - n) / n, 0, half * (2 * b - n) / n});
  const auto base = [&](int a, int b) {  // a along x, b along z
    if (b == n) return ring(0, 0, a);
    if (a == n) return ring(0, 1, n - b);
    if (b == 0) return ring(0, 2, n - a);
    if (a == 0) return ring(0, 3, b);
    return inner + (b - 1) * (n - 1) + a - 1;
  };
  const int edge = (n - grid.k) / 2;
  for (int b = 0; b < n; ++b)
    for (int a = 0; a < n; ++a) {
      const int p = base(a, b), q = base(a + 1, b), r = base(a + 1, b + 1), t = base(a, b + 1);
      if (a >= edge && b >= edge && a < edge + grid.k && b < edge + grid.k) {
        const int centre = static_cast<int>(s.points.size());
        s.points.push_back({half * (2 * a + 1 - n) / n, 0, half * (2 * b + 1 - n) / n});
        for (const Corners& side :
             {Corners{p, q, centre}, Corners{q, r, centre}, Corners{r, t, centre}, Corners{t, p, centre}})
          s.triangles.push_back(side);
        continue;
      }
      // Diagonals point to the middle; on the axes of an odd grid they follow the quarter turn.
      const int x = 2 * a + 1 - n, z = 2 * b + 1 - n;
      const bool rising = (x > 0 && z >= 0) || (x < 0 && z <= 0);
      if (rising) {
        s.triangles.push_back({p, q, r});
        s.triangles.push_back({p, r, t});
      } else {
        s.triangles.push_back({p, q, t});
        s.triangles.push_back({q, r, t});
      }
    }
  return s;
}

// ---- T -------------------------------------------------------------------------------------------

struct SidePlane {
  int axis;  // 0 x, 1 y, 2 z
  double at;
};
constexpr SidePlane t_planes[10] = {{1, 0},   {0, 15}, {1, 70},  {0, 50}, {1, 100},
                                    {0, -50}, {1, 70}, {0, -15}, {2, 15}, {2, -15}};

class TShapeTarget : public TargetShape {
 public:
  Point project(const Point& p, std::uint32_t patches, double, Point&) const override {
    Point q = p;
    for (std::uint32_t k = 0; k < 10; ++k)
      if ((patches >> k & 1U) != 0U) (t_planes[k].axis == 0 ? q.x : t_planes[k].axis == 1 ? q.y : q.z) = t_planes[k].at;
    return q;
  }
};

// ---- hemisphere ----------------------------------------------------------------------------------

constexpr double hemisphere_radius = 50;

class HemisphereTarget : public TargetShape {
 public:
  Point project(const Point& p, std::uint32_t patches, double, Point&) const override {
    const bool dome = (patches & 1U) != 0U, base = (patches & 2U) != 0U;
    const Point q{p.x, base ? 0 : p.y, p.z};
    return dome ? q * (hemisphere_radius / length(q)) : q;
  }
};

}  // namespace

Model make_pyramid(int vertices, Context& context) {
  context.check_cancelled();
  return plain(pyramid(pyramid_grid(vertices)));
}

Model make_t_shape(int vertices, Context& context) {
  const double outline[8][2] = {{-15, 0}, {15, 0}, {15, 70}, {50, 70}, {50, 100}, {-50, 100}, {-50, 70}, {-15, 70}};
  Surface s;
  std::vector<int> patch;
  for (double z : {15.0, -15.0})
    for (const auto& p : outline) s.points.push_back({p[0], p[1], z});
  for (const Corners& t : {Corners{0, 1, 2}, {0, 2, 7}, {6, 7, 5}, {7, 4, 5}, {7, 2, 4}, {2, 3, 4}}) {
    s.triangles.push_back(t);
    patch.push_back(8);
    s.triangles.push_back({t[0] + 8, t[2] + 8, t[1] + 8});
    patch.push_back(9);
  }
  for (int k = 0; k < 8; ++k) {
    const int a = k, b = (k + 1) % 8;
    s.triangles.push_back({a, a + 8, b + 8});
    s.triangles.push_back({a, b + 8, b});
    patch.insert(patch.end(), 2, k);
  }
  return plain(remesh(s, patch, TShapeTarget(), vertices, context));
}

Model make_hemisphere(int vertices, Context& context) {
  constexpr double r = hemisphere_radius;
  Surface s;
  s.points = {{0, r, 0}, {r, 0, 0}, {0, 0, -r}, {-r, 0, 0}, {0, 0, r}, {0, 0, 0}};
  std::vector<int> patch;
  for (int k = 0; k < 4; ++k) {
    const int a = 1 + k, b = 1 + (k + 1) % 4;
    s.triangles.push_back({0, a, b});
    s.triangles.push_back({5, b, a});
    patch.insert(patch.end(), {0, 1});
  }
  return plain(remesh(s, patch, HemisphereTarget(), vertices, context));
}

}  // namespace formwright::samples
