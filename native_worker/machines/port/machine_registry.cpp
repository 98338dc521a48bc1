// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/port/machine_registry.h"

#include <fcntl.h>
#include <strings.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "base/error.h"
#include "base/data/json_text.h"
#include "base/sha256.h"
#include "system/files.h"
#include "system/machine_errors.h"
#include "system/private_data.h"
#include "system/host.h"

namespace formwright {
namespace {

constexpr std::array<const char*, 6> kind_names{"serial", "ruida", "printer", "octoprint", "moonraker", "slicer"};
constexpr std::array<int, 12> baud_rates{9600,   19200,  38400,  57600,  76800,  115200,
                                         230400, 250000, 460800, 500000, 921600, 1000000};

std::string id_of(MachineKind kind, const std::string& address) {
  return sha256_hex(as_bytes(std::string(to_string(kind)) + "\n" + address)).substr(0, 16);
}

struct Address {
  std::string scheme, user, host, resource;
  int port = 0;
};

Address read_address(const std::string& url) {
  char scheme[32] = "", user[256] = "", host[256] = "", resource[1024] = "";
  int port = 0;
  const http_uri_status_t status = httpSeparateURI(HTTP_URI_CODING_ALL, url.c_str(), scheme, sizeof scheme, user,
                                                   sizeof user, host, sizeof host, &port, resource, sizeof resource);
  if (status < HTTP_URI_STATUS_OK)
    refuse("--url", "\"" + url +
                        "\" is not an address: give one such as ipp://192.168.1.20/ipp/print, http://octopi.local, "
                        "ruida://192.168.1.30, "
                        "tcp://192.168.1.31:23 or serial:/dev/ttyUSB0.");
  return {scheme, user, host, resource, port};
}

/// Keeps others out while the file is read, changed and written.
class FileLock {
 public:
  explicit FileLock(const std::filesystem::path& path)
      : descriptor_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600)) {
    if (descriptor_ < 0 || ::flock(descriptor_, LOCK_EX) != 0)
      refuse("--data", path.parent_path().string() + " cannot be written: choose another folder with --data.");
  }
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;
  ~FileLock() { ::close(descriptor_); }

 private:
  int descriptor_;
};

std::vector<Machine> machines_from_json(const Json& list) {
  std::vector<Machine> machines;
  for (const Json& entry : list) {
    const auto text = [&](const char* name) {
      return entry.is_object() && entry.contains(name) && entry[name].is_string() ? entry[name].get<std::string>()
                                                                                  : std::string();
    };
    try {
      machines.push_back(machine_from_words(
          {text("name"), text("url"), text("kind"), text("controller"), text("api_key"), text("baud")}));
    } catch (const Error&) {
      // Written by a later version, or by hand: the others count all the same.
    }
  }
  return machines;
}

}  // namespace

const char* to_string(MachineKind kind) { return kind_names[static_cast<std::size_t>(kind)]; }

const SerialController* find_serial_controller(const std::string& name) {
  const auto found = std::find_if(serial_controllers.begin(), serial_controllers.end(),
                                  [&](const SerialController& known) { return name == known.name; });
  return found == serial_controllers.end() ? nullptr : found;
}

std::string Machine::detail() const {
  if (!url.empty()) return url.starts_with("serial:") ? url.substr(7) : url;
  if (!destination) return "";
  const char* model = cupsGetOption("printer-make-and-model", destination->num_options, destination->options);
  return model ? model : "";
}

Json machine_json(const Machine& m) {
  Json json = {{"id", m.id},           {"name", m.name},   {"kind", to_string(m.kind)},
               {"detail", m.detail()}, {"state", m.state}, {"registered", m.registered}};
  if (!m.controller.empty()) json["controller"] = m.controller;
  if (m.kind == MachineKind::serial) json["baud"] = m.baud;
  return json;
}

Machine machine_from_words(const MachineWords& words) {
  Machine machine;
  machine.name = words.name;
  if (words.name.empty() || words.name.size() > 80 ||
      std::any_of(words.name.begin(), words.name.end(), [](char c) { return static_cast<unsigned char>(c) < 32; }))
    refuse("--name", "Give the machine a name of up to 80 letters: --name Studio.");
  if (words.url.empty())
    refuse("--url",
           "Say where the machine is: --url ipp://ADDRESS, http://ADDRESS, ruida://ADDRESS, tcp://ADDRESS:PORT or "
           "serial:/dev/NAME.");
  machine.url = words.url;
  machine.registered = true;
  machine.api_key = words.api_key;
  if (machine.api_key.size() > 512 || machine.api_key.find_first_of("\r\n") != std::string::npos)
    refuse("--api-key-file", "The key must be one line of up to 512 characters.");
  std::string controllers;
  if (words.url.starts_with("serial:")) {
    const std::string path = words.url.substr(7);
    if (!path.starts_with('/') || path.find("..") != std::string::npos)
      refuse("--url", "A serial port is named by its whole path: serial:/dev/ttyUSB0.");
    machine.kind = MachineKind::serial;
  } else {
    const Address address = read_address(words.url);
    if (!address.user.empty())
      refuse("--url", "A name or password does not belong in the address: give the key in a file, --api-key-file.");
    if (address.host.empty())
      refuse("--url", "\"" + words.url + "\" names no machine: write its address behind the two slashes.");
    if (address.scheme == "ipp" || address.scheme == "ipps") machine.kind = MachineKind::printer;
    else if (address.scheme == "ruida") machine.kind = MachineKind::ruida;
    else if (address.scheme == "tcp") machine.kind = MachineKind::serial;
    else if (address.scheme == "http" || address.scheme == "https") {
      if (words.kind != "octoprint" && words.kind != "moonraker")
        refuse("--kind", "Say what answers there: --kind octoprint or --kind moonraker.");
      machine.kind = words.kind == "octoprint" ? MachineKind::octoprint : MachineKind::moonraker;
      while (machine.url.ends_with('/')) machine.url.pop_back();
    } else {
      refuse("--url", "\"" + address.scheme +
                          "\" is no kind of address known here: ipp, ipps, http, https, ruida, tcp or serial.");
    }
    if (address.scheme == "tcp" && address.port <= 0)
      refuse("--url", "Name the port too: tcp://" + address.host + ":23.");
  }
  if (!words.kind.empty() && words.kind != to_string(machine.kind))
    refuse("--kind", "The address is that of a " + std::string(to_string(machine.kind)) +
                         ": leave --kind out, or correct --url.");
  if (machine.kind == MachineKind::serial) {
    machine.controller = words.controller.empty() ? "grbl" : words.controller;
    if (!find_serial_controller(machine.controller))
      refuse("--controller", "The controller must be grbl, grbl_mill, marlin or marlin_printer.");
  } else if (machine.kind == MachineKind::ruida) {
    machine.controller = "ruida";
  } else if (!words.controller.empty()) {
    refuse("--controller",
           "A " + std::string(to_string(machine.kind)) + " has no controller to choose: leave --controller out.");
  }
  if (!words.baud.empty()) {
    int baud = 0;
    const auto [end, error] = std::from_chars(words.baud.data(), words.baud.data() + words.baud.size(), baud);
    if (error != std::errc() || *end != '\0' ||
        std::find(baud_rates.begin(), baud_rates.end(), baud) == baud_rates.end())
      refuse("--baud", "The baud rate must be one of 9600 to 1000000 that ports have, such as 115200 or 250000.");
    machine.baud = baud;
  }
  machine.id = id_of(machine.kind, machine.url);
  return machine;
}

MachineRegistry::MachineRegistry(std::filesystem::path data) : data_(std::move(data)) { make_private(data_); }

std::vector<Machine> MachineRegistry::read() const {
  const auto path = data_ / "machines.json";
  std::error_code status;
  if (!std::filesystem::exists(path, status)) return {};
  const auto bytes = read_file(path, "--data", std::uintmax_t{4} << 20);
  const Json list = parse_json_text(as_text(*bytes));
  if (!list.is_array())
    refuse("--data",
           path.string() + " is not a list of machines: correct it, or move it away and add the machines again.");
  return machines_from_json(list);
}

void MachineRegistry::write(const std::vector<Machine>& machines) const {
  Json list = Json::array();
  for (const Machine& m : machines) {
    Json entry = {{"name", m.name}, {"kind", to_string(m.kind)}, {"url", m.url}};
    if (!m.api_key.empty()) entry["api_key"] = m.api_key;
    if (m.kind == MachineKind::serial) entry["controller"] = m.controller, entry["baud"] = std::to_string(m.baud);
    list.push_back(entry);
  }
  const auto path = data_ / "machines.json";
  const auto old = ::umask(0077);  // it holds keys
  try {
    write_file(path, as_bytes(json_text(list, 2) + "\n"));
  } catch (...) {
    ::umask(old);
    throw;
  }
  ::umask(old);
}

void MachineRegistry::add(const Machine& machine) const {
  std::error_code status;
  std::filesystem::create_directories(data_, status);
  const FileLock lock(data_ / "machines.lock");
  auto machines = read();
  for (const Machine& m : machines) {
    if (::strcasecmp(m.name.c_str(), machine.name.c_str()) == 0)
      refuse("--name",
             "There is a machine called " + m.name + " already: choose another name, or remove that one first.");
    if (m.id == machine.id) refuse("--url", "That address is registered already, as " + m.name + ".");
  }
  machines.push_back(machine);
  write(machines);
}

void MachineRegistry::remove(const std::string& name) const {
  std::error_code status;
  std::filesystem::create_directories(data_, status);
  const FileLock lock(data_ / "machines.lock");
  auto machines = read();
  const auto count = std::erase_if(
      machines, [&](const Machine& m) { return m.id == name || ::strcasecmp(m.name.c_str(), name.c_str()) == 0; });
  if (count == 0)
    refuse("machine", "No machine called " + name + " was registered: formwright machine list shows them.");
  write(machines);
}

}  // namespace formwright
