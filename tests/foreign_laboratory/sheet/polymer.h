// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The hot plastic as networks of chains that break and form again ([GT46]; [Lod64], the rubberlike liquid): one lasts,
// two relax. Temperature acts on relaxation times by the equation of [WLF55], and on moduli by an Arrhenius law.
// References: docs/references.bib.
//
// Units in this folder: mm, N, s, MPa = N/mm^2, tonnes (N s^2/mm), kelvin.
#include <array>

namespace formwright::foreign_laboratory {

/// An amorphous sheet such as PETG at forming temperature: Young's modulus 3.6 MPa at once, 0.9 MPa in the end.
struct Polymer {
  double density_t_per_mm3 = 1.27e-9;
  double lasting_modulus_mpa = 0.3;                           // shear modulus of the network that lasts
  std::array<double, 2> relaxing_modulus_mpa = {0.55, 0.35};  // shear moduli of the networks that relax
  std::array<double, 2> relaxation_s = {0.1, 5};              // at forming_temperature_k
  double forming_temperature_k = 413;
  double glass_temperature_k = 353;
  double wlf_c1 = 17.44, wlf_c2_k = 51.6;      // universal constants about the glass temperature [WLF55]
  double modulus_activation_j_per_mol = 30e3;  // 23 % stiffer when 10 K colder
  double max_stiffening = 6;                   // what cold contact may add to the moduli before the sheet sets
  double set_young_modulus_mpa = 2000;         // of the plastic at room temperature
  double heat_capacity_mj_per_mm3_k = 2.286;   // density times 1800 J/(kg K), in mJ/(mm^3 K)
};

/// Relaxation times at `temperature_k` over those at forming temperature. Below the glass temperature the value there.
double relaxation_time_shift(const Polymer& polymer, double temperature_k);

/// Moduli at `temperature_k` over those at forming temperature, at most `max_stiffening`.
double modulus_shift(const Polymer& polymer, double temperature_k);

/// Young's modulus (three times the shear modulus, the sheet being incompressible) `time_s` after a sudden small
/// stretch.
double relaxation_modulus_mpa(const Polymer& polymer, double time_s, double temperature_k);

/// How many times stiffer a place of `temperature_k` is than one at forming temperature, one second after a sudden
/// stretch: what to compare with the project's factor on Young's modulus.
double stiffness_ratio(const Polymer& polymer, double temperature_k);

/// Sum of the shear moduli of all networks at forming temperature.
double total_modulus_mpa(const Polymer& polymer);

}  // namespace formwright::foreign_laboratory
