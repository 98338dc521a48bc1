// SPDX-License-Identifier: GPL-3.0-or-later
#include "fuzz/fuzz_reader.h"
#include "formats/obj/obj.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace formwright;
  const ReadOptions options = fuzz::small_options();
  Context context;
  try {
    for (const auto& [material, texture] :
         read_mtl(MeshSource({reinterpret_cast<const std::byte*>(data), size}, "input", options, context)))
      fuzz::check(material.diffuse.allFinite() && material.diffuse.minCoeff() >= 0 &&
                  material.diffuse.maxCoeff() <= 1 && texture.size() <= 1010);
  } catch (const Error& error) {
    fuzz::check_refusal(error);
  }
  return 0;
}
