// SPDX-License-Identifier: GPL-3.0-or-later
// Steps of repair() that need no topology: merging, triangles without area, duplicates.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "base/index.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/repair/repair_steps.h"

namespace formwright::repair_steps {
namespace {

std::uint64_t mixed(std::uint64_t z) {  // the finaliser of splitmix64
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}
std::uint64_t hash_of(std::uint64_t a, std::uint64_t b, std::uint64_t c) {
  return mixed(a + 0x9e3779b97f4a7c15ull * mixed(b + 0x9e3779b97f4a7c15ull * mixed(c)));
}

/// Open addressing over integers that the caller compares; -1 is free.
class HashTable {
 public:
  explicit HashTable(std::size_t count) : slots_(std::bit_ceil(2 * count + 16), -1) {}
  /// The stored item with this hash for which same(item) holds, or else -1 after storing `fresh`
  /// (nothing is stored when fresh is -1).
  template <class Same>
  int find_or_store(std::uint64_t hash, int fresh, const Same& same) {
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t slot = hash & mask;; slot = (slot + 1) & mask) {
      if (slots_[slot] < 0) {
        if (fresh >= 0) slots_[slot] = fresh;
        return -1;
      }
      if (same(slots_[slot])) return slots_[slot];
    }
  }

 private:
  std::vector<int> slots_;
};

using Key = std::array<std::uint64_t, 3>;

/// For each vertex the first one at exactly the same place; 0 and -0 are the same place.
std::vector<int> coinciding(const Positions& V) {
  const int n = static_cast<int>(V.rows());
  HashTable table(index(n));
  std::vector<int> first(index(n));
  for (int v = 0; v < n; ++v) {
    Key key;
    for (int k = 0; k < 3; ++k) key[index(k)] = std::bit_cast<std::uint64_t>(V(v, k) + 0.0);
    const int found = table.find_or_store(hash_of(key[0], key[1], key[2]), v, [&](int u) {
      return V(u, 0) == V(v, 0) && V(u, 1) == V(v, 1) && V(u, 2) == V(v, 2);
    });
    first[index(v)] = found < 0 ? v : found;
  }
  return first;
}

/// For each vertex the first kept one within `tolerance`; vertices are taken in order and kept when
/// there is none. Kept vertices are listed per cell of a grid of that size.
std::vector<int> nearby(const Positions& V, const std::vector<char>& wanted, double tolerance) {
  const int n = static_cast<int>(V.rows());
  std::vector<int> first(index(n)), next_in_cell(index(n), -1);
  std::vector<std::array<std::int64_t, 3>> cell(index(n));
  HashTable table(index(n));
  const auto lookup = [&](const std::array<std::int64_t, 3>& c, int fresh) {
    return table.find_or_store(
        hash_of(static_cast<std::uint64_t>(c[0]), static_cast<std::uint64_t>(c[1]), static_cast<std::uint64_t>(c[2])),
        fresh, [&](int u) { return cell[index(u)] == c; });
  };
  for (int v = 0; v < n; ++v) {
    first[index(v)] = v;
    if (!wanted[index(v)]) continue;
    for (int k = 0; k < 3; ++k)
      cell[index(v)][index(k)] = static_cast<std::int64_t>(std::clamp(std::floor(V(v, k) / tolerance), -9e18, 9e18));
    int best = -1;
    for (int step = 0; step < 27; ++step) {
      std::array<std::int64_t, 3> c = cell[index(v)];
      c[0] += step % 3 - 1;
      c[1] += step / 3 % 3 - 1;
      c[2] += step / 9 - 1;
      for (int u = lookup(c, -1); u >= 0; u = next_in_cell[index(u)])
        if ((V.row(u) - V.row(v)).norm() <= tolerance && (best < 0 || u < best)) best = u;
    }
    if (best >= 0) {
      first[index(v)] = best;
    } else if (const int head = lookup(cell[index(v)], v); head >= 0) {
      next_in_cell[index(v)] = next_in_cell[index(head)];
      next_in_cell[index(head)] = v;
    }
  }
  return first;
}

bool repeats_a_vertex(const Triangles& F, int f) {
  return F(f, 0) == F(f, 1) || F(f, 1) == F(f, 2) || F(f, 2) == F(f, 0);
}

/// Without area to round-off: the height is less than this share of the longest side.
constexpr double flat_height = 1e-12;
bool is_flat(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double scale =
      std::max({(b - a).cwiseAbs().maxCoeff(), (c - b).cwiseAbs().maxCoeff(), (a - c).cwiseAbs().maxCoeff()});
  if (scale == 0) return true;
  const Vec3 u = (b - a) / scale, w = (c - a) / scale;  // keeps tiny and huge meshes in range
  const double longest = std::max({u.squaredNorm(), w.squaredNorm(), (w - u).squaredNorm()});
  return u.cross(w).norm() <= flat_height * longest;
}

/// What one round of mending does to a flat face: its two nearest corners become one when they almost
/// coincide; else its long side is turned, with the face beyond it, to end at the corner in between.
enum class Fixing { none, merged, turned };
Fixing fix(Draft& draft, const Adjacency& adjacency, int f, std::vector<char>& touched, std::vector<int>& merged_into) {
  Triangles& F = draft.mesh.F;
  int longest = 0, shortest = 0;
  std::array<double, 3> length{};
  for (int k = 0; k < 3; ++k) {
    length[index(k)] = (draft.position(F(f, (k + 1) % 3)) - draft.position(F(f, k))).norm();
    if (length[index(k)] > length[index(longest)]) longest = k;
    if (length[index(k)] < length[index(shortest)]) shortest = k;
  }
  const auto around = [&](int v) {
    for (const int h : adjacency.outgoing(v))
      if (touched[index(h / 3)]) return true;
    return false;
  };
  if (length[index(shortest)] <= 1e-6 * length[index(longest)]) {
    const int a = std::min(F(f, shortest), F(f, (shortest + 1) % 3)),
              b = std::max(F(f, shortest), F(f, (shortest + 1) % 3));
    if (around(a) || around(b)) return Fixing::none;
    for (const int v : {a, b})
      for (const int h : adjacency.outgoing(v)) touched[index(h / 3)] = 1;
    merged_into[index(b)] = a;
    return Fixing::merged;
  }
  const int h = 3 * f + longest;
  const auto along = adjacency.halfedges_of_edge(adjacency.edge_of(h));
  if (along.size() != 2) return Fixing::none;
  const int g = along[0] == h ? along[1] : along[0], beyond = g / 3;
  const int middle = F(f, (longest + 2) % 3), apex = adjacency.from(previous_halfedge(g));
  if (touched[index(beyond)] || apex == middle || adjacency.find_edge(middle, apex) >= 0) return Fixing::none;
  const int p = adjacency.from(g), q = adjacency.to(g);
  if (is_flat(draft.position(p), draft.position(middle), draft.position(apex)) ||
      is_flat(draft.position(middle), draft.position(q), draft.position(apex)))
    return Fixing::none;
  // Two faces (p, middle, apex) and (middle, q, apex), oriented as the face beyond was.
  const int old_apex = draft.corner_of[index(previous_halfedge(g))], old_p = draft.corner_of[index(g)],
            old_q = draft.corner_of[index(next_halfedge(g))],
            old_middle = draft.corner_of[index(3 * f + (longest + 2) % 3)];
  const std::array<int, 3> first{p, middle, apex}, second{middle, q, apex};
  const std::array<int, 3> first_old{old_p, old_middle, old_apex}, second_old{old_middle, old_q, old_apex};
  for (int k = 0; k < 3; ++k) {
    F(beyond, k) = first[index(k)];
    F(f, k) = second[index(k)];
    draft.corner_of[index(3 * beyond + k)] = first_old[index(k)];
    draft.corner_of[index(3 * f + k)] = second_old[index(k)];
  }
  draft.face_of[index(f)] = draft.face_of[index(beyond)];  // it lies on that face, not on the line it came from
  for (const int v : {p, q, middle, apex})
    for (const int out : adjacency.outgoing(v)) touched[index(out / 3)] = 1;
  return Fixing::turned;
}

}  // namespace

int merge_vertices(Draft& draft, double tolerance) {
  Triangles& F = draft.mesh.F;
  std::vector<char> used(index(draft.mesh.vertex_count()), 0);
  for (Eigen::Index i = 0; i < F.size(); ++i) used[index(F.data()[i])] = 1;
  const std::vector<int> first = tolerance > 0 ? nearby(draft.mesh.V, used, tolerance) : coinciding(draft.mesh.V);
  int merged = 0;
  for (std::size_t v = 0; v < first.size(); ++v) merged += used[v] && first[v] != static_cast<int>(v) ? 1 : 0;
  for (Eigen::Index i = 0; i < F.size(); ++i) F.data()[i] = first[index(F.data()[i])];
  return merged;
}

DegenerateCount fix_degenerate_faces(Draft& draft, Context& context) {
  const int before = draft.mesh.face_count();
  DegenerateCount count;
  const auto flat_faces = [&] {
    std::vector<char> keep(index(draft.mesh.face_count()), 1);
    for (int f = 0; f < draft.mesh.face_count(); ++f) keep[index(f)] = repeats_a_vertex(draft.mesh.F, f) ? 0 : 1;
    draft.keep_faces(keep);
    std::vector<int> flat;
    for (int f = 0; f < draft.mesh.face_count(); ++f)
      if (is_flat(draft.position(draft.mesh.F(f, 0)), draft.position(draft.mesh.F(f, 1)),
                  draft.position(draft.mesh.F(f, 2))))
        flat.push_back(f);
    return flat;
  };
  std::vector<int> flat = flat_faces();
  // Each round repairs faces that do not touch; a chain of flat faces needs several.
  for (int round = 0; round < 12 && !flat.empty(); ++round) {
    context.check_cancelled();
    const Adjacency adjacency(draft.mesh);
    std::vector<char> touched(index(draft.mesh.face_count()), 0);
    std::vector<int> merged_into(index(draft.mesh.vertex_count()), -1);
    bool any = false;
    for (const int f : flat) {
      if (touched[index(f)]) continue;
      const Fixing fixing = fix(draft, adjacency, f, touched, merged_into);
      any = any || fixing != Fixing::none;
      count.fixed += fixing == Fixing::turned ? 1 : 0;
    }
    if (!any) break;
    for (Eigen::Index i = 0; i < draft.mesh.F.size(); ++i)
      if (const int into = merged_into[index(draft.mesh.F.data()[i])]; into >= 0) draft.mesh.F.data()[i] = into;
    flat = flat_faces();
  }
  std::vector<char> keep(index(draft.mesh.face_count()), 1);
  for (const int f : flat) keep[index(f)] = 0;
  draft.keep_faces(keep);
  count.removed = before - draft.mesh.face_count();
  return count;
}

DuplicateCount remove_duplicate_faces(Draft& draft) {
  Triangles& F = draft.mesh.F;
  const int m = draft.mesh.face_count();
  DuplicateCount count;
  // Faces rotated to begin at their lowest vertex; `mirror` is the first face with the opposite sense.
  const auto corners = [&](int f) {
    const int low = F(f, 0) < F(f, 1) ? (F(f, 0) < F(f, 2) ? 0 : 2) : (F(f, 1) < F(f, 2) ? 1 : 2);
    return std::array<int, 3>{F(f, low), F(f, (low + 1) % 3), F(f, (low + 2) % 3)};
  };
  HashTable table(index(m));
  const auto lookup = [&](const std::array<int, 3>& key, int fresh) {
    return table.find_or_store(hash_of(static_cast<std::uint64_t>(key[0]), static_cast<std::uint64_t>(key[1]),
                                       static_cast<std::uint64_t>(key[2])),
                               fresh, [&](int f) { return corners(f) == key; });
  };
  std::vector<char> keep(index(m), 1);
  std::vector<int> mirror(index(m), -1);
  bool any_mirror = false;
  for (int f = 0; f < m; ++f) {
    const auto [a, b, c] = corners(f);
    if (lookup({a, b, c}, f) >= 0) {
      keep[index(f)] = 0;
      ++count.removed;
    } else if (const int other = lookup({a, c, b}, -1); other >= 0) {
      mirror[index(f)] = other;
      mirror[index(other)] = f;
      any_mirror = true;
    }
  }
  if (any_mirror) {
    // A mirrored pair may be the wall between two solids that touch: then every edge has as many faces
    // running one way as the other, and the pair belongs to a surface that is not all pairs.
    TriangleMesh kept;
    kept.V = draft.mesh.V;
    std::vector<int> old_face;
    for (int f = 0; f < m; ++f)
      if (keep[index(f)]) old_face.push_back(f);
    kept.F.resize(static_cast<Eigen::Index>(old_face.size()), 3);
    for (std::size_t i = 0; i < old_face.size(); ++i) kept.F.row(static_cast<Eigen::Index>(i)) = F.row(old_face[i]);
    const Adjacency adjacency(kept);
    const Components parts = face_components(adjacency);
    std::vector<char> all_pairs(index(parts.count), 1);
    for (std::size_t i = 0; i < old_face.size(); ++i)
      if (mirror[index(old_face[i])] < 0) all_pairs[index(parts.of[i])] = 0;
    const auto balanced = [&](int h) {
      int sum = 0;
      for (const int g : adjacency.halfedges_of_edge(adjacency.edge_of(h)))
        sum += adjacency.from(g) < adjacency.to(g) ? 1 : -1;
      return sum == 0;
    };
    for (std::size_t i = 0; i < old_face.size(); ++i) {
      const int f = old_face[i], h = 3 * static_cast<int>(i);
      if (mirror[index(f)] < 0 || mirror[index(f)] > f) continue;
      if (!all_pairs[index(parts.of[i])] && balanced(h) && balanced(h + 1) && balanced(h + 2)) continue;
      keep[index(f)] = 0;
      ++count.second_sides;
    }
  }
  draft.keep_faces(keep);
  return count;
}

}  // namespace formwright::repair_steps
