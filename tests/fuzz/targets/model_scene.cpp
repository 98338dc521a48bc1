// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes of several models, and a model put to each place of them.
#include "fuzz/fuzz_check.h"
#include "job/operations/mesh/model_scene.h"

namespace {
using namespace formwright;

/// Of edges 1, 2 and 3.
Positions tetrahedron() {
  Positions V(4, 3);
  V << 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3;
  return V;
}
}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const std::vector<PlacedModel> models = read_model_scene(ByteView(reinterpret_cast<const std::byte*>(data), size));
    const std::string written = model_scene_json(models).dump();
    const std::vector<PlacedModel> again = read_model_scene(as_bytes(written));
    fuzz::check(again.size() == models.size());
    static const Positions model = tetrahedron();
    for (std::size_t k = 0; k < models.size(); ++k) {
      const Positions V = placed(model, models[k].placement);
      fuzz::check(V.allFinite() && V == placed(model, again[k].placement));
    }
  } catch (const Error& error) {
    fuzz::check_invalid_input(error);
  }
  return 0;
}
