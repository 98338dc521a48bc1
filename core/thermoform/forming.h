// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Thermoforming from the flat sheet to the formed one: thesis 4.2.2, "Simulation stages".
#include <memory>
#include <string>
#include <vector>

#include "base/context.h"
#include "thermoform/sheet/formed_sheet.h"
#include "thermoform/contact/mould_contact.h"
#include "thermoform/sheet_dynamics.h"
#include "thermoform/sheet/thermoform_options.h"

namespace formwright {

enum class FormingPhase { relax, raise, vacuum };

/// The sheet at one moment.
struct FormingFrame {
  double time_s = 0;
  FormingPhase phase = FormingPhase::relax;
  double platform_z_mm = 0;         // where the platform stands, 0 once it is up
  Positions V;                      // n x 3, machine coordinates as the platform has them (mould at rest)
  std::vector<float> thickness_mm;  // n
  double touching_share = 0;        // of the vertices that are free to move
};

struct FormedResult {
  FormedSheet sheet;
  Placement placement;               // where the model stood, its displacements included
  std::vector<FormingFrame> frames;  // first the flat sheet, last the final one
  double sag_mm = 0;                 // at the end of the relaxation
  double phase_end_s[3] = {0, 0, 0};
  bool reached_time_limit = false;
  double pressure_end_kpa = 0;
  double volume_drift = 0;                            // relative, of sum A h
  double min_thickness_mm = 0;                        // of the faces
  double formed_area_mm2 = 0, unformed_area_mm2 = 0;  // of the final sheet: faces with a corner that never touched
  double mould_edge_penetration_mm = 0;               // deepest sharp point of the mould beyond the sheet's inner face
  double vertex_distance_min_mm = 0;  // smallest of the free and stuck vertices from mould and plate; above 0
  double touching_share = 0;          // of the vertices that are free to move
  double mean_thickness_mm = 0;       // over the sheet within the opening
  double webbing_area_mm2 = 0;        // of faces squeezed by more than a tenth in some direction
  double elastic_energy_mj = 0;
  DynamicsStatistics statistics;
  int point_contacts = 0;
  double seconds = 0;
};

/// Forms a sheet over `shape`, meant to stand at `nominal`: the options' effects (sheet_effects.h) displace it. The
/// same bits at every call and for any number of threads. Throws Error: invalid_input (a model that does not fit the
/// machine, a clamp opening larger than the sheet, values that contradict each other), could_not_solve, cancelled.
FormedResult form_sheet(std::shared_ptr<const MouldShape> shape, const Placement& nominal,
                        const ThermoformOptions& options, Context& context);

}  // namespace formwright
