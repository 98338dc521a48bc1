// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/machine_registry.h"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <fstream>

#include "base/error.h"
#include "machines/machine_log.h"
#include "machines/upload.h"

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

TEST(machine_registry, addresses_say_the_kind) {
  EXPECT_EQ(machine_from_words({"a", "ipps://printer.local/ipp/print", "", "", "", ""}).kind, MachineKind::printer);
  EXPECT_EQ(machine_from_words({"a", "ruida://192.168.1.30", "", "", "", ""}).controller, "ruida");
  EXPECT_EQ(machine_from_words({"a", "serial:/dev/ttyUSB0", "", "marlin", "", "250000"}).baud, 250000);
  EXPECT_EQ(machine_from_words({"a", "http://octopi.local/", "octoprint", "", "key", ""}).url, "http://octopi.local");
  EXPECT_EQ(where_of({"a", "http://octopi.local", "", "", "", ""}), "--kind");
  EXPECT_EQ(where_of({"a", "tcp://192.168.1.30", "", "", "", ""}), "--url");
  EXPECT_EQ(where_of({"a", "file:///etc/passwd", "", "", "", ""}), "--url");
  EXPECT_EQ(where_of({"a", "serial:ttyUSB0", "", "", "", ""}), "--url");
  EXPECT_EQ(where_of({"a", "serial:/dev/../etc/passwd", "", "", "", ""}), "--url");
  EXPECT_EQ(where_of({"a", "serial:/dev/ttyUSB0", "", "k40", "", ""}), "--controller");
  EXPECT_EQ(where_of({"a", "serial:/dev/ttyUSB0", "", "", "", "12"}), "--baud");
  EXPECT_EQ(where_of({"a\nb", "serial:/dev/ttyUSB0", "", "", "", ""}), "--name");
  EXPECT_EQ(where_of({"a", "ipp://x/y", "", "", "a\r\nX-Other: b", ""}), "--api-key-file");
}

TEST(machine_registry, what_is_added_is_there_again_and_unreadable_to_others) {
  const Folder folder;
  const MachineRegistry registry(folder.path);
  const Machine machine = machine_from_words({"Printer", "http://10.0.0.1:5000", "octoprint", "", "secret", ""});
  registry.add(machine);
  registry.add(machine_from_words({"Laser", "serial:/dev/ttyUSB3", "", "grbl_mill", "", "57600"}));
  const auto back = MachineRegistry(folder.path).read();
  ASSERT_EQ(back.size(), 2u);
  EXPECT_EQ(back[0].id, machine.id);
  EXPECT_EQ(back[0].api_key, "secret");
  EXPECT_EQ(machine_json(back[0]).dump().find("secret"), std::string::npos);
  EXPECT_EQ(back[1].baud, 57600);
  EXPECT_EQ(back[1].controller, "grbl_mill");
  struct stat status {};
  ASSERT_EQ(::stat((folder.path / "machines.json").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 077, 0u);
  EXPECT_THROW(registry.add(machine), Error);
  registry.remove("PRINTER");
  EXPECT_EQ(registry.read().size(), 1u);
  EXPECT_THROW(registry.remove("Printer"), Error);
  std::ofstream(folder.path / "machines.json")
      << "[{\"name\": 5}, 7, {\"name\": \"B\", \"url\": \"ipp://b/ipp/print\", \"later\": true}]";
  ASSERT_EQ(registry.read().size(), 1u);
  EXPECT_EQ(registry.read()[0].name, "B");
}

TEST(machine_registry, serial_ports_are_listed_once_and_by_their_lasting_name) {
  const Folder folder;
  std::filesystem::create_directories(folder.path / "serial/by-id");
  for (const char* name : {"ttyUSB0", "ttyUSB1", "ttyACM0", "ttyS0", "null"}) std::ofstream(folder.path / name) << "";
  std::filesystem::create_symlink("../../ttyUSB1", folder.path / "serial/by-id/usb-1a86_USB2.0-Serial-if00-port0");
  std::filesystem::create_symlink("../../ttyUSB9", folder.path / "serial/by-id/usb-gone-if00");
  const auto ports = find_serial_ports(folder.path);
  ASSERT_EQ(ports.size(), 3u);
  EXPECT_EQ(ports[0].name, "1a86 USB2.0-Serial");
  EXPECT_TRUE(ports[0].url.ends_with("by-id/usb-1a86_USB2.0-Serial-if00-port0"));
  EXPECT_EQ(ports[1].name, "ttyACM0");
  EXPECT_EQ(ports[2].name, "ttyUSB0");
  EXPECT_TRUE(find_serial_ports(folder.path / "nothing").empty());
}

TEST(machine_log, lines_are_whole_newest_first_and_half_ones_are_left_out) {
  const Folder folder;
  Machine machine;
  machine.id = "0123456789abcdef";
  machine.name = "Laser";
  MachineLog log(folder.path);
  for (int i = 0; i < 10; ++i)
    log.append(machine, {{"event", i % 2 ? "sent" : "note"}, {"text", "line " + std::to_string(i) + "\xff"}}, i == 9);
  for (const auto& file : std::filesystem::directory_iterator(folder.path / "machine_log"))
    std::ofstream(file.path(), std::ios::app) << "{\"event\": \"no";
  const Json all = log.newest(4, true), notes = log.newest(100, false);
  ASSERT_EQ(all.size(), 4u);
  EXPECT_GE(all[0]["unix_s"].get<double>(), all[3]["unix_s"].get<double>());
  EXPECT_EQ(notes.size(), 5u);
  EXPECT_EQ(notes[0]["name"], "Laser");
}

TEST(upload, file_names_are_plain) {
  EXPECT_EQ(upload_file_name("mould.gcode"), "mould.gcode");
  EXPECT_EQ(upload_file_name("../../etc/pass wd"), "pass_wd.gcode");
  EXPECT_EQ(upload_file_name("C:\\x\\a\"b.GCO"), "a_b.GCO.gcode");
  EXPECT_EQ(upload_file_name(std::string(500, 'x')).size(), 106u);
  EXPECT_THROW(upload_file_name("../"), Error);
  EXPECT_THROW(upload_file_name("..."), Error);
}

}  // namespace
}  // namespace formwright
