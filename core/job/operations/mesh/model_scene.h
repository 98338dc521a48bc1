// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Scenes of several models as JSON, and the one that is built in. docs/relief.md says what stands in the file.
#include "geometry/mesh/placement.h"
#include "job/contract/scene_entry.h"

namespace formwright {

struct PlacedModel {
  SceneModelSource source;
  std::string name;  // for a person
  Placement placement;
};

inline constexpr int max_scene_models = 40;

/// Throws Error{invalid_input, "scene"} in one sentence that names the model, counting from 1.
std::vector<PlacedModel> read_model_scene(ByteView bytes);

/// With every value, so that it can be read again, edited or not.
Json model_scene_json(const std::vector<PlacedModel>& models);

/// `count` models of the job side by side along x, each 100 mm large.
std::vector<PlacedModel> models_in_a_row(int count);

/// A small family of one sample, as the cows of the thesis, Fig. 3.18. `vertices`: of each.
std::vector<PlacedModel> sample_model_scene(int vertices);

}  // namespace formwright
