// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/flat_design.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "base/error.h"
#include "base/data/json_text.h"
#include "geometry/mesh/adjacency.h"
#include "zippable/fabric_colours.h"

namespace formwright {
namespace {

[[noreturn]] void refuse_design(const std::string& what) {
  throw Error(ErrorCode::invalid_input, "design", what + ": give the design.json that zippable-design wrote.");
}

template <int dimensions>
Eigen::Matrix<double, dimensions, 1> read_point(const Json& json) {
  Eigen::Matrix<double, dimensions, 1> point;
  if (!json.is_array() || json.size() != dimensions) refuse_design("A vertex of the ribbon is not a point");
  for (int k = 0; k < dimensions; ++k) {
    if (!json[std::size_t(k)].is_number()) refuse_design("A vertex of the ribbon is not a point");
    point[k] = json[std::size_t(k)].get<double>();
    if (!(std::abs(point[k]) < 1e7)) refuse_design("A vertex of the ribbon has no position");
  }
  return point;
}

int read_index(const Json& json, int minimum, int end) {
  if (!json.is_number_integer()) refuse_design("A vertex number in the design is not a whole number");
  const auto value = json.get<std::int64_t>();
  if (value < minimum || value >= end) refuse_design("The design names a vertex that does not exist");
  return static_cast<int>(value);
}

void check_disc(const FlatDesign& design) {
  TriangleMesh mesh;
  mesh.V = Positions::Zero(design.vertex_count(), 3);
  mesh.F = design.F;
  const Adjacency adjacency(mesh);
  if (design.F.rows() != design.vertex_count() - 2 || !adjacency.is_manifold() || euler_characteristic(adjacency) != 1)
    refuse_design("The ribbon in the design is not one disc with all vertices on its boundary");
  for (int v = 0; v < design.vertex_count(); ++v)
    if (const int e = adjacency.find_edge(v, design.next(v)); e < 0 || !adjacency.is_boundary_edge(e))
      refuse_design("The ribbon's boundary in the design is not that of its triangles");
}

void find_sides(FlatDesign& design, int samples) {
  design.left_vertex.assign(samples, -1), design.right_vertex.assign(samples, -1);
  design.piece_of.assign(samples, -1), design.arclength_mm.assign(samples, 0);
  for (int v = 0; v < design.vertex_count(); ++v)
    if (const int sample = design.boundary[v].sample; sample >= 0)
      (design.boundary[v].left ? design.left_vertex : design.right_vertex)[sample] = v;
  for (std::size_t p = 0; p < design.pieces.size(); ++p)
    for (std::size_t k = 0; k < design.pieces[p].size(); ++k) {
      const int sample = design.pieces[p][k], left = design.left_vertex[sample], right = design.right_vertex[sample];
      if (left < 0 || right < 0) refuse_design("A sample of the zipper lacks one of its sides");
      if (!(design.length_in_space_mm(left, right) < 1e-6))
        refuse_design("The sides of the zipper do not meet in space");
      design.piece_of[sample] = static_cast<int>(p);
      if (k > 0) design.zipper_mm += design.length_in_space_mm(design.left_vertex[design.pieces[p][k - 1]], left);
      design.arclength_mm[sample] = design.zipper_mm;
    }
  for (const FlatVertex& vertex : design.boundary)
    if (vertex.sample >= 0 && design.piece_of[vertex.sample] < 0)
      refuse_design("A sample of the zipper is in none of its pieces");
}

ClosureRun read_run(const Json& json, const FlatDesign& design, double length_mm, bool rising) {
  if (!json.is_object() || !json.contains("first_vertex") || !json.contains("along_mm"))
    refuse_design("A side of a cut is incomplete");
  ClosureRun run;
  run.first_vertex = read_index(json["first_vertex"], 0, design.vertex_count());
  const Json& along = json["along_mm"];
  if (!along.is_array() || along.size() < 2 || static_cast<int>(along.size()) > design.vertex_count())
    refuse_design("A side of a cut has no edge or too many");
  for (const Json& item : along) {
    if (!item.is_number()) refuse_design("A position along a cut is not a number");
    const double mm = item.get<double>();
    if (!(mm >= 0 && mm <= length_mm) ||
        (!run.along_mm.empty() && !(rising ? mm > run.along_mm.back() : mm < run.along_mm.back())))
      refuse_design("Positions along a cut are not in order");
    run.along_mm.push_back(mm);
  }
  for (int k = 0; k < run.edge_count(); ++k)
    if (design.zipper_edge(design.vertex_of(run, k))) refuse_design("A cut of the design runs along the zipper");
  return run;
}

void read_closures(const Json& list, FlatDesign& design) {
  if (!list.is_array()) refuse_design("The design's cuts are not a list");
  for (const Json& item : list) {
    const Json sides = item.is_object() ? item.value("sides", Json()) : Json(),
               length = item.is_object() ? item.value("length_mm", Json()) : Json();
    if (!sides.is_array() || sides.size() != 2 || !length.is_number() ||
        !(length.get<double>() > 0 && length.get<double>() < 1e9))
      refuse_design("A cut of the design lacks two sides or a length");
    HandleClosure closure;
    closure.length_mm = length.get<double>();
    closure.closed = item.value("closed", Json(true)) != false;
    for (std::size_t side = 0; side < 2; ++side) {
      if (!sides[side].is_array() || sides[side].empty()) refuse_design("A side of a cut is empty");
      for (const Json& run : sides[side])
        closure.sides[side].push_back(read_run(run, design, closure.length_mm, side == 0));
    }
    design.closures.push_back(std::move(closure));
  }
}

}  // namespace

bool FlatDesign::zipper_edge(int v) const {
  const FlatVertex &a = boundary[v], &b = boundary[next(v)];
  return a.sample >= 0 && b.sample >= 0 && a.left == b.left && piece_of[a.sample] == piece_of[b.sample];
}

FlatDesign read_flat_design(ByteView bytes) {
  const Json json = parse_json_text(as_text(bytes));
  if (!json.is_object() || json.value("format", Json()) != "formwright zippable design" ||
      json.value("version", Json()) != 1)
    refuse_design("This is not a zippable design");
  const Json ribbon = json.value("ribbon", Json()), pieces = json.value("pieces", Json());
  if (!ribbon.is_object() || !ribbon.contains("boundary") || !ribbon.contains("triangles") || !pieces.is_array())
    refuse_design("The design has no ribbon");
  FlatDesign design;
  const Json &boundary = ribbon["boundary"], &triangles = ribbon["triangles"];
  if (!boundary.is_array() || !triangles.is_array() || boundary.size() < 3 || boundary.size() > 1'000'000)
    refuse_design("The design's ribbon is empty or too large");
  const int count = static_cast<int>(boundary.size());
  int samples = 0;
  for (const Json& item : boundary) {
    if (!item.is_object() || !item.contains("position_mm") || !item.contains("flat_mm") ||
        !item.contains("zipper_sample"))
      refuse_design("A vertex of the ribbon is incomplete");
    FlatVertex vertex;
    vertex.position_mm = read_point<3>(item["position_mm"]);
    vertex.flat_mm = read_point<2>(item["flat_mm"]);
    vertex.sample = read_index(item["zipper_sample"], -1, count);
    vertex.left = item.value("side", Json()) != "right";
    samples = std::max(samples, vertex.sample + 1);
    design.boundary.push_back(vertex);
  }
  design.F.resize(static_cast<Eigen::Index>(triangles.size()), 3);
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    if (!triangles[f].is_array() || triangles[f].size() != 3)
      refuse_design("A triangle of the ribbon does not have three corners");
    for (std::size_t k = 0; k < 3; ++k)
      design.F(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(k)) = read_index(triangles[f][k], 0, count);
  }
  check_disc(design);
  design.fabric_of_face.assign(triangles.size(), 0);
  if (const Json fabric = ribbon.value("fabric", Json()); !fabric.is_null()) {
    if (!fabric.is_array() || fabric.size() != triangles.size())
      refuse_design("The design's fabrics are not those of its triangles");
    for (std::size_t f = 0; f < fabric.size(); ++f) {
      if (fabric[f] != 0 && fabric[f] != 1) refuse_design("A triangle of the design has no fabric");
      design.fabric_of_face[f] = fabric[f].get<int>();
    }
    design.fabrics = fabric_count;
  }
  for (const Json& piece : pieces) {
    if (!piece.is_array() || piece.size() < 2) refuse_design("A piece of the zipper has no length");
    design.pieces.emplace_back();
    for (const Json& sample : piece) design.pieces.back().push_back(read_index(sample, 0, samples));
  }
  find_sides(design, samples);
  if (json.contains("handle_cuts")) read_closures(json["handle_cuts"], design);
  return design;
}

}  // namespace formwright
