// SPDX-License-Identifier: GPL-3.0-or-later
// make_fuzz_seeds FOLDER: writes a folder of seeds for each target.
#include <filesystem>
#include <fstream>

#include "fuzz/seeds.h"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  for (const auto& [target, files] : formwright::fuzz::fuzz_seeds()) {
    const auto folder = std::filesystem::path(argv[1]) / target;
    std::filesystem::create_directories(folder);
    for (const auto& [name, bytes] : files)
      std::ofstream(folder / name, std::ios::binary)
          .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
}
