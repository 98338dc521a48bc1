// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The mesh formats, in one table, and how a file's format is found.
#include <array>
#include <optional>
#include <string_view>

#include "base/bytes.h"

namespace formwright {

enum class MeshFormat { obj, stl, ply, glb, three_mf };

struct MeshFormatInfo {
  MeshFormat format;
  std::string_view extension;   // lower case, without the dot
  std::string_view media_type;  // IANA's, but for PLY, which has none
  std::string_view title;       // for a person
};

inline constexpr std::array<MeshFormatInfo, 5> mesh_formats{{
    {MeshFormat::obj, "obj", "model/obj", "Wavefront OBJ"},
    {MeshFormat::stl, "stl", "model/stl", "STL"},
    {MeshFormat::ply, "ply", "application/x-ply", "Stanford PLY"},
    {MeshFormat::glb, "glb", "model/gltf-binary", "glTF binary"},
    {MeshFormat::three_mf, "3mf", "model/3mf", "3D Manufacturing Format"},
}};

constexpr const MeshFormatInfo& mesh_format_info(MeshFormat format) {
  return mesh_formats[static_cast<std::size_t>(format)];
}

/// By extension, with or without the dot, in any case; "model.OBJ", ".obj" and "obj" all do.
std::optional<MeshFormat> mesh_format_of_extension(std::string_view file_name);

/// By what the bytes are, then by the file's name (never by the name against the bytes).
/// Throws Error{invalid_input, where}: an empty file, or a format that is not read (named where it is known).
MeshFormat detect_mesh_format(ByteView bytes, std::string_view file_name, std::string_view where = "mesh");

/// Of a binary STL: what stands before its triangles, and each of them.
inline constexpr std::size_t stl_header_bytes = 84, stl_triangle_bytes = 50;
/// Whether the size is that of a binary STL with as many triangles as bytes 80 to 83 say; then it is one, even if
/// its header begins with "solid".
bool has_binary_stl_size(ByteView bytes);

}  // namespace formwright
