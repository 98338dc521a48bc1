// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The gallery: shapes made by code, at any resolution. The page offers them, tests and benches use them.
//
// All are in millimetres, about 100 mm large, y up, standing on y = 0 and centred on the y axis, facing +z:
// the viewer stands at +z and looks along -z.
#include <string>
#include <string_view>
#include <vector>

#include "base/context.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct SampleInfo {
  std::string name;         // key: "bust"
  std::string title;        // for a person: "Bust"
  std::string description;  // one line
  int default_vertices;
  bool closed;          // watertight; otherwise one boundary loop
  bool has_texture;     // UV and a PNG beside the vertex colours
  Vec3 view_direction;  // suggested, from the viewer into the scene, unit length
  Vec3 view_up;
};

inline constexpr int min_sample_vertices = 500;
inline constexpr int max_sample_vertices = 2'000'000;

/// The shapes on offer, in the order in which to show them.
const std::vector<SampleInfo>& sample_catalog();

/// The shape called `name` with `target_vertices` vertices (organic shapes exactly, the structured ones
/// within 5 %), 500 to 2,000,000. Manifold, outward oriented, evenly triangulated; the same bits at every call and
/// on every target. Vertex colours are linear RGB.
/// Throws Error: invalid_input ("sample": unknown name; "vertices": out of range), cancelled.
Model make_sample(std::string_view name, int target_vertices, Context& context);

}  // namespace formwright
