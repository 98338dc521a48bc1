// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// One sheet from the heater to the set shell: it sags, the mould is raised into it, air is pumped out from below, and
// it sets in the shape that it then has. The stress left in it would strain the set plastic by some ten-thousandths
// (`spring_back_strain`), which the shell's bending stiffness and the mould hold back; that is left out.
#include <random>

#include "foreign_laboratory/faults.h"
#include "foreign_laboratory/sheet/membrane.h"
#include "foreign_laboratory/mould_shape.h"
#include "foreign_laboratory/sheet/polymer.h"

namespace formwright::foreign_laboratory {

/// What setup.json says of the machine.
struct Machine {
  double sheet_x_mm = 240, sheet_y_mm = 260, thickness_mm = 1;
  double opening_x_mm = 220, opening_y_mm = 240;
  double clamp_z_mm = 1;  // of the sheet's middle surface, above the raised plate
  double plate_start_z_mm = -120;
  double mould_speed_mm_per_s = 100;
  double sag_s = 1;
  double vacuum_kpa = 80;
};

/// What no file says of it.
struct World {
  Polymer polymer;
  double pump_s = 0.15;            // to a fraction 1/e of the air, at a constant volume
  double dead_volume_mm3 = 0.5e6;  // of hoses and holes
  double hold_s = 1.2;             // from the valve to the setting
  double mould_k = 333, cold_mould_k = 293;
  double contact_w_per_m2_k = 60;  // to a dry mould of wood or gypsum
  double warmer_k = 0;             // all of the sheet, than its forming temperature
  double thicker = 0;              // all of the sheet, than the set-up says, as a fraction
};

/// The polymer's moduli and times, the pump and the hold, each within a third of its usual value.
World draw_world(std::mt19937_64& random);

/// The same on another day. Standard deviations: 2 K of the sheet, 1 % of its thickness, 5 % of the pump's time, 2 % of
/// the hold and a tenth of the heat that the mould takes.
World on_another_day(World world, std::mt19937_64& random);

struct FormingOptions {
  int cells = 60;           // along each side of the opening
  double mass_scale = 20;   // inertia; 5 and 40 move the marks by 0.01 to 0.03 mm in the mean
  double step_share = 0.8;  // of the largest stable step
};

struct FormedSheet {
  Grid grid;
  Points place_mm;                // middle surface, one column a node, raised plate at z = 0
  Points outward;                 // unit normals, away from the mould
  Eigen::VectorXd thickness_mm;   // at the nodes
  double clamp_feed_mm = 0;       // mean movement of the rim from under the clamp
  double inside_node_mm = 0;      // how far the inner face of any node is inside of the mould or the plate
  double inside_cell_mm = 0;      // the same of the middles of cells and of their sides
  double spring_back_strain = 0;  // mean stress left over Young's modulus of the set plastic
  long steps = 0;
};

/// Throws std::invalid_argument where the mould does not fit below the sheet, std::runtime_error where the sheet's
/// shape is no longer finite.
FormedSheet form_sheet(Mould mould, const Machine& machine, const World& world, const Faults& faults,
                       const FormingOptions& options);

}  // namespace formwright::foreign_laboratory
