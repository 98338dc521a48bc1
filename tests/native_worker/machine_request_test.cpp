// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "base/error.h"
#include "machines/machine_page.h"
#include "machines/machine_session.h"

namespace formwright {
namespace {

TEST(machine_request, the_four_kinds) {
  EXPECT_EQ(read_machine_request(R"({"open": {"controller": "grbl"}})").content["controller"], "grbl");
  EXPECT_EQ(read_machine_request(R"({"n": 7, "command": {"do": "stop"}})").number, 7);
  const auto load = read_machine_request(R"({"load": {"name": "a", "sha256": ")" + std::string(64, 'a') + R"("}})");
  EXPECT_EQ(load.kind, MachineRequest::Kind::load);
  EXPECT_EQ(load.sha256, std::string(64, 'a'));
  EXPECT_EQ(read_machine_request(R"({"close": true})").kind, MachineRequest::Kind::close);
}

TEST(machine_request, anything_else_is_refused_with_a_sentence) {
  for (const std::string text :
       {"", "x", "{}", "[]", "{\"n\": 3}", "{\"open\": 3}", "{\"close\": false}", "{\"open\": {}, \"close\": true}",
        "{\"n\": 1.5, \"close\": true}", "{\"n\": 1e99, \"close\": true}",
        "{\"load\": {\"name\": \"a\", \"sha256\": \"../x\"}}", "{\"load\": {\"sha256\": 4}}", "{\"run\": {}}"}) {
    try {
      read_machine_request(text);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_input);
      EXPECT_TRUE(std::string(error.what()).ends_with('.')) << error.what();
    }
  }
}

TEST(driver_options, a_port_has_the_controllers_that_speak_over_it) {
  Machine serial;
  serial.controller = "grbl_mill";
  serial.baud = 57600;
  const Json options = driver_options(serial, nullptr);
  EXPECT_EQ(options["controller"], "grbl");
  EXPECT_EQ(options["tool"], "mill");
  EXPECT_EQ(options["baud"], 57600);
  EXPECT_EQ(driver_options(serial, {{"controller", "marlin"}})["controller"], "marlin");
  EXPECT_THROW(driver_options(serial, {{"controller", "ruida"}}), Error);
  EXPECT_THROW(driver_options(serial, {{"controller", "k40"}}), Error);
  EXPECT_THROW(driver_options(serial, Json::array()), Error);
  serial.controller = "marlin_printer";
  EXPECT_EQ(driver_options(serial, nullptr)["controller"], "marlin");
  EXPECT_EQ(driver_options(serial, nullptr)["tool"], "printer");
  Machine ruida;
  ruida.kind = MachineKind::ruida;
  ruida.controller = "ruida";
  EXPECT_EQ(driver_options(ruida, nullptr)["controller"], "ruida");
  EXPECT_THROW(driver_options(ruida, {{"controller", "grbl"}}), Error);
}

}  // namespace
}  // namespace formwright
