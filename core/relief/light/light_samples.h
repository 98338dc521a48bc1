// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Lights as lists of points and directions that each give a part of the light. Lists are the same for every place of a
// surface and have no random numbers in them. Axes: x right, y up, z out of the wall, mm.
#include <vector>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// Light from very far away.
struct FarLight {
  Vec3 direction;     // towards the light, unit
  double irradiance;  // of a surface that faces it, nothing in between
};

/// Light from a point of a lamp or a window.
struct NearLight {
  Vec3 place;
  Vec3 facing;       // unit, into which a window's point shines most; 0: shines into all directions alike
  double intensity;  // irradiance times squared distance, mm^2, of a surface that faces it from where it shines most
};

struct LightSamples {
  std::vector<FarLight> far;
  std::vector<NearLight> near;
};

/// The sun as a disc of half a degree, evenly bright: `count` directions on a spiral. A surface that faces its middle
/// gets `irradiance`, but for the 1e-5 by which the rim is aslant. `towards`: unit. Precondition: count > 0.
LightSamples sun_disc(const Vec3& towards, double irradiance, int count);

enum class SkyKind {
  uniform,   // equally bright all over
  overcast,  // CIE: the zenith is three times as bright as the horizon (Moon and Spencer 1942)
};

/// What a wall sees of the sky, `level_irradiance` being that of level ground under the whole sky: `count` directions
/// evenly over the half sphere before the wall (Gonzalez 2010), those below the horizon dark. Precondition: count > 0.
LightSamples sky_light(SkyKind kind, double level_irradiance, int count);

/// The same of level ground that sends `sent_back` of irradiance up again, alike into all directions: half of it falls
/// on a bare wall.
LightSamples ground_light(double sent_back, int count);

/// A window whose radiance is 1: a rectangle whose middle is `centre` and whose plane faces the origin,
/// its lower edge level: `count` points of a rank-1 lattice. What lies behind the wall (z <= 0) is left out.
/// Preconditions: `centre` is not on the y axis; count > 0.
LightSamples window_light(const Vec3& centre, double width_mm, double height_mm, int count);

/// A bare lamp that shines into all directions alike; a surface at the origin that faces it gets an irradiance of 1.
LightSamples strobe_light(const Vec3& place);

/// Both together.
LightSamples joined(LightSamples a, const LightSamples& b);

}  // namespace formwright
