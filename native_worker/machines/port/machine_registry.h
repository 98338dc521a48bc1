// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The machines this computer knows: those it finds (serial ports, printers) and those a person registered on the
// command line. The page chooses among them by their names here; an address never comes from it.
#include <cups/cups.h>

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/data/json.h"

namespace formwright {

enum class MachineKind { serial, ruida, printer, octoprint, moonraker, slicer };
const char* to_string(MachineKind kind);

/// What a serial machine may be registered as, and the options that its driver gets then.
struct SerialController {
  const char *name, *controller, *tool;
};
inline constexpr std::array<SerialController, 4> serial_controllers{{{"grbl", "grbl", "laser"},
                                                                     {"grbl_mill", "grbl", "mill"},
                                                                     {"marlin", "marlin", "laser"},
                                                                     {"marlin_printer", "marlin", "printer"}}};
/// Null where there is none of that name.
const SerialController* find_serial_controller(const std::string& name);

struct Machine {
  std::string id;  // 16 hexadecimal digits, made from kind and address: the same after a restart
  std::string name;
  MachineKind kind = MachineKind::serial;
  std::string
      url;  // serial:/dev/..., tcp://host:port, ruida://host, ipp(s)://..., http(s)://...; empty for a CUPS destination
  std::string api_key;     // never leaves this computer but to the machine itself
  std::string controller;  // serial: one of serial_controllers; ruida: ruida; empty otherwise
  int baud = 115200;
  bool registered = false;
  std::string state;  // what the search found, may be empty
  std::shared_ptr<cups_dest_t> destination;
  /// For a person: the address, or what is known of it.
  std::string detail() const;
};

/// {"id", "name", "kind", "detail", "state", "registered", "controller"?}; without the key.
Json machine_json(const Machine& machine);

/// One from words of the command line. Throws Error{invalid_input} with where --name, --url, --kind, --controller or
/// --baud.
struct MachineWords {
  std::string name, url, kind, controller, api_key, baud;
};
Machine machine_from_words(const MachineWords& words);

/// What was registered: DATA/machines.json, readable by its owner alone (it holds keys), written whole. Several
/// processes may use it.
class MachineRegistry {
 public:
  /// Closes a DATA folder that is there to others (private_data.h).
  explicit MachineRegistry(std::filesystem::path data);
  /// Entries that cannot be understood are left out. Throws Error{invalid_input, "--data"} when the file cannot be read
  /// or is not JSON.
  std::vector<Machine> read() const;
  /// Throws Error{invalid_input, "--name"} when the name is taken.
  void add(const Machine& machine) const;
  /// By name or id. Throws Error{invalid_input, "machine"} when there is none.
  void remove(const std::string& name) const;
  const std::filesystem::path& data() const { return data_; }

 private:
  void write(const std::vector<Machine>& machines) const;
  std::filesystem::path data_;
};

/// Serial ports under `devices`: serial/by-id names first, then ttyUSB* and ttyACM* that have none.
std::vector<Machine> find_serial_ports(const std::filesystem::path& devices = "/dev");

/// Printers of the system's print service and on the network. Blocks for up to `patience_ms`.
std::vector<Machine> find_printers(int patience_ms = 1500);

/// All of the above and the slicer, registered ones first; what is registered is not listed twice.
std::vector<Machine> find_machines(const MachineRegistry& registry);

/// The one of that id, or (for the command line) name in any case. Throws Error{invalid_input, "machine"} naming what
/// there is.
const Machine& choose_machine(const std::vector<Machine>& machines, const std::string& name_or_id);

}  // namespace formwright
