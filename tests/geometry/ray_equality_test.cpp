// SPDX-License-Identifier: GPL-3.0-or-later
// Embree's tree and our own must give the same hits to the last bit: on a million rays, most of them awkward.
// A third answer, for some of the rays, tests every triangle without any tree.
#include <catch2/catch_test_macros.hpp>

#include <bit>
#include <limits>
#include <optional>
#include <string>

#include "base/parallel.h"
#include "geometry/queries/bvh_rays.h"
#include "geometry/queries/embree_rays.h"
#include "geometry/ray_sets.h"

namespace formwright {
namespace {
using namespace test;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Triangles without area (three kinds), the same triangle many times, needles and a mesh in one plane.
std::vector<Shape> degenerate_shapes() {
  TriangleMesh broken = icosphere(3);
  Random random(7);
  for (int f = 0; f < broken.face_count(); f += 3) {
    if (f % 2 == 0) broken.F(f, 1) = broken.F(f, 0);
    else broken.F.row(f) = broken.F.row(random.below(broken.face_count()));
    if (f % 5 == 0) broken.V.row(broken.F(f, 2)) = 0.5 * (broken.V.row(broken.F(f, 0)) + broken.V.row(broken.F(f, 1)));
  }
  TriangleMesh needles = torus(40, 24);
  for (int f = 0; f < needles.face_count(); f += 2)
    needles.V.row(needles.F(f, 2)) =
        (1 - 1e-12) * needles.V.row(needles.F(f, 1)) + 1e-12 * needles.V.row(needles.F(f, 0));
  TriangleMesh pile = tetrahedron();
  pile.F = tetrahedron().F.replicate(50, 1);
  TriangleMesh point = tetrahedron();
  point.V.rowwise() = Vec3(3, -2, 1).transpose();
  return {{"broken", broken}, {"needles", needles}, {"pile", pile}, {"point", point}};
}

std::vector<Shape> all_shapes() {
  std::vector<Shape> result = shapes();
  for (Shape& shape : degenerate_shapes()) result.push_back(std::move(shape));
  TriangleMesh turned = rotated(grid(16, 16, 0), Vec3(1, 2, 3), 0.9);
  result.push_back({"turned plane", turned});
  result.push_back({"plane", grid(16, 16, 0)});
  result.push_back({"far and small", moved(icosphere(3), Vec3(1e6, -2e6, 3e6), 1e-3)});
  result.push_back({"smallest", moved(icosphere(2), Vec3(0, 0, 0), 1e-36)});
  result.push_back({"largest", moved(torus(20, 12), Vec3(0, 0, 0), 1e28)});
  return result;
}

/// A ray and the part of it that is asked for.
struct Question {
  Ray ray;
  double near = 0, far = infinity;
};

/// One of many kinds of rays that are hard for trees and for triangle tests.
Question awkward_question(const TriangleMesh& mesh, const BoundingBox& box, int kind, Random& random) {
  const double radius = box.diagonal() / 2;
  const int f = random.below(mesh.face_count());
  const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)), c = mesh.V.row(mesh.F(f, 2));
  const Vec3 middle = (a + b + c) / 3, other = mesh.V.row(random.below(mesh.vertex_count()));
  const Vec3 outside = box.centre() + 2 * radius * random.direction();
  const auto in_plane = [&] { return Vec3(a + random.uniform(-3, 3) * (b - a) + random.uniform(-3, 3) * (c - a)); };
  const auto towards = [](const Vec3& from, const Vec3& to) {
    return from == to ? Ray{from, Vec3::UnitZ()} : ray_between(from, to);
  };
  Vec3 axis = Vec3::Zero();
  axis[random.below(3)] = random.below(2) == 0 ? 1 : -1;
  switch (kind) {
    case 0:  // through a vertex, an edge
      return {towards(outside, random.below(2) == 0 ? a : Vec3(a + random.uniform() * (b - a)))};
    case 1:  // within the plane of a face
      return {towards(in_plane(), in_plane())};
    case 2:  // along an edge, from beyond it
      return {towards(a - random.uniform(0, 3) * (b - a), b)};
    case 3:  // parallel to an axis, through a vertex; half the time with negative zeros
      return {{a - random.uniform(-1, 3) * radius * axis, random.below(2) == 0 ? axis : Vec3(-(-axis))}};
    case 4: {  // within a side of the box of a face
      Vec3 from = box.centre() + 2 * radius * random.in_cube(), to = box.centre() + radius * random.in_cube();
      const int k = random.below(3);
      from[k] = to[k] = a[k];
      return {towards(from, to)};
    }
    case 5:  // from on the surface, to both sides
      return {towards(random.below(2) == 0 ? a : middle, other), random.below(2) == 0 ? 0 : -infinity};
    case 6: {  // almost parallel to an axis: components down to subnormal ones
      Vec3 direction = axis;
      for (int k = 0; k < 3; ++k)
        if (axis[k] == 0) direction[k] = std::pow(10, random.uniform(-320, -3)) * (random.below(2) == 0 ? 1 : -1);
      return {{middle - 3 * radius * axis, direction.normalized()}};
    }
    case 7:  // from far away
      return {towards(box.centre() + radius * std::pow(10, random.uniform(1, 13)) * random.direction(), middle)};
    case 8: {  // ends at what it meets, or just before or behind
      const Vec3 from = outside;
      const double distance = (middle - from).norm();
      const double end = std::nextafter(distance, random.below(2) == 0 ? 0 : infinity);
      return {towards(from, middle), random.below(2) == 0 ? 0 : end, random.below(2) == 0 ? end : infinity};
    }
    case 9:  // between two vertices, no farther
      return {towards(a, other), 0, (other - a).norm()};
    case 10:  // past the mesh, touching its box
      return {towards(outside, box.centre() + radius * random.direction())};
    default:  // anywhere, behind the origin, too
      return {towards(box.centre() + 3 * radius * random.in_cube(), box.centre() + radius * random.in_cube()),
              random.below(2) == 0 ? 0 : -3 * radius, random.below(2) == 0 ? infinity : radius};
  }
}

bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }
bool same_bits(const RayHit& a, const RayHit& b) {
  return a.face == b.face && same_bits(a.distance, b.distance) && same_bits(a.barycentric[0], b.barycentric[0]) &&
         same_bits(a.barycentric[1], b.barycentric[1]) && same_bits(a.barycentric[2], b.barycentric[2]);
}
bool same_bits(const std::vector<RayHit>& a, const std::vector<RayHit>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const RayHit& x, const RayHit& y) { return same_bits(x, y); });
}
bool same_bits(const std::optional<RayHit>& a, const std::optional<RayHit>& b) {
  return a.has_value() == b.has_value() && (!a || same_bits(*a, *b));
}

std::vector<RayHit> hits_without_tree(const TriangleMesh& mesh, const SearchSphere& sphere, const Question& q) {
  const ShearedRay ray(q.ray.origin, q.ray.direction, CentredRay(sphere, q.ray.origin, q.ray.direction).tolerance);
  std::vector<RayHit> found;
  for (int f = 0; f < mesh.face_count(); ++f) {
    TriangleCorners<double> corner;
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k)
        corner[static_cast<std::size_t>(c)][static_cast<std::size_t>(k)] = mesh.V(mesh.F(f, c), k);
    TriangleHits<double> hits;
    if (meet(ray, corner, q.near, q.far, hits) != 0)
      found.push_back({f, hits.distance, Vec3(hits.barycentric[0], hits.barycentric[1], hits.barycentric[2])});
  }
  std::sort(found.begin(), found.end(), comes_before);
  return found;
}

std::string text_of(const Question& q, const std::vector<RayHit>& hits) {
  std::string text;
  char number[200];
  std::snprintf(number, sizeof number, "from (%a %a %a) towards (%a %a %a), %g to %g:", q.ray.origin[0],
                q.ray.origin[1], q.ray.origin[2], q.ray.direction[0], q.ray.direction[1], q.ray.direction[2], q.near,
                q.far);
  text += number;
  for (const RayHit& hit : hits) {
    std::snprintf(number, sizeof number, " face %d at %.17g", hit.face, hit.distance);
    text += number;
  }
  return text;
}

TEST_CASE("RayEquality.EmbreesTreeAndOursGiveTheSameBits") {
  constexpr int kinds = 12;
#if defined(__SANITIZE_ADDRESS__)
  constexpr int rays_per_kind = 400;
#else
  constexpr int rays_per_kind = 4700;  // a million in all
#endif
  int rays = 0, hit = 0, hits_in_all = 0;
  for (const auto& [name, mesh] : all_shapes()) {
    INFO(name);
    const BvhRays ours(mesh);
    const EmbreeRays embree(mesh);
    const SearchSphere sphere = search_sphere(mesh);
    const BoundingBox box = bounding_box(mesh);
    Random random(101);
    for (int kind = 0; kind < kinds; ++kind) {
      INFO("kind " + std::to_string(kind));
      int different = 0, hits_of_kind = 0;
      for (int i = 0; i < rays_per_kind; ++i, ++rays) {
        const Question q = awkward_question(mesh, box, kind, random);
        const auto first = ours.first_hit(q.ray.origin, q.ray.direction, q.near, q.far);
        const auto all = ours.all_hits(q.ray.origin, q.ray.direction, q.near, q.far);
        const auto embree_all = embree.all_hits(q.ray.origin, q.ray.direction, q.near, q.far);
        bool same = same_bits(first, embree.first_hit(q.ray.origin, q.ray.direction, q.near, q.far)) &&
                    same_bits(all, embree_all) && first.has_value() == !all.empty() &&
                    (!first || same_bits(*first, all[0]));
        if (i % 16 == 0) same = same && same_bits(all, hits_without_tree(mesh, sphere, q));
        if (!same && ++different <= 3)
          FAIL_CHECK(text_of(q, all) << "\nEmbree: " << text_of(q, embree_all)
                                     << "\nwithout a tree: " << text_of(q, hits_without_tree(mesh, sphere, q)));
        hit += first ? 1 : 0;
        hits_of_kind += static_cast<int>(all.size());
      }
      CHECK(different == 0);
      hits_in_all += hits_of_kind;
    }
  }
  CHECK(hit > rays / 3);
  SUCCEED("rays " << rays);
  SUCCEED("hits " << hits_in_all);
  std::printf("%d rays, %d of them hit, %d hits\n", rays, hit, hits_in_all);
}

TEST_CASE("RayEquality.HoweverManyThreadsBuildTheTree") {
  const TriangleMesh mesh = torus(300, 200);  // large enough for several threads
  const BoundingBox box = bounding_box(mesh);
  std::optional<EmbreeRays> several(mesh), one, inside_loop;
  {
    const ThreadLimit limit(1);
    one.emplace(mesh);
  }
  parallel_for(2, 1, [&](std::size_t begin, std::size_t) {
    if (begin == 0) inside_loop.emplace(mesh);
  });
  const BvhRays ours(mesh);
  Random random(3);
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    const Question q = awkward_question(mesh, box, i % 12 == 7 ? 0 : i % 12, random);  // not from far away: too slow
    const auto expected = ours.all_hits(q.ray.origin, q.ray.direction, q.near, q.far);
    for (const auto* rays : {&several, &one, &inside_loop})
      CHECK(same_bits((*rays)->all_hits(q.ray.origin, q.ray.direction, q.near, q.far), expected));
    hits += static_cast<int>(expected.size());
  }
  CHECK(hits > 1000);
}

}  // namespace
}  // namespace formwright
