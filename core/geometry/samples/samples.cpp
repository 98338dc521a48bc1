// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/samples/samples.h"

#include <algorithm>

#include "base/error.h"
#include "geometry/samples/shapes.h"

namespace formwright {
namespace {

struct Entry {
  SampleInfo info;
  Model (*make)(int, Context&);
};

const std::vector<Entry>& entries() {
  static const std::vector<Entry> all{
      {{"bust", "Bust", "A bearded head with curled hair and a draped cloak, in the antique manner", 60000, true, false, {0, 0, -1}, {0, 1, 0}}, samples::make_bust},
  };
  return all;
}

}  // namespace

const std::vector<SampleInfo>& sample_catalog() {
  static const std::vector<SampleInfo> catalog = [] {
    std::vector<SampleInfo> infos;
    for (const Entry& entry : entries()) infos.push_back(entry.info);
    return infos;
  }();
  return catalog;
}

Model make_sample(std::string_view name, int target_vertices, Context& context) {
  const auto& all = entries();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Entry& e) { return e.info.name == name; });
  if (found == all.end()) {
    std::string names;
    for (const Entry& e : all) names += (names.empty() ? "" : ", ") + e.info.name;
    throw Error(ErrorCode::invalid_input, "sample", "There is no sample called '" + std::string(name) + "'; choose one of " + names + ".");
  }
  if (target_vertices < least_sample_vertices || target_vertices > most_sample_vertices)
    throw Error(ErrorCode::invalid_input, "vertices",
                "A sample has " + std::to_string(least_sample_vertices) + " to " + std::to_string(most_sample_vertices) +
                    " vertices; " + std::to_string(target_vertices) + " is outside.");
  return found->make(target_vertices, context);
}

}  // namespace formwright
