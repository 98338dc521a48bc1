// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// glTF 2.0, binary (Khronos, ISO/IEC 12113:2022).
#include "formats/shared/mesh_source.h"

namespace formwright {

/// A .glb, or a .gltf whose buffers are embedded or given as companions. All meshes of the scene, with the nodes'
/// transforms, in mm (glTF is in metres): positions, TEXCOORD of the base colour, COLOR_0, scalar attributes with
/// an underscore (as columns, lower case), base colour factors and textures. Vertices that glTF had to split at seams
/// are merged again (options.merge_duplicates); colours and columns of such a vertex are those of its first part.
/// Several mesh nodes become groups. Skins and morph targets are left at rest. Refuses what needs a decoder
/// (Draco, meshopt) and buffers outside the file.
ModelFile read_glb(const MeshSource& source);

/// float32 positions in mm under a node of scale 0.001, area-weighted normals, COLOR_0 (linear), TEXCOORD_0, materials
/// with embedded PNG or JPEG textures, options.columns as float attributes: normal_error_deg is _NORMAL_ERROR_DEG.
Bytes write_glb(const Model& model, const WriteOptions& options, Context& context);

}  // namespace formwright
