// SPDX-License-Identifier: GPL-3.0-or-later
// Steps of repair() about topology: which faces belong together, and on which side they face out.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "base/error.h"
#include "base/index.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "geometry/queries/ray_caster.h"
#include "geometry/repair/repair_steps.h"

namespace formwright::repair_steps {
namespace {

/// Turns faces so that across every edge of exactly two faces both run opposite ways, wherever that is
/// possible; each patch keeps the sense of the majority of its faces.
int orient_patches(Draft& draft, const Adjacency& adjacency) {
  const int m = adjacency.face_count();
  std::vector<char> turned(index(m), 0), reached(index(m), 0);
  std::vector<int> patch;
  int total = 0;
  for (int start = 0; start < m; ++start) {
    if (reached[index(start)]) continue;
    patch.assign(1, start);
    reached[index(start)] = 1;
    int count = 0;
    for (std::size_t i = 0; i < patch.size(); ++i) {
      const int f = patch[i];
      count += turned[index(f)];
      for (int h = 3 * f; h < 3 * f + 3; ++h) {
        const auto along = adjacency.halfedges_of_edge(adjacency.edge_of(h));
        if (along.size() != 2) continue;
        const int g = along[0] == h ? along[1] : along[0];
        if (reached[index(g / 3)]) continue;
        reached[index(g / 3)] = 1;
        turned[index(g / 3)] = static_cast<char>(turned[index(f)] ^ (adjacency.from(g) == adjacency.from(h) ? 1 : 0));
        patch.push_back(g / 3);
      }
    }
    if (2 * count > static_cast<int>(patch.size())) {
      for (const int f : patch) turned[index(f)] = turned[index(f)] ? 0 : 1;
      count = static_cast<int>(patch.size()) - count;
    }
    total += count;
  }
  for (int f = 0; f < m; ++f)
    if (turned[index(f)]) draft.reverse_face(f);
  return total;
}

/// Pairs the half-edges where three or more faces meet: going round the edge, a face that has solid
/// behind it as seen that way belongs with the next one that has solid before it, as brackets do.
/// Writes the pairs into `glue`.
void pair_around_edge(const Draft& draft, const Adjacency& adjacency, int e, std::vector<int>& glue) {
  const Edge edge = adjacency.edges()[index(e)];
  const Vec3 origin = draft.position(edge.lower), axis = (draft.position(edge.higher) - origin).normalized();
  Vec3 x = Vec3::Zero(), y = Vec3::Zero();
  struct Spoke {
    double angle;
    bool solid_before;  // the face runs with the axis: its normal points onwards, its solid lies before it
    int halfedge;
  };
  std::vector<Spoke> spokes;
  for (const int h : adjacency.halfedges_of_edge(e)) {
    const Vec3 to_apex = draft.position(adjacency.from(previous_halfedge(h))) - origin;
    const Vec3 radial = to_apex - axis * axis.dot(to_apex);
    if (x.isZero(0)) {
      x = radial.normalized();
      y = axis.cross(x);
    }
    spokes.push_back({std::atan2(y.dot(radial), x.dot(radial)), adjacency.from(h) == edge.lower, h});
  }
  // Faces at the same angle are the two sides of a wall between solids: the one that closes comes first.
  std::sort(spokes.begin(), spokes.end(), [](const Spoke& a, const Spoke& b) {
    if (a.angle != b.angle) return a.angle < b.angle;
    if (a.solid_before != b.solid_before) return a.solid_before;
    return a.halfedge < b.halfedge;
  });
  std::vector<int> open;
  for (int turn = 0; turn < 2; ++turn)
    for (std::size_t i = 0; i < spokes.size(); ++i) {
      const int h = spokes[i].halfedge;
      if (glue[index(h)] >= 0) continue;
      if (!spokes[i].solid_before) {
        if (turn == 0) open.push_back(h);
      } else if (!open.empty()) {
        glue[index(h)] = open.back();
        glue[index(open.back())] = h;
        open.pop_back();
      }
    }
}

/// Gives every fan of faces around a vertex a vertex of its own; the first fan keeps the old one.
/// Returns the number of vertices at which more than one fan met.
int split_fans(Draft& draft, const Adjacency& adjacency, const std::vector<int>& glue) {
  std::vector<int> corner = std::vector<int>(draft.mesh.F.data(), draft.mesh.F.data() + draft.mesh.F.size());
  std::vector<char> met(corner.size(), 0);
  std::vector<Vec3> positions;
  std::vector<int> stand_for;
  int split = 0;
  for (int v = 0; v < adjacency.vertex_count(); ++v) {
    bool first = true, several = false;
    for (const int start : adjacency.outgoing(v)) {
      if (met[index(start)]) continue;
      int name = v;
      if (!first) {
        name = draft.mesh.vertex_count() + static_cast<int>(positions.size());
        positions.push_back(draft.position(v));
        stand_for.push_back(draft.vertex_of[index(v)]);
        several = true;
      }
      first = false;
      const auto take = [&](int h) {
        met[index(h)] = 1;
        corner[index(h)] = name;
      };
      take(start);
      int h = glue[index(previous_halfedge(start))];
      for (; h >= 0 && !met[index(h)]; h = glue[index(previous_halfedge(h))]) take(h);
      if (h < 0)
        for (int g = glue[index(start)]; g >= 0;) {
          g = next_halfedge(g);
          if (met[index(g)]) break;
          take(g);
          g = glue[index(g)];
        }
    }
    split += several ? 1 : 0;
  }
  if (!positions.empty()) {
    std::copy(corner.begin(), corner.end(), draft.mesh.F.data());
    draft.add_vertices(positions, stand_for);
  }
  return split;
}

/// Where edges that are not glued to one another still have the same two ends (a sheet pinched along an
/// edge), all but the first get a vertex in their middle. Returns false when there are none.
bool separate_edges_with_equal_ends(Draft& draft, const std::vector<int>& glue) {
  const Adjacency adjacency(draft.mesh);
  if (adjacency.nonmanifold_edge_count() == 0 && adjacency.inconsistent_edge_count() == 0) return false;
  std::vector<char> touched(index(draft.mesh.face_count()), 0);
  std::vector<Vec3> positions;
  std::vector<int> stand_for, new_faces, old_faces, old_corners;
  const auto split_face = [&](int h, int middle) {
    // (a, b, c) along h = a -> b becomes (a, middle, c) and (middle, b, c).
    const int f = h / 3, a = h % 3, b = (a + 1) % 3, c = (a + 2) % 3;
    touched[index(f)] = 1;
    std::array<int, 3> other{}, other_old{};
    other[index(a)] = middle;
    other[index(b)] = draft.mesh.F(f, b);
    other[index(c)] = draft.mesh.F(f, c);
    for (int k = 0; k < 3; ++k) other_old[index(k)] = draft.corner_of[index(3 * f + k)];
    new_faces.insert(new_faces.end(), other.begin(), other.end());
    old_corners.insert(old_corners.end(), other_old.begin(), other_old.end());
    old_faces.push_back(draft.face_of[index(f)]);
    draft.mesh.F(f, b) = middle;
    draft.corner_of[index(3 * f + b)] = draft.corner_of[index(3 * f + a)];
  };
  for (int e = 0; e < adjacency.edge_count(); ++e) {
    const auto along = adjacency.halfedges_of_edge(e);
    if (along.size() < 2 || (along.size() == 2 && adjacency.opposite(along[0]) >= 0)) continue;
    std::vector<char> done(along.size(), 0);
    bool first = true;
    for (std::size_t i = 0; i < along.size(); ++i) {
      const int h = along[i], g = glue[index(h)];
      if (done[i]) continue;
      for (std::size_t j = i; j < along.size(); ++j)
        done[j] = static_cast<char>(done[j] | (along[j] == h || along[j] == g ? 1 : 0));
      if (first) {
        first = false;
        continue;
      }
      if (touched[index(h / 3)] || (g >= 0 && touched[index(g / 3)])) continue;  // next time
      const int a = adjacency.from(h), b = adjacency.to(h),
                middle = draft.mesh.vertex_count() + static_cast<int>(positions.size());
      positions.push_back(0.5 * (draft.position(a) + draft.position(b)));
      stand_for.push_back(draft.vertex_of[index(std::min(a, b))]);
      split_face(h, middle);
      if (g >= 0) split_face(g, middle);
    }
  }
  draft.add_vertices(positions, stand_for);
  draft.add_faces(new_faces, old_faces, old_corners);
  return true;
}

}  // namespace

GluingCount make_manifold(Draft& draft, Context& context) {
  GluingCount count;
  for (int round = 0;; ++round) {
    if (round > 100) throw Error(ErrorCode::internal, "mesh", "The mesh could not be made manifold; please report it.");
    context.check_cancelled();
    auto adjacency = std::make_unique<Adjacency>(draft.mesh);
    if (adjacency->inconsistent_edge_count() > 0) {
      const int turned = orient_patches(draft, *adjacency);
      if (round == 0) count.faces_turned = turned;
      if (turned > 0) adjacency = std::make_unique<Adjacency>(draft.mesh);
    }
    std::vector<int> glue(index(3 * draft.mesh.face_count()));
    for (std::size_t h = 0; h < glue.size(); ++h) glue[h] = adjacency->opposite(static_cast<int>(h));
    if (adjacency->nonmanifold_edge_count() > 0)
      for (int e = 0; e < adjacency->edge_count(); ++e)
        if (adjacency->halfedges_of_edge(e).size() > 2) pair_around_edge(draft, *adjacency, e, glue);
    const int split = split_fans(draft, *adjacency, glue);
    if (round == 0) {
      count.edges_cut = adjacency->nonmanifold_edge_count();
      count.one_sided_edges = adjacency->inconsistent_edge_count();
      // A vertex at the end of a cut edge is part of that cut, not a place where sheets only touch.
      if (split > 0) {
        std::vector<char> beside_cut(index(adjacency->vertex_count()), 0);
        for (int e = 0; e < adjacency->edge_count(); ++e) {
          const auto along = adjacency->halfedges_of_edge(e);
          if (along.size() < 2 || (along.size() == 2 && adjacency->opposite(along[0]) >= 0)) continue;
          beside_cut[index(adjacency->edges()[index(e)].lower)] =
              beside_cut[index(adjacency->edges()[index(e)].higher)] = 1;
        }
        for (const int v : adjacency->nonmanifold_vertices()) count.vertices_split += beside_cut[index(v)] ? 0 : 1;
      }
    }
    const bool clean = adjacency->nonmanifold_edge_count() == 0 && adjacency->inconsistent_edge_count() == 0;
    if (clean || !separate_edges_with_equal_ends(draft, glue)) {
      if (split == 0) count.adjacency = std::move(adjacency);
      return count;
    }
  }
}

int turn_outwards(Draft& draft, const Adjacency& adjacency, const Components& parts, Context& context) {
  std::vector<char> closed(index(parts.count), 1);
  std::vector<BoundingBox> box(index(parts.count));
  for (int h = 0; h < 3 * draft.mesh.face_count(); ++h) {
    if (adjacency.opposite(h) < 0) closed[index(parts.of[index(h / 3)])] = 0;
    box[index(parts.of[index(h / 3)])].add(draft.position(adjacency.from(h)));
  }
  std::vector<double> volume(index(parts.count), 0);
  std::vector<int> first_face(index(parts.count), -1);
  for (int f = 0; f < draft.mesh.face_count(); ++f) {
    const std::size_t part = index(parts.of[index(f)]);
    if (first_face[part] < 0) first_face[part] = f;
    const Vec3 centre = box[part].centre();
    const Vec3 a = draft.position(draft.mesh.F(f, 0)) - centre, b = draft.position(draft.mesh.F(f, 1)) - centre,
               c = draft.position(draft.mesh.F(f, 2)) - centre;
    volume[part] += a.dot(b.cross(c));
  }
  const int closed_parts = static_cast<int>(std::count(closed.begin(), closed.end(), 1));
  std::vector<char> turn(index(parts.count), 0);
  std::unique_ptr<RayCaster> caster;
  int count = 0;
  for (int part = 0; part < parts.count; ++part) {
    if (!closed[index(part)] || volume[index(part)] >= 0) continue;
    // A cavity lies within an odd number of other closed parts. Parts may be very many (foam, a scan's
    // crumbs): only those that the ray meets are looked at.
    int enclosing = 0;
    if (closed_parts > 1) {
      context.check_cancelled();
      if (!caster) caster = std::make_unique<RayCaster>(draft.mesh);
      const Vec3 point = draft.position(draft.mesh.F(first_face[index(part)], 0));
      const Vec3 direction = Vec3(0.5377, 0.2138, 0.8156).normalized();  // along no axis, through no likely edge
      std::vector<int> crossed;
      for (const RayHit& hit : caster->all_hits(point, direction, 0, 1e300)) {
        const int other = parts.of[index(hit.face)];
        if (other != part && closed[index(other)] && box[index(other)].surrounds(point)) crossed.push_back(other);
      }
      std::sort(crossed.begin(), crossed.end());
      for (std::size_t i = 0, next = 0; i < crossed.size(); i = next) {
        while (next < crossed.size() && crossed[next] == crossed[i]) ++next;
        enclosing += static_cast<int>(next - i) % 2;
      }
    }
    if (enclosing % 2 == 1) continue;
    turn[index(part)] = 1;
    ++count;
  }
  if (count > 0)
    for (int f = 0; f < draft.mesh.face_count(); ++f)
      if (turn[index(parts.of[index(f)])]) draft.reverse_face(f);
  return count;
}

DropCount drop_small_parts(Draft& draft, double min_share) {
  const Components parts = face_components(Adjacency(draft.mesh));
  const Eigen::VectorXd areas = face_areas(draft.mesh);
  std::vector<double> area(index(parts.count), 0);
  for (int f = 0; f < draft.mesh.face_count(); ++f) area[index(parts.of[index(f)])] += areas[f];
  const double minimum = min_share * areas.sum(), largest = *std::max_element(area.begin(), area.end());
  DropCount count;
  for (const double a : area) count.parts += a < minimum && a < largest ? 1 : 0;
  std::vector<char> keep(index(draft.mesh.face_count()), 1);
  for (int f = 0; f < draft.mesh.face_count(); ++f) {
    const double a = area[index(parts.of[index(f)])];
    if (a < minimum && a < largest) {
      keep[index(f)] = 0;
      ++count.faces;
    }
  }
  draft.keep_faces(keep);
  return count;
}

// ---- Draft ----

void Draft::keep_faces(const std::vector<char>& keep) {
  int kept = 0;
  for (int f = 0; f < mesh.face_count(); ++f) {
    if (!keep[index(f)]) continue;
    if (kept != f) {
      mesh.F.row(kept) = mesh.F.row(f).eval();
      face_of[index(kept)] = face_of[index(f)];
      for (int k = 0; k < 3; ++k) corner_of[index(3 * kept + k)] = corner_of[index(3 * f + k)];
    }
    ++kept;
  }
  if (kept == mesh.face_count()) return;
  mesh.F.conservativeResize(kept, 3);
  face_of.resize(index(kept));
  corner_of.resize(index(3 * kept));
}

void Draft::add_vertices(const std::vector<Vec3>& positions, const std::vector<int>& stand_for) {
  const Eigen::Index n = mesh.V.rows();
  mesh.V.conservativeResize(n + static_cast<Eigen::Index>(positions.size()), 3);
  for (std::size_t i = 0; i < positions.size(); ++i) mesh.V.row(n + static_cast<Eigen::Index>(i)) = positions[i];
  vertex_of.insert(vertex_of.end(), stand_for.begin(), stand_for.end());
}

void Draft::add_faces(const std::vector<int>& corners, const std::vector<int>& old_faces,
                      const std::vector<int>& old_corners) {
  const Eigen::Index m = mesh.F.rows();
  mesh.F.conservativeResize(m + static_cast<Eigen::Index>(old_faces.size()), 3);
  std::copy(corners.begin(), corners.end(), mesh.F.data() + 3 * m);
  face_of.insert(face_of.end(), old_faces.begin(), old_faces.end());
  corner_of.insert(corner_of.end(), old_corners.begin(), old_corners.end());
}

void Draft::reverse_face(int f) {
  std::swap(mesh.F(f, 1), mesh.F(f, 2));
  std::swap(corner_of[index(3 * f + 1)], corner_of[index(3 * f + 2)]);
}

void Draft::drop_unused_vertices() {
  std::vector<int> name(index(mesh.vertex_count()), -1);
  for (Eigen::Index i = 0; i < mesh.F.size(); ++i) name[index(mesh.F.data()[i])] = 0;
  int kept = 0;
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    if (name[index(v)] < 0) continue;
    if (kept != v) {
      mesh.V.row(kept) = mesh.V.row(v).eval();
      vertex_of[index(kept)] = vertex_of[index(v)];
    }
    name[index(v)] = kept++;
  }
  if (kept == mesh.vertex_count()) return;
  mesh.V.conservativeResize(kept, 3);
  vertex_of.resize(index(kept));
  for (Eigen::Index i = 0; i < mesh.F.size(); ++i) mesh.F.data()[i] = name[index(mesh.F.data()[i])];
}

}  // namespace formwright::repair_steps
