// SPDX-License-Identifier: GPL-3.0-or-later
// Forms and measures one object in the laboratory of another kind, for evidence-diagnose:
//   foreign_laboratory --mould NAME --cause NAME [--level 1|0.5|0.25] [--noise MM] [--points N] [--seed N] [--cells N]
//                      [--world-seed N] [--day-seed N] --out DIR
//   foreign_laboratory --names        the moulds and the causes
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "foreign_laboratory/measurement.h"

namespace {

using namespace formwright::foreign_laboratory;

double number(const std::string& flag, const std::string& text) {
  std::size_t used = 0;
  double value = 0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used == 0 || used != text.size()) throw std::invalid_argument(flag + ": '" + text + "' is not a number");
  return value;
}

int count(const std::string& flag, const std::string& text) {
  const double value = number(flag, text);
  if (!(value >= 0 && value <= 1e9) || value != static_cast<int>(value))
    throw std::invalid_argument(flag + ": give a whole number from 0 to 1,000,000,000");
  return static_cast<int>(value);
}

int run(int argument_count, char** arguments) {
  Request request;
  std::string out;
  for (int i = 1; i < argument_count; ++i) {
    const std::string flag = arguments[i];
    if (flag == "--names") {
      for (const auto& name : mould_names) std::printf("mould %s\n", std::string(name).c_str());
      for (const auto& name : cause_names) std::printf("cause %s\n", std::string(name).c_str());
      return 0;
    }
    if (i + 1 >= argument_count) throw std::invalid_argument(flag + ": give a value after it");
    const std::string value = arguments[++i];
    if (flag == "--mould") request.mould = mould_of(value);
    else if (flag == "--cause") request.cause = value;
    else if (flag == "--level") request.level = number(flag, value);
    else if (flag == "--noise") request.scan.noise_mm = number(flag, value);
    else if (flag == "--points") request.scan.points = count(flag, value);
    else if (flag == "--seed") request.seed = static_cast<unsigned>(count(flag, value));
    else if (flag == "--world-seed") request.world_seed = static_cast<unsigned>(count(flag, value));
    else if (flag == "--day-seed") request.day_seed = static_cast<unsigned>(count(flag, value));
    else if (flag == "--cells") request.forming.cells = count(flag, value);
    else if (flag == "--out") out = value;
    else throw std::invalid_argument(flag + ": unknown; see the head of foreign_laboratory.cpp");
  }
  if (out.empty()) throw std::invalid_argument("--out: give a folder to write to");
  const auto start = std::chrono::steady_clock::now();
  const auto files = make_object(request);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  std::filesystem::create_directories(out);
  for (const auto& [name, text] : files) {
    std::ofstream file(std::filesystem::path(out) / name, std::ios::binary);
    file << text;
    if (!file.flush()) throw std::runtime_error("--out: cannot write " + out + "/" + name);
  }
  std::printf("%s%.1f s\n", files.at("truth.json").c_str(), seconds.count());
  return 0;
}

}  // namespace

int main(int argument_count, char** arguments) {
  try {
    return run(argument_count, arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "foreign_laboratory: %s\n", error.what());
    return 2;
  }
}
