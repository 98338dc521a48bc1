// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/mould/draft_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

#include "base/format.h"
#include "base/parallel.h"
#include "geometry/mesh/measures.h"
#include "geometry/queries/ray_caster.h"

namespace formwright {
namespace {

constexpr double to_degrees = 180 / std::numbers::pi;
constexpr int direction_count = 6;  // pairs of opposite directions, 30 degrees apart
constexpr double upright = 1e-9;    // of a unit normal: rounding tilts upright walls by less
constexpr double min_ratio = 0.1;   // flatter hollows are none
constexpr double floor_deg = 30;    // cavities are measured at their floors: upright creases have no width
constexpr double cavity_area_mm2 = 10;
constexpr double overhang_deg = -60;  // a wall that leans in further is a ceiling
constexpr std::size_t grain = 1024;

/// Angle between a plane and the vertical, exact at 0 and 90 where the normal is.
double draft_of(const Vec3& normal) { return std::atan2(normal.z(), std::hypot(normal.x(), normal.y())) * to_degrees; }

/// Faces that do not lie on the plate, and their vertices.
TriangleMesh without_base(const TriangleMesh& solid) {
  std::vector<int> fresh(static_cast<std::size_t>(solid.V.rows()), -1);
  TriangleMesh mesh{Positions(solid.V.rows(), 3), Triangles(solid.F.rows(), 3)};
  int vertices = 0, faces = 0;
  for (Eigen::Index f = 0; f < solid.F.rows(); ++f) {
    const auto face = solid.F.row(f);
    if (solid.V(face[0], 2) == 0 && solid.V(face[1], 2) == 0 && solid.V(face[2], 2) == 0) continue;
    for (int k = 0; k < 3; ++k) {
      int& index = fresh[static_cast<std::size_t>(face[k])];
      if (index < 0) {
        index = vertices++;
        mesh.V.row(index) = solid.V.row(face[k]);
      }
      mesh.F(faces, k) = index;
    }
    ++faces;
  }
  mesh.V.conservativeResize(vertices, 3);
  mesh.F.conservativeResize(faces, 3);
  return mesh;
}

/// Walls met outwards from a point: ever higher ones, with their distance.
struct Wall {
  double distance_mm, height_mm;
};
/// Only as far as walls could still make more of a cavity than `ratio`.
void climb(const HeightGrid& grid, const Vec3& p, const Vec2& direction, double ratio, std::vector<Wall>& walls) {
  walls.clear();
  double highest = p.z();
  const Vec2 end = grid.lower_mm + grid.pitch_mm * Vec2(grid.columns, grid.rows);
  const double reach = (grid.top_mm - p.z()) / ratio + 2 * grid.pitch_mm;
  for (double t = grid.pitch_mm; t < reach && highest < grid.top_mm; t += grid.pitch_mm) {
    const Vec2 q = p.head<2>() + t * direction;
    if (q.x() < grid.lower_mm.x() || q.y() < grid.lower_mm.y() || q.x() > end.x() || q.y() > end.y()) return;
    // The least height around comes half a cell late on average, the step another half.
    if (const double height = grid.min_around(q.x(), q.y()); height > highest) {
      highest = height;
      walls.push_back({std::max(t - grid.pitch_mm, 0.5 * grid.pitch_mm), height});
    }
  }
}

struct Side {
  const char* name;
  double x, y;
};
constexpr std::array<Side, 4> model_sides{{{"right", 1, 0}, {"left", -1, 0}, {"back", 0, 1}, {"front", 0, -1}}};

/// The depth to width that `cavity_area_mm2` of the grid together reach: single nodes in creases do not count.
void deepest_cavity(DraftMap& map, const HeightGrid& grid, double min_width_mm, Context& context) {
  const std::size_t count = grid.height_mm.size(), columns = static_cast<std::size_t>(grid.columns);
  const auto node = [&](std::size_t i) {
    return Vec3(grid.lower_mm.x() + grid.pitch_mm * static_cast<double>(i % columns),
                grid.lower_mm.y() + grid.pitch_mm * static_cast<double>(i / columns), grid.height_mm[i]);
  };
  std::vector<double> ratio(count, 0.0);
  parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (std::size_t i = begin; i < end; ++i)
      if (grid.height_mm[i] > 0) ratio[i] = depth_to_width_at(grid, node(i), min_width_mm);
  });
  const auto rank = static_cast<std::size_t>(std::ceil(cavity_area_mm2 / (grid.pitch_mm * grid.pitch_mm)));
  if (rank >= count) return;
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::ranges::nth_element(order, order.begin() + static_cast<std::ptrdiff_t>(rank), [&](std::size_t a, std::size_t b) {
    return ratio[a] != ratio[b] ? ratio[a] > ratio[b] : a < b;
  });
  map.depth_to_width_max = ratio[order[rank]];
  map.deepest_mm = node(order[rank]);
}

/// In a maker's words: which sides lock, where the sheet will not reach.
void describe(DraftMap& map, const Positions& normals, const Eigen::VectorXd& areas) {
  double locked = 0, hanging = 0;
  for (Eigen::Index f = 0; f < areas.size(); ++f)
    if (map.face_draft_deg[f] < overhang_deg) hanging += areas[f];
  if (hanging > 0.005 * map.area_mm2)
    map.sentences.push_back(with_decimals(hanging / 100, 1) +
                            " cm² face down over an empty space: the sheet cannot reach them.");
  for (const Side& side : model_sides) {
    double area = 0, lean = 0;
    for (Eigen::Index f = 0; f < areas.size(); ++f) {
      const double along = normals(f, 0) * side.x + normals(f, 1) * side.y,
                   across = normals(f, 0) * side.y - normals(f, 1) * side.x;
      if (map.face_draft_deg[f] >= -1 || map.face_draft_deg[f] < overhang_deg || along < std::abs(across)) continue;
      area += areas[f];
      lean -= areas[f] * map.face_draft_deg[f];
    }
    if (area < 0.005 * map.area_mm2) continue;
    locked += area;
    map.sentences.push_back(std::string("The ") + side.name + " side leans in by " + with_decimals(lean / area, 0) +
                            " degrees over " + with_decimals(area / 100, 1) +
                            " cm²: the formed shell cannot be lifted off a rigid mould there.");
  }
  if (locked + hanging == 0 && map.undercut_area_mm2 > 0.005 * map.area_mm2)
    map.sentences.push_back(with_decimals(map.undercut_area_mm2 / 100, 1) +
                            " cm² of the model lie below another part of it: the sheet cannot reach them.");
  if (map.undercut_area_mm2 <= 0.005 * map.area_mm2) {
    if (map.below_3_deg_area_mm2 > 0.005 * map.area_mm2)
      map.sentences.push_back(
          with_decimals(map.below_3_deg_area_mm2 / 100, 1) +
          " cm² of wall have less than 3 degrees of draft: the formed shell will be hard to lift off.");
    else
      map.sentences.emplace_back("All walls have a draft of 3 degrees or more: the formed shell will lift off easily.");
  } else {
    map.sentences.emplace_back(
        "Lower the model into the plate to its widest place, turn it, or plan to break the mould to get it out.");
  }
  if (map.depth_to_width_max > 1)
    map.sentences.push_back("The deepest cavity, at x " + with_decimals(map.deepest_mm.x(), 0) + ", y " +
                            with_decimals(map.deepest_mm.y(), 0) + " mm, is " +
                            with_decimals(map.depth_to_width_max, 1) +
                            " times as deep as wide: the sheet will bridge it or get very thin.");
}

}  // namespace

double HeightGrid::min_around(double x_mm, double y_mm) const {
  const auto column = static_cast<int>(std::floor((x_mm - lower_mm.x()) / pitch_mm)),
             row = static_cast<int>(std::floor((y_mm - lower_mm.y()) / pitch_mm));
  if (column < 0 || row < 0 || column + 1 >= columns || row + 1 >= rows) return 0;
  const double* corner = height_mm.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                         static_cast<std::size_t>(column);
  return std::min({corner[0], corner[1], corner[columns], corner[columns + 1]});
}

HeightGrid height_grid(const TriangleMesh& solid, int cells, Context& context) {
  const BoundingBox box = bounding_box(solid);
  HeightGrid grid;
  grid.pitch_mm = std::max(box.size().x(), box.size().y()) / cells;
  if (!(grid.pitch_mm > 0)) return grid;
  grid.columns = std::max(1, static_cast<int>(std::ceil(box.size().x() / grid.pitch_mm)));
  grid.rows = std::max(1, static_cast<int>(std::ceil(box.size().y() / grid.pitch_mm)));
  grid.lower_mm = box.centre().head<2>() - 0.5 * grid.pitch_mm * Vec2(grid.columns - 1, grid.rows - 1);
  grid.height_mm.assign(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows), 0.0);
  const RayCaster caster(solid);
  const double top = box.upper.z() + 1;
  parallel_for(grid.height_mm.size(), grain, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (std::size_t i = begin; i < end; ++i) {
      const auto column = static_cast<double>(i % static_cast<std::size_t>(grid.columns)),
                 row = static_cast<double>(i / static_cast<std::size_t>(grid.columns));
      const Vec3 origin(grid.lower_mm.x() + column * grid.pitch_mm, grid.lower_mm.y() + row * grid.pitch_mm, top);
      if (const auto hit = caster.first_hit(origin, -Vec3::UnitZ(), 0, top + 1))
        grid.height_mm[i] = top - hit->distance;
    }
  });
  grid.top_mm = *std::ranges::max_element(grid.height_mm);
  return grid;
}

HeightGrid closed_grid(const HeightGrid& grid, double width_mm) {
  HeightGrid closed = grid;
  const int radius = static_cast<int>(std::floor(0.5 * width_mm / grid.pitch_mm));
  if (radius == 0) return closed;
  const auto columns = static_cast<std::size_t>(grid.columns);
  const auto pass = [&](bool along_rows, bool greatest) {
    const std::vector<double> old = closed.height_mm;
    for (int row = 0; row < grid.rows; ++row)
      for (int column = 0; column < grid.columns; ++column) {
        double& value = closed.height_mm[static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column)];
        for (int k = -radius; k <= radius; ++k) {
          const int r = along_rows ? row : row + k, c = along_rows ? column + k : column;
          // Beside the grid is the plate when it grows; when it shrinks again, that must not eat the rim.
          if (r < 0 || c < 0 || r >= grid.rows || c >= grid.columns) continue;
          const double other = old[static_cast<std::size_t>(r) * columns + static_cast<std::size_t>(c)];
          value = greatest ? std::max(value, other) : std::min(value, other);
        }
      }
  };
  pass(true, true), pass(false, true), pass(true, false), pass(false, false);
  return closed;
}

double depth_to_width_at(const HeightGrid& grid, const Vec3& point, double min_width_mm) {
  const Vec3 p(point.x(), point.y(), std::max(point.z(), grid.min_around(point.x(), point.y())));
  double best = min_ratio;
  std::vector<Wall> left, right;
  for (int d = 0; d < direction_count; ++d) {
    const double angle = std::numbers::pi * d / direction_count;
    const Vec2 direction(std::cos(angle), std::sin(angle));
    climb(grid, p, direction, best, right);
    if (right.empty()) continue;
    climb(grid, p, -direction, best, left);
    // Both lists climb outwards: at each level, the nearest wall on either side that is as high.
    std::size_t i = 0, j = 0;
    while (i < left.size() && j < right.size()) {
      const double level = std::min(left[i].height_mm, right[j].height_mm);
      best = std::max(best, (level - p.z()) / std::max(min_width_mm, left[i].distance_mm + right[j].distance_mm));
      if (left[i].height_mm <= right[j].height_mm) ++i;
      else ++j;
    }
  }
  return best > min_ratio ? best : 0;
}

DraftMap draft_map(const TriangleMesh& solid, double sheet_thickness_mm, int cells, Context& context) {
  DraftMap map;
  map.mesh = without_base(solid);
  const Eigen::Index n = map.mesh.V.rows(), m = map.mesh.F.rows();
  const Positions normals = face_normals(map.mesh), corner_normals = vertex_normals(map.mesh);
  const Eigen::VectorXd areas = face_areas(map.mesh);
  const RayCaster caster(solid);
  const double size = bounding_box(solid).diagonal(), lift = 1e-7 * size;
  const auto hidden = [&](const Vec3& p, const Vec3& normal) {
    if (normal.z() < -upright) return true;  // the solid itself lies above
    return caster.first_hit(p + lift * normal, Vec3::UnitZ(), 0, 2 * size).has_value();
  };
  map.face_draft_deg.resize(m);
  map.face_undercut.assign(static_cast<std::size_t>(m), 0);
  context.progress(0, "Looking for undercuts");
  parallel_for(static_cast<std::size_t>(m), grain, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (std::size_t f = begin; f < end; ++f) {
      const auto row = static_cast<Eigen::Index>(f);
      const Vec3 normal = normals.row(row);
      const Vec3 centre = (map.mesh.V.row(map.mesh.F(row, 0)) + map.mesh.V.row(map.mesh.F(row, 1)) +
                           map.mesh.V.row(map.mesh.F(row, 2))) /
                          3;
      map.face_draft_deg[row] = draft_of(normal);
      map.face_undercut[f] = hidden(centre, normal) ? 1 : 0;
    }
  });
  for (Eigen::Index f = 0; f < m; ++f) {
    if (areas[f] == 0) continue;
    map.area_mm2 += areas[f];
    if (map.face_undercut[static_cast<std::size_t>(f)]) map.undercut_area_mm2 += areas[f];
    // A hundredth of a degree for walls that rounding tilts.
    if (map.face_draft_deg[f] < 3 - 0.01) map.below_3_deg_area_mm2 += areas[f];
    map.draft_min_deg = std::min(map.draft_min_deg, map.face_draft_deg[f]);
  }
  context.progress(0.4, "Measuring cavities");
  const HeightGrid grid = closed_grid(height_grid(solid, cells, context), sheet_thickness_mm);
  map.draft_deg.resize(n);
  map.depth_to_width = Eigen::VectorXd::Zero(n);
  map.undercut.assign(static_cast<std::size_t>(n), 0);
  parallel_for(static_cast<std::size_t>(n), grain, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (std::size_t v = begin; v < end; ++v) {
      const auto row = static_cast<Eigen::Index>(v);
      const Vec3 p = map.mesh.V.row(row), normal = corner_normals.row(row);
      map.draft_deg[row] = draft_of(normal);
      map.undercut[v] = hidden(p, normal) ? 1 : 0;
      if (!map.undercut[v] && map.draft_deg[row] >= floor_deg)
        map.depth_to_width[row] = depth_to_width_at(grid, p, sheet_thickness_mm);
    }
  });
  deepest_cavity(map, grid, sheet_thickness_mm, context);
  describe(map, normals, areas);
  return map;
}

}  // namespace formwright
