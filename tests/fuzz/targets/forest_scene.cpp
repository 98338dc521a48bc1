// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes of pillars and viewpoints, and the floor plan that is made of them before anything is solved.
#include "fuzz/fuzz_check.h"
#include "job/operations/relief/forest/forest_scene_file.h"
#include "relief/forest/forest.h"

namespace {
using namespace formwright;

/// A box, seen by every viewpoint in place of its model.
TriangleMesh box() {
  TriangleMesh mesh;
  mesh.V.resize(8, 3);
  for (int i = 0; i < 8; ++i) mesh.V.row(i) << (i & 1), (i >> 1 & 1), (i >> 2 & 1);
  mesh.F.resize(12, 3);
  mesh.F << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5;
  return mesh;
}
}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  Context context;
  try {
    const ForestSceneFile file = read_forest_scene(ByteView(reinterpret_cast<const std::byte*>(data) + 1, size - 1));
    const std::string written = forest_scene_json(file).dump();
    fuzz::check(read_forest_scene(as_bytes(written)).scene.pillars.size() == file.scene.pillars.size());
    check_viewpoints(file.scene);
    static const TriangleMesh model = box();
    std::vector<ViewFrame> frames;
    for (const ForestViewpoint& viewpoint : file.scene.viewpoints)
      frames.push_back(make_view_frame(model, ForestView(viewpoint).relief_options({})));
    std::vector<const ViewFrame*> of_views;
    for (const ViewFrame& frame : frames) of_views.push_back(&frame);
    ForestOptions options;
    options.layout = static_cast<PillarLayout>(data[0] % EnumNames<PillarLayout>::names.size());
    const ForestPlan plan = plan_forest(file.scene, of_views, options, context);
    fuzz::check(plan.strips.size() == frames.size() && plan.pins_mm.size() == plan.scene.pillars.size());
  } catch (const Error& error) {
    fuzz::check_invalid_input(error);
  }
  return 0;
}
