// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How the pieces are put together, step by step, on paper: what is needed, pictures, seams in their order. Thesis
// Sec. 5.3.
#include "base/bytes.h"
#include "zippable/plan/zippable_plan.h"

namespace formwright {

struct AssemblySheet {
  Bytes pdf;
  int pages = 0;
};

/// Beyond the zipper at each end, to hold it by while it is attached.
inline constexpr double zipper_end_mm = 30;

/// The zipper to cut from the reel: its length and both ends, rounded up to a centimetre; 0 where there is none.
double zipper_to_cut_mm(const FlatDesign& design, const ZippablePlan& plan);

/// Throws Error: could_not_solve (the PDF cannot be written), cancelled.
AssemblySheet write_assembly_sheet(const FlatDesign& design, const ZippablePlan& plan, const PlanOptions& options,
                                   const Context& context);

}  // namespace formwright
