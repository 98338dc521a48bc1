// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// PLY, the polygon file format (Turk 1994): ASCII, binary little and big endian.
#include <optional>

#include "formats/shared/mesh_source.h"

namespace formwright {

/// Any elements and properties in any order and type. Known: x y z, red green blue (sRGB), s t or u v of vertices;
/// vertex_indices and texcoord of faces (polygons too); tristrips; `comment TextureFile`. Other numbers of vertices
/// become columns; other lists and elements are left out.
ModelFile read_ply(const MeshSource& source);

/// float64 positions, uchar sRGB colours, options.columns each in its own kind, texture coordinates per vertex
/// where every vertex has one and per face corner otherwise.
Bytes write_ply(const Model& model, const WriteOptions& options, Context& context);

// ---- the header, for the reader ----

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
std::size_t size_of(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type;                       // of the number, or of a list's items
  std::optional<PlyType> count_type;  // of a list
};

struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  enum class Encoding { ascii, little_endian, big_endian } encoding = Encoding::ascii;
  std::vector<PlyElement> elements;
  std::vector<std::string> textures;
  std::size_t body = 0;  // offset of the first byte after the header

  const PlyElement* element(std::string_view name) const;
};

/// Throws Error{invalid_input}: a header that is broken, or declares more than the rest of the file can hold.
PlyHeader read_ply_header(const MeshSource& source);

}  // namespace formwright
