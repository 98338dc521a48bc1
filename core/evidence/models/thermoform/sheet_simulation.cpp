// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/thermoform/sheet_simulation.h"

#include <cstdint>
#include <cstring>
#include <vector>

#include "base/sha256.h"
#include "thermoform/sheet/sheet_mesh.h"

namespace formwright {
namespace {

/// What later readers of a stored simulation must find unchanged; raised when the simulation computes something else.
constexpr const char* simulation_version = "thermoform-2:";
constexpr const char* clamp_version = "clamp-4:";  // of simulations in which the clamp slips
/// Before the sentence of a simulation without an answer.
constexpr std::string_view no_answer = "no answer:";

/// Vertices and thicknesses in single precision, as they are kept between runs; what is computed afresh is rounded
/// alike.
Bytes packed_sheet(const FormedSheet& sheet) {
  const Eigen::Index n = sheet.mesh.V.rows();
  std::vector<float> numbers;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (int k = 0; k < 3; ++k) numbers.push_back(static_cast<float>(sheet.mesh.V(i, k)));
    numbers.push_back(static_cast<float>(sheet.thickness_mm[i]));
  }
  Bytes bytes(numbers.size() * sizeof(float));
  std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return bytes;
}

Bytes packed_error(const Error& error) {
  const Json words = {
      {"unsolvable", error.code() == ErrorCode::could_not_solve}, {"where", error.where()}, {"message", error.what()}};
  return to_bytes(std::string(no_answer) + words.dump(-1, ' ', true, Json::error_handler_t::replace));
}

[[noreturn]] void throw_damaged(const std::string& what) {
  throw Error(ErrorCode::invalid_input, "tasks",
              what + ": run the same version of formwright on every computer, and start the job again.");
}

TriangleMesh unpacked_mould(ByteView bytes) {
  std::uint64_t counts[2] = {0, 0};
  if (bytes.size() < sizeof counts) throw_damaged("The mould of a simulation is cut short");
  std::memcpy(counts, bytes.data(), sizeof counts);
  constexpr std::uint64_t largest = 1U << 28;
  if (counts[0] > largest || counts[1] > largest ||
      bytes.size() != sizeof counts + counts[0] * 3 * sizeof(double) + counts[1] * 3 * sizeof(int))
    throw_damaged("The mould of a simulation has another size than it says");
  TriangleMesh mesh;
  mesh.V.resize(static_cast<Eigen::Index>(counts[0]), 3);
  mesh.F.resize(static_cast<Eigen::Index>(counts[1]), 3);
  const auto vertex_bytes = static_cast<std::size_t>(counts[0] * 3 * sizeof(double)),
             face_bytes = static_cast<std::size_t>(counts[1] * 3 * sizeof(int));
  if (vertex_bytes > 0) std::memcpy(mesh.V.data(), bytes.data() + sizeof counts, vertex_bytes);
  if (counts[1] > 0) std::memcpy(mesh.F.data(), bytes.data() + sizeof counts + vertex_bytes, face_bytes);
  if (mesh.F.size() == 0 || mesh.F.minCoeff() < 0 || mesh.F.maxCoeff() >= mesh.vertex_count() || !mesh.V.allFinite())
    throw_damaged("The mould of a simulation is no mesh");
  return mesh;
}

}  // namespace

std::string SheetSimulation::key() const {
  return sha256_hex(as_bytes(std::string(simulation_version) + (options.clamp_slip_mm > 0 ? clamp_version : "") +
                             mould_name + ":" + std::to_string(base_plate_end_z_mm) + ":" +
                             write_parameters(options).dump()));
}

Bytes simulated(const SheetSimulation& simulation, const std::shared_ptr<const MouldShape>& mould,
                const Context& context) {
  Context silent(Host{{}, [&context] { return context.cancelled(); }, {}});
  Placement as_it_is;
  as_it_is.translation.z() = -simulation.base_plate_end_z_mm;
  try {
    Bytes bytes = packed_sheet(form_sheet(mould, as_it_is, simulation.options, silent).sheet);
    if (!kept_sheet(bytes, simulation.options))
      throw Error(ErrorCode::could_not_solve, "", "The simulation gave no finite sheet.");
    return bytes;
  } catch (const Error& error) {
    if (error.code() != ErrorCode::could_not_solve && error.code() != ErrorCode::invalid_input) throw;
    return packed_error(error);
  }
}

std::shared_ptr<const FormedSheet> kept_sheet(const Bytes& bytes, const ThermoformOptions& options) {
  if (as_text(bytes).starts_with(no_answer)) {
    const Json words = Json::parse(as_text(bytes).substr(no_answer.size()), nullptr, false);
    if (!words.is_object() || !words.contains("unsolvable") || !words["unsolvable"].is_boolean()) return nullptr;
    const auto text = [&](const char* name) {
      return words.contains(name) && words[name].is_string() ? words[name].get<std::string>() : std::string();
    };
    throw Error(words["unsolvable"].get<bool>() ? ErrorCode::could_not_solve : ErrorCode::invalid_input, text("where"),
                text("message"));
  }
  const SheetMesh flat = make_sheet_mesh(clamp_opening_mm(options), options.triangles);
  const Eigen::Index n = flat.flat_mm.rows();
  if (bytes.size() != static_cast<std::size_t>(n) * 4 * sizeof(float)) return nullptr;
  std::vector<float> numbers(static_cast<std::size_t>(n) * 4);
  std::memcpy(numbers.data(), bytes.data(), bytes.size());
  auto sheet = std::make_shared<FormedSheet>();
  sheet->mesh.V.resize(n, 3);
  sheet->mesh.F = flat.F;
  sheet->sheet_mm = flat.flat_mm;
  sheet->thickness_mm.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (int k = 0; k < 3; ++k) sheet->mesh.V(i, k) = numbers[static_cast<std::size_t>(4 * i + k)];
    sheet->thickness_mm[i] = numbers[static_cast<std::size_t>(4 * i + 3)];
  }
  if (!sheet->mesh.V.allFinite() || !sheet->thickness_mm.allFinite()) return nullptr;
  return sheet;
}

Json simulation_recipe(const SheetSimulation& simulation) {
  return {{"kind", "thermoform"},
          {"mould", simulation.mould_name},
          {"base_plate_end_z_mm", simulation.base_plate_end_z_mm},
          {"options", write_parameters(simulation.options)}};
}

Bytes packed_mould(const TriangleMesh& mesh) {
  const std::uint64_t counts[2] = {static_cast<std::uint64_t>(mesh.V.rows()),
                                   static_cast<std::uint64_t>(mesh.F.rows())};
  const auto vertex_bytes = static_cast<std::size_t>(counts[0] * 3 * sizeof(double)),
             face_bytes = static_cast<std::size_t>(counts[1] * 3 * sizeof(int));
  Bytes bytes(sizeof counts + vertex_bytes + face_bytes);
  std::memcpy(bytes.data(), counts, sizeof counts);
  if (vertex_bytes > 0) std::memcpy(bytes.data() + sizeof counts, mesh.V.data(), vertex_bytes);
  if (face_bytes > 0) std::memcpy(bytes.data() + sizeof counts + vertex_bytes, mesh.F.data(), face_bytes);
  return bytes;
}

Bytes simulated_by_recipe(const std::string& key, const Json& recipe, ByteView mould, const Context& context) {
  SheetSimulation simulation;
  try {
    simulation.mould_name = recipe.at("mould").get<std::string>();
    simulation.base_plate_end_z_mm = recipe.at("base_plate_end_z_mm").get<double>();
    simulation.options = read_parameters<ThermoformOptions>(recipe.at("options"));
  } catch (const std::exception& error) {
    throw_damaged(std::string("The recipe of a simulation cannot be read (") + error.what() + ")");
  }
  // The key holds the version of the simulation and every number of it.
  if (simulation.key() != key) throw_damaged("The recipe of a simulation makes another result than it is named for");
  return simulated(simulation, std::make_shared<const MouldShape>(unpacked_mould(mould)), context);
}

}  // namespace formwright
