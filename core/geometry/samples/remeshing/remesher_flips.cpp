// SPDX-License-Identifier: GPL-3.0-or-later
// Steps of Remesher that turn edges inside their two triangles.
#include "geometry/samples/remeshing/remesher.h"

#include <vector>

#include "base/index.h"

namespace formwright::samples {

bool Remesher::can_flip(int h) const {
  if (s_.is_feature(h)) return false;
  const int t = s_.twin(h), a = s_.start(s_.previous(h)), b = s_.start(s_.previous(t));
  const Point &u = s_.point(s_.start(h)), &v = s_.point(s_.start(t)), &pa = s_.point(a), &pb = s_.point(b);
  const Point n1 = normal_of(u, v, pa), n2 = normal_of(v, u, pb);
  const Point f1 = normal_of(pb, pa, u), f2 = normal_of(pa, pb, v);
  const Point mean = n1 + n2;
  if (!agree(n1, n2, 0.5) || !agree(f1, f2, 0.5) || !agree(f1, mean, 0.5) || !agree(f2, mean, 0.5)) return false;
  return !s_.adjacent(a, b);
}

void Remesher::flip_by_valence() {
  std::vector<int> valence(index(s_.vertex_slots()), 0);
  for (int h = 0; h < s_.halfedge_slots(); ++h)
    if (s_.alive(h)) ++valence[index(s_.start(h))];
  const auto excess = [&](int v, int change) {
    const int e = valence[index(v)] + change - 6;
    return e * e;
  };
  for (int h = 0; h < s_.halfedge_slots(); ++h) {
    poll(h);
    if (!real(h) || h > s_.twin(h)) continue;
    const int t = s_.twin(h), u = s_.start(h), v = s_.start(t), a = s_.start(s_.previous(h)),
              b = s_.start(s_.previous(t));
    if (valence[index(u)] <= 4 || valence[index(v)] <= 4) continue;
    const int before = excess(u, 0) + excess(v, 0) + excess(a, 0) + excess(b, 0);
    const int after = excess(u, -1) + excess(v, -1) + excess(a, 1) + excess(b, 1);
    if (after >= before || !can_flip(h)) continue;
    // Never for a much worse shape.
    const Point &pu = s_.point(u), &pv = s_.point(v), &pa = s_.point(a), &pb = s_.point(b);
    if (distance2(pa, pb) > 2.2 * distance2(pu, pv)) continue;
    s_.flip(h);
    --valence[index(u)];
    --valence[index(v)];
    ++valence[index(a)];
    ++valence[index(b)];
  }
}

void Remesher::flip_to_delaunay() {
  for (int round = 0; round < 4; ++round) {
    int flips = 0;
    for (int h = 0; h < s_.halfedge_slots(); ++h) {
      poll(h);
      if (!real(h) || h > s_.twin(h) || s_.is_feature(h)) continue;
      const int t = s_.twin(h), u = s_.start(h), v = s_.start(t), a = s_.start(s_.previous(h)),
                b = s_.start(s_.previous(t));
      const Point &pu = s_.point(u), &pv = s_.point(v), &pa = s_.point(a), &pb = s_.point(b);
      const double weight = cotangent(pa, pu, pv) + cotangent(pb, pu, pv);
      if (weight >= -1e-6 || s_.valence(u) <= 3 || s_.valence(v) <= 3 || !can_flip(h)) continue;
      // On a curved surface the other diagonal may be no better: insist on a gain.
      if (cotangent(pu, pa, pb) + cotangent(pv, pa, pb) <= weight) continue;
      s_.flip(h);
      ++flips;
    }
    if (flips == 0) break;
  }
}

}  // namespace formwright::samples
