// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Mesh files in and out: OBJ, STL, PLY, GLB, 3MF. Bytes in, bytes out; hosts touch disks.
#include <string_view>

#include "base/context.h"
#include "formats/shared/mesh_format.h"
#include "formats/shared/model_file.h"

namespace formwright {

/// Reads any of the formats, found by content first and by `file_name`'s extension second. Lengths come out in
/// mm where the file declares a unit (glTF: metres), else as they stand. Indices are in range, every number is finite.
/// Polygons become triangles; unused vertices stay.
/// Throws Error{invalid_input, options.where} with one sentence that names the file, what is wrong with it and
/// the fix; Error{cancelled}.
ModelFile read_model_file(ByteView bytes, std::string_view file_name, const ReadOptions& options, Context& context);

/// The same without the rest of what the file says.
Model read_model(ByteView bytes, std::string_view file_name, Context& context);

/// Looks up what `file` names in `companions`: OBJ's material libraries, then every texture without bytes. Names are
/// compared without folders, in any case. Fills materials and textures, and says in `missing_companions` what is
/// still not there; that is not an error. read_model_file calls it with options.companions.
/// Throws Error{invalid_input} for a material library that is not text.
void read_model_materials(ModelFile& file, std::span<const Companion> companions, const ReadOptions& options = {});

/// Lengths are taken to be mm. Throws Error{internal} if the model is not one (an index out of range, a number that
/// is not finite, sizes that disagree) and Error{invalid_input} if the format cannot hold it (too many vertices).
Bytes write_model(const Model& model, MeshFormat format, const WriteOptions& options, Context& context);
Bytes write_model(const Model& model, MeshFormat format, Context& context);

}  // namespace formwright
