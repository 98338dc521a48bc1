// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/queries/embree_rays.h"

#include <embree3/rtcore.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <limits>
#include <new>
#include <string>

#include "base/error.h"
#include "base/library_threads.h"
#include "geometry/queries/ray_triangle.h"
#include "geometry/queries/search_sphere.h"

namespace formwright {
namespace {

using Triangle = TriangleCorners<double>;

// In Embree's coordinates the mesh fills the unit sphere about 0, and a ray starts two radii before the foot of the
// perpendicular from there, so that distances within the sphere are from 1 to 3 (Embree takes no negative ones).
constexpr double foot_distance = 2, max_distance = 4;
// Single precision moves the start of a ray by 2^-23 at most, a point 4 away by 4 * 2^-24 more, the sides of a box by
// 2^-24; hits lie up to 2e-7 outside the boxes of their triangles. Embree's own rounding is allowed for by
// RTC_SCENE_FLAG_ROBUST.
constexpr double box_widening = 2e-6;
// Distances are rounded by 2^-23, and that of a hit may lie outside the part of the ray in the box as above.
constexpr double distance_slack = 4e-6;

// Below this the tree is built by the calling thread: it takes 50 ms, and other threads take memory of their own.
constexpr std::size_t min_parallel_triangles = 100'000;

[[noreturn]] void fail(RTCError error) {
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  throw Error(ErrorCode::internal, "mesh", "Embree failed with error " + std::to_string(error) + ".");
}

/// One for the process, never released: its end would wait for other threads.
RTCDevice embree_device() {
  // Nothing here is subdivided; the cache for that would reserve 128 MB of addresses.
  static const RTCDevice device = rtcNewDevice("tessellation_cache_size=0");
  if (device == nullptr) fail(rtcGetDeviceError(nullptr));
  return device;
}

/// One ray, and what it has met so far. Embree hands its address on to Scene::meet_first and Scene::meet_all.
struct Query : RTCIntersectContext {
  ShearedRay ray;
  double near, limit;   // the limit is `far`, or the distance of the best hit
  double foot, radius;  // of the ray: CentredRay::start; of the sphere
  RayHit best;
  std::vector<RayHit> all;
  bool out_of_memory = false;

  Query(const CentredRay& centred, const SearchSphere& sphere, const Vec3& origin, double open_near, double far)
      : ray(origin, centred.direction, centred.tolerance),
        near(open_near),
        limit(far),
        foot(centred.start),
        radius(std::max(sphere.radius, std::numeric_limits<double>::min())) {
    rtcInitIntersectContext(this);
  }
  float embree_distance(double distance, double slack) const {
    return static_cast<float>(std::clamp((distance - foot) / radius + foot_distance + slack, 0.0, max_distance));
  }
  RTCRay embree_ray(const CentredRay& centred) const {
    const Vec3 start = centred.foot / radius - foot_distance * centred.direction;
    RTCRay result{};
    result.org_x = static_cast<float>(start.x());
    result.org_y = static_cast<float>(start.y());
    result.org_z = static_cast<float>(start.z());
    result.dir_x = static_cast<float>(centred.direction.x());
    result.dir_y = static_cast<float>(centred.direction.y());
    result.dir_z = static_cast<float>(centred.direction.z());
    result.tnear = embree_distance(near, -distance_slack);
    result.tfar = embree_distance(limit, distance_slack);
    result.mask = ~0u;
    return result;
  }

  /// Returns whether the triangle is the best so far.
  bool meet_first(const Triangle& triangle, unsigned face) {
    RayHit hit;
    if (!met(triangle, face, hit) || (best.face >= 0 && !comes_before(hit, best))) return false;
    best = hit;
    limit = hit.distance;
    return true;
  }
  /// Throws nothing, because Embree calls it.
  void meet_all(const Triangle& triangle, unsigned face) noexcept {
    RayHit hit;
    if (!met(triangle, face, hit)) return;
    try {
      all.push_back(hit);
    } catch (const std::bad_alloc&) {
      out_of_memory = true;
    }
  }

 private:
  bool met(const Triangle& triangle, unsigned face, RayHit& hit) const {
    TriangleHits<double> hits;
    if (meet(ray, triangle, near, limit, hits) == 0) return false;
    hit = {static_cast<int>(face), hits.distance, Vec3(hits.barycentric[0], hits.barycentric[1], hits.barycentric[2])};
    return true;
  }
};

}  // namespace

struct EmbreeRays::Scene {
  SearchSphere sphere;
  std::vector<Triangle> triangles;
  RTCScene scene = nullptr;

  ~Scene() {
    if (scene != nullptr) rtcReleaseScene(scene);
  }

  void build();

  static const Scene& of(void* pointer) { return *static_cast<const Scene*>(pointer); }
  static void find_box(const RTCBoundsFunctionArguments* arguments);
  static void meet_first(const RTCIntersectFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) return;
    Query& query = *static_cast<Query*>(arguments->context);
    const Scene& scene = of(arguments->geometryUserPtr);
    if (query.meet_first(scene.triangles[arguments->primID], arguments->primID))
      reinterpret_cast<RTCRayHit*>(arguments->rayhit)->ray.tfar = query.embree_distance(query.limit, distance_slack);
  }
  static void meet_all(const RTCOccludedFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) return;
    // The ray is left as it is: nothing occludes it, and Embree goes on through all boxes.
    static_cast<Query*>(arguments->context)
        ->meet_all(of(arguments->geometryUserPtr).triangles[arguments->primID], arguments->primID);
  }
};

void EmbreeRays::Scene::find_box(const RTCBoundsFunctionArguments* arguments) {
  const Scene& scene = of(arguments->geometryUserPtr);
  const Triangle& triangle = scene.triangles[arguments->primID];
  std::array<float, 3> lower, upper;
  const double radius = std::max(scene.sphere.radius, std::numeric_limits<double>::min());
  for (std::size_t k = 0; k < 3; ++k) {
    const double a = triangle[0][k], b = triangle[1][k], c = triangle[2][k];
    const double centre = scene.sphere.centre[static_cast<Eigen::Index>(k)];
    lower[k] = static_cast<float>((std::min({a, b, c}) - centre) / radius - box_widening);
    upper[k] = static_cast<float>((std::max({a, b, c}) - centre) / radius + box_widening);
  }
  RTCBounds& box = *arguments->bounds_o;
  box.lower_x = lower[0], box.lower_y = lower[1], box.lower_z = lower[2];
  box.upper_x = upper[0], box.upper_y = upper[1], box.upper_z = upper[2];
}

void EmbreeRays::Scene::build() {
  const RTCDevice device = embree_device();
  scene = rtcNewScene(device);
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  if (scene == nullptr || geometry == nullptr) throw std::bad_alloc();
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(triangles.size()));
  rtcSetGeometryUserData(geometry, this);
  rtcSetGeometryBoundsFunction(
      geometry, [](const RTCBoundsFunctionArguments* arguments) { find_box(arguments); }, nullptr);
  rtcSetGeometryIntersectFunction(geometry, meet_first);
  rtcSetGeometryOccludedFunction(geometry, meet_all);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);  // the scene holds it
  const auto commit = [&](int threads) {
    tbb::task_arena(threads).execute([&] { rtcCommitScene(scene); });
    return rtcGetDeviceError(device);
  };
  const int threads = triangles.size() < min_parallel_triangles ? 1 : allowed_threads();
  RTCError error = commit(threads);
  if (error != RTC_ERROR_NONE && threads > 1) error = commit(1);  // other threads need memory, or were not to be had
  if (error != RTC_ERROR_NONE) fail(error);
}

EmbreeRays::EmbreeRays(const TriangleMesh& mesh) : scene_(std::make_unique<Scene>()) {
  scene_->sphere = search_sphere(mesh);
  if (mesh.face_count() == 0) return;
  scene_->triangles.resize(static_cast<std::size_t>(mesh.face_count()));
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k)
        scene_->triangles[static_cast<std::size_t>(f)][static_cast<std::size_t>(c)][static_cast<std::size_t>(k)] =
            mesh.V(mesh.F(f, c), k);
  scene_->build();
}
EmbreeRays::~EmbreeRays() = default;
EmbreeRays::EmbreeRays(EmbreeRays&&) noexcept = default;
EmbreeRays& EmbreeRays::operator=(EmbreeRays&&) noexcept = default;

std::optional<RayHit> EmbreeRays::first_hit(const Vec3& origin, const Vec3& direction, double near, double far) const {
  const CentredRay centred(scene_->sphere, origin, direction);
  Query query(centred, scene_->sphere, origin, near, far);
  if (centred.is_too_far) {
    for (unsigned f = 0; f < scene_->triangles.size(); ++f) query.meet_first(scene_->triangles[f], f);
  } else if (!centred.misses && scene_->scene != nullptr) {
    RTCRayHit ray{query.embree_ray(centred), {}};
    rtcIntersect1(scene_->scene, &query, &ray);
  }
  return query.best.face >= 0 ? std::optional(query.best) : std::nullopt;
}

std::vector<RayHit> EmbreeRays::all_hits(const Vec3& origin, const Vec3& direction, double near, double far) const {
  const CentredRay centred(scene_->sphere, origin, direction);
  Query query(centred, scene_->sphere, origin, near, far);
  if (centred.is_too_far) {
    for (unsigned f = 0; f < scene_->triangles.size(); ++f) query.meet_all(scene_->triangles[f], f);
  } else if (!centred.misses && scene_->scene != nullptr) {
    RTCRay ray = query.embree_ray(centred);
    rtcOccluded1(scene_->scene, &query, &ray);
  }
  if (query.out_of_memory) throw std::bad_alloc();
  std::sort(query.all.begin(), query.all.end(), comes_before);
  return std::move(query.all);
}

}  // namespace formwright
