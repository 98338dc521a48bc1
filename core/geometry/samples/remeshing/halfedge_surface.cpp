// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/samples/remeshing/halfedge_surface.h"

#include <algorithm>
#include <bit>

#include "base/error.h"

namespace formwright::samples {

HalfedgeSurface::HalfedgeSurface(const Surface& surface, const std::vector<int>& patch)
    : points_(surface.points), live_vertices_(static_cast<int>(surface.points.size())) {
  const std::size_t faces = surface.triangles.size(), vertices = points_.size();
  start_.resize(3 * faces);
  twin_.assign(3 * faces, -1);
  out_.assign(vertices, -1);
  patch_ = patch.empty() ? std::vector<int>(faces, 0) : patch;
  patches_.assign(vertices, 0);
  // Half-edges in buckets by their start (counting sort), then each looks for its reverse.
  std::vector<int> first(vertices + 1, 0);
  for (const Corners& t : surface.triangles)
    for (int v : t) ++first[index(v) + 1];
  for (std::size_t v = 0; v < vertices; ++v) first[v + 1] += first[v];
  std::vector<int> outgoing(3 * faces), fill(first.begin(), first.end() - 1);
  for (std::size_t f = 0; f < faces; ++f)
    for (std::size_t c = 0; c < 3; ++c) {
      const int v = surface.triangles[f][c], h = static_cast<int>(3 * f + c);
      start_[index(h)] = v;
      out_[index(v)] = h;
      outgoing[index(fill[index(v)]++)] = h;
      patches_[index(v)] |= std::uint32_t{1} << patch_[f];
    }
  for (int h = 0; h < halfedge_slots(); ++h) {
    const int u = start(h), v = end(h);
    int found = -1, count = 0, same = 0;
    for (int k = first[index(v)]; k < first[index(v) + 1]; ++k)
      if (end(outgoing[index(k)]) == u) {
        found = outgoing[index(k)];
        ++count;
      }
    for (int k = first[index(u)]; k < first[index(u) + 1]; ++k) same += end(outgoing[index(k)]) == v ? 1 : 0;
    if (count != 1 || same != 1)
      throw Error(ErrorCode::internal, "sample", "The sample's surface is not closed and manifold.");
    twin_[index(h)] = found;
  }
}

int HalfedgeSurface::valence(int v) const {
  int count = 0;
  const int begin = out(v);
  int h = begin;
  do {
    ++count;
    h = rotate(h);
  } while (h != begin);
  return count;
}

bool HalfedgeSurface::adjacent(int a, int b) const {
  const int begin = out(a);
  int h = begin;
  do {
    if (end(h) == b) return true;
    h = rotate(h);
  } while (h != begin);
  return false;
}

void HalfedgeSurface::flip(int h) {
  const int t = twin(h), hn = next(h), hp = previous(h), tn = next(t), tp = previous(t);
  const int u = start(h), v = start(t), a = start(hp), b = start(tp);
  const int va = twin(hn), au = twin(hp), ub = twin(tn), bv = twin(tp);
  start_[index(h)] = b;
  start_[index(hn)] = a;
  start_[index(hp)] = u;
  start_[index(t)] = a;
  start_[index(tn)] = b;
  start_[index(tp)] = v;
  glue(hn, au);
  glue(hp, ub);
  glue(tn, bv);
  glue(tp, va);
  out_[index(u)] = hp;
  out_[index(v)] = tp;
  out_[index(a)] = hn;
  out_[index(b)] = h;
}

int HalfedgeSurface::split(int h, const Point& p) {
  const int t = twin(h), hn = next(h), tp = previous(t);
  const int v = start(t), a = start(previous(h)), b = start(tp);
  const int va = twin(hn), bv = twin(tp);
  const int m = vertex_slots(), f2 = halfedge_slots(), g2 = f2 + 3;
  const int f = h / 3, g = t / 3;
  points_.push_back(p);
  patches_.push_back((std::uint32_t{1} << patch_[index(f)]) | (std::uint32_t{1} << patch_[index(g)]));
  patch_.push_back(patch_[index(f)]);
  patch_.push_back(patch_[index(g)]);
  start_.insert(start_.end(), {m, v, a, v, m, b});
  twin_.insert(twin_.end(), 6, -1);
  out_.push_back(f2);
  ++live_vertices_;
  start_[index(hn)] = m;
  start_[index(t)] = m;
  glue(f2, g2);
  glue(f2 + 1, va);
  glue(f2 + 2, hn);
  glue(g2 + 1, tp);
  glue(g2 + 2, bv);
  out_[index(v)] = f2 + 1;
  out_[index(a)] = f2 + 2;
  out_[index(b)] = g2 + 2;
  return m;
}

bool HalfedgeSurface::can_collapse(int h, Point& p) const {
  const int t = twin(h), u = start(h), v = start(t), a = start(previous(h)), b = start(previous(t));
  const std::uint32_t pu = patches(u), pv = patches(v);
  const int nu = std::popcount(pu), nv = std::popcount(pv);
  if (nu > nv || nu > 2) return false;
  if (nu == 2 && (!is_feature(h) || (nv == 2 && pu != pv))) return false;
  p = nu == nv ? (point(u) + point(v)) / 2 : point(v);
  if (valence(a) <= 3 || valence(b) <= 3) return false;
  // Link condition (Dey et al. 1999): the ends share the two opposite vertices and no other.
  int ring[64], count = 0;
  const int begin = out(u);
  int k = begin;
  do {
    if (count == 64) return false;
    ring[count++] = end(k);
    k = rotate(k);
  } while (k != begin);
  int shared = 0;
  const int start_v = out(v);
  k = start_v;
  do {
    for (int i = 0; i < count; ++i) shared += ring[i] == end(k) ? 1 : 0;
    k = rotate(k);
  } while (k != start_v);
  if (shared != 2) return false;
  // A side of the two vanishing triangles may be a feature only if the edge ends on it.
  if (nu == 1) return true;
  return true;
}

void HalfedgeSurface::collapse(int h, const Point& p) {
  const int t = twin(h), u = start(h), v = start(t), a = start(previous(h)), b = start(previous(t));
  const int va = twin(next(h)), ua = twin(previous(h)), bu = twin(next(t)), vb = twin(previous(t));
  const int begin = h;
  int k = h;
  std::vector<int> leaving;
  do {
    leaving.push_back(k);
    k = rotate(k);
  } while (k != begin);
  for (int e : leaving) start_[index(e)] = v;
  glue(va, ua);
  glue(bu, vb);
  for (int dead : {h, t}) {
    start_[index(dead)] = -1;
    start_[index(next(dead))] = -1;
    start_[index(previous(dead))] = -1;
  }
  out_[index(v)] = ua;
  out_[index(a)] = va;
  out_[index(b)] = bu;
  out_[index(u)] = -1;
  points_[index(v)] = p;
  --live_vertices_;
}

Surface HalfedgeSurface::compact(std::vector<int>* patch) const {
  Surface surface;
  std::vector<int> fresh(points_.size(), -1);
  for (int v = 0; v < vertex_slots(); ++v)
    if (vertex_alive(v)) {
      fresh[index(v)] = static_cast<int>(surface.points.size());
      surface.points.push_back(point(v));
    }
  if (patch != nullptr) patch->clear();
  for (int f = 0; 3 * f < halfedge_slots(); ++f)
    if (alive(3 * f)) {
      surface.triangles.push_back(
          {fresh[index(start(3 * f))], fresh[index(start(3 * f + 1))], fresh[index(start(3 * f + 2))]});
      if (patch != nullptr) patch->push_back(patch_[index(f)]);
    }
  return surface;
}

}  // namespace formwright::samples
