// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/repair/repair.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "base/error.h"
#include "base/index.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/repair/repair_steps.h"

namespace formwright {
namespace {

std::string counted(int count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}
std::string triangles(int count) { return counted(count, "triangle", "triangles"); }

repair_steps::Draft checked_draft(const TriangleMesh& mesh, std::vector<std::string>& sentences) {
  repair_steps::Draft draft;
  draft.mesh = mesh;
  draft.vertex_of.resize(index(mesh.vertex_count()));
  draft.face_of.resize(index(mesh.face_count()));
  draft.corner_of.resize(index(3 * mesh.face_count()));
  std::iota(draft.vertex_of.begin(), draft.vertex_of.end(), 0);
  std::iota(draft.face_of.begin(), draft.face_of.end(), 0);
  std::iota(draft.corner_of.begin(), draft.corner_of.end(), 0);

  std::vector<char> keep(index(mesh.face_count()), 1), used(index(mesh.vertex_count()), 0);
  int dropped = 0;
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int v = mesh.F(f, k);
      if (v < 0 || v >= mesh.vertex_count())
        throw Error(ErrorCode::invalid_input, "mesh",
                    "A triangle names vertex " + std::to_string(v) + ", but the mesh has " +
                        std::to_string(mesh.vertex_count()) + " vertices; export the mesh again.");
      used[index(v)] = 1;
      if (!mesh.V.row(v).allFinite()) {
        dropped += keep[index(f)];
        keep[index(f)] = 0;
      } else if (mesh.V.row(v).cwiseAbs().maxCoeff() > 1e100) {
        throw Error(ErrorCode::invalid_input, "mesh", "The mesh has coordinates beyond 1e100; check its unit.");
      }
    }
  if (dropped > 0) {
    draft.keep_faces(keep);
    sentences.push_back("Removed " + triangles(dropped) + " with a corner that is not a number.");
  }
  if (const auto unused = static_cast<int>(std::count(used.begin(), used.end(), 0)); unused > 0)
    sentences.push_back("Removed " + counted(unused, "vertex that no triangle uses", "vertices that no triangle uses") +
                        ".");
  return draft;
}

}  // namespace

RepairedMesh repair(const TriangleMesh& mesh, const RepairOptions& options, Context& context) {
  using namespace repair_steps;
  RepairedMesh result;
  std::vector<std::string>& say = result.sentences;
  if (mesh.face_count() == 0)
    throw Error(ErrorCode::invalid_input, "mesh", "The mesh has no triangles; export a surface, not points or lines.");
  context.progress(0, "Checking the mesh");
  Draft draft = checked_draft(mesh, say);

  if (options.merge_duplicates) {
    if (const int merged = merge_vertices(draft, options.merge_tolerance_mm); merged > 0)
      say.push_back("Merged " + counted(merged, "vertex that lies", "vertices that lie") +
                    (options.merge_tolerance_mm > 0 ? " next to another." : " at the same place as another."));
  }
  context.progress(0.15);
  const DegenerateCount degenerate = fix_degenerate_faces(draft, context);
  if (degenerate.removed > 0) say.push_back("Removed " + triangles(degenerate.removed) + " without area.");
  if (degenerate.fixed > 0)
    say.push_back("Repaired " + triangles(degenerate.fixed) + " without area by flipping an edge.");
  if (draft.mesh.face_count() == 0)
    throw Error(ErrorCode::invalid_input, "mesh",
                "No triangle of the mesh has an area; check that it is not flattened to a line or a point.");
  context.progress(0.25);
  const DuplicateCount duplicate = remove_duplicate_faces(draft);
  if (duplicate.removed > 0)
    say.push_back("Removed " + counted(duplicate.removed, "duplicate triangle", "duplicate triangles") + ".");
  if (duplicate.second_sides > 0)
    say.push_back("Removed " + triangles(duplicate.second_sides) +
                  " that duplicated the surface facing the other way.");
  context.progress(0.4);
  GluingCount gluing = make_manifold(draft, context);
  if (gluing.edges_cut > 0)
    say.push_back("Separated the surface along " + counted(gluing.edges_cut, "edge", "edges") +
                  " where more than two triangles met.");
  if (gluing.vertices_split > 0)
    say.push_back(
        "Separated the surface at " +
        counted(gluing.vertices_split, "vertex where parts of the surface", "vertices where parts of the surface") +
        " only touched.");
  if (gluing.one_sided_edges > 0)
    say.push_back("The surface has only one side, like a Möbius band; it was cut along " +
                  counted(gluing.one_sided_edges, "edge", "edges") + ".");
  if (gluing.faces_turned > 0)
    say.push_back("Turned " + triangles(gluing.faces_turned) + " to face the same way as the rest.");
  context.progress(0.75);

  if (options.drop_parts_below_percent > 0)
    if (const DropCount dropped = drop_small_parts(draft, options.drop_parts_below_percent / 100); dropped.parts > 0) {
      gluing.adjacency.reset();
      say.push_back("Dropped " + counted(dropped.parts, "small part", "small parts") + " (" + triangles(dropped.faces) +
                    ").");
    }
  if (options.fill_holes_up_to_edges > 0)
    if (const FillCount filled = fill_holes(draft, options.fill_holes_up_to_edges, context); filled.holes > 0) {
      gluing.adjacency.reset();
      say.push_back("Filled " + counted(filled.holes, "hole", "holes") + " with " + triangles(filled.faces) + ".");
    }
  if (!gluing.adjacency) gluing.adjacency = std::make_unique<Adjacency>(draft.mesh);
  const Adjacency& adjacency = *gluing.adjacency;
  const Components parts = face_components(adjacency);
  result.part_count = parts.count;
  result.hole_count = static_cast<int>(boundary_loops(adjacency).size());
  result.genus = (2 * result.part_count - euler_characteristic(adjacency) - result.hole_count) / 2;
  context.progress(0.9);
  if (const int turned = turn_outwards(draft, adjacency, parts, context); turned > 0)
    say.push_back("Turned " + counted(turned, "closed part", "closed parts") + " to face outwards.");
  draft.drop_unused_vertices();
  if (result.hole_count > 0)
    say.push_back("The surface has " + counted(result.hole_count, "hole", "holes") +
                  ". Fine for reliefs; a zippable or a mould needs a closed surface.");
  result.mesh = std::move(draft.mesh);
  result.vertex_of = std::move(draft.vertex_of);
  result.face_of = std::move(draft.face_of);
  result.corner_of = std::move(draft.corner_of);
  context.progress(1);
  return result;
}

Model repaired_model(const Model& model, const RepairedMesh& repaired) {
  Model result;
  result.mesh = repaired.mesh;
  result.group_names = model.group_names;
  result.materials = model.materials;
  result.textures = model.textures;
  const int n = repaired.mesh.vertex_count(), m = repaired.mesh.face_count();
  if (model.vertex_colours.rows() == model.mesh.V.rows() && model.vertex_colours.rows() > 0) {
    result.vertex_colours.resize(n, 3);
    for (int v = 0; v < n; ++v) result.vertex_colours.row(v) = model.vertex_colours.row(repaired.vertex_of[index(v)]);
  }
  if (model.FT.rows() == model.mesh.F.rows() && model.FT.rows() > 0) {
    result.UV = model.UV;
    result.FT.resize(m, 3);
    for (int c = 0; c < 3 * m; ++c) {
      const int old = repaired.corner_of[index(c)];
      result.FT(c / 3, c % 3) = model.FT(old / 3, old % 3);
    }
  }
  const auto per_face = [&](const std::vector<int>& values) {
    std::vector<int> moved;
    if (values.empty()) return moved;
    // A face that fills a hole takes after the face of its first corner.
    for (int f = 0; f < m; ++f) {
      const int old = repaired.face_of[index(f)];
      moved.push_back(values[index(old >= 0 ? old : repaired.corner_of[index(3 * f)] / 3)]);
    }
    return moved;
  };
  result.face_group = per_face(model.face_group);
  result.face_material = per_face(model.face_material);
  return result;
}

}  // namespace formwright
