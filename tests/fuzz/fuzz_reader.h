// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What every target does: read, and if it was read, check it and write it in every format. An Error is an answer;
// any other exception, a sanitizer's finding, too much memory or time is a finding.
#include "fuzz/fuzz_check.h"
#include "formats/mesh_io.h"
#include "formats/shared/mesh_source.h"
#include "formats/shared/model_file.h"

namespace formwright::fuzz {

inline ReadOptions small_options() {
  ReadOptions options;
  options.max_triangles = 20'000;
  return options;
}

/// `Reader` is one format's reader, so that the search is not spent on telling formats apart.
template <class Reader>
void read_and_write(const std::uint8_t* data, std::size_t size, const Reader& reader) {
  const ByteView bytes(reinterpret_cast<const std::byte*>(data), size);
  const ReadOptions options = small_options();
  Context context;
  ModelFile file;
  try {
    file = reader(MeshSource(bytes, "input", options, context));
  } catch (const Error& error) {
    check_refusal(error);
    return;
  }
  read_model_materials(file, {}, options);
  check(file.model.mesh.face_count() > 0 && file.model.mesh.face_count() <= options.max_triangles);
  for (const VertexColumn& column : file.columns)
    check(column.values.size() == file.model.mesh.V.rows() && column.values.allFinite());
  // Throws Error{internal} for a model that is not sound, which ends the run.
  for (const auto& info : mesh_formats) write_model(file.model, info.format, context);
}

}  // namespace formwright::fuzz
