// SPDX-License-Identifier: GPL-3.0-or-later
// The small files that people keep beside their models. The first byte says which.
#include "evidence/registration/calibration_pattern.h"
#include "evidence/models/relief/relief_model.h"
#include "fuzz/fuzz_check.h"
#include "thermoform/machine_profile.h"
#include "thermoform/measured/measured_object.h"
#include "thermoform/measured/measured_thickness.h"
#include "zippable/design_files.h"
#include "zippable/flat_design.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace formwright;
  if (size == 0) return 0;
  const ByteView bytes(reinterpret_cast<const std::byte*>(data) + 1, size - 1);
  try {
    switch (data[0] % 8) {
      case 0: read_object_setup(bytes); break;
      case 1:
        read_measured_thickness(bytes);
        read_measured_points(bytes);
        break;
      case 2: write_machine_profile(read_machine_profile(bytes)); break;
      case 3: read_segments(bytes); break;
      case 4: read_flat_design(bytes); break;
      case 5: read_calibration_pattern(bytes); break;
      case 6: read_shading_setup(bytes); break;
      default: read_shaded_points(bytes); break;
    }
  } catch (const Error& error) {
    fuzz::check_invalid_input(error);
  }
  return 0;
}
