// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/contract/model_columns.h"

#include <algorithm>
#include <array>
#include <map>

namespace formwright {
namespace {

/// Per vertex of the file, the first one at the same place.
std::vector<int> first_at_place(const Positions& V) {
  std::map<std::array<double, 3>, int> places;
  std::vector<int> first;
  for (int i = 0; i < V.rows(); ++i) first.push_back(places.try_emplace({V(i, 0), V(i, 1), V(i, 2)}, i).first->second);
  return first;
}

}  // namespace

const ModelColumn* ModelColumns::find(std::string_view name) const {
  const auto found = std::ranges::find_if(columns, [&](const ModelColumn& c) { return c.column.name == name; });
  return found == columns.end() ? nullptr : &*found;
}

double ModelColumns::megabytes() const {
  double bytes = static_cast<double>(file_vertex.size() * sizeof(int));
  for (const ModelColumn& column : columns) bytes += static_cast<double>(column.column.values.size()) * sizeof(double);
  return bytes * 1e-6;
}

ModelColumns carried_columns(const ModelFile& file, const RepairedMesh& repaired) {
  ModelColumns result;
  result.not_numbers = file.columns_not_numbers;
  result.file_vertex = repaired.vertex_of;
  result.file_vertices = file.model.mesh.vertex_count();
  if (file.columns.empty()) return result;
  const bool some_gone = repaired.mesh.vertex_count() < result.file_vertices;
  const std::vector<int> first = some_gone ? first_at_place(file.model.mesh.V) : std::vector<int>();
  for (const VertexColumn& column : file.columns) {
    ModelColumn carried;
    carried.column = {column.name, column.values(repaired.vertex_of), column.kind};
    for (std::size_t i = 0; i < first.size(); ++i)
      carried.lost += column.values[static_cast<Eigen::Index>(i)] != column.values[first[i]];
    result.columns.push_back(std::move(carried));
  }
  return result;
}

}  // namespace formwright
