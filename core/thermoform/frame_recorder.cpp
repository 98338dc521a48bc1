// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/frame_recorder.h"

#include <algorithm>

namespace formwright {

FrameRecorder::FrameRecorder(const ThermoformOptions& options, double start_z_mm)
    : start_z_mm_(start_z_mm),
      speed_mm_per_s_(options.mould_speed_mm_per_s),
      raise_begins_s_(options.relaxation_s),
      max_frames_(std::max(2, options.frames)) {}

FormingFrame FrameRecorder::frame(const SheetDynamics& dynamics, FormingPhase phase) const {
  FormingFrame result;
  result.time_s = dynamics.time_s();
  result.phase = phase;
  result.platform_z_mm =
      std::min(0.0, start_z_mm_ + speed_mm_per_s_ * std::max(0.0, dynamics.time_s() - raise_begins_s_));
  result.V = dynamics.x();
  const std::vector<double> thickness = dynamics.vertex_thickness_mm(dynamics.x());
  result.thickness_mm.assign(thickness.begin(), thickness.end());
  const auto movable = std::count(dynamics.sheet().clamped.begin(), dynamics.sheet().clamped.end(), 0);
  result.touching_share =
      movable > 0 ? 1 - static_cast<double>(dynamics.free_count()) / static_cast<double>(movable) : 1;
  return result;
}

void FrameRecorder::record(const SheetDynamics& dynamics, FormingPhase phase) {
  last_phase_ = phase;
  PhaseFrames& kept = phases_[static_cast<int>(phase)];
  // A quarter of the frames for what hardly moves, the rest shared.
  const int room = std::max(2, phase == FormingPhase::relax ? max_frames_ / 8 : max_frames_ / 2 - max_frames_ / 16);
  if (kept.offered++ % kept.stride != 0) return;
  kept.frames.push_back(frame(dynamics, phase));
  if (static_cast<int>(kept.frames.size()) > 2 * room) {
    for (std::size_t i = 0; 2 * i < kept.frames.size(); ++i)
      if (i > 0) kept.frames[i] = std::move(kept.frames[2 * i]);
    kept.frames.resize((kept.frames.size() + 1) / 2);
    kept.stride *= 2;
  }
}

std::vector<FormingFrame> FrameRecorder::finish(const SheetDynamics& dynamics) {
  std::vector<FormingFrame> all;
  for (PhaseFrames& phase : phases_)
    for (FormingFrame& f : phase.frames) all.push_back(std::move(f));
  FormingFrame last = frame(dynamics, last_phase_);
  if (!all.empty() && all.back().time_s >= last.time_s) all.pop_back();
  // Thin out evenly what is still too many; the first one stays.
  const auto room = static_cast<std::size_t>(max_frames_ - 1);
  std::vector<FormingFrame> chosen;
  if (all.size() <= room) {
    chosen = std::move(all);
  } else {
    for (std::size_t i = 0; i < room; ++i)
      chosen.push_back(std::move(all[room > 1 ? i * (all.size() - 1) / (room - 1) : 0]));
  }
  chosen.push_back(std::move(last));
  return chosen;
}

}  // namespace formwright
