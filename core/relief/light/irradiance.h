// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How much light falls on places of a surface, with and without the shadows that it casts on itself.
#include <memory>
#include <vector>

#include "base/context.h"
#include "geometry/queries/ray_caster.h"
#include "relief/light/light_samples.h"

namespace formwright {

/// What stands in the light.
struct LitObject {
  explicit LitObject(const TriangleMesh& mesh);

  std::shared_ptr<const RayCaster> rays;
  Vec3 low, high;  // its box
};

/// Places of its surface.
struct SurfacePoints {
  Positions place;   // n x 3, mm
  Positions normal;  // n x 3, unit, as shading takes them
  double clearance;  // mm along the normal, from where rays to the light start: more than the mesh is off the surface
};

struct Irradiance {
  std::vector<double> lit;   // n
  std::vector<double> open;  // n, were nothing in the way
  Irradiance() = default;
  explicit Irradiance(std::size_t count) : lit(count, 0), open(count, 0) {}
};

/// Sum over the light's samples. Light from behind the wall (z <= 0) does not come through it.
/// Rays start at the clearance over the place. Takes points times samples rays; reports progress over them.
/// The same on any number of threads. Throws Error: cancelled.
Irradiance irradiance(const LitObject& object, const SurfacePoints& points, const LightSamples& light,
                      Context& context);

/// a += b, of the same points.
void add(Irradiance& a, const Irradiance& b);

}  // namespace formwright
