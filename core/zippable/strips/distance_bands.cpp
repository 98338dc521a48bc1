// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/strips/distance_bands.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "geometry/mesh/adjacency.h"
#include "geometry/paths/geodesic_distance.h"

namespace formwright {
namespace {

Vec3 position(const TriangleMesh& mesh, int v) { return mesh.V.row(v).transpose(); }

/// Not normalised: twice the area long.
Vec3 area_normal(const TriangleMesh& mesh, int f) {
  return (position(mesh, mesh.F(f, 1)) - position(mesh, mesh.F(f, 0)))
      .cross(position(mesh, mesh.F(f, 2)) - position(mesh, mesh.F(f, 0)));
}

/// Numbers what is connected without crossing an edge for which `border(h)` holds.
template <class Border>
int number_components(const Adjacency& adjacency, const Border& border, std::vector<int>& label) {
  label.assign(std::size_t(adjacency.face_count()), -1);
  int count = 0;
  for (int f = 0; f < adjacency.face_count(); ++f) {
    if (label[f] >= 0) continue;
    label[f] = count;
    for (std::vector<int> open{f}; !open.empty();) {
      const int g = open.back();
      open.pop_back();
      for (int h = 3 * g; h < 3 * g + 3; ++h)
        if (const int o = adjacency.opposite(h); o >= 0 && label[o / 3] < 0 && !border(h))
          label[o / 3] = count, open.push_back(o / 3);
    }
    ++count;
  }
  return count;
}

/// Joins what is smaller than `min_area_mm2` to the neighbour along its longest border that `may(f, g)` be joined to,
/// the smallest first, and renumbers.
template <class May>
int join_small(const TriangleMesh& mesh, const Adjacency& adjacency, double min_area_mm2, const May& may,
               std::vector<int>& label, int count) {
  for (;;) {
    std::vector<double> area(std::size_t(count), 0.0);
    for (int f = 0; f < mesh.face_count(); ++f) area[label[f]] += area_normal(mesh, f).norm() / 2;
    std::vector<std::map<int, double>> beside(std::size_t(count), std::map<int, double>{});
    for (int h = 0; h < 3 * mesh.face_count(); ++h)
      if (const int o = adjacency.opposite(h); o >= 0 && label[h / 3] != label[o / 3] && may(h / 3, o / 3))
        beside[label[h / 3]][label[o / 3]] +=
            (position(mesh, adjacency.from(h)) - position(mesh, adjacency.to(h))).norm();
    int smallest = -1;
    for (int i = 0; i < count; ++i)
      if (area[i] < min_area_mm2 && !beside[i].empty() && (smallest < 0 || area[i] < area[smallest])) smallest = i;
    if (smallest < 0) return count;
    const auto into =
        std::max_element(beside[smallest].begin(), beside[smallest].end(), [](const auto& a, const auto& b) {
          return a.second < b.second;
        })->first;
    for (int& l : label) {
      if (l == smallest) l = into;
      if (l > smallest) --l;
    }
    --count;
  }
}

/// Cuts every face where the distance passes a multiple of its part's band width.
class BandCutter {
 public:
  BandCutter(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& part,
             const Eigen::VectorXd& distance, const std::vector<double>& width, const std::vector<int>& bands)
      : mesh_(mesh), adjacency_(adjacency), part_(part), distance_(distance), width_(width), bands_(bands) {
    for (int v = 0; v < mesh.vertex_count(); ++v) points_.push_back(position(mesh, v));
  }

  /// Slab of every new face in `slab`.
  Bands cut(std::vector<int>& slab) {
    Bands result;
    std::vector<std::array<int, 3>> faces;
    for (int f = 0; f < mesh_.face_count(); ++f) {
      const double width = width_[part_[f]];
      double low = 1e300, high = 0;
      for (int k = 0; k < 3; ++k)
        low = std::min(low, distance_[mesh_.F(f, k)]), high = std::max(high, distance_[mesh_.F(f, k)]);
      const int first = std::min(bands_[part_[f]] - 1, static_cast<int>(std::floor(low / width))),
                last = std::clamp(static_cast<int>(std::ceil(high / width)) - 1, first, bands_[part_[f]] - 1);
      for (int s = first; s <= last; ++s) {
        const std::vector<int> polygon = inside_slab(f, s, s == first, s == last);
        for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
          faces.push_back({polygon[0], polygon[k], polygon[k + 1]});
          slab.push_back(s);
          result.part.push_back(part_[f]);
        }
      }
    }
    result.mesh.V.resize(static_cast<Eigen::Index>(points_.size()), 3);
    for (std::size_t i = 0; i < points_.size(); ++i) result.mesh.V.row(static_cast<Eigen::Index>(i)) = points_[i];
    result.mesh.F.resize(static_cast<Eigen::Index>(faces.size()), 3);
    for (std::size_t i = 0; i < faces.size(); ++i)
      result.mesh.F.row(static_cast<Eigen::Index>(i)) << faces[i][0], faces[i][1], faces[i][2];
    return result;
  }

 private:
  std::vector<int> inside_slab(int f, int s, bool open_below, bool open_above) {
    const double width = width_[part_[f]], low = open_below ? -1 : s * width,
                 high = open_above ? 1e300 : (s + 1) * width;
    std::vector<int> polygon;
    for (int h = 3 * f; h < 3 * f + 3; ++h) {
      const int a = adjacency_.from(h), b = adjacency_.to(h);
      if (distance_[a] >= low && distance_[a] <= high) polygon.push_back(a);
      const bool up = distance_[a] < distance_[b];
      for (const int level : up ? std::array{s, s + 1} : std::array{s + 1, s}) {
        if ((level == s && open_below) || (level == s + 1 && open_above)) continue;
        if ((distance_[a] - level * width) * (distance_[b] - level * width) < 0)
          polygon.push_back(crossing(h, level, width));
      }
    }
    return polygon;
  }

  int crossing(int h, int level, double width) {
    int& number = crossings_.try_emplace({adjacency_.edge_of(h), level}, -1).first->second;
    if (number < 0) {
      const auto [a, b] = adjacency_.edges()[adjacency_.edge_of(h)];
      const double share = (level * width - distance_[a]) / (distance_[b] - distance_[a]);
      number = static_cast<int>(points_.size());
      points_.push_back(position(mesh_, a) + share * (position(mesh_, b) - position(mesh_, a)));
    }
    return number;
  }

  const TriangleMesh& mesh_;
  const Adjacency& adjacency_;
  const std::vector<int>& part_;
  const Eigen::VectorXd& distance_;
  const std::vector<double>& width_;
  const std::vector<int>& bands_;
  std::vector<Vec3> points_;
  std::map<std::pair<int, int>, int> crossings_;  // by edge and level
};

}  // namespace

Bands distance_bands(const TriangleMesh& mesh, const std::vector<int>& limb, double feature_degrees, double width_mm,
                     Context& context) {
  const Adjacency adjacency(mesh);
  const double maximum = std::cos(feature_degrees * std::numbers::pi / 180);
  std::vector<int> part;
  int parts = number_components(
      adjacency,
      [&](int h) {
        const int o = adjacency.opposite(h);
        const Vec3 a = area_normal(mesh, h / 3), b = area_normal(mesh, o / 3);
        return limb[h / 3] != limb[o / 3] || a.dot(b) < maximum * a.norm() * b.norm();
      },
      part);
  parts = join_small(
      mesh, adjacency, width_mm * width_mm, [](int, int) { return true; }, part, parts);
  context.check_cancelled();
  std::vector<int> sources;
  std::vector<char> is_source(std::size_t(mesh.vertex_count()), 0);
  for (int h = 0; h < 3 * mesh.face_count(); ++h) {
    const int o = adjacency.opposite(h);
    if (o >= 0 && part[o / 3] == part[h / 3]) continue;
    for (const int v : {adjacency.from(h), adjacency.to(h)})
      if (!is_source[v]) is_source[v] = 1, sources.push_back(v);
  }
  if (sources.empty()) {
    Eigen::Index outermost = 0;
    (mesh.V.rowwise() - mesh.V.colwise().mean()).rowwise().squaredNorm().maxCoeff(&outermost);
    sources.push_back(static_cast<int>(outermost));
  }
  Eigen::VectorXd distance = geodesic_distance_mm(mesh, adjacency, sources);
  std::vector<double> farthest(std::size_t(parts), 0.0), width(std::size_t(parts), width_mm);
  std::vector<int> bands(std::size_t(parts), 1);
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) farthest[part[f]] = std::max(farthest[part[f]], distance[mesh.F(f, k)]);
  for (int i = 0; i < parts; ++i) {
    bands[i] = std::max(1, static_cast<int>(std::lround(farthest[i] / width_mm)));
    if (farthest[i] > 0) width[i] = farthest[i] / bands[i];
  }
  // What lies just beside a band's border is moved onto it, lest slivers be cut.
  std::vector<int> part_of_vertex(std::size_t(mesh.vertex_count()), 0);
  double edges_mm = 0;
  for (const auto& [a, b] : adjacency.edges()) edges_mm += (position(mesh, a) - position(mesh, b)).norm();
  const double beside_mm = 0.1 * edges_mm / std::max(1, adjacency.edge_count());
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) part_of_vertex[mesh.F(f, k)] = part[f];
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const double w = width[part_of_vertex[v]], level = std::round(distance[v] / w);
    if (level >= 1 && std::abs(distance[v] - level * w) < beside_mm) distance[v] = level * w;
  }
  std::vector<int> slab;
  Bands result = BandCutter(mesh, adjacency, part, distance, width, bands).cut(slab);
  const Adjacency again(result.mesh);
  result.part_count = parts;
  result.band_count = number_components(
      again,
      [&](int h) {
        return slab[h / 3] != slab[again.opposite(h) / 3] || result.part[h / 3] != result.part[again.opposite(h) / 3];
      },
      result.band);
  const auto same_part = [&](int f, int g) { return result.part[f] == result.part[g]; };
  result.band_count =
      join_small(result.mesh, again, 0.25 * width_mm * width_mm, same_part, result.band, result.band_count);
  return result;
}

}  // namespace formwright
