// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Numbers of a model file's vertices beside the mesh, carried through its repair.
#include <string>
#include <vector>

#include "formats/shared/model_file.h"
#include "geometry/repair/repair.h"

namespace formwright {

struct ModelColumn {
  VertexColumn column;  // one value a vertex of the repaired mesh: that of the vertex which it stands for
  int lost = 0;         // vertices of the file whose value gave way to another one's at the same place
};

struct ModelColumns {
  std::vector<ModelColumn> columns;
  std::vector<std::string> not_numbers;  // names of columns that were left out: they hold values that are not numbers
  std::vector<int> file_vertex;          // per vertex of the repaired mesh: that of the file which it stands for
  int file_vertices = 0;

  const ModelColumn* find(std::string_view name) const;
  double megabytes() const;
};

/// `file`: as it was read, before its mesh was repaired.
ModelColumns carried_columns(const ModelFile& file, const RepairedMesh& repaired);

}  // namespace formwright
