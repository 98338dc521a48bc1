// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/placement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>

#include "base/error.h"

namespace formwright {
namespace {

Vec3 box_middle(const Positions& V) { return 0.5 * (V.colwise().minCoeff() + V.colwise().maxCoeff()).transpose(); }

/// Indices of a list that is appended to another: those that name nothing stay so.
void append_shifted(std::vector<int>& all, const std::vector<int>& more, std::size_t faces, int shift) {
  if (more.empty()) {
    all.insert(all.end(), faces, -1);
    return;
  }
  for (const int index : more) all.push_back(index < 0 ? -1 : index + shift);
}

}  // namespace

Positions placed(const Positions& V, const Placement& placement) {
  if (V.rows() == 0) throw Error(ErrorCode::invalid_input, "mesh", "The model has no vertices: choose another file.");
  const double longest = (V.colwise().maxCoeff() - V.colwise().minCoeff()).maxCoeff();
  if (!(longest > 0))
    throw Error(ErrorCode::invalid_input, "mesh", "All points of the model are in one place: choose another file.");
  const Vec3 angle = placement.turn_deg * (std::numbers::pi / 180);
  const Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(angle.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(angle.y(), Vec3::UnitY()) *
       Eigen::AngleAxisd(angle.x(), Vec3::UnitX()))
          .toRotationMatrix();
  const Eigen::RowVector3d middle = box_middle(V).transpose();
  // Reduced first, so that no product is larger than the result.
  Positions turned = ((V.rowwise() - middle) / longest) * turn.transpose();
  const Eigen::RowVector3d shift = placement.at_mm.transpose() - placement.size_mm * box_middle(turned).transpose();
  turned *= placement.size_mm;
  turned.rowwise() += shift;
  return turned;
}

Model joined(std::span<const Model> models, std::span<const std::string> names) {
  Model all;
  Eigen::Index vertices = 0, faces = 0, texture_vertices = 0;
  bool coloured = false, textured = false;
  for (const Model& model : models) {
    vertices += model.mesh.V.rows();
    faces += model.mesh.F.rows();
    texture_vertices += model.FT.rows() > 0 ? model.UV.rows() : 1;
    coloured = coloured || model.vertex_colours.rows() > 0;
    textured = textured || model.FT.rows() > 0;
  }
  all.mesh.V.resize(vertices, 3);
  all.mesh.F.resize(faces, 3);
  if (coloured) all.vertex_colours.setOnes(vertices, 3);
  // A model without pictures has one texture vertex for all its corners.
  if (textured) all.UV.setZero(texture_vertices, 2), all.FT.setZero(faces, 3);
  Eigen::Index v = 0, f = 0, t = 0;
  for (std::size_t k = 0; k < models.size(); ++k) {
    const Model& model = models[k];
    const Eigen::Index n = model.mesh.V.rows(), m = model.mesh.F.rows();
    all.mesh.V.middleRows(v, n) = model.mesh.V;
    all.mesh.F.middleRows(f, m) = model.mesh.F.array() + static_cast<int>(v);
    if (model.vertex_colours.rows() > 0) all.vertex_colours.middleRows(v, n) = model.vertex_colours;
    if (textured) {
      const bool own = model.FT.rows() > 0;
      if (own) {
        all.UV.middleRows(t, model.UV.rows()) = model.UV;
        all.FT.middleRows(f, m) = model.FT.array() + static_cast<int>(t);
      } else {
        all.FT.middleRows(f, m).setConstant(static_cast<int>(t));
      }
      t += own ? model.UV.rows() : 1;
    }
    const auto faces_here = static_cast<std::size_t>(m);
    const auto textures = static_cast<int>(all.textures.size()), materials = static_cast<int>(all.materials.size());
    all.face_group.insert(all.face_group.end(), faces_here, static_cast<int>(k));
    all.group_names.push_back(names[k]);
    append_shifted(all.face_material, model.face_material, faces_here, materials);
    for (Material material : model.materials) {
      if (material.diffuse_texture >= 0) material.diffuse_texture += textures;
      all.materials.push_back(std::move(material));
    }
    all.textures.insert(all.textures.end(), model.textures.begin(), model.textures.end());
    v += n;
    f += m;
  }
  if (all.materials.empty()) all.face_material.clear();
  return all;
}

}  // namespace formwright
