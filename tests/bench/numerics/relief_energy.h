// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A realistic energy for benches: the relief seen along -z, so that u is a displacement in depth.
//   Q = L^T A^-1 L,  L the cotangent Laplacian (cotangents within +-20), A areas of at least 1e-3 of their mean.
#include <Eigen/Geometry>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/triangle_mesh.h"
#include "numerics/bounded_qp.h"

namespace formwright::bench {

/// Vertices and polygons (fanned) of an OBJ file; everything else is skipped.
inline TriangleMesh read_obj(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  std::vector<double> v;
  std::vector<int> f;
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key == "v") {
      double x = 0, y = 0, z = 0;
      words >> x >> y >> z;
      v.insert(v.end(), {x, y, z});
    } else if (key == "f") {
      std::vector<int> corner;
      for (std::string word; words >> word;) corner.push_back(std::stoi(word) - 1);
      for (std::size_t k = 2; k < corner.size(); ++k) f.insert(f.end(), {corner[0], corner[k - 1], corner[k]});
    }
  }
  TriangleMesh mesh;
  mesh.V = Eigen::Map<const Positions>(v.data(), static_cast<Eigen::Index>(v.size() / 3), 3);
  mesh.F = Eigen::Map<const Triangles>(f.data(), static_cast<Eigen::Index>(f.size() / 3), 3);
  return mesh;
}

/// Keeps the vertices that triangles use, scales the width (x) to 100 and turns the model by `turn_degrees` about y.
inline TriangleMesh prepare(TriangleMesh mesh, double turn_degrees) {
  std::vector<int> place(static_cast<std::size_t>(mesh.vertex_count()), -1);
  int used = 0;
  for (Eigen::Index k = 0; k < mesh.F.size(); ++k) {
    int& to = place[static_cast<std::size_t>(mesh.F.data()[k])];
    if (to < 0) to = used++;
    mesh.F.data()[k] = to;
  }
  Positions V(used, 3);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(turn_degrees * 3.14159265358979323846 / 180, Eigen::Vector3d::UnitY()).toRotationMatrix();
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (place[i] >= 0) V.row(place[i]) = (turn * mesh.V.row(static_cast<Eigen::Index>(i)).transpose()).transpose();
  }
  const double width = V.col(0).maxCoeff() - V.col(0).minCoeff();
  mesh.V = V * (100 / width);
  return mesh;
}

/// Splits every triangle in four and moves new vertices off the flat facets by a seeded bump of `relief` of the
/// local edge length, so that finer meshes carry finer detail, as scans do.
inline TriangleMesh subdivide(const TriangleMesh& mesh, double relief) {
  std::map<std::pair<int, int>, int> middle;
  std::vector<Vec3> V;
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) V.emplace_back(mesh.V.row(i));
  std::uint64_t state = 88172645463325252ULL;
  const auto random = [&] {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return static_cast<double>(state >> 11) * 0x1.0p-53 - 0.5;
  };
  const auto split = [&](int a, int b) {
    const auto [it, fresh] = middle.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<int>(V.size()));
    if (fresh) {
      const Vec3 pa = V[static_cast<std::size_t>(a)], pb = V[static_cast<std::size_t>(b)];
      V.push_back(0.5 * (pa + pb) + relief * (pb - pa).norm() * Vec3(random(), random(), random()));
    }
    return it->second;
  };
  TriangleMesh fine;
  fine.F.resize(4 * mesh.F.rows(), 3);
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const int a = mesh.F(f, 0), b = mesh.F(f, 1), c = mesh.F(f, 2);
    const int ab = split(a, b), bc = split(b, c), ca = split(c, a);
    fine.F.row(4 * f) << a, ab, ca;
    fine.F.row(4 * f + 1) << ab, b, bc;
    fine.F.row(4 * f + 2) << ca, bc, c;
    fine.F.row(4 * f + 3) << ab, bc, ca;
  }
  fine.V.resize(static_cast<Eigen::Index>(V.size()), 3);
  for (std::size_t i = 0; i < V.size(); ++i) fine.V.row(static_cast<Eigen::Index>(i)) = V[i];
  return fine;
}

/// Lower triangle of Q and barycentric areas.
inline std::pair<SparseMatrix, Eigen::VectorXd> relief_energy(const TriangleMesh& mesh) {
  const Eigen::Index n = mesh.V.rows();
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd area = Eigen::VectorXd::Zero(n);
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.F(f, k), b = mesh.F(f, (k + 1) % 3), c = mesh.F(f, (k + 2) % 3);
      const Vec3 e1 = mesh.V.row(b) - mesh.V.row(a), e2 = mesh.V.row(c) - mesh.V.row(a);
      const double twice = std::max(e1.cross(e2).norm(), 1e-300);
      area[a] += twice / 6;
      const double w = 0.5 * std::clamp(e1.dot(e2) / twice, -20.0, 20.0);
      entries.emplace_back(b, c, w);
      entries.emplace_back(c, b, w);
      entries.emplace_back(b, b, -w);
      entries.emplace_back(c, c, -w);
    }
  }
  area = area.cwiseMax(1e-3 * area.mean());
  SparseMatrix L(n, n);
  L.setFromTriplets(entries.begin(), entries.end());
  const SparseMatrix Q = SparseMatrix(L.transpose()) * area.cwiseInverse().asDiagonal() * L;
  SparseMatrix lower = Q.triangularView<Eigen::Lower>();
  return {lower, area};
}

inline std::vector<int> components_of(const TriangleMesh& mesh) {
  std::vector<int> parent(static_cast<std::size_t>(mesh.vertex_count()));
  for (std::size_t i = 0; i < parent.size(); ++i) parent[i] = static_cast<int>(i);
  const auto find = [&](int i) {
    while (parent[static_cast<std::size_t>(i)] != i) {
      auto& p = parent[static_cast<std::size_t>(i)];
      p = parent[static_cast<std::size_t>(p)];
      i = p;
    }
    return i;
  };
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    for (int k = 1; k < 3; ++k) {
      const int a = find(mesh.F(f, 0)), b = find(mesh.F(f, k));
      parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  }
  std::map<int, int> name;
  std::vector<int> component(parent.size());
  for (std::size_t i = 0; i < parent.size(); ++i) {
    component[i] = name.try_emplace(find(static_cast<int>(i)), static_cast<int>(name.size())).first->second;
  }
  return component;
}

/// A slab of `thickness_part` of the width: -z_i - T <= u_i - m <= -z_i. `visible` (empty: all) limits it.
inline BoundedQpConstraints slab(const TriangleMesh& mesh, const Eigen::VectorXd& area, double thickness_part,
                                 const std::vector<char>& visible) {
  const Eigen::Index n = mesh.V.rows();
  const double thickness = thickness_part * (mesh.V.col(0).maxCoeff() - mesh.V.col(0).minCoeff());
  BoundedQpConstraints c;
  c.upper = -mesh.V.col(2);
  c.lower = c.upper.array() - thickness;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!visible.empty() && !visible[static_cast<std::size_t>(i)]) {
      c.lower[i] = -std::numeric_limits<double>::infinity();
      c.upper[i] = std::numeric_limits<double>::infinity();
    }
  }
  c.lower_slope = c.upper_slope = Eigen::VectorXd::Ones(n);
  c.group.assign(static_cast<std::size_t>(n), 0);
  c.gauge = area / area.sum();
  return c;
}

}  // namespace formwright::bench
