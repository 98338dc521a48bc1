// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/relief/pieces/piece_files.h"

#include <algorithm>

#include "fabrication/page_tiles.h"
#include "formats/container/zip.h"
#include "formats/glb/glb_nodes.h"
#include "formats/mesh_io.h"
#include "geometry/mesh/file_grid.h"
#include "geometry/mesh/measures.h"
#include "job/contract/model_input.h"
#include "job/operations/relief/forest/forest_files.h"

namespace formwright {
namespace {

Bytes stl_files(const std::vector<PlacedPiece>& pieces, Context& context) {
  ZipWriter zip;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const std::string name = "piece_" + numbered(k, pieces.size());
    Model model;
    model.mesh = pieces[k].lying;
    WriteOptions write;
    write.name = name;
    zip.add_stored(name + ".stl", write_model(model, MeshFormat::stl, write, context));
  }
  return zip.finish();
}

std::vector<NamedMesh> standing(const std::vector<PlacedPiece>& pieces) {
  std::vector<NamedMesh> meshes;
  for (std::size_t k = 0; k < pieces.size(); ++k)
    meshes.push_back({"Piece " + std::to_string(k + 1), pieces[k].standing});
  return meshes;
}

/// One model with a group for each mesh.
Model grouped(const std::vector<NamedMesh>& meshes) {
  Model model;
  Eigen::Index vertices = 0, faces = 0;
  for (const NamedMesh& one : meshes) {
    vertices += one.mesh.V.rows();
    faces += one.mesh.F.rows();
  }
  model.mesh.V.resize(vertices, 3);
  model.mesh.F.resize(faces, 3);
  vertices = faces = 0;
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    const auto& [V, F] = meshes[k].mesh;
    model.mesh.V.middleRows(vertices, V.rows()) = V;
    model.mesh.F.middleRows(faces, F.rows()) = F.array() + static_cast<int>(vertices);
    model.face_group.insert(model.face_group.end(), static_cast<std::size_t>(F.rows()), static_cast<int>(k));
    model.group_names.push_back(meshes[k].name);
    vertices += V.rows();
    faces += F.rows();
  }
  return model;
}

void report_pieces(Json& report, const std::vector<PlacedPiece>& pieces) {
  Json list = Json::array();
  bool watertight = true;
  double volume_mm3 = 0;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const PlacedPiece& piece = pieces[k];
    const Vec3 size = bounding_box(piece.lying).size();
    list.push_back({{"number", k + 1},
                    {"size_mm", {size.x(), size.y(), size.z()}},
                    {"depth_mm", piece.depth_mm},
                    {"turn_deg", piece.turn_deg},
                    {"volume_ml", piece.volume_mm3 / 1000},
                    {"numbered", piece.numbered}});
    watertight = watertight && piece.watertight;
    volume_mm3 += piece.volume_mm3;
  }
  report["pieces"] = list;
  report["pieces_watertight"] = watertight;
  report["pieces_volume_ml"] = volume_mm3 / 1000;
}

}  // namespace

std::vector<OutputInfo> piece_outputs() {
  return {{"pieces.zip", "application/zip", "Pieces, STL",
           "On stairs, strips and a base of several parts: every step, strip or part as a watertight solid of its own, "
           "lying on its back, with its number and an arrow that points up sunk into a flat back: piece_01.stl and so "
           "on.",
           false},
          {"pieces.3mf", "model/3mf", "Pieces, 3MF",
           "The same pieces where they belong, as objects with names of their own.", false},
          {"pieces.glb", "model/gltf-binary", "Pieces, GLB",
           "The same pieces where they belong, as nodes with names, for viewing.", false},
          {"placement.svg", "image/svg+xml", "Placement plan, SVG",
           "Where the pieces go, at true size: from the front and across, with numbers, sizes and depths.", false},
          {"placement.pdf", "application/pdf", "Placement plan, PDF",
           "The placement plan at true size over as many A4 pages as it takes.", false}};
}

std::vector<ReportField> piece_report_fields() {
  return {
      {"pieces", "Pieces", "",
       "For each piece, only where files of them are made: its number, the size of its solid, how far its middle "
       "(of a part of a file: its foremost place) lies behind the foremost place of the base, its turn against the plate, its volume and whether there was "
       "room for its number."},
      {"pieces_watertight", "Pieces watertight", "",
       "Whether every piece has no holes, as slicers need; checked on the result."},
      {"pieces_volume_ml", "Volume of the pieces", "ml", "Volume of all pieces together."}};
}

bool wants_pieces(const OperationCall& call) {
  for (const OutputInfo& info : piece_outputs())
    if (call.wants(info.name)) return true;
  return false;
}

std::vector<PlacedPiece> placed(const std::vector<ReliefPiece>& pieces) {
  std::vector<PlacedPiece> result;
  for (const auto& [tile, solid] : pieces)
    result.push_back({solid.mesh, in_place(solid, tile), std::max(0.0, tile.depth_mm()), tile.turn_deg(),
                      solid.volume_mm3, solid.numbered, solid.watertight});
  return result;
}

std::vector<PlacedPiece> placed(const std::vector<PartPiece>& pieces) {
  std::vector<PlacedPiece> result;
  for (const PartPiece& piece : pieces) {
    TriangleMesh lying = piece.solid.mesh;
    lying.V.rowwise() -= bounding_box(lying).lower.transpose();
    result.push_back({on_file_grid(lying), piece.solid.mesh, piece.depth_mm, 0, piece.solid.volume_mm3,
                      piece.solid.numbered, piece.solid.watertight});
  }
  return result;
}

void add_piece_files(const OperationCall& call, const std::vector<PlacedPiece>& pieces,
                     const std::function<CutSheet()>& plan, OperationResult& result) {
  Context& context = call.context;
  report_pieces(result.report, pieces);
  const auto add = [&](const char* name, const auto& make) {
    if (!call.wants(name)) return;
    for (const OutputInfo& info : piece_outputs())
      if (info.name == name) result.outputs.push_back(make_output(info, make()));
    context.check_cancelled();
  };
  add("pieces.zip", [&] { return stl_files(pieces, context); });
  const std::vector<NamedMesh> meshes =
      call.wants("pieces.3mf") || call.wants("pieces.glb") ? standing(pieces) : std::vector<NamedMesh>{};
  add("pieces.3mf", [&] {
    WriteOptions write;
    write.object_per_group = true;
    write.name = "pieces";
    return write_model(grouped(meshes), MeshFormat::three_mf, write, context);
  });
  add("pieces.glb", [&] { return write_glb_nodes(meshes, context); });
  if (!call.wants("placement.svg") && !call.wants("placement.pdf")) return;
  const CutSheet drawn = plan();
  add("placement.svg", [&] { return write_svg(drawn); });
  add("placement.pdf", [&] {
    PageContent content;
    content.drawing = &drawn;
    content.width_mm = drawn.width_mm;
    content.height_mm = drawn.height_mm;
    return make_page_tiles(content, PageTilesOptions{}, context).pdf;
  });
}

}  // namespace formwright
