// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/shared/mesh_format.h"

#include <algorithm>

#include "base/error.h"
#include "formats/shared/byte_order.h"
#include "formats/shared/mesh_source.h"
#include "formats/shared/text_scan.h"

namespace formwright {
namespace {

struct ForeignFormat {
  std::string_view start, name;
};
// Named in the refusal, because the fix differs from "the file is broken".
constexpr std::array<ForeignFormat, 16> foreign_formats{{{"Kaydara FBX Binary", "an FBX file"},
                                                         {"ISO-10303-21", "a STEP file"},
                                                         {"BLENDER", "a Blender project"},
                                                         {"OFF", "an OFF file"},
                                                         {"<?xml", "an XML file (such as COLLADA, X3D or AMF)"},
                                                         {"<", "an XML or HTML file"},
                                                         {"#VRML", "a VRML file"},
                                                         {"# vtk", "a VTK file"},
                                                         {"\x89PNG", "a PNG picture"},
                                                         {"\xff\xd8\xff", "a JPEG picture"},
                                                         {"GIF8", "a GIF picture"},
                                                         {"%PDF", "a PDF document"},
                                                         {"\x1f\x8b", "a gzip archive"},
                                                         {"7z\xbc\xaf", "a 7-Zip archive"},
                                                         {"Rar!", "a RAR archive"},
                                                         {"\x28\xb5\x2f\xfd", "a Zstandard archive"}}};

/// Whether the first lines read like an OBJ's: known keywords, a vertex or a face among them.
bool looks_like_obj(std::string_view text) {
  constexpr std::array<std::string_view, 12> keywords{"v", "vt", "vn", "f",      "g",      "o",
                                                      "s", "l",  "p",  "usemtl", "mtllib", "vp"};
  bool geometry = false;
  int lines = 0;
  while (!text.empty() && lines < 200) {
    const std::size_t newline = text.find_first_of("\r\n");
    const std::string_view line = trimmed(text.substr(0, newline));
    text.remove_prefix(newline == std::string_view::npos ? text.size() : newline + 1);
    if (line.empty() || line.front() == '#') continue;
    const std::string_view keyword = line.substr(0, line.find_first_of(" \t"));
    if (std::ranges::find(keywords, keyword) == keywords.end()) return geometry && lines > 3;
    geometry = geometry || keyword == "v" || keyword == "f";
    ++lines;
  }
  return geometry;
}

std::optional<MeshFormat> mesh_format_of_content(ByteView bytes) {
  std::string_view text = as_text(bytes);
  if (text.starts_with("glTF")) return MeshFormat::glb;
  if (text.starts_with("PK\x03\x04") || text.starts_with("PK\x05\x06")) return MeshFormat::three_mf;
  if (text.starts_with("ply") && text.size() > 3 && is_space(text[3])) return MeshFormat::ply;
  if (has_binary_stl_size(bytes)) return MeshFormat::stl;
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  text = trimmed(text.substr(0, 100'000));
  if (equal_ignoring_case(text.substr(0, 5), "solid") && (text.size() == 5 || is_space(text[5])))
    return MeshFormat::stl;
  if (text.starts_with("{") && text.find("\"asset\"") != std::string_view::npos) return MeshFormat::glb;
  if (looks_like_obj(text)) return MeshFormat::obj;
  return std::nullopt;
}

}  // namespace

std::optional<MeshFormat> mesh_format_of_extension(std::string_view file_name) {
  const std::string_view extension = file_name.substr(file_name.find_last_of('.') + 1);  // npos + 1 = 0
  for (const auto& info : mesh_formats)
    if (equal_ignoring_case(extension, info.extension)) return info.format;
  if (equal_ignoring_case(extension, "gltf")) return MeshFormat::glb;
  return std::nullopt;
}

MeshFormat detect_mesh_format(ByteView bytes, std::string_view file_name, std::string_view where) {
  const auto refuse = [&](const std::string& what) {
    throw Error(ErrorCode::invalid_input, std::string(where),
                clean_text(file_name.empty() ? "The file" : file_name) + ": " + what);
  };
  if (bytes.empty()) refuse("it is empty; export the model again.");
  if (const auto format = mesh_format_of_content(bytes)) return *format;
  const std::string_view text = as_text(bytes);
  for (const auto& foreign : foreign_formats)
    if (text.starts_with(foreign.start))
      refuse("this is " + std::string(foreign.name) +
             ", which is not read here; export the model as OBJ, STL, PLY, GLB or 3MF.");
  if (const auto format = mesh_format_of_extension(file_name)) return *format;
  refuse("this is not a mesh that can be read here; export the model as OBJ, STL, PLY, GLB or 3MF.");
  return MeshFormat::obj;  // never reached
}

bool has_binary_stl_size(ByteView bytes) {
  if (bytes.size() < stl_header_bytes) return false;
  const std::uint64_t declared = load<std::uint32_t>(bytes.data() + 80);
  return bytes.size() == stl_header_bytes + declared * stl_triangle_bytes;
}

}  // namespace formwright
