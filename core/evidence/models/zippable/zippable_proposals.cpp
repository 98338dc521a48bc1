// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/zippable/zippable_proposals.h"

#include "evidence/models/zippable/zipper_place.h"

namespace formwright {
namespace {

constexpr int proposed_lengths = 20;
constexpr double tape_sigma_mm = 0.5;

}  // namespace

std::vector<ProposedMeasurement> proposed_measurements(const ZippableModel& model, Context& context) {
  std::vector<ProposedMeasurement> proposals;
  const auto propose = [&](int zipped, int flat, const char* what) {
    // Parameters and causes must be those of the model that is asked about.
    MeasuredZippable object = model.objects().front();
    object.lengths = measurable_lengths(pattern_of(object.design, 0, context), object.marker_spacing_mm, zipped, flat,
                                        tape_sigma_mm);
    const bool had_lengths = !model.objects().front().lengths.empty();
    if (object.lengths.empty() || !had_lengths) return;
    auto other = std::make_unique<ZippableModel>(std::vector{std::move(object)}, context);
    proposals.push_back({what, std::move(other)});
  };
  propose(0, proposed_lengths,
          "Measure some twenty lengths on the pieces while they lie flat, across the ribbon and along it.");
  propose(proposed_lengths, 0, "Measure twenty more lengths of the zipped object, between marks all over it.");
  return proposals;
}

}  // namespace formwright
