// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Models for the tests of readers and writers: generated, with texture seams, colours, columns, groups and materials.
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "formats/shared/model_file.h"

namespace formwright::test {

/// A closed wavy torus of rows x columns vertices, so that no two coordinates agree by accident; outward faces. The
/// texture coordinates have seams in both directions: (rows + 1) x (columns + 1) texture vertices.
inline Model wavy_torus(int rows, int columns) {
  Model model;
  const double tau = 2 * std::numbers::pi;
  model.mesh.V.resize(rows * columns, 3);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const double u = tau * i / rows, v = tau * j / columns, tube = 10 + std::sin(3 * u + 0.3) * std::cos(2 * v + 0.7);
      model.mesh.V.row(i * columns + j) << (30 + tube * std::cos(v)) * std::cos(u),
          (30 + tube * std::cos(v)) * std::sin(u), tube * std::sin(v) + 0.1;
    }
  model.UV.resize((rows + 1) * (columns + 1), 2);
  for (int i = 0; i <= rows; ++i)
    for (int j = 0; j <= columns; ++j)
      model.UV.row(i * (columns + 1) + j) << static_cast<double>(i) / rows, static_cast<double>(j) / columns;
  model.mesh.F.resize(2 * rows * columns, 3);
  model.FT.resize(2 * rows * columns, 3);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const auto vertex = [&](int a, int b) { return (a % rows) * columns + b % columns; };
      const auto texture = [&](int a, int b) { return a * (columns + 1) + b; };
      const int f = 2 * (i * columns + j);
      model.mesh.F.row(f) << vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1);
      model.mesh.F.row(f + 1) << vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1);
      model.FT.row(f) << texture(i, j), texture(i + 1, j), texture(i + 1, j + 1);
      model.FT.row(f + 1) << texture(i, j), texture(i + 1, j + 1), texture(i, j + 1);
    }
  return model;
}

/// Smooth colours that survive eight bits of sRGB to within half a step.
inline void add_colours(Model& model) {
  model.vertex_colours.resize(model.mesh.V.rows(), 3);
  for (Eigen::Index v = 0; v < model.mesh.V.rows(); ++v)
    for (int k = 0; k < 3; ++k) model.vertex_colours(v, k) = 0.5 + 0.5 * std::sin(0.05 * model.mesh.V(v, k) + k);
}

/// The smallest PNG: one red pixel. (Signature, IHDR, IDAT, IEND.)
inline Bytes red_pixel_png() {
  constexpr unsigned char bytes[] = {0x89, 'P',  'N',  'G',  '\r', '\n', 0x1a, '\n', 0,    0,    0,    13,   'I',  'H',
                                     'D',  'R',  0,    0,    0,    1,    0,    0,    0,    1,    8,    2,    0,    0,
                                     0,    0x90, 0x77, 0x53, 0xde, 0,    0,    0,    12,   'I',  'D',  'A',  'T',  0x08,
                                     0xd7, 0x63, 0xf8, 0xcf, 0xc0, 0,    0,    0x03, 0x01, 0x01, 0,    0x18, 0xdd, 0x8d,
                                     0xb0, 0,    0,    0,    0,    'I',  'E',  'N',  'D',  0xae, 0x42, 0x60, 0x82};
  const auto* const from = reinterpret_cast<const std::byte*>(bytes);
  return {from, from + sizeof bytes};
}

/// Two materials, the second with a picture, on the two halves of the faces; two groups likewise.
inline void add_materials_and_groups(Model& model) {
  model.textures.push_back({"red.png", "image/png", red_pixel_png()});
  model.materials.push_back({"grey", Vec3(0.25, 0.5, 0.75), -1});
  model.materials.push_back({"picture", Vec3(1, 1, 1), 0});
  model.group_names = {"front half", "back"};
  for (Eigen::Index f = 0; f < model.mesh.F.rows(); ++f) {
    const int half = 2 * f < model.mesh.F.rows() ? 0 : 1;
    model.face_material.push_back(half);
    model.face_group.push_back(half);
  }
}

inline std::vector<VertexColumn> sample_columns(const Model& model) {
  const auto n = model.mesh.V.rows();
  Eigen::VectorXd wave(n), flags(n);
  for (Eigen::Index v = 0; v < n; ++v)
    wave[v] = std::cos(0.01 * static_cast<double>(v)) / 3, flags[v] = static_cast<double>(v % 2);
  return {{"lambda_mm", wave, ColumnKind::float64},
          {"visible", flags, ColumnKind::uint8},
          {"error", wave, ColumnKind::float32},
          {"number", 1000 * flags, ColumnKind::int32}};
}

/// Sum of signed tetrahedra: positive for outward faces.
inline double signed_volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)), c = mesh.V.row(mesh.F(f, 2));
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

}  // namespace formwright::test
