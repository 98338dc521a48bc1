// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What is read from a mesh file, and how it is to be read or written.
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/bytes.h"
#include "formats/shared/mesh_format.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// A named number per vertex that a format carries beside the mesh: PLY properties, glTF custom attributes.
enum class ColumnKind { uint8, int32, float32, float64 };
struct VertexColumn {
  std::string name;
  Eigen::VectorXd values;                 // one a vertex, finite
  ColumnKind kind = ColumnKind::float64;  // how it was, and will be, stored
};

/// A file that came along with the mesh: an OBJ's .mtl, a texture.
struct Companion {
  std::string name;
  ByteView bytes;
};

/// A model and the rest of what its file said.
struct ModelFile {
  Model model;
  MeshFormat format = MeshFormat::obj;
  std::string unit;                   // of length, as the file declares it: "m", "mm", "inch"...; "" when it does not.
                                      // Positions are in mm already where it does.
  std::vector<VertexColumn> columns;  // PLY, GLB
  std::vector<std::string>
      columns_not_numbers;  // names of those left out, because they hold values that are not numbers
  std::vector<std::string> material_libraries;  // OBJ: names after mtllib
  std::vector<std::string> missing_companions;  // named by the file, not given
  std::vector<std::string> notes;               // what was repaired or left out: one sentence each, for a person
};

// 20 million triangles take about 1 GB as a mesh; 32-bit WASM has 4 GB for everything.
inline constexpr std::int64_t default_max_triangles = sizeof(void*) == 4 ? 4'000'000 : 20'000'000;

struct ReadOptions {
  std::int64_t max_triangles = default_max_triangles;  // a file with more is refused
  bool merge_duplicates = true;                        // STL, GLB: vertices at exactly the same place become one
  std::span<const Companion> companions;
  std::string where = "mesh";  // the input's name, for errors
};

struct WriteOptions {
  bool ascii = false;                     // STL and PLY as text
  std::span<const VertexColumn> columns;  // PLY, GLB; each with one value a vertex
  std::string material_library;           // OBJ: writes mtllib and usemtl; the file itself comes from write_mtl
  bool object_per_group = false;          // 3MF: groups that share no vertices become objects of their own
  std::string name = "formwright";        // of the object, where the format has one
};

}  // namespace formwright
