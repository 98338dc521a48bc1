// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A closed triangle surface that can be edited: half-edge h = 3 f + c runs along side c of face f.
// Faces carry a patch (a smooth piece of the shape); an edge between two patches is a feature.
#include <cstdint>
#include <vector>

#include "geometry/samples/sculpting/marching_cubes.h"

namespace formwright::samples {

class HalfedgeSurface {
 public:
  /// `patch` per triangle (0 to 31), empty for a shape without features.
  /// Throws Error{internal} unless the surface is closed, oriented and edge-manifold.
  explicit HalfedgeSurface(const Surface& surface, const std::vector<int>& patch = {});

  static int next(int h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static int previous(int h) { return h % 3 == 0 ? h + 2 : h - 1; }
  int halfedge_slots() const { return static_cast<int>(start_.size()); }
  int vertex_slots() const { return static_cast<int>(points_.size()); }
  int vertex_count() const { return live_vertices_; }
  bool alive(int h) const { return start_[index(h)] >= 0; }
  bool vertex_alive(int v) const { return out_[index(v)] >= 0; }
  int start(int h) const { return start_[index(h)]; }
  int end(int h) const { return start_[index(next(h))]; }
  int twin(int h) const { return twin_[index(h)]; }
  int out(int v) const { return out_[index(v)]; }
  /// The outgoing half-edge after h around its start.
  int rotate(int h) const { return twin(previous(h)); }
  const Point& point(int v) const { return points_[index(v)]; }
  void move(int v, const Point& p) { points_[index(v)] = p; }
  double edge_length2(int h) const { return distance2(point(start(h)), point(end(h))); }
  bool is_feature(int h) const { return patch_[index(h / 3)] != patch_[index(twin(h) / 3)]; }
  /// Patches that meet at a vertex, as bits: one on a smooth piece, two on a feature line, more at a corner.
  std::uint32_t patches(int v) const { return patches_[index(v)]; }
  int valence(int v) const;
  bool adjacent(int a, int b) const;

  /// Turns the edge inside its two triangles. The caller has checked that the other diagonal is free.
  void flip(int h);
  /// Inserts a vertex at p on edge h and returns it.
  int split(int h, const Point& p);
  /// Whether start(h) can be merged into end(h) without pinching the surface or dissolving a feature;
  /// `p` is set to where the merged vertex should go.
  bool can_collapse(int h, Point& p) const;
  /// Merges start(h) into end(h), which moves to p.
  void collapse(int h, const Point& p);

  Surface compact(std::vector<int>* patch = nullptr) const;

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  void glue(int h, int t) {
    twin_[index(h)] = t;
    twin_[index(t)] = h;
  }
  std::vector<Point> points_;
  std::vector<int> start_, twin_, out_, patch_;
  std::vector<std::uint32_t> patches_;
  int live_vertices_ = 0;
};

}  // namespace formwright::samples
