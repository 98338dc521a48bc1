// SPDX-License-Identifier: GPL-3.0-or-later
// Paintings of a model of 12 vertices.
#include "fuzz/fuzz_check.h"
#include "job/operations/relief/painting/painting_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace formwright;
  constexpr int vertices = 12;
  try {
    const Painting painting = read_painting(ByteView(reinterpret_cast<const std::byte*>(data), size), "painting",
                                            "painting.json", {vertices}, "the model")
                                  .painting;
    fuzz::check(painting.weight.size() == 0 || painting.weight.size() == vertices);
    fuzz::check(painting.region.empty() || painting.region.size() == static_cast<std::size_t>(vertices));
    for (Eigen::Index i = 0; i < painting.weight.size(); ++i)
      fuzz::check(painting.weight[i] >= min_painted_weight && painting.weight[i] <= max_painted_weight);
    for (const VertexColumn& column : columns_of_painting(painting, 5, 0))
      fuzz::check(column.values.size() == vertices && column.values.allFinite());
  } catch (const Error& error) {
    fuzz::check_invalid_input(error);
  }
  return 0;
}
