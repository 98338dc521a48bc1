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
      {{"bust",
        "Bust",
        "A bearded head with curled hair and a draped cloak, in the antique manner",
        60000,
        true,
        false,
        {0, 0, -1},
        {0, 1, 0}},
       samples::make_bust},
      {{"cat", "Cat", "A tabby cat, sitting, her tail around her paws", 40000, true, true, {0, 0, -1}, {0, 1, 0}},
       samples::make_cat},
      {{"octopus",
        "Octopus",
        "Eight curling arms with suckers, a domed head",
        40000,
        true,
        false,
        {0, -0.34202014332566873, -0.93969262078590838},
        {0, 1, 0}},
       samples::make_octopus},
      {{"mountain",
        "Mountain",
        "An eroded massif on a square, open below",
        40000,
        false,
        true,
        {0, -0.57357643635104605, -0.81915204428899178},
        {0, 1, 0}},
       samples::make_mountain},
      {{"fish",
        "Fish",
        "Overlapping scales and rayed fins, seen from the side",
        40000,
        true,
        false,
        {0, 0, -1},
        {0, 1, 0}},
       samples::make_fish},
      {{"coin",
        "Medal",
        "An owl between olive branches; fine, flat detail on both faces",
        60000,
        true,
        false,
        {0, 0, -1},
        {0, 1, 0}},
       samples::make_coin},
      {{"star", "Star", "A soft five-pointed star", 20000, true, false, {0, 0, -1}, {0, 1, 0}}, samples::make_star},
      {{"heart", "Heart", "A full, smooth heart", 20000, true, false, {0, 0, -1}, {0, 1, 0}}, samples::make_heart},
      {{"pyramid",
        "Pyramid",
        "Four sides over 100 x 100 mm, 60 mm high; planar to the last bit",
        5000,
        true,
        false,
        {0, -0.57357643635104605, -0.81915204428899178},
        {0, 1, 0}},
       samples::make_pyramid},
      {{"t_shape", "T", "A block T with sharp edges, 100 x 100 x 30 mm", 5000, true, false, {0, 0, -1}, {0, 1, 0}},
       samples::make_t_shape},
      {{"hemisphere",
        "Hemisphere",
        "A dome of 50 mm radius with its flat base",
        5000,
        true,
        false,
        {0, -0.57357643635104605, -0.81915204428899178},
        {0, 1, 0}},
       samples::make_hemisphere},
      {{"torus", "Torus", "A ring of genus one: radii 35 and 15 mm", 10000, true, false, {0, 0, -1}, {0, 1, 0}},
       samples::make_torus},
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
    throw Error(ErrorCode::invalid_input, "sample",
                "There is no sample called '" + std::string(name) + "'; choose one of " + names + ".");
  }
  if (target_vertices < min_sample_vertices || target_vertices > max_sample_vertices)
    throw Error(ErrorCode::invalid_input, "vertices",
                "A sample has " + std::to_string(min_sample_vertices) + " to " + std::to_string(max_sample_vertices) +
                    " vertices; " + std::to_string(target_vertices) + " is outside.");
  return found->make(target_vertices, context);
}

}  // namespace formwright
