// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/rig_tracks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/planar/plane.h"
#include "fabrication/sheet/contours.h"

namespace formwright {
namespace {

constexpr double step_mm = 1, shortest_mm = 10;
constexpr double leads_mm[] = {8, 14};  // from a track's end to the middle of its opening

Vec2 right_of(const Vec2& direction) { return Vec2(direction.y(), -direction.x()); }
double turn_between(const Vec2& a, const Vec2& b) { return std::atan2(cross(a, b), a.dot(b)); }

/// A place on a track's middle and the place on the cloth's edge that it belongs to.
struct TrackPoint {
  Vec2 middle, foot;
};

/// The edge moved to its right, rounded where it opens; where it closes, what comes nearer than the distance is taken
/// out.
std::vector<TrackPoint> moved(const std::vector<Vec2>& edge, double distance_mm) {
  std::vector<TrackPoint> points;
  Vec2 before(0, 0);
  const auto add = [&](const Vec2& foot, const Vec2& outward) {
    const Vec2 middle = foot + distance_mm * outward;
    if (nearest_on_line(edge, false, middle).distance_mm > distance_mm - 0.01) points.push_back({middle, foot});
  };
  for (std::size_t i = 0; i + 1 < edge.size(); ++i) {
    const Vec2 segment = edge[i + 1] - edge[i];
    const double length = segment.norm();
    if (length < 1e-6) continue;
    const Vec2 outward = right_of(segment / length);
    if (const double turn = before.isZero() ? 0 : turn_between(before, outward); turn > 0.05)
      for (double angle = 0.05; angle < turn; angle += 0.05) add(edge[i], Eigen::Rotation2Dd(angle) * before);
    const int parts = std::max(1, static_cast<int>(std::ceil(length / step_mm)));
    for (int k = 0; k <= parts; ++k) add(edge[i] + segment * k / parts, outward);
    before = outward;
  }
  return points;
}

double length_of(const std::vector<TrackPoint>& points) {
  double length = 0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) length += (points[i + 1].middle - points[i].middle).norm();
  return length;
}

class TrackMaker {
 public:
  TrackMaker(const Polygon& cloth, const RigSizes& sizes) : cloth_(cloth), sizes_(sizes) {}

  void add_edge(const std::vector<Vec2>& edge, bool left) {
    const std::vector<TrackPoint> points = moved(edge, sizes_.offset_mm);
    std::vector<TrackPoint> stretch;
    double kept = 0;
    const auto finish = [&] {
      if (const double length = length_of(stretch); length >= shortest_mm) {
        kept += length;
        stretches_.push_back({left, stretch});
      }
      stretch.clear();
    };
    for (const TrackPoint& point : points) {
      const bool gap = !stretch.empty() && (point.middle - stretch.back().middle).norm() > 3 * step_mm;
      if (gap) finish();
      if (free(point.middle, stretch)) stretch.push_back(point);
      else finish();
    }
    finish();
    result.left_out_mm += std::max(0.0, path_length_mm(edge, false) - kept);
  }

  void make() {
    for (const Stretch& stretch : stretches_) {
      RigTrack track;
      track.left = stretch.left;
      track.along_cloth_mm = length_of(stretch.points);
      const double inward = sizes_.track_mm / 2 - sizes_.slot_mm / 2;
      for (const TrackPoint& p : stretch.points) {
        track.middle_mm.push_back(p.middle);
        track.slot_mm.push_back(p.middle + inward * (p.foot - p.middle).normalized());
      }
      result.tracks.push_back(std::move(track));
    }
    for (std::size_t i = 0; i < result.tracks.size(); ++i)
      for (const bool at_end : {true, false}) open(i, at_end);
  }

  RigTracks result;

 private:
  struct Stretch {
    bool left;
    std::vector<TrackPoint> points;
  };

  double apart_mm() const { return sizes_.track_mm + sizes_.wall_mm; }

  bool free(const Vec2& p, const std::vector<TrackPoint>& mine) const {
    if (contains(cloth_, p)) return false;
    const auto near = [&](const TrackPoint& q) { return (q.middle - p).norm() < apart_mm(); };
    for (const Stretch& other : stretches_)
      if (std::any_of(other.points.begin(), other.points.end(), near)) return false;
    // The same track where it comes back to itself, far along it.
    const std::size_t own = static_cast<std::size_t>(std::ceil(4 * apart_mm() / step_mm));
    return mine.size() <= own || std::none_of(mine.begin(), mine.end() - static_cast<std::ptrdiff_t>(own), near);
  }

  /// A lead on from one end to an opening, where there is room.
  void open(std::size_t number, bool at_end) {
    RigTrack& track = result.tracks[number];
    const std::size_t count = track.middle_mm.size(), last = at_end ? count - 1 : 0;
    const std::size_t before = at_end ? count - std::min<std::size_t>(count, 4) : std::min<std::size_t>(count, 4) - 1;
    const Vec2 end = track.middle_mm[last], segment = (end - track.middle_mm[before]).normalized();
    // The cloth lies to the left of the edge: outwards is to the right of it, or to the left going back.
    for (const double lead : leads_mm)
      for (int k = 0; k <= 9; ++k) {
        const double angle = (at_end ? -1 : 1) * k * 10 * std::numbers::pi / 180;
        const Vec2 centre = end + lead * (Eigen::Rotation2Dd(angle) * segment);
        if (!room(number, end, centre)) continue;
        track.openings_mm.push_back(centre);
        leads_.push_back({end, centre});
        track.middle_mm.insert(at_end ? track.middle_mm.end() : track.middle_mm.begin(), centre);
        track.slot_mm.insert(at_end ? track.slot_mm.end() : track.slot_mm.begin(), centre);
        return;
      }
  }

  bool room(std::size_t number, const Vec2& end, const Vec2& centre) const {
    const double disc = sizes_.opening_mm / 2;
    if (contains(cloth_, centre) || nearest_on_line(cloth_, true, centre).distance_mm < disc + 0.3) return false;
    const std::vector<Vec2> lead{end, centre};
    for (const Vec2& p : {Vec2(end + 0.35 * (centre - end)), Vec2(end + 0.7 * (centre - end))})
      if (contains(cloth_, p) || nearest_on_line(cloth_, true, p).distance_mm < 0.6 * sizes_.offset_mm) return false;
    for (std::size_t i = 0; i < result.tracks.size(); ++i) {
      const RigTrack& other = result.tracks[i];
      for (const Vec2& p : other.middle_mm) {
        if (i == number && (p - end).norm() < 2 * apart_mm()) {
          if ((p - centre).norm() < disc + sizes_.track_mm / 2) return false;
          continue;
        }
        if ((p - centre).norm() < disc + sizes_.track_mm / 2 + sizes_.wall_mm) return false;
        if (nearest_on_line(lead, false, p).distance_mm < apart_mm()) return false;
      }
    }
    // Leads have no points of their own between their ends.
    return std::all_of(leads_.begin(), leads_.end(), [&](const std::vector<Vec2>& other) {
      if ((other.back() - centre).norm() < 2 * disc + sizes_.wall_mm) return false;
      if (nearest_on_line(lead, false, other.back()).distance_mm < disc + sizes_.track_mm / 2 + sizes_.wall_mm)
        return false;
      if (nearest_on_line(other, false, centre).distance_mm < disc + sizes_.track_mm / 2 + sizes_.wall_mm) return false;
      for (double share = 0; share <= 1; share += 0.125)
        if (nearest_on_line(other, false, end + share * (centre - end)).distance_mm < apart_mm()) return false;
      return true;
    });
  }

  const Polygon& cloth_;
  RigSizes sizes_;
  std::vector<Stretch> stretches_;
  std::vector<std::vector<Vec2>> leads_;  // from a track's end to the middle of its opening
};

}  // namespace

double rig_reach_mm(const RigSizes& sizes) { return sizes.offset_mm + leads_mm[1] + sizes.opening_mm / 2; }

RigTracks rig_tracks(const Polygon& cloth, const std::vector<std::vector<Vec2>>& edges,
                     const std::vector<char>& edge_left, const RigSizes& sizes) {
  TrackMaker maker(cloth, sizes);
  for (std::size_t i = 0; i < edges.size(); ++i) maker.add_edge(edges[i], edge_left[i] != 0);
  maker.make();
  return std::move(maker.result);
}

}  // namespace formwright
