// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A painting as a file: JSON that the page writes, or numbers of a model's vertices.
#include <string>

#include "job/contract/model_columns.h"
#include "relief/painting/painting.h"

namespace formwright {

/// Vertex properties of PLY; in glTF _WEIGHT, _REGION, _THICKNESS_MM, _CARVE_DEPTH_MM.
inline constexpr std::array<std::string_view, 4> painted_columns{"weight", "region", "thickness_mm", "carve_depth_mm"};

/// A painting whose values count the vertices of a file.
struct PaintingFile {
  int vertices = 0;
  Painting painting;
};

/// {"vertices": n, "weight": ..., "region": ..., "thickness_mm": ..., "carve_depth_mm": ...}. Each list has n values,
/// or runs [first vertex, number of vertices, value]; what no run names is not painted. Regions are numbers or names.
/// `vertex_counts`: those that `vertices` may be; `of`: what has so many, for the sentence.
/// Throws Error{invalid_input, where}: see check_painting; text that is not of this form; another number of vertices.
PaintingFile read_painting(ByteView text, const std::string& where, const std::string& file_name,
                           const std::vector<int>& vertex_counts, const std::string& of);

/// The painting that the columns of a model hold; empty without any. Throws as check_painting does, and for columns
/// with values that are not numbers.
Painting painting_of_columns(const ModelColumns& columns, const std::string& where, const std::string& file_name);

/// The same as columns, those that are there, with the values in force at every vertex.
std::vector<VertexColumn> columns_of_painting(const Painting& painting, double thickness_mm, double carve_depth_mm);

}  // namespace formwright
