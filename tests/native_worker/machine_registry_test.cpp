// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/port/machine_registry.h"

#include <catch2/catch_test_macros.hpp>
#include <stdlib.h>
#include <sys/stat.h>

#include <fstream>
#include <set>

#include "base/error.h"
#include "machines/port/machine_log.h"
#include "machines/print/upload.h"

namespace formwright {
namespace {

class Folder {
 public:
  Folder() {
    char name[] = "/tmp/formwright-test-XXXXXX";
    path = ::mkdtemp(name);
  }
  ~Folder() { std::filesystem::remove_all(path); }
  std::filesystem::path path;
};

std::string where_of(const MachineWords& words) {
  try {
    machine_from_words(words);
  } catch (const Error& error) {
    return error.where();
  }
  return "";
}

TEST_CASE("machine_registry.addresses_say_the_kind") {
  CHECK(machine_from_words({"a", "ipps://printer.local/ipp/print", "", "", "", ""}).kind == MachineKind::printer);
  CHECK(machine_from_words({"a", "ruida://192.168.1.30", "", "", "", ""}).controller == "ruida");
  CHECK(machine_from_words({"a", "serial:/dev/ttyUSB0", "", "marlin", "", "250000"}).baud == 250000);
  CHECK(machine_from_words({"a", "http://octopi.local/", "octoprint", "", "key", ""}).url == "http://octopi.local");
  CHECK(where_of({"a", "http://octopi.local", "", "", "", ""}) == "--kind");
  CHECK(where_of({"a", "tcp://192.168.1.30", "", "", "", ""}) == "--url");
  CHECK(where_of({"a", "file:///etc/passwd", "", "", "", ""}) == "--url");
  CHECK(where_of({"a", "serial:ttyUSB0", "", "", "", ""}) == "--url");
  CHECK(where_of({"a", "serial:/dev/../etc/passwd", "", "", "", ""}) == "--url");
  CHECK(where_of({"a", "serial:/dev/ttyUSB0", "", "k40", "", ""}) == "--controller");
  CHECK(where_of({"a", "serial:/dev/ttyUSB0", "", "", "", "12"}) == "--baud");
  CHECK(where_of({"a\nb", "serial:/dev/ttyUSB0", "", "", "", ""}) == "--name");
  CHECK(where_of({"a", "ipp://x/y", "", "", "a\r\nX-Other: b", ""}) == "--api-key-file");
}

TEST_CASE("machine_registry.what_is_added_is_there_again_and_unreadable_to_others") {
  const Folder folder;
  const MachineRegistry registry(folder.path);
  const Machine machine = machine_from_words({"Printer", "http://10.0.0.1:5000", "octoprint", "", "secret", ""});
  registry.add(machine);
  registry.add(machine_from_words({"Laser", "serial:/dev/ttyUSB3", "", "grbl_mill", "", "57600"}));
  const auto back = MachineRegistry(folder.path).read();
  REQUIRE(back.size() == 2u);
  CHECK(back[0].id == machine.id);
  CHECK(back[0].api_key == "secret");
  CHECK(machine_json(back[0]).dump().find("secret") == std::string::npos);
  CHECK(back[1].baud == 57600);
  CHECK(back[1].controller == "grbl_mill");
  struct stat status {};
  REQUIRE(::stat((folder.path / "machines.json").c_str(), &status) == 0);
  CHECK((status.st_mode & 077) == 0u);
  CHECK_THROWS_AS(registry.add(machine), Error);
  registry.remove("PRINTER");
  CHECK(registry.read().size() == 1u);
  CHECK_THROWS_AS(registry.remove("Printer"), Error);
  std::ofstream(folder.path / "machines.json")
      << "[{\"name\": 5}, 7, {\"name\": \"B\", \"url\": \"ipp://b/ipp/print\", \"later\": true}]";
  REQUIRE(registry.read().size() == 1u);
  CHECK(registry.read()[0].name == "B");
}

TEST_CASE("machine_registry.serial_ports_are_listed_once_and_by_their_lasting_name") {
  const Folder folder;
  std::filesystem::create_directories(folder.path / "serial/by-id");
  for (const char* name : {"ttyUSB0", "ttyUSB1", "ttyACM0", "ttyS0", "null"}) std::ofstream(folder.path / name) << "";
  std::filesystem::create_symlink("../../ttyUSB1", folder.path / "serial/by-id/usb-1a86_USB2.0-Serial-if00-port0");
  std::filesystem::create_symlink("../../ttyUSB9", folder.path / "serial/by-id/usb-gone-if00");
  const auto ports = find_serial_ports(folder.path);
  REQUIRE(ports.size() == 3u);
  CHECK(ports[0].name == "1a86 USB2.0-Serial");
  CHECK(ports[0].url.ends_with("by-id/usb-1a86_USB2.0-Serial-if00-port0"));
  CHECK(ports[1].name == "ttyACM0");
  CHECK(ports[2].name == "ttyUSB0");
  CHECK(find_serial_ports(folder.path / "nothing").empty());
}

TEST_CASE("machine_log.lines_are_whole_newest_first_and_half_ones_are_left_out") {
  const Folder folder;
  Machine machine;
  machine.id = "0123456789abcdef";
  machine.name = "Laser";
  MachineLog log(folder.path);
  for (int i = 0; i < 10; ++i)
    log.append(machine, {{"event", i % 2 ? "sent" : "note"}, {"text", "line " + std::to_string(i) + "\xff"}}, i == 9);
  log.flush();
  for (const auto& file : std::filesystem::directory_iterator(folder.path / "machine_log"))
    std::ofstream(file.path(), std::ios::app) << "{\"event\": \"no";
  const Json all = log.newest(4, true), notes = log.newest(100, false);
  REQUIRE(all.size() == 4u);
  CHECK(all[0]["unix_s"].get<double>() >= all[3]["unix_s"].get<double>());
  CHECK(notes.size() == 5u);
  CHECK(notes[0]["name"] == "Laser");
}

Machine machine_called(const std::string& id) {
  Machine machine;
  machine.id = id;
  machine.name = "Machine " + id;
  return machine;
}

/// Names of the files below `folder` that this process holds open.
std::set<std::string> held_open(const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const auto& descriptor : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code status;
    const auto file = std::filesystem::read_symlink(descriptor.path(), status);
    if (!status && file.parent_path() == std::filesystem::canonical(folder)) names.insert(file.filename().string());
  }
  return names;
}

std::vector<std::string> texts_in(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::vector<std::string> texts;
  for (std::string line; std::getline(stream, line);) texts.push_back(Json::parse(line)["text"].get<std::string>());
  return texts;
}

TEST_CASE("machine_log.two_machines_at_once_have_their_files_open_until_the_day_is_over") {
  const Folder folder;
  const auto logs = folder.path / "machine_log";
  const Machine first = machine_called("0123456789abcdef"), second = machine_called("fedcba9876543210");
  std::string day = "2026-11-23";
  MachineLog log(folder.path, [&] { return day; });
  std::vector<std::string> said;
  for (int i = 0; i < 50; ++i) {
    said.push_back("line " + std::to_string(i));
    log.append(first, {{"event", "sent"}, {"text", said.back()}});
    log.append(second, {{"event", "received"}, {"text", said.back()}});
    log.flush();
    // Neither is closed for the other: opening lists the folder, and a machine that is fed waits for that.
    const std::set<std::string> both{day + "-" + first.id + ".jsonl", day + "-" + second.id + ".jsonl"};
    INFO(i);
    REQUIRE(held_open(logs) == both);
  }
  day = "2026-11-24";
  log.append(second, {{"event", "note"}, {"text", "next day"}});
  log.flush();
  CHECK(held_open(logs) == std::set<std::string>{day + "-" + second.id + ".jsonl"});
  CHECK(texts_in(logs / ("2026-11-23-" + first.id + ".jsonl")) == said);
  CHECK(texts_in(logs / ("2026-11-23-" + second.id + ".jsonl")) == said);
  CHECK(texts_in(logs / ("2026-11-24-" + second.id + ".jsonl")) == std::vector<std::string>{"next day"});
  CHECK(log.newest(1, false)[0]["text"] == "next day");
}

TEST_CASE("machine_log.many_machines_do_not_use_up_the_descriptors") {
  const Folder folder;
  MachineLog log(folder.path);
  for (int turn = 0; turn < 2; ++turn)
    for (int i = 0; i < 100; ++i)
      log.append(machine_called(std::to_string(1000 + i)), {{"event", "note"}, {"text", "x"}});
  log.flush();
  CHECK(held_open(folder.path / "machine_log").size() <= 32u);
  CHECK(log.newest(500, false).size() == 200u);
}

TEST_CASE("machine_log.the_oldest_days_go_and_never_what_is_being_written") {
  const Folder folder;
  const auto logs = folder.path / "machine_log";
  std::filesystem::create_directories(logs);
  // No block of these is ever written.
  for (const char* name : {"2026-11-20-a.jsonl", "2026-11-22-a.jsonl", "2026-11-23-a.jsonl"}) {
    std::ofstream(logs / name).close();
    std::filesystem::resize_file(logs / name, std::uintmax_t{300} << 20);
  }
  std::filesystem::create_directories(logs / "2026-11-21-folder.jsonl");  // weighs nothing
  MachineLog log(folder.path, [] { return std::string("2026-11-23"); });
  log.append(machine_called("b"), {{"event", "note"}, {"text", "x"}});
  log.flush();
  CHECK_FALSE(std::filesystem::exists(logs / "2026-11-20-a.jsonl"));
  CHECK_FALSE(std::filesystem::exists(logs / "2026-11-22-a.jsonl"));
  CHECK(std::filesystem::exists(logs / "2026-11-21-folder.jsonl"));
  CHECK(std::filesystem::exists(logs / "2026-11-23-a.jsonl"));
  std::filesystem::resize_file(logs / "2026-11-23-a.jsonl", std::uintmax_t{600} << 20);
  log.append(machine_called("c"), {{"event", "note"}, {"text", "x"}});
  log.flush();
  CHECK(std::filesystem::exists(logs / "2026-11-23-a.jsonl"));  // another program may be at it
  CHECK(std::filesystem::exists(logs / "2026-11-23-b.jsonl"));
}

TEST_CASE("upload.file_names_are_plain") {
  CHECK(upload_file_name("mould.gcode") == "mould.gcode");
  CHECK(upload_file_name("../../etc/pass wd") == "pass_wd.gcode");
  CHECK(upload_file_name("C:\\x\\a\"b.GCO") == "a_b.GCO.gcode");
  CHECK(upload_file_name(std::string(500, 'x')).size() == 106u);
  CHECK_THROWS_AS(upload_file_name("../"), Error);
  CHECK_THROWS_AS(upload_file_name("..."), Error);
}

}  // namespace
}  // namespace formwright
