// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// STL, binary and ASCII (3D Systems, StereoLithography Interface Specification, 1989).
#include "formats/shared/mesh_source.h"

namespace formwright {

/// Triangles become an indexed mesh by merging corners at exactly the same place (options.merge_duplicates);
/// normals and attribute bytes are left out. Several solids of an ASCII file become groups. A binary file whose
/// triangle count is wrong but whose size is whole is read by its size, with a note; one that ends early is refused.
ModelFile read_stl(const MeshSource& source);

/// float32 positions, as binary STL has no others; the text form has them too, so that both hold the same mesh.
Bytes write_stl(const Model& model, const WriteOptions& options, Context& context);

}  // namespace formwright
