// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// One simulation of a measured object's sheet: what it depends on, what names it, and its result as it is kept. Made
// here or on another computer, it has the same bits.
#include <memory>
#include <string>

#include "base/bytes.h"
#include "base/context.h"
#include "base/data/json.h"
#include "thermoform/forming.h"

namespace formwright {

struct SheetSimulation {
  std::string mould_name;  // FormedObject::key
  double base_plate_end_z_mm = 0;
  ThermoformOptions options;

  /// Names the simulation: a hash of all that it depends on.
  std::string key() const;
};

/// The formed sheet, or the sentence why there is none, as bytes that are kept. Throws Error{cancelled}, and what is no
/// answer of the simulation (out_of_memory, internal).
Bytes simulated(const SheetSimulation& simulation, const std::shared_ptr<const MouldShape>& mould,
                const Context& context);

/// The sheet of simulated()'s bytes; null where they are damaged. Throws the Error that the simulation ended with:
/// invalid_input or could_not_solve.
std::shared_ptr<const FormedSheet> kept_sheet(const Bytes& bytes, const ThermoformOptions& options);

/// A simulation as a recipe for another computer; the mould's mesh, which goes with it, is written by packed_mould().
Json simulation_recipe(const SheetSimulation& simulation);
Bytes packed_mould(const TriangleMesh& mesh);

/// Makes a recipe's result. Throws as simulated() does, and Error{invalid_input, "tasks"} where recipe or mould are
/// damaged, or of another version of the program.
Bytes simulated_by_recipe(const std::string& key, const Json& recipe, ByteView mould, const Context& context);

}  // namespace formwright
