// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Several meshes in one GLB file, each under a node with a name of its own.
#include <span>
#include <string>

#include "base/bytes.h"
#include "base/context.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct NamedMesh {
  std::string name;
  TriangleMesh mesh;  // mm, y up and z towards the viewer, as glTF has them
};

/// float32 positions in mm under nodes of scale 0.001, without normals: viewers then draw flat faces
/// (glTF 2.0, 3.7.2.1). Throws Error: invalid_input where the file would exceed 4 GB, cancelled.
Bytes write_glb_nodes(std::span<const NamedMesh> meshes, Context& context);

}  // namespace formwright
