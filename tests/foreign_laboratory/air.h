// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Air below the sheet, at a constant temperature: pressure times volume follows the amount. The pump takes a share of
// what is left every moment, down to its final pressure; a sheet that comes down squeezes the rest.
#include <cmath>

namespace formwright::foreign_laboratory {

class Air {
 public:
  static constexpr double atmosphere_mpa = 0.101325;

  /// At the pressure of the atmosphere in `volume_mm3`. At a constant volume the difference to the atmosphere becomes
  /// `final_vacuum_mpa` (1 - exp(-t/pump_s)).
  Air(double volume_mm3, double final_vacuum_mpa, double pump_s)
      : volume_mm3_(volume_mm3), final_mpa_(atmosphere_mpa - final_vacuum_mpa), pump_s_(pump_s) {}

  /// Pressure difference across the sheet after a step that ends with `volume_mm3`.
  double step(double volume_mm3, double seconds) {
    const double mpa_per_amount = atmosphere_mpa * volume_mm3_ / volume_mm3;
    const double final_amount = final_mpa_ / mpa_per_amount;
    amount_ = final_amount + (amount_ - final_amount) * std::exp(-seconds / pump_s_);
    return atmosphere_mpa - amount_ * mpa_per_amount;
  }

 private:
  double volume_mm3_, final_mpa_, pump_s_;
  double amount_ = 1;  // of what was there at first
};

}  // namespace formwright::foreign_laboratory
