// SPDX-License-Identifier: GPL-3.0-or-later
#include "foreign_laboratory/sheet/polymer.h"

#include <algorithm>
#include <cmath>

namespace formwright::foreign_laboratory {

double relaxation_time_shift(const Polymer& polymer, double temperature_k) {
  const auto decades_over_glass = [&](double kelvin) {
    const double above = std::max(0.0, kelvin - polymer.glass_temperature_k);
    return -polymer.wlf_c1 * above / (polymer.wlf_c2_k + above);
  };
  return std::pow(10, decades_over_glass(temperature_k) - decades_over_glass(polymer.forming_temperature_k));
}

double modulus_shift(const Polymer& polymer, double temperature_k) {
  constexpr double gas_constant_j_per_mol_k = 8.314462618;
  const double exponent = polymer.modulus_activation_j_per_mol / gas_constant_j_per_mol_k *
                          (1 / temperature_k - 1 / polymer.forming_temperature_k);
  return std::min(polymer.max_stiffening, std::exp(exponent));
}

double relaxation_modulus_mpa(const Polymer& polymer, double time_s, double temperature_k) {
  const double slower = relaxation_time_shift(polymer, temperature_k);
  double shear = polymer.lasting_modulus_mpa;
  for (std::size_t k = 0; k < polymer.relaxation_s.size(); ++k)
    shear += polymer.relaxing_modulus_mpa[k] * std::exp(-time_s / (polymer.relaxation_s[k] * slower));
  return 3 * modulus_shift(polymer, temperature_k) * shear;
}

double stiffness_ratio(const Polymer& polymer, double temperature_k) {
  constexpr double forming_time_s = 1;
  return relaxation_modulus_mpa(polymer, forming_time_s, temperature_k) /
         relaxation_modulus_mpa(polymer, forming_time_s, polymer.forming_temperature_k);
}

double total_modulus_mpa(const Polymer& polymer) {
  return polymer.lasting_modulus_mpa + polymer.relaxing_modulus_mpa[0] + polymer.relaxing_modulus_mpa[1];
}

}  // namespace formwright::foreign_laboratory
