// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What whoever uses samples lets a person choose of them.
#include "base/data/parameters.h"
#include "geometry/samples/samples.h"

namespace formwright {

/// Of whatever has a built-in scene of samples and such a member.
template <class Options>
constexpr auto scene_vertices_parameter(int Options::*member) {
  return parameter(
             "scene_vertices", member, "Vertices of the samples", unit::none, min_sample_vertices, 500000,
             "Number of vertices of each model of the built-in scene. Fewer are solved faster and show less detail.")
      .slider(2000, 60000)
      .advanced();
}

}  // namespace formwright
