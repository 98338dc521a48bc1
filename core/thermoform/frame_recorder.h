// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Keeps moments of the forming, spread over what moves, without knowing beforehand how many steps there will be.
#include <vector>

#include "thermoform/forming.h"

namespace formwright {

class FrameRecorder {
 public:
  /// `start_z_mm`: where the platform stands at first.
  FrameRecorder(const ThermoformOptions& options, double start_z_mm);

  /// Offers the sheet as it is now. A phase keeps every second, fourth... step once it has too many.
  void record(const SheetDynamics& dynamics, FormingPhase phase);

  /// At most options.frames frames, the last of them the sheet as it is now.
  std::vector<FormingFrame> finish(const SheetDynamics& dynamics);

 private:
  FormingFrame frame(const SheetDynamics& dynamics, FormingPhase phase) const;

  struct PhaseFrames {
    std::vector<FormingFrame> frames;
    int stride = 1, offered = 0;
  };
  PhaseFrames phases_[3];
  double start_z_mm_, speed_mm_per_s_, raise_begins_s_;
  int max_frames_;
  FormingPhase last_phase_ = FormingPhase::relax;
};

}  // namespace formwright
