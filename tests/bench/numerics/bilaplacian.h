// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Matrices of the size and kind that the relief solver factors: L^T A^-1 L + epsilon A on a triangle mesh,
// with the cotangent Laplacian L and lumped areas A (about 19 entries a row, the two-ring of a vertex).
#include <Eigen/Geometry>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace formwright::bench {

inline TriangleMesh read_obj(const std::string& path) {
  std::ifstream file(path);
  std::vector<double> xyz;
  std::vector<int> corners;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      for (double x; xyz.size() % 3 != 2 || !xyz.empty();) {
        if (!(words >> x)) break;
        xyz.push_back(x);
      }
    } else if (word == "f") {
      for (int k = 0; k < 3 && words >> word; ++k) corners.push_back(std::stoi(word) - 1);
    }
  }
  TriangleMesh mesh;
  mesh.V = Eigen::Map<const Positions>(xyz.data(), static_cast<Eigen::Index>(xyz.size() / 3), 3);
  mesh.F = Eigen::Map<const Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
  return mesh;
}

/// Every triangle becomes four.
inline TriangleMesh subdivide(const TriangleMesh& mesh) {
  std::unordered_map<std::uint64_t, int> middle;
  std::vector<std::array<int, 2>> edges;
  const auto midpoint = [&](int a, int b) {
    const auto key = (static_cast<std::uint64_t>(std::min(a, b)) << 32) | static_cast<std::uint64_t>(std::max(a, b));
    const auto [it, fresh] = middle.try_emplace(key, mesh.vertex_count() + static_cast<int>(edges.size()));
    if (fresh) edges.push_back({a, b});
    return it->second;
  };
  TriangleMesh fine;
  fine.F.resize(4 * mesh.F.rows(), 3);
  for (int f = 0; f < mesh.face_count(); ++f) {
    const int a = mesh.F(f, 0), b = mesh.F(f, 1), c = mesh.F(f, 2);
    const int ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
    fine.F.row(4 * f) << a, ab, ca;
    fine.F.row(4 * f + 1) << ab, b, bc;
    fine.F.row(4 * f + 2) << ca, bc, c;
    fine.F.row(4 * f + 3) << ab, bc, ca;
  }
  fine.V.resize(mesh.V.rows() + static_cast<Eigen::Index>(edges.size()), 3);
  fine.V.topRows(mesh.V.rows()) = mesh.V;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    fine.V.row(mesh.V.rows() + static_cast<Eigen::Index>(e)) = 0.5 * (mesh.V.row(edges[e][0]) + mesh.V.row(edges[e][1]));
  }
  return fine;
}

/// A bumpy closed surface of 10 f^2 + 2 vertices: an icosahedron whose edges are cut into f pieces.
inline TriangleMesh bumpy_sphere(int f) {
  const double g = std::numbers::phi;
  const std::array<std::array<double, 3>, 12> p{{{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0}, {0, -1, g}, {0, 1, g},
                                                {0, -1, -g}, {0, 1, -g}, {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}}};
  const std::array<std::array<int, 3>, 20> t{{{0, 11, 5}, {0, 5, 1}, {0, 1, 7}, {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                                             {11, 10, 2}, {10, 7, 6}, {7, 1, 8}, {3, 9, 4}, {3, 4, 2}, {3, 2, 6}, {3, 6, 8},
                                             {3, 8, 9}, {4, 9, 5}, {2, 4, 11}, {6, 2, 10}, {8, 6, 7}, {9, 8, 1}}};
  std::map<std::array<int, 6>, int> known;  // corners with their weights, sorted
  std::vector<std::array<double, 3>> points;
  std::vector<std::array<int, 3>> faces;
  for (const auto& face : t) {
    const auto point = [&](int i, int j) {
      const int k = f - i - j;
      std::array<std::pair<int, int>, 3> w{{{face[0], i}, {face[1], j}, {face[2], k}}};
      for (auto& [corner, weight] : w) corner = weight == 0 ? -1 : corner;
      std::sort(w.begin(), w.end());
      const auto [it, fresh] = known.try_emplace({w[0].first, w[0].second, w[1].first, w[1].second, w[2].first, w[2].second},
                                                 static_cast<int>(points.size()));
      if (fresh) {
        Vec3 x(0, 0, 0);
        for (const auto& [corner, weight] : w) {
          if (corner >= 0) {
            const auto& q = p[static_cast<std::size_t>(corner)];
            x += weight * Vec3(q[0], q[1], q[2]);
          }
        }
        x.normalize();
        x *= 1 + 0.15 * std::sin(5 * x[0] + 1) * std::sin(6 * x[1]) * std::cos(4 * x[2]);
        points.push_back({x[0], x[1], x[2]});
      }
      return it->second;
    };
    for (int i = 0; i < f; ++i) {
      for (int j = 0; i + j < f; ++j) {
        faces.push_back({point(i, j), point(i + 1, j), point(i, j + 1)});
        if (i + j + 1 < f) faces.push_back({point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)});
      }
    }
  }
  TriangleMesh mesh;
  mesh.V.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    mesh.V.row(static_cast<Eigen::Index>(i)) << points[i][0], points[i][1], points[i][2];
  }
  mesh.F.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    mesh.F.row(static_cast<Eigen::Index>(i)) << faces[i][0], faces[i][1], faces[i][2];
  }
  return mesh;
}

/// Lower triangle of L^T A^-1 L + epsilon A, areas scaled to a mean of one.
inline Eigen::SparseMatrix<double> bilaplacian(const TriangleMesh& mesh, double epsilon = 1e-4) {
  const int n = mesh.vertex_count();
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd area = Eigen::VectorXd::Zero(n);
  for (int f = 0; f < mesh.face_count(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int i = mesh.F(f, k), a = mesh.F(f, (k + 1) % 3), b = mesh.F(f, (k + 2) % 3);
      const Vec3 u = mesh.V.row(a) - mesh.V.row(i), v = mesh.V.row(b) - mesh.V.row(i);
      const double twice_area = std::max(u.cross(v).norm(), 1e-30);
      const double w = 0.5 * std::clamp(u.dot(v) / twice_area, -20.0, 20.0);
      area[i] += twice_area / 6;
      entries.emplace_back(a, b, w);
      entries.emplace_back(b, a, w);
      entries.emplace_back(a, a, -w);
      entries.emplace_back(b, b, -w);
    }
  }
  area /= area.mean();
  area = area.cwiseMax(1e-3);
  Eigen::SparseMatrix<double> laplacian(n, n), mass(n, n);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  mass = area.asDiagonal();
  Eigen::SparseMatrix<double> scaled = area.cwiseInverse().cwiseSqrt().asDiagonal() * laplacian;
  Eigen::SparseMatrix<double> energy = scaled.transpose() * scaled;
  energy += epsilon * mass;
  Eigen::SparseMatrix<double> lower = energy.triangularView<Eigen::Lower>();
  lower.makeCompressed();
  return lower;
}

}  // namespace formwright::bench
