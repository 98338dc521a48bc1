// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/strips/strip_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "fabrication/sheet/nesting.h"
#include "fabrication/sheet/word_paths.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/queries/point_distance.h"
#include "zippable/plan/pieces/splitting.h"
#include "zippable/parts/polygon_dissection.h"
#include "zippable/ribbon/ribbon.h"
#include "zippable/strips/band_network.h"

namespace formwright {
namespace {

constexpr double margin_mm = 5, spacing_mm = 2;

NestingOptions nesting_of(const StripOptions& options) {
  return {options.bed_x_mm, options.bed_y_mm, margin_mm, spacing_mm, false};
}

/// One walk around a band: its loops, joined where they come nearest to each other by cuts that are walked both ways.
std::vector<int> one_walk(std::vector<std::vector<int>> loops, const std::vector<Vec3>& points) {
  std::sort(loops.begin(), loops.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  std::vector<int> walk = std::move(loops.front());
  loops.erase(loops.begin());
  while (!loops.empty()) {
    double minimum = 1e300;
    std::size_t which = 0, at = 0, from = 0;
    for (std::size_t l = 0; l < loops.size(); ++l)
      for (std::size_t i = 0; i < walk.size(); ++i)
        for (std::size_t j = 0; j < loops[l].size(); ++j)
          if (const double distance = (points[walk[i]] - points[loops[l][j]]).squaredNorm(); distance < minimum)
            minimum = distance, which = l, at = i, from = j;
    std::vector<int> joined(walk.begin(), walk.begin() + static_cast<std::ptrdiff_t>(at) + 1);
    std::vector<int>& loop = loops[which];
    for (std::size_t j = 0; j <= loop.size(); ++j) joined.push_back(loop[(from + j) % loop.size()]);
    joined.insert(joined.end(), walk.begin() + static_cast<std::ptrdiff_t>(at), walk.end());
    walk = std::move(joined);
    loops.erase(loops.begin() + static_cast<std::ptrdiff_t>(which));
  }
  return walk;
}

struct Strip {
  std::vector<Vec3> positions;  // once for every place of the walk
  Triangles F;
};

Strip filled(const std::vector<int>& walk, const std::vector<Vec3>& points, double width_mm) {
  Strip strip;
  for (const int v : walk) strip.positions.push_back(points[v]);
  std::vector<int> places(walk.size());
  std::iota(places.begin(), places.end(), 0);
  const auto position = [&](int i) -> const Vec3& { return strip.positions[i]; };
  // Triangles without area only where nothing else is left, as on the ribbon.
  const auto triangles = cheapest_triangulation(
      places, [&](int a, int b) { return (position(a) - position(b)).norm(); },
      [&](int a, int b, int c) {
        const Vec3 ab = position(b) - position(a), ac = position(c) - position(a), bc = position(c) - position(b);
        return ab.cross(ac).norm() > 1e-5 * std::max({ab.squaredNorm(), ac.squaredNorm(), bc.squaredNorm()})
                   ? 0.0
                   : 1e6 * width_mm;
      });
  strip.F.resize(static_cast<Eigen::Index>(triangles.size()), 3);
  for (std::size_t i = 0; i < triangles.size(); ++i)
    strip.F.row(static_cast<Eigen::Index>(i)) << triangles[i][0], triangles[i][1], triangles[i][2];
  return strip;
}

/// From a corner of the walk over the band's edges to its vertex farthest from the walk: where a tip would be cut off,
/// the band is slit as far as there.
class Slitter {
 public:
  Slitter(const Bands& bands, double sample_mm)
      : bands_(bands), adjacency_(bands.mesh), sample_mm_(sample_mm), vertices_(std::size_t(bands.band_count)) {
    for (int h = 0; h < 3 * bands.mesh.face_count(); ++h) vertices_[bands.band[h / 3]].insert(adjacency_.from(h));
  }

  /// The walk with the slit in both directions; the walk itself where the filled band comes near to all of it.
  std::vector<int> slit(int band, const std::vector<int>& walk, const Strip& strip, double near_mm,
                        std::vector<Vec3>& points) const {
    TriangleMesh mesh;
    mesh.V.resize(static_cast<Eigen::Index>(strip.positions.size()), 3);
    for (std::size_t i = 0; i < strip.positions.size(); ++i)
      mesh.V.row(static_cast<Eigen::Index>(i)) = strip.positions[i];
    mesh.F = strip.F;
    const PointDistance surface(mesh);
    int tip = -1;
    double farthest = near_mm;
    for (const int v : vertices_[band])
      if (const double distance = surface.nearest(position(v))->distance; distance > farthest)
        farthest = distance, tip = v;
    if (tip < 0) return walk;
    std::vector<Vec3> route = path_to(band, tip, walk, points);
    const auto foot = std::min_element(walk.begin(), walk.end(), [&](int a, int b) {
      return (points[a] - route.front()).squaredNorm() < (points[b] - route.front()).squaredNorm();
    });
    route.insert(route.begin(), points[*foot]);
    std::vector<int> inward;
    double along = 0, taken = 0, length = 0;
    for (std::size_t i = 0; i + 1 < route.size(); ++i) length += (route[i + 1] - route[i]).norm();
    const double step = length / std::max(1.0, std::round(length / sample_mm_));
    for (std::size_t i = 1; i < route.size(); ++i) {
      along += (route[i] - route[i - 1]).norm();
      if (along - taken < step && i + 1 < route.size()) continue;
      taken = along;
      inward.push_back(static_cast<int>(points.size()));
      points.push_back(route[i]);
    }
    std::vector<int> result(walk.begin(), foot + 1);
    result.insert(result.end(), inward.begin(), inward.end());
    result.insert(result.end(), inward.rbegin() + 1, inward.rend());
    result.insert(result.end(), foot, walk.end());
    return result;
  }

 private:
  Vec3 position(int v) const { return bands_.mesh.V.row(v).transpose(); }

  /// Along edges inside the band, from its border to the tip.
  std::vector<Vec3> path_to(int band, int tip, const std::vector<int>& walk, const std::vector<Vec3>& points) const {
    std::map<int, double> distance{{tip, 0}};
    std::map<int, int> before;
    std::set<std::pair<double, int>> open{{0, tip}};
    int end = tip;
    double minimum = 1e300;
    while (!open.empty()) {
      const auto [d, v] = *open.begin();
      open.erase(open.begin());
      // As far as to the border's nearest sample, however near that is.
      double beyond = 1e300;
      for (const int p : walk) beyond = std::min(beyond, (points[p] - position(v)).norm());
      if (d + 2 * beyond < minimum) minimum = d + 2 * beyond, end = v;
      if (d > minimum) break;
      for (const int w : adjacency_.neighbours(v)) {
        if (!vertices_[band].contains(w)) continue;
        const double there = d + (position(w) - position(v)).norm();
        const auto [known, fresh] = distance.try_emplace(w, there);
        if (!fresh && known->second <= there) continue;
        if (!fresh) open.erase({known->second, w});
        known->second = there;
        before[w] = v;
        open.insert({there, w});
      }
    }
    std::vector<Vec3> route{position(end)};
    for (int v = end; v != tip;) route.push_back(position(v = before.at(v)));
    return route;
  }

  const Bands& bands_;
  Adjacency adjacency_;
  double sample_mm_;
  std::vector<std::set<int>> vertices_;  // per band
};

/// How many bands have a handle, which their borders alone do not show.
int bands_with_handles(const Bands& bands, const BandNetwork& network) {
  const Adjacency adjacency(bands.mesh);
  std::vector<int> euler(std::size_t(bands.band_count), 0);
  // A vertex where the band touches itself counts once for every fan of it, and each fan has one border leaving.
  std::map<std::pair<int, int>, int> borders;
  for (int h = 0; h < 3 * bands.mesh.face_count(); ++h) {
    const int band = bands.band[h / 3], o = adjacency.opposite(h);
    if (h % 3 == 0) ++euler[band];
    if (o < h || bands.band[o / 3] != band) --euler[band];  // every edge once
    borders[{band, adjacency.from(h)}] += o < 0 || bands.band[o / 3] != band;
  }
  for (const auto& [corner, leaving] : borders) euler[corner.first] += std::max(1, leaving);
  int count = 0;
  for (int band = 0; band < bands.band_count; ++band)
    count += 2 - static_cast<int>(network.loops[band].size()) - euler[band] >= 2;
  return count;
}

/// The walk around the triangles of one piece of a strip.
Polygon outline_of(const Triangles& F, const std::vector<Vec2>& flat) {
  std::map<std::pair<int, int>, bool> edges;
  for (Eigen::Index f = 0; f < F.rows(); ++f)
    for (int k = 0; k < 3; ++k) edges[{F(f, k), F(f, (k + 1) % 3)}] = true;
  std::map<int, int> next;
  for (const auto& [edge, there] : edges)
    if (!edges.contains({edge.second, edge.first})) next[edge.first] = edge.second;
  Polygon outline;
  if (next.empty()) return outline;
  int v = next.begin()->first;
  do outline.push_back(flat[v]);
  while ((v = next.at(v)) != next.begin()->first);
  return outline;
}

void add_pieces(const Strip& strip, const StripOptions& options, StripModel& model, Context& context) {
  const std::vector<Vec2> flat = unfold(strip.positions, strip.F);
  for (Eigen::Index f = 0; f < strip.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = strip.F(f, k), b = strip.F(f, (k + 1) % 3);
      const double length = (strip.positions[a] - strip.positions[b]).norm();
      model.isometry_error =
          std::max(model.isometry_error, std::abs((flat[a] - flat[b]).norm() - length) / std::max(length, 1e-300));
    }
  const NestingOptions nesting = nesting_of(options);
  const double reserved = 2 * margin_mm + 4 * nesting_cell_mm(nesting);
  const auto fits = [&](const Polygon& hull) {
    return hull.size() < 2 ||
           !fitting_turns(hull, options.bed_x_mm - reserved, options.bed_y_mm - reserved, false).empty();
  };
  const Splitting splitting = split_ribbon(strip.F, flat, fits, 0, 0.01 * options.width_mm * options.width_mm, context);
  for (int piece = 0; piece < splitting.piece_count; ++piece) {
    StripPiece made{strip.positions, flat, Triangles(0, 3), {}};
    for (Eigen::Index f = 0; f < strip.F.rows(); ++f)
      if (splitting.piece_of_face[f] == piece) {
        made.F.conservativeResize(made.F.rows() + 1, 3);
        made.F.row(made.F.rows() - 1) = strip.F.row(f);
      }
    made.outline_mm = outline_of(made.F, flat);
    model.pieces.push_back(std::move(made));
  }
}

}  // namespace

StripModel make_strips(const TriangleMesh& mesh, const std::vector<int>& limb, const StripOptions& options,
                       Context& context) {
  context.progress(0, "Dividing into bands");
  const Bands bands = distance_bands(mesh, limb, options.feature_degrees, options.width_mm, context);
  BandNetwork network = band_network(bands, 0.2 * options.width_mm);
  const Slitter slitter(bands, 0.2 * options.width_mm);
  StripModel model;
  model.parts = bands.part_count, model.bands = bands.band_count;
  constexpr int max_tips = 12;  // of a band
  int degenerate = 0;
  for (int band = 0; band < bands.band_count; ++band) {
    context.progress(static_cast<double>(band + 1) / (bands.band_count + 1), "Unfolding strips");
    if (network.loops[band].empty()) {
      ++degenerate;
      continue;
    }
    std::vector<int> walk = one_walk(network.loops[band], network.points_mm);
    if (walk.size() < 3) {
      ++degenerate;
      continue;
    }
    Strip strip = filled(walk, network.points_mm, options.width_mm);
    for (int tips = 0; tips < max_tips; ++tips) {
      std::vector<int> slit = slitter.slit(band, walk, strip, 0.25 * options.width_mm, network.points_mm);
      if (slit.size() == walk.size()) break;
      walk = std::move(slit);
      strip = filled(walk, network.points_mm, options.width_mm);
    }
    add_pieces(strip, options, model, context);
  }
  if (degenerate > 0)
    model.notes.push_back(std::to_string(degenerate) +
                          " bands have no border along which to lay them flat and were left out.");
  if (const int handles = bands_with_handles(bands, network); handles > 0)
    model.notes.push_back(std::to_string(handles) +
                          " bands run around a handle and were filled without it. Use narrower strips.");
  int vertices = 0, faces = 0;
  for (const StripPiece& piece : model.pieces)
    vertices += static_cast<int>(piece.positions_mm.size()), faces += static_cast<int>(piece.F.rows());
  model.formed.V.resize(vertices, 3);
  model.formed.F.resize(faces, 3);
  vertices = faces = 0;
  for (const StripPiece& piece : model.pieces) {
    model.formed.F.middleRows(faces, piece.F.rows()) = piece.F.array() + vertices;
    faces += static_cast<int>(piece.F.rows());
    for (const Vec3& p : piece.positions_mm) model.formed.V.row(vertices++) = p;
  }
  return model;
}

PieceFigures piece_figures(const std::vector<Polygon>& outlines) {
  PieceFigures figures{static_cast<int>(outlines.size()), 0, 1e300};
  for (const Polygon& outline : outlines) {
    double length = 0;
    for (std::size_t i = 0; i < outline.size(); ++i) length += (outline[(i + 1) % outline.size()] - outline[i]).norm();
    figures.cut_length_mm += length;
    if (length > 0) figures.narrowest_mm = std::min(figures.narrowest_mm, 2 * signed_area_mm2(outline) / length);
  }
  if (outlines.empty()) figures.narrowest_mm = 0;
  return figures;
}

std::vector<CutSheet> strip_sheets(const StripModel& model, const StripOptions& options, Context& context) {
  std::vector<Polygon> outlines;
  for (const StripPiece& piece : model.pieces) outlines.push_back(piece.outline_mm);
  const Nesting nesting = nest(outlines, nesting_of(options), context);
  std::vector<CutSheet> sheets(std::size_t(nesting.sheet_count),
                               CutSheet{"Strips", options.bed_x_mm, options.bed_y_mm, {}});
  for (std::size_t i = 0; i < outlines.size(); ++i) {
    auto& paths = sheets[nesting.places[i].sheet].paths;
    for (Vec2& p : outlines[i]) p = nesting.places[i](p);
    // The number on the longest line across.
    const StripPiece& piece = model.pieces[i];
    double longest = 0;
    Vec2 middle(0, 0), along(1, 0);
    for (Eigen::Index f = 0; f < piece.F.rows(); ++f)
      for (int k = 0; k < 3; ++k) {
        const Vec2 a = nesting.places[i](piece.flat_mm[piece.F(f, k)]),
                   b = nesting.places[i](piece.flat_mm[piece.F(f, (k + 1) % 3)]);
        if ((b - a).norm() > longest)
          longest = (b - a).norm(), along = (b - a) / longest,
          middle = (nesting.places[i](piece.flat_mm[piece.F(f, 0)]) + nesting.places[i](piece.flat_mm[piece.F(f, 1)]) +
                    nesting.places[i](piece.flat_mm[piece.F(f, 2)])) /
                   3;
      }
    const double height = std::min(3.0, longest / 6);
    for (CutPath& path : word_paths(std::to_string(i + 1), middle, along, height, CutLayer::engrave))
      paths.push_back(std::move(path));
    paths.push_back({CutLayer::cut, outlines[i], true, "strip-" + std::to_string(i + 1)});
  }
  return sheets;
}

}  // namespace formwright
