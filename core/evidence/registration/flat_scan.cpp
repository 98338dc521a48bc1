// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/registration/flat_scan.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "geometry/planar/plane.h"
#include "base/error.h"
#include "base/parallel.h"
#include "geometry/mesh/adjacency.h"
#include "numerics/sparse/sparse_cholesky.h"

namespace formwright {
namespace {

using Frame = Eigen::Matrix<double, 3, 2>;  // a triangle's corners in its own plane

Frame own_plane(const TriangleMesh& mesh, int f) {
  const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)), c = mesh.V.row(mesh.F(f, 2));
  const Vec3 ab = b - a, ac = c - a;
  const double length = ab.norm(), along = length > 0 ? ac.dot(ab) / length : 0,
               height = length > 0 ? ab.cross(ac).norm() / length : 0;
  Frame frame;
  frame << 0, 0, length, 0, along, height;
  return frame;
}

double face_area(const TriangleMesh& mesh, int f) {
  const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)), c = mesh.V.row(mesh.F(f, 2));
  return 0.5 * (b - a).cross(c - a).norm();
}

std::vector<int> longest_border(const TriangleMesh& mesh, const Adjacency& adjacency) {
  std::vector<int> longest;
  double maximum = -1;
  for (auto& loop : boundary_loops(adjacency)) {
    double length = 0;
    for (std::size_t i = 0; i < loop.size(); ++i)
      length += (mesh.V.row(loop[i]) - mesh.V.row(loop[(i + 1) % loop.size()])).norm();
    if (length > maximum) {
      maximum = length;
      longest = std::move(loop);
    }
  }
  return longest;
}

bool crosses_itself(const std::vector<Vec2>& loop) {
  const auto side = [](const Vec2& a, const Vec2& b, const Vec2& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
  };
  const std::size_t n = loop.size();
  // Sorted by x, so that only neighbours in x are compared.
  std::vector<std::size_t> order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = i;
  const auto left = [&](std::size_t i) { return std::min(loop[i].x(), loop[(i + 1) % n].x()); };
  const auto right = [&](std::size_t i) { return std::max(loop[i].x(), loop[(i + 1) % n].x()); };
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return left(a) < left(b) || (left(a) == left(b) && a < b); });
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n && left(order[j]) <= right(order[i]); ++j) {
      const std::size_t p = order[i], q = order[j];
      if ((p + 1) % n == q || (q + 1) % n == p) continue;
      const Vec2 &a = loop[p], &b = loop[(p + 1) % n], &c = loop[q], &d = loop[(q + 1) % n];
      if (side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0) return true;
    }
  return false;
}

/// Places of the border's vertices: their shadow along the loop's area vector, or by arc length on a circle.
std::vector<Vec2> border_places(const TriangleMesh& mesh, const std::vector<int>& border) {
  const std::size_t n = border.size();
  Vec3 middle = Vec3::Zero(), normal = Vec3::Zero();
  for (const int v : border) middle += mesh.V.row(v).transpose() / static_cast<double>(n);
  double length = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 a = mesh.V.row(border[i]), b = mesh.V.row(border[(i + 1) % n]);
    normal += (a - middle).cross(b - middle);
    length += (b - a).norm();
  }
  std::vector<Vec2> places(n);
  if (normal.norm() > 1e-3 * length * length / 12) {
    normal.normalize();
    const Vec3 x = (std::abs(normal.x()) < 0.8 ? Vec3::UnitX() : Vec3::UnitY()).cross(normal).normalized(),
               y = normal.cross(x);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 d = mesh.V.row(border[i]).transpose() - middle;
      places[i] = {d.dot(x), d.dot(y)};
    }
    if (!crosses_itself(places)) return places;
  }
  double along = 0;
  const double radius = length / (2 * 3.14159265358979324);
  for (std::size_t i = 0; i < n; ++i) {
    places[i] = radius * Vec2(std::cos(along / radius), std::sin(along / radius));
    along += (mesh.V.row(border[i]) - mesh.V.row(border[(i + 1) % n])).norm();
  }
  return places;
}

/// L with every row and column of `fixed` replaced by the unit one; the rest's coupling to them is given back.
/// `regular` is added to the diagonal.
SparseMatrix without_fixed(const SparseMatrix& full, const std::vector<char>& fixed,
                           std::vector<Eigen::Triplet<double>>& coupling, double regular) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int column = 0; column < full.outerSize(); ++column)
    for (SparseMatrix::InnerIterator it(full, column); it; ++it) {
      const int row = static_cast<int>(it.row());
      const bool row_fixed = fixed[static_cast<std::size_t>(row)] != 0,
                 column_fixed = fixed[static_cast<std::size_t>(column)] != 0;
      if (!row_fixed && column_fixed) coupling.emplace_back(row, column, it.value());
      if (row < column || row_fixed != column_fixed || (row_fixed && row != column)) continue;
      entries.emplace_back(row, column, row_fixed ? 1.0 : it.value() + (row == column ? regular : 0.0));
    }
  SparseMatrix lower(full.rows(), full.cols());
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

Eigen::MatrixXd harmonic(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& border,
                         const std::vector<Vec2>& places, Context& context) {
  SparseMatrix laplacian(mesh.vertex_count(), mesh.vertex_count());
  std::vector<Eigen::Triplet<double>> entries;
  for (const Edge& e : adjacency.edges()) {
    // Cotangents held positive: the shape of the surface counts, and the maximum principle still holds.
    double weight = 0;
    for (const int h : adjacency.halfedges_of_edge(adjacency.find_edge(e.lower, e.higher))) {
      const Vec3 a = mesh.V.row(adjacency.from(h)), b = mesh.V.row(adjacency.to(h)),
                 c = mesh.V.row(adjacency.from(previous_halfedge(h)));
      weight += 0.5 * (a - c).dot(b - c) / std::max(1e-12, (a - c).cross(b - c).norm());
    }
    weight = std::clamp(weight, 0.05, 20.0);
    entries.emplace_back(e.lower, e.higher, -weight);
    entries.emplace_back(e.higher, e.lower, -weight);
    entries.emplace_back(e.lower, e.lower, weight);
    entries.emplace_back(e.higher, e.higher, weight);
  }
  laplacian.setFromTriplets(entries.begin(), entries.end());
  std::vector<char> fixed(static_cast<std::size_t>(mesh.vertex_count()), 0);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(mesh.vertex_count(), 2);
  for (std::size_t i = 0; i < border.size(); ++i) {
    fixed[static_cast<std::size_t>(border[i])] = 1;
    right.row(border[i]) = places[i];
  }
  std::vector<Eigen::Triplet<double>> coupling;
  const SparseMatrix lower = without_fixed(laplacian, fixed, coupling, 0);
  Eigen::MatrixXd moved = right;
  for (const auto& entry : coupling) moved.row(entry.row()) -= entry.value() * right.row(entry.col());
  SparseCholesky cholesky;
  cholesky.analyze(lower, mesh.V, context);
  cholesky.factorize(lower, context);
  cholesky.solve(moved);
  return moved;
}

}  // namespace

ScanPart sheet_part(const Model& model) {
  const Adjacency adjacency(model.mesh);
  const Components parts = face_components(adjacency);
  std::vector<double> area(static_cast<std::size_t>(parts.count), 0);
  for (int f = 0; f < model.mesh.face_count(); ++f)
    area[static_cast<std::size_t>(parts.of[static_cast<std::size_t>(f)])] += face_area(model.mesh, f);
  std::vector<int> order(area.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return area[static_cast<std::size_t>(a)] > area[static_cast<std::size_t>(b)]; });
  for (std::size_t rank = 0; rank < std::min<std::size_t>(order.size(), 10); ++rank) {
    std::vector<int> faces, vertex(static_cast<std::size_t>(model.mesh.vertex_count()), -1), vertices;
    for (int f = 0; f < model.mesh.face_count(); ++f)
      if (parts.of[static_cast<std::size_t>(f)] == order[rank]) faces.push_back(f);
    ScanPart part;
    Model& out = part.model;
    const auto count = static_cast<Eigen::Index>(faces.size());
    out.mesh.F.resize(count, 3);
    for (Eigen::Index i = 0; i < count; ++i)
      for (int k = 0; k < 3; ++k) {
        int& index = vertex[static_cast<std::size_t>(model.mesh.F(faces[static_cast<std::size_t>(i)], k))];
        if (index < 0) {
          index = static_cast<int>(vertices.size());
          vertices.push_back(model.mesh.F(faces[static_cast<std::size_t>(i)], k));
        }
        out.mesh.F(i, k) = index;
      }
    out.mesh.V = model.mesh.V(vertices, Eigen::all);
    const Adjacency own(out.mesh);
    const auto loops = static_cast<int>(boundary_loops(own).size());
    if (loops == 0 || genus(own) != 0) continue;
    out.UV = model.UV;
    if (model.FT.rows() > 0) out.FT = model.FT(faces, Eigen::all);
    if (model.vertex_colours.rows() > 0) out.vertex_colours = model.vertex_colours(vertices, Eigen::all);
    out.materials = model.materials;
    out.textures = model.textures;
    if (!model.face_material.empty())
      for (const int f : faces) out.face_material.push_back(model.face_material[static_cast<std::size_t>(f)]);
    part.other_parts = parts.count - 1;
    part.holes = loops - 1;
    if (rank > 0)
      part.notes.push_back(
          "The scan's largest part is closed or has handles, so it is not a sheet; the next one that is was taken.");
    if (part.other_parts > 0)
      part.notes.push_back(std::to_string(part.other_parts) +
                           (part.other_parts == 1 ? " smaller part" : " smaller parts") +
                           " of the scan, not joined to the sheet, were left out.");
    if (part.holes > 0)
      part.notes.push_back("The scan has " + std::to_string(part.holes) + (part.holes == 1 ? " hole" : " holes") +
                           ", which stay without points.");
    return part;
  }
  throw Error(
      ErrorCode::invalid_input, "scan",
      "The scan is closed or has handles, so it cannot be laid flat: trim it to the outer face of the sheet, with one border.");
}

FlatScan flatten(const TriangleMesh& mesh, int iterations, Context& context) {
  const Adjacency adjacency(mesh);
  const std::vector<int> border = longest_border(mesh, adjacency);
  if (border.size() < 3)
    throw Error(ErrorCode::invalid_input, "scan",
                "The scan has no border, so it cannot be laid flat: trim it to the outer face of the sheet.");
  context.progress(0, "Laying the scan flat");
  Eigen::MatrixXd place = harmonic(mesh, adjacency, border, border_places(mesh, border), context);
  context.progress(0.3);

  const int faces = mesh.face_count();
  std::vector<Frame> frames(static_cast<std::size_t>(faces));
  std::vector<Vec3> cotangents(static_cast<std::size_t>(faces));
  std::vector<double> area(static_cast<std::size_t>(faces));
  for (int f = 0; f < faces; ++f) {
    const auto i = static_cast<std::size_t>(f);
    frames[i] = own_plane(mesh, f);
    area[i] = 0.5 * frames[i](1, 0) * frames[i](2, 1);
    for (int k = 0; k < 3; ++k) {
      const Vec2 a = frames[i].row((k + 1) % 3) - frames[i].row(k), b = frames[i].row((k + 2) % 3) - frames[i].row(k);
      const double twice_area = cross(a, b);
      cotangents[i][k] = twice_area > 0 ? a.dot(b) / twice_area : 0;
    }
    // A sliver counts less, all its cotangents together, so that its energy stays positive.
    const double largest = cotangents[i].cwiseAbs().maxCoeff();
    if (!std::isfinite(largest)) cotangents[i].setZero();
    else if (largest > 20) cotangents[i] *= 20 / largest;
  }
  // Global steps share one factor: the Laplacian of these cotangents with one vertex held.
  std::vector<Eigen::Triplet<double>> entries;
  for (int f = 0; f < faces; ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.F(f, (k + 1) % 3), b = mesh.F(f, (k + 2) % 3);
      const double weight = 0.5 * cotangents[static_cast<std::size_t>(f)][k];
      entries.emplace_back(a, b, -weight);
      entries.emplace_back(b, a, -weight);
      entries.emplace_back(a, a, weight);
      entries.emplace_back(b, b, weight);
    }
  SparseMatrix laplacian(mesh.vertex_count(), mesh.vertex_count());
  laplacian.setFromTriplets(entries.begin(), entries.end());
  std::vector<char> fixed(static_cast<std::size_t>(mesh.vertex_count()), 0);
  fixed[static_cast<std::size_t>(border[0])] = 1;
  std::vector<Eigen::Triplet<double>> coupling;
  SparseCholesky cholesky;
  const SparseMatrix lower = without_fixed(laplacian, fixed, coupling, 1e-9);
  cholesky.analyze(lower, mesh.V, context);
  cholesky.factorize(lower, context);
  FlatScan flat;
  std::vector<Eigen::Matrix2d> rotation(static_cast<std::size_t>(faces));
  const auto jacobian_sums = [&](int f) {  // sum of cot (p_j - p_k) (x_j - x_k)^T, which the best rotation comes from
    const auto i = static_cast<std::size_t>(f);
    Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
    for (int k = 0; k < 3; ++k) {
      const int a = (k + 1) % 3, b = (k + 2) % 3;
      const Vec2 p = place.row(mesh.F(f, a)) - place.row(mesh.F(f, b)), x = frames[i].row(a) - frames[i].row(b);
      sum += cotangents[i][k] * p * x.transpose();
    }
    return sum;
  };
  double change_mm = 1e300;
  const double size_mm = (mesh.V.colwise().maxCoeff() - mesh.V.colwise().minCoeff()).norm();
  for (; flat.iterations < iterations && change_mm > 1e-4 * size_mm; ++flat.iterations) {
    context.progress(0.4 + 0.6 * flat.iterations / iterations);
    parallel_for(static_cast<std::size_t>(faces), 8192, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Eigen::Matrix2d s = jacobian_sums(static_cast<int>(i));
        // The nearest rotation of a 2 x 2 matrix is its direction as a complex number.
        const Vec2 direction(s(0, 0) + s(1, 1), s(1, 0) - s(0, 1));
        const double norm = direction.norm();
        const Vec2 c = norm > 0 ? Vec2(direction / norm) : Vec2(1, 0);
        rotation[i] << c.x(), -c.y(), c.y(), c.x();
      }
    });
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(mesh.vertex_count(), 2);
    for (int f = 0; f < faces; ++f) {
      const auto i = static_cast<std::size_t>(f);
      for (int k = 0; k < 3; ++k) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        const Vec2 pull = 0.5 * cotangents[i][k] * rotation[i] * (frames[i].row(a) - frames[i].row(b)).transpose();
        right.row(mesh.F(f, a)) += pull;
        right.row(mesh.F(f, b)) -= pull;
      }
    }
    for (const auto& entry : coupling) right.row(entry.row()) -= entry.value() * place.row(entry.col());
    right.row(border[0]) = place.row(border[0]);
    cholesky.solve(right);
    change_mm = (right - place).rowwise().norm().maxCoeff();
    place = right;
  }
  double stretch_squared = 0, total = 0;
  for (int f = 0; f < faces; ++f) {
    const auto i = static_cast<std::size_t>(f);
    Eigen::Matrix2d now, then;
    now << (place.row(mesh.F(f, 1)) - place.row(mesh.F(f, 0))).transpose(),
        (place.row(mesh.F(f, 2)) - place.row(mesh.F(f, 0))).transpose();
    then << (frames[i].row(1) - frames[i].row(0)).transpose(), (frames[i].row(2) - frames[i].row(0)).transpose();
    if (now.determinant() <= 0) ++flat.flipped;
    if (then.determinant() < 1e-12 * size_mm * size_mm) continue;
    const Eigen::Vector2d s = (now * then.inverse()).jacobiSvd().singularValues();
    stretch_squared += area[i] * ((s[0] - 1) * (s[0] - 1) + (s[1] - 1) * (s[1] - 1)) / 2;
    total += area[i];
  }
  flat.stretch_rms = total > 0 ? std::sqrt(stretch_squared / total) : 0;
  flat.place_mm = place;
  return flat;
}

}  // namespace formwright
