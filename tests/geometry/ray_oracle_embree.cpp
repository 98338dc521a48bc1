// SPDX-License-Identifier: GPL-3.0-or-later
#include <embree3/rtcore.h>

#include <algorithm>

#include "geometry/ray_oracles.h"

namespace formwright::test {

struct EmbreeTriangles::Implementation {
  RTCDevice device = rtcNewDevice(nullptr);
  RTCScene scene = rtcNewScene(device);
  ~Implementation() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
};

EmbreeTriangles::EmbreeTriangles(const TriangleMesh& mesh) : implementation_(std::make_unique<Implementation>()) {
  const RTCScene scene = implementation_->scene;
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  const RTCGeometry geometry = rtcNewGeometry(implementation_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* positions = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                12, static_cast<std::size_t>(mesh.vertex_count())));
  std::transform(mesh.V.data(), mesh.V.data() + mesh.V.size(), positions,
                 [](double x) { return static_cast<float>(x); });
  auto* corners = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                 12, static_cast<std::size_t>(mesh.face_count())));
  std::transform(mesh.F.data(), mesh.F.data() + mesh.F.size(), corners, [](int v) { return static_cast<unsigned>(v); });
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
}
EmbreeTriangles::~EmbreeTriangles() = default;

std::optional<EmbreeTriangles::Hit> EmbreeTriangles::first_hit(const Vec3& origin, const Vec3& direction) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query{};
  query.ray.org_x = static_cast<float>(origin[0]);
  query.ray.org_y = static_cast<float>(origin[1]);
  query.ray.org_z = static_cast<float>(origin[2]);
  query.ray.dir_x = static_cast<float>(direction[0]);
  query.ray.dir_y = static_cast<float>(direction[1]);
  query.ray.dir_z = static_cast<float>(direction[2]);
  query.ray.tfar = 1e30f;
  query.ray.mask = ~0u;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(implementation_->scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return Hit{static_cast<int>(query.hit.primID), static_cast<double>(query.ray.tfar)};
}

}  // namespace formwright::test
