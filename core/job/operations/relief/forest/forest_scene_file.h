// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Scenes of pillars and viewpoints as JSON, and the one that is built in. docs/relief.md says what stands in the file.
#include "job/contract/scene_entry.h"
#include "relief/forest/plan/forest_scene.h"

namespace formwright {

struct ForestSceneFile {
  ForestScene scene;
  std::vector<SceneModelSource> models;  // of each viewpoint
};

/// Throws Error{invalid_input, "scene"} in one sentence that names the viewpoint or pillar, counting from 1: no JSON, a
/// name that is not known, a value that is missing or of the wrong kind. Whether places make sense is for check_forest.
ForestSceneFile read_forest_scene(ByteView bytes);

/// With every pillar by its shape or outline, so that it can be read again, edited or not.
Json forest_scene_json(const ForestSceneFile& file);

/// Four samples, seen from four sides; without pillars, which a layout makes. Thesis, Fig. 3.14.
/// `vertices`: of each sample.
ForestSceneFile sample_forest_scene(int vertices);

}  // namespace formwright
