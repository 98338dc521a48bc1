// SPDX-License-Identifier: GPL-3.0-or-later
// The mould as triangles: rays from the origin, which every mould surrounds in such a way that each ray meets it once.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "foreign_laboratory/mould_shape.h"

namespace formwright::foreign_laboratory {
namespace {

using Eigen::Vector3d;
using Edge = std::pair<int, int>;

/// From outside inwards by the distance itself, which never goes too far (sphere tracing [Har96]), then halving.
Vector3d on_surface(Mould mould, const Vector3d& direction) {
  constexpr double outside_mm = 150;
  double far = outside_mm, near = 0;
  for (int k = 0; k < 60 && far > 0; ++k) {
    const double d = distance_to(mould, far * direction).mm;
    if (d < 1e-7) break;
    far -= d;
  }
  near = std::max(0.0, far - 1e-2);
  while (near > 0 && distance_to(mould, near * direction).mm > 0) near = std::max(0.0, near - 1);
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (near + far);
    (distance_to(mould, middle * direction).mm > 0 ? far : near) = middle;
  }
  return far * direction;
}

/// Where to divide a chord: at about the farthest of five of its points; 0 where none is farther than the tolerance.
double worst_place(Mould mould, const Vector3d& a, const Vector3d& b, double chord_error_mm) {
  double worst = chord_error_mm, where = 0;
  for (const double t : {0.5, 0.35, 0.65, 0.2, 0.8})
    if (const double off = std::abs(distance_to(mould, a + t * (b - a)).mm); off > worst) worst = off, where = t;
  // Not near an end, where an edge across a crease would take many divisions.
  return where > 0 ? std::clamp(where, 0.35, 0.65) : 0;
}

class Refinement {
 public:
  Refinement(Mould mould, double chord_error_mm) : mould_(mould), chord_error_mm_(chord_error_mm) {
    // Six sides and the top.
    mesh_.vertices.push_back(on_surface(mould, Vector3d::UnitZ()));
    constexpr int sides = 6;
    for (int k = 0; k < sides; ++k) {
      const double angle = 2 * std::numbers::pi * k / sides;
      mesh_.vertices.push_back(on_surface(mould, {std::cos(angle), std::sin(angle), 0}));
      mesh_.triangles.push_back({0, 1 + k, 1 + (k + 1) % sides});
    }
  }

  Triangulation run() {
    constexpr int max_rounds = 100;
    constexpr std::size_t max_triangles = 400000;
    for (int round = 0; round < max_rounds; ++round) {
      if (!divide()) return close();
      if (mesh_.triangles.size() > max_triangles) break;
    }
    throw std::runtime_error("chord_error_mm: too small for this mould; give a larger one");
  }

 private:
  /// Divides every edge that is too far off, and those of a triangle whose middle is. False where none was.
  bool divide() {
    middle_.clear();
    const auto worst = [&](int a, int b) {
      const Edge edge = std::minmax(a, b);
      const auto [entry, is_new] = where_.try_emplace(edge, 0);
      if (is_new) entry->second = worst_place(mould_, vertex(edge.first), vertex(edge.second), chord_error_mm_);
      return entry->second;
    };
    for (const auto& [a, b, c] : mesh_.triangles) {
      bool any = false;
      for (const auto& [from, to] : {Edge{a, b}, Edge{b, c}, Edge{c, a}})
        if (const double t = worst(from, to); t > 0) split(from, to, t), any = true;
      if (any) continue;
      const Vector3d centre = (vertex(a) + vertex(b) + vertex(c)) / 3;
      if (std::abs(distance_to(mould_, centre).mm) <= chord_error_mm_) continue;
      for (const auto& [from, to] : {Edge{a, b}, Edge{b, c}, Edge{c, a}}) split(from, to, 0.5);
    }
    if (middle_.empty()) return false;
    divide_longest();
    std::vector<std::array<int, 3>> finer;
    for (const auto& triangle : mesh_.triangles) replace(triangle, finer);
    mesh_.triangles = std::move(finer);
    return true;
  }

  /// A triangle that is divided is divided across its longest edge, too, so that angles stay bounded [Riv84].
  void divide_longest() {
    for (bool any = true; any;) {
      any = false;
      for (const auto& [a, b, c] : mesh_.triangles) {
        if (middle(a, b) < 0 && middle(b, c) < 0 && middle(c, a) < 0) continue;
        Edge longest{a, b};
        for (const Edge& edge : {Edge{b, c}, Edge{c, a}})
          if (length(edge) > length(longest)) longest = edge;
        if (middle(longest.first, longest.second) >= 0) continue;
        split(longest.first, longest.second, 0.5);
        any = true;
      }
    }
  }

  double length(const Edge& edge) const { return (vertex(edge.first) - vertex(edge.second)).norm(); }

  Vector3d vertex(int index) const { return mesh_.vertices[static_cast<std::size_t>(index)]; }

  /// `t` counts from the end with the smaller number.
  void split(int from, int to, double t) {
    const Edge edge = std::minmax(from, to);
    if (middle_.contains(edge)) return;
    Vector3d direction = vertex(edge.first) + t * (vertex(edge.second) - vertex(edge.first));
    if (vertex(edge.first).z() == 0 && vertex(edge.second).z() == 0) direction.z() = 0;
    mesh_.vertices.push_back(on_surface(mould_, direction.normalized()));
    middle_[edge] = static_cast<int>(mesh_.vertices.size()) - 1;
  }

  int middle(int a, int b) const {
    const auto entry = middle_.find(std::minmax(a, b));
    return entry == middle_.end() ? -1 : entry->second;
  }

  void replace(const std::array<int, 3>& triangle, std::vector<std::array<int, 3>>& finer) const {
    auto [a, b, c] = triangle;
    int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    const int count = (ab >= 0) + (bc >= 0) + (ca >= 0);
    if (count == 0) return finer.push_back(triangle);
    if (count == 3) {
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
      return;
    }
    // Turned until the only divided edge is ab, or the only whole one is ca.
    while (count == 1 ? ab < 0 : ca >= 0) {
      std::tie(a, b, c) = std::tuple(b, c, a);
      std::tie(ab, bc, ca) = std::tuple(bc, ca, ab);
    }
    if (count == 1) {
      finer.push_back({a, ab, c});
      finer.push_back({ab, b, c});
      return;
    }
    finer.push_back({ab, b, bc});
    if ((vertex(a) - vertex(bc)).norm() < (vertex(ab) - vertex(c)).norm()) {
      finer.push_back({a, ab, bc});
      finer.push_back({a, bc, c});
    } else {
      finer.push_back({a, ab, c});
      finer.push_back({ab, bc, c});
    }
  }

  /// The bottom: a fan about the origin over the edges that have a triangle on one side alone.
  Triangulation close() {
    std::map<Edge, int> used;
    for (const auto& [a, b, c] : mesh_.triangles)
      for (const auto& [from, to] : {Edge{a, b}, Edge{b, c}, Edge{c, a}}) ++used[std::minmax(from, to)];
    const auto origin = static_cast<int>(mesh_.vertices.size());
    mesh_.vertices.push_back(Vector3d::Zero());
    const std::vector<std::array<int, 3>> sides = mesh_.triangles;
    for (const auto& [a, b, c] : sides)
      for (const auto& [from, to] : {Edge{a, b}, Edge{b, c}, Edge{c, a}})
        if (used[std::minmax(from, to)] == 1) mesh_.triangles.push_back({to, from, origin});
    return std::move(mesh_);
  }

  Mould mould_;
  double chord_error_mm_;
  Triangulation mesh_;
  std::map<Edge, int> middle_;    // of this round: the vertex that divides an edge
  std::map<Edge, double> where_;  // of every edge so far: where it is to be divided
};

}  // namespace

Triangulation triangulate(Mould mould, double chord_error_mm) {
  if (!(chord_error_mm > 0)) throw std::invalid_argument("chord_error_mm: give a length above 0");
  return Refinement(mould, chord_error_mm).run();
}

std::string write_obj(const Triangulation& mesh) {
  std::string text;
  char line[100];
  for (const Vector3d& v : mesh.vertices) {
    std::snprintf(line, sizeof line, "v %.7g %.7g %.7g\n", v.x(), v.y(), v.z());
    text += line;
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    std::snprintf(line, sizeof line, "f %d %d %d\n", a + 1, b + 1, c + 1);
    text += line;
  }
  return text;
}

}  // namespace formwright::foreign_laboratory
