// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A triangle mesh as the papers write it: V (n x 3) and F (m x 3).
#include <Eigen/Core>
#include <string>
#include <vector>

#include "base/bytes.h"

namespace formwright {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Positions = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;  // one vertex a row
using Triangles = Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor>;     // one face a row
using TextureCoordinates = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;

/// Faces are counter-clockwise seen from outside. Lengths in millimetres unless said otherwise.
struct TriangleMesh {
  Positions V;
  Triangles F;

  int vertex_count() const { return static_cast<int>(V.rows()); }
  int face_count() const { return static_cast<int>(F.rows()); }
};

struct Texture {
  std::string name;        // as the file calls it
  std::string media_type;  // "image/png", "image/jpeg", "" when unknown
  Bytes bytes;             // encoded; empty when only the name is known (OBJ + MTL)
};

struct Material {
  std::string name;
  Vec3 diffuse{0.8, 0.8, 0.8};  // linear RGB, 0 to 1
  int diffuse_texture = -1;     // index into Model::textures, -1 for none
};

/// A mesh with whatever else a file says about it. Every optional matrix is empty when absent.
struct Model {
  TriangleMesh mesh;
  TextureCoordinates UV;     // one texture vertex a row, v upwards (OBJ convention)
  Triangles FT;              // per face, rows of UV; empty or m x 3
  Positions vertex_colours;  // n x 3, linear RGB 0 to 1
  std::vector<std::string> group_names;
  std::vector<int> face_group;  // per face, index into group_names, -1 for none
  std::vector<Material> materials;
  std::vector<int> face_material;  // per face, index into materials, -1 for none
  std::vector<Texture> textures;
};

}  // namespace formwright
