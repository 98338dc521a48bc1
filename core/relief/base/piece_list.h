// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The pieces of a relief while they are cut, one vertex and one triangle after the other.
#include <utility>
#include <vector>

#include "geometry/mesh/mesh_lists.h"
#include "relief/base/relief_pieces.h"

namespace formwright {

class PieceList {
 public:
  /// `origin`: as ReliefPieces has it; `room`: how far the vertex may be before and behind the base. Returns its
  /// number.
  int add_vertex(const Vec3& place, int origin, const Vec2& room) {
    places_.push_back(place);
    origin_.push_back(origin);
    room_.push_back(room);
    return static_cast<int>(places_.size()) - 1;
  }
  int vertex_count() const { return static_cast<int>(places_.size()); }
  void add_face(const Eigen::Vector3i& face, int band) {
    faces_.push_back(face);
    band_.push_back(band);
  }

  /// `painted`: whether vertices have limits of their own.
  ReliefPieces pieces(bool painted) {
    ReliefPieces result;
    TriangleMesh mesh = mesh_of(places_, faces_);
    result.V = std::move(mesh.V);
    result.F = std::move(mesh.F);
    result.band = std::move(band_);
    result.origin = std::move(origin_);
    if (!painted) return result;
    result.above.resize(result.V.rows());
    result.below.resize(result.V.rows());
    for (std::size_t i = 0; i < room_.size(); ++i) {
      result.above[static_cast<Eigen::Index>(i)] = room_[i][0];
      result.below[static_cast<Eigen::Index>(i)] = room_[i][1];
    }
    return result;
  }

 private:
  std::vector<Vec3> places_;
  std::vector<Eigen::Vector3i> faces_;
  std::vector<int> band_, origin_;
  std::vector<Vec2> room_;
};

}  // namespace formwright
