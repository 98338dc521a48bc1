// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Wavefront OBJ and its material library, MTL (Alias|Wavefront, Advanced Visualizer manual, appendix B1, 1992).
#include "formats/shared/mesh_source.h"

namespace formwright {

/// Vertices (with colours, as sRGB after the position), texture vertices, faces of any size, groups and objects,
/// material names. Normals, lines, points and free-form surfaces are left out. Vertex colours above 1 are taken for
/// 0 to 255. Faces without texture vertices beside others that have them share one extra row of UV, (0, 0).
ModelFile read_obj(const MeshSource& source);

Bytes write_obj(const Model& model, const WriteOptions& options, Context& context);

/// The material library that write_obj names: diffuse colours and the names of diffuse textures.
Bytes write_mtl(const Model& model);

struct MtlMaterial {
  Material material;    // without its texture
  std::string texture;  // map_Kd, "" for none
};
/// Throws Error{invalid_input} if it is not text, or a colour is not a number.
std::vector<MtlMaterial> read_mtl(const MeshSource& source);

}  // namespace formwright
