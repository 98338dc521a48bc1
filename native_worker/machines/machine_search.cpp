// SPDX-License-Identifier: GPL-3.0-or-later
// What this computer finds by itself.
#include <strings.h>

#include <algorithm>
#include <set>

#include "base/error.h"
#include "base/sha256.h"
#include "machines/port/machine_registry.h"
#include "machines/print/slicer.h"

namespace formwright {
namespace {

Machine found(MachineKind kind, const std::string& name, const std::string& address) {
  Machine machine;
  machine.kind = kind;
  machine.name = name;
  machine.id = sha256_hex(as_bytes(std::string(to_string(kind)) + "\n" + address)).substr(0, 16);
  return machine;
}

/// "usb-1a86_USB2.0-Serial-if00-port0" -> "1a86 USB2.0-Serial".
std::string readable_port_name(std::string name) {
  if (name.starts_with("usb-")) name.erase(0, 4);
  if (const auto at = name.rfind("-if"); at != std::string::npos && at > 0) name.resize(at);
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

}  // namespace

std::vector<Machine> find_serial_ports(const std::filesystem::path& devices) {
  std::vector<Machine> machines;
  std::set<std::string> known;
  const auto add = [&](const std::filesystem::path& path, const std::string& name) {
    std::error_code status;
    const auto real = std::filesystem::canonical(path, status);
    if (status || !known.insert(real.string()).second) return;
    // The address with the device's own name stays right when another cable is plugged in first.
    Machine machine = found(MachineKind::serial, name, "serial:" + path.string());
    machine.url = "serial:" + path.string();
    machine.controller = "grbl";
    machines.push_back(std::move(machine));
  };
  const auto names_in = [](const std::filesystem::path& folder) {
    std::set<std::filesystem::path> names;
    std::error_code status;
    for (std::filesystem::directory_iterator it(folder, status), end; !status && it != end; it.increment(status))
      names.insert(it->path());
    return names;
  };
  for (const auto& path : names_in(devices / "serial/by-id")) add(path, readable_port_name(path.filename().string()));
  for (const auto& path : names_in(devices)) {
    const std::string name = path.filename().string();
    if (name.starts_with("ttyUSB") || name.starts_with("ttyACM")) add(path, name);
  }
  return machines;
}

std::vector<Machine> find_printers(int patience_ms) {
  std::vector<Machine> machines;
  const cups_dest_cb_t take = [](void* list, unsigned flags, cups_dest_t* destination) {
    auto& all = *static_cast<std::vector<Machine>*>(list);
    if (flags & CUPS_DEST_FLAGS_REMOVED || destination->instance) return 1;
    Machine machine = found(MachineKind::printer, destination->name, std::string("cups:") + destination->name);
    if (std::any_of(all.begin(), all.end(), [&](const Machine& m) { return m.id == machine.id; })) return 1;
    if (const char* info = cupsGetOption("printer-info", destination->num_options, destination->options); info && *info)
      machine.name = info;
    if (const char* state = cupsGetOption("printer-state", destination->num_options, destination->options);
        state && *state)
      machine.state = *state == '5' ? "stopped" : *state == '4' ? "printing" : "idle";
    cups_dest_t* copy = nullptr;
    if (cupsCopyDest(destination, 0, &copy) != 1) return 1;
    machine.destination.reset(copy, [](cups_dest_t* d) { cupsFreeDests(1, d); });
    all.push_back(std::move(machine));
    return all.size() < 200 ? 1 : 0;
  };
  cupsEnumDests(CUPS_DEST_FLAGS_NONE, patience_ms, nullptr, 0, 0, take, &machines);
  return machines;
}

std::vector<Machine> find_machines(const MachineRegistry& registry) {
  std::vector<Machine> machines = registry.read();
  const auto append = [&](std::vector<Machine> more) {
    for (Machine& m : more)
      if (std::none_of(machines.begin(), machines.end(), [&](const Machine& known) { return known.id == m.id; }))
        machines.push_back(std::move(m));
  };
  append(find_serial_ports());
  append(find_printers());
  if (const std::string program = slicer_program(); !program.empty()) {
    Machine slicer = found(MachineKind::slicer, "PrusaSlicer", program);
    slicer.url = program;
    slicer.state = "ready";
    append({slicer});
  }
  return machines;
}

const Machine& choose_machine(const std::vector<Machine>& machines, const std::string& name_or_id) {
  std::string list;
  for (const Machine& m : machines) {
    if (m.id == name_or_id || ::strcasecmp(m.name.c_str(), name_or_id.c_str()) == 0) return m;
    list += (list.empty() ? "" : ", ") + m.name;
  }
  throw Error(ErrorCode::invalid_input, "machine",
              "There is no machine called " + name_or_id + ": " +
                  (list.empty() ? "none was found; add it with formwright machine add." : "there are " + list + "."));
}

}  // namespace formwright
