// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/parts/segmentation.h"

#include <algorithm>
#include <unordered_map>

#include "base/error.h"

namespace formwright {
namespace {

/// Half-edges of a part's boundary as closed walks; nothing when a vertex is passed twice.
struct PartLoops {
  std::vector<std::vector<int>> loops;
  bool pinched = false;
};

PartLoops loops_of_part(const Adjacency& adjacency, const std::vector<int>& face_segment, int part) {
  std::unordered_map<int, int> leaving;
  std::vector<int> all;
  PartLoops result;
  for (int h = 0; h < 3 * adjacency.face_count(); ++h) {
    if (face_segment[h / 3] != part) continue;
    const int o = adjacency.opposite(h);
    if (o >= 0 && face_segment[o / 3] == part) continue;
    if (!leaving.emplace(adjacency.from(h), h).second) result.pinched = true;
    all.push_back(h);
  }
  if (result.pinched) return result;
  std::unordered_map<int, char> seen;
  for (const int start : all) {
    if (seen.contains(start)) continue;
    std::vector<int> loop;
    for (int h = start; !seen.contains(h);) {
      seen.emplace(h, 1);
      loop.push_back(h);
      h = leaving.at(adjacency.to(h));
    }
    result.loops.push_back(std::move(loop));
  }
  return result;
}

struct PartTopology {
  int euler = 0, pieces = 0;
};

PartTopology topology_of_part(const Adjacency& adjacency, const std::vector<int>& face_segment, int part) {
  std::vector<char> vertex(adjacency.vertex_count(), 0), edge(adjacency.edge_count(), 0),
      face(adjacency.face_count(), 0);
  PartTopology result;
  std::vector<int> stack;
  for (int f = 0; f < adjacency.face_count(); ++f) {
    if (face_segment[f] != part || face[f]) continue;
    ++result.pieces;
    face[f] = 1;
    stack.push_back(f);
    while (!stack.empty()) {
      const int g = stack.back();
      stack.pop_back();
      ++result.euler;
      for (int h = 3 * g; h < 3 * g + 3; ++h) {
        if (!vertex[adjacency.from(h)]) vertex[adjacency.from(h)] = 1, ++result.euler;
        if (!edge[adjacency.edge_of(h)]) edge[adjacency.edge_of(h)] = 1, --result.euler;
        const int o = adjacency.opposite(h);
        if (o >= 0 && face_segment[o / 3] == part && !face[o / 3]) face[o / 3] = 1, stack.push_back(o / 3);
      }
    }
  }
  return result;
}

std::vector<int> vertices_of(const Adjacency& adjacency, const std::vector<int>& loop) {
  std::vector<int> vertices;
  vertices.reserve(loop.size());
  for (const int h : loop) vertices.push_back(adjacency.from(h));
  return vertices;
}

class Builder {
 public:
  Builder(Segmentation& result, const Adjacency& adjacency)
      : result_(result), adjacency_(adjacency), interface_of_edge_(adjacency.edge_count(), -1) {}

  std::string build(int part) {
    const PartTopology topology = topology_of_part(adjacency_, result_.face_segment, part);
    if (topology.pieces != 1)
      return "It is in " + std::to_string(topology.pieces) + " pieces: give each a part of its own.";
    const PartLoops found = loops_of_part(adjacency_, result_.face_segment, part);
    if (found.pinched) return "Its boundary touches itself at a vertex: move the loop away from there.";
    if (topology.euler != 0 || found.loops.size() != 2) {
      const int handles = (2 - topology.euler - static_cast<int>(found.loops.size())) / 2;
      if (handles > 0) return "It has a handle: cut the handle open first.";
      return found.loops.size() < 2
                 ? "It has " + std::to_string(found.loops.size()) +
                       " openings instead of two: put another hole into it."
                 : "It has " + std::to_string(found.loops.size()) + " openings instead of two: divide it.";
    }
    int open_loops = 0;
    for (const auto& loop : found.loops) {
      const auto open = std::count_if(loop.begin(), loop.end(), [&](int h) { return adjacency_.opposite(h) < 0; });
      if (open != 0 && open != static_cast<std::ptrdiff_t>(loop.size()))
        return "Its opening touches the next part: move one of them.";
      if (open != 0) ++open_loops;
    }
    const bool alone = result_.part_count() == 1;
    if (!alone && open_loops != 1)
      return open_loops == 0 ? "It has no opening: put a hole into it."
                             : "It has no neighbouring part: the surface is not connected.";
    Segment& segment = result_.segments[part];
    segment.face_count = static_cast<int>(std::count(result_.face_segment.begin(), result_.face_segment.end(), part));
    const bool first_is_top = !alone && adjacency_.opposite(found.loops[0].front()) < 0;
    segment.top.vertices = vertices_of(adjacency_, found.loops[first_is_top ? 0 : 1]);
    const std::vector<int>& bottom = found.loops[first_is_top ? 1 : 0];
    if (alone) segment.bottom.vertices = vertices_of(adjacency_, bottom);
    else build_transition(part, bottom);
    return "";
  }

 private:
  int neighbour(int h) const { return result_.face_segment[adjacency_.opposite(h) / 3]; }

  void build_transition(int part, std::vector<int> loop) {
    BoundaryLine& line = result_.segments[part].bottom;
    const int n = static_cast<int>(loop.size());
    int start = -1;
    for (int i = 0; i < n && start < 0; ++i)
      if (neighbour(loop[i]) != neighbour(loop[(i + n - 1) % n])) start = i;
    if (start < 0) {  // one closed interface: both sides begin at the same vertex
      start = 0;
      if (const int known = interface_of_edge_[adjacency_.edge_of(loop[0])]; known >= 0)
        while (adjacency_.from(loop[start]) != result_.interfaces[known].vertices.front()) ++start;
    }
    std::rotate(loop.begin(), loop.begin() + start, loop.end());
    line.vertices = vertices_of(adjacency_, loop);
    for (int i = 0; i < n;) {
      int j = i;
      while (j < n && neighbour(loop[j]) == neighbour(loop[i])) ++j;
      const int known = interface_of_edge_[adjacency_.edge_of(loop[i])];
      if (known >= 0) {
        line.uses.push_back({known, false});
      } else {
        Interface made{part, neighbour(loop[i]), {}};
        for (int k = i; k < j; ++k) {
          made.vertices.push_back(adjacency_.from(loop[k]));
          interface_of_edge_[adjacency_.edge_of(loop[k])] = static_cast<int>(result_.interfaces.size());
        }
        made.vertices.push_back(adjacency_.to(loop[j - 1]));
        line.uses.push_back({static_cast<int>(result_.interfaces.size()), true});
        result_.interfaces.push_back(std::move(made));
      }
      i = j;
    }
  }

  Segmentation& result_;
  const Adjacency& adjacency_;
  std::vector<int> interface_of_edge_;
};

/// Per vertex and part: which line of the part it lies on. Parts share lines, so that one number a vertex is not
/// enough.
std::vector<std::vector<std::pair<int, int>>> lines_at_vertices(const Segmentation& s) {
  std::vector<std::vector<std::pair<int, int>>> lines(s.mesh.vertex_count());
  for (int part = 0; part < s.part_count(); ++part) {
    for (const int v : s.segments[part].bottom.vertices) lines[v].emplace_back(part, 0);
    for (const int v : s.segments[part].top.vertices) lines[v].emplace_back(part, 1);
  }
  return lines;
}

/// Splits inner edges that join two vertices of one line; true if there were any.
bool split_chords(TriangleMesh& mesh, std::vector<int>& face_segment, const Adjacency& adjacency,
                  const Segmentation& s) {
  const auto lines = lines_at_vertices(s);
  std::vector<int> middle(adjacency.edge_count(), -1);
  std::vector<Vec3> points;
  for (int e = 0; e < adjacency.edge_count(); ++e) {
    const auto halfedges = adjacency.halfedges_of_edge(e);
    if (halfedges.size() != 2 || face_segment[halfedges[0] / 3] != face_segment[halfedges[1] / 3]) continue;
    const auto [a, b] = adjacency.edges()[e];
    const int part = face_segment[halfedges[0] / 3];
    for (int line = 0; line < 2; ++line) {
      const std::pair key{part, line};
      const auto on = [&](int v) { return std::find(lines[v].begin(), lines[v].end(), key) != lines[v].end(); };
      if (middle[e] >= 0 || !on(a) || !on(b)) continue;
      middle[e] = mesh.vertex_count() + static_cast<int>(points.size());
      points.push_back(0.5 * (mesh.V.row(a) + mesh.V.row(b)).transpose());
    }
  }
  if (points.empty()) return false;
  std::vector<std::array<int, 3>> faces;
  std::vector<int> segments;
  const auto add = [&](int a, int b, int c, int part) {
    faces.push_back({a, b, c});
    segments.push_back(part);
  };
  for (int f = 0; f < adjacency.face_count(); ++f) {
    // One edge is split at a time: what remains is a triangle that may be split again.
    std::vector<std::array<int, 3>> pending{{mesh.F(f, 0), mesh.F(f, 1), mesh.F(f, 2)}};
    for (int h = 3 * f; h < 3 * f + 3; ++h) {
      const int m = middle[adjacency.edge_of(h)];
      if (m < 0) continue;
      const int a = adjacency.from(h), b = adjacency.to(h);
      for (std::size_t t = 0; t < pending.size(); ++t)
        for (int k = 0; k < 3; ++k) {
          const auto triangle = pending[t];
          if (triangle[k] != a || triangle[(k + 1) % 3] != b) continue;
          pending[t] = {a, m, triangle[(k + 2) % 3]};
          pending.push_back({m, b, triangle[(k + 2) % 3]});
          break;
        }
    }
    for (const auto& t : pending) add(t[0], t[1], t[2], face_segment[f]);
  }
  const Eigen::Index old = mesh.V.rows();
  mesh.V.conservativeResize(old + static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i) mesh.V.row(old + static_cast<Eigen::Index>(i)) = points[i];
  mesh.F.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (int k = 0; k < 3; ++k) mesh.F(static_cast<Eigen::Index>(i), k) = faces[i][k];
  face_segment = std::move(segments);
  return true;
}

Segmentation derive(TriangleMesh mesh, std::vector<int> face_segment, const Adjacency& adjacency) {
  Segmentation result;
  result.mesh = std::move(mesh);
  result.face_segment = std::move(face_segment);
  const int parts = 1 + *std::max_element(result.face_segment.begin(), result.face_segment.end());
  result.segments.resize(parts);
  result.problems.resize(parts);
  Builder builder(result, adjacency);
  for (int part = 0; part < parts; ++part) result.problems[part] = builder.build(part);
  return result;
}

}  // namespace

bool Segmentation::valid() const {
  return !segments.empty() &&
         std::all_of(problems.begin(), problems.end(), [](const std::string& p) { return p.empty(); });
}

Segmentation make_segmentation(const TriangleMesh& mesh, const std::vector<int>& face_segment) {
  const Adjacency adjacency(mesh);
  if (mesh.face_count() == 0 || static_cast<int>(face_segment.size()) != mesh.face_count())
    throw Error(ErrorCode::invalid_input, "mesh", "Every triangle of a segmentation needs the number of its part.");
  if (!adjacency.is_manifold())
    throw Error(ErrorCode::invalid_input, "mesh", "The mesh is not a manifold: repair it first.");
  if (face_components(adjacency).count != 1)
    throw Error(ErrorCode::invalid_input, "mesh",
                "The model is in several separate pieces: make each a zippable of its own.");
  if (adjacency.boundary_edge_count() == 0)
    throw Error(ErrorCode::invalid_input, "mesh", "The surface has no opening: put a hole into it.");
  if (*std::min_element(face_segment.begin(), face_segment.end()) < 0)
    throw Error(ErrorCode::invalid_input, "mesh", "The parts of a segmentation must be numbered from 0.");
  Segmentation result = derive(mesh, face_segment, adjacency);
  if (!result.valid()) return result;
  TriangleMesh split = result.mesh;
  std::vector<int> segments = result.face_segment;
  if (!split_chords(split, segments, adjacency, result)) return result;
  const Adjacency again(split);
  return derive(std::move(split), std::move(segments), again);
}

double walk_length_mm(const TriangleMesh& mesh, const std::vector<int>& vertices, bool closed) {
  double length = 0;
  for (std::size_t i = 0; i + 1 < vertices.size(); ++i)
    length += (mesh.V.row(vertices[i + 1]) - mesh.V.row(vertices[i])).norm();
  if (closed && !vertices.empty()) length += (mesh.V.row(vertices.front()) - mesh.V.row(vertices.back())).norm();
  return length;
}

}  // namespace formwright
