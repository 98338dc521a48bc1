// SPDX-License-Identifier: GPL-3.0-or-later
// A few thousand damaged files: each is read as some sound mesh or refused in words; nothing else may happen. The
// fuzzers in tests/fuzz search deeper; this runs with every test.
#include <catch2/generators/catch_generators.hpp>
#include <catch2/generators/catch_generators_range.hpp>
#include <random>

#include "formats/io_test_tools.h"
#include "formats/model_samples.h"
#include "formats/container/zip.h"

namespace formwright {
namespace {
using namespace test;

void expect_sound_or_refused(ByteView bytes, const std::string& what) {
  ReadOptions options;
  options.max_triangles = 100'000;
  Context context;
  try {
    const Model model = read_model_file(bytes, "damaged.bin", options, context).model;
    write(model, MeshFormat::ply);  // checks every index and number on the way
  } catch (const Error& error) {
    {
      INFO(what << ": " << error.what());
      CHECK(error.code() == ErrorCode::invalid_input);
    }
    INFO(error.what());
    CHECK(std::string(error.what()).find("damaged.bin") != std::string::npos);
  } catch (const std::exception& error) {
    FAIL_CHECK(what << ": " << error.what());
  }
}

struct Sample {
  std::string name;
  Bytes bytes;
};

std::vector<Sample> samples() {
  Model model = wavy_torus(5, 4);
  add_materials_and_groups(model);
  const auto columns = sample_columns(model);
  std::vector<Sample> result;
  for (const auto& info : mesh_formats) {
    WriteOptions options;
    options.columns = columns;
    options.material_library = "m.mtl";
    result.push_back({std::string(info.extension), write(model, info.format, options)});
    options.ascii = true;
    if (info.format == MeshFormat::stl || info.format == MeshFormat::ply)
      result.push_back({std::string(info.extension) + " ascii", write(model, info.format, options)});
  }
  return result;
}

TEST_CASE("Mutation.NeverDoesAnythingElse") {
  const auto& [name, good] = GENERATE(from_range(samples()));
  for (unsigned seed = 0; seed < 600; ++seed) {
    std::mt19937 random(seed);
    const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
    Bytes bytes = good;
    const unsigned kind = seed % 4;
    if (kind == 0) bytes.resize(below(bytes.size()));
    if (kind == 1)
      for (std::size_t k = 1 + below(8); k > 0; --k) bytes[below(bytes.size())] = static_cast<std::byte>(random());
    if (kind == 2) {  // in the first part, where headers are
      for (std::size_t k = 1 + below(4); k > 0; --k)
        bytes[below(std::min<std::size_t>(bytes.size(), 400))] ^= static_cast<std::byte>(1u << below(8));
    }
    if (kind == 3) {  // a piece doubled or cut out
      const std::size_t from = below(bytes.size()), size = std::min(bytes.size() - from, 1 + below(100));
      const Bytes piece(bytes.begin() + static_cast<std::ptrdiff_t>(from),
                        bytes.begin() + static_cast<std::ptrdiff_t>(from + size));
      if (seed % 8 < 4)
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(below(bytes.size())), piece.begin(), piece.end());
      else
        bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(from),
                    bytes.begin() + static_cast<std::ptrdiff_t>(from + size));
    }
    expect_sound_or_refused(bytes, name + ", seed " + std::to_string(seed));
  }
}

TEST_CASE("Mutation.TheModelWithinA3mf") {
  // Changes to the archive are nearly always caught by its checksum: change the text and pack it rightly.
  Model model = wavy_torus(5, 4);
  add_materials_and_groups(model);
  const Bytes good = write(model, MeshFormat::three_mf);
  const ReadOptions options;
  Context context;
  const MeshSource source(good, "good.3mf", options, context);
  ZipArchive archive(source);
  const Bytes text = archive.read(*archive.find("3D/3dmodel.model"), 1 << 24);
  for (unsigned seed = 0; seed < 1500; ++seed) {
    std::mt19937 random(seed);
    std::string changed(as_text(text));
    for (std::size_t k = 1 + random() % 5; k > 0; --k) {
      constexpr std::string_view alphabet = "0123456789<>/\"' =-.#&;apvtxy";
      changed[random() % changed.size()] =
          seed % 2 ? alphabet[random() % alphabet.size()] : static_cast<char>(random());
    }
    if (seed % 5 == 0) changed.resize(random() % changed.size());
    ZipWriter zip;
    zip.add("3D/3dmodel.model", changed, context);
    expect_sound_or_refused(zip.finish(), "seed " + std::to_string(seed));
  }
}

TEST_CASE("Mutation.Noise") {
  for (unsigned seed = 0; seed < 2000; ++seed) {
    std::mt19937 random(seed);
    Bytes bytes(random() % 400);
    for (auto& byte : bytes) byte = static_cast<std::byte>(random());
    // With each format's beginning, so that its reader gets it.
    const std::string_view starts[] = {
        "", "ply\nformat binary_little_endian 1.0\n", "glTF\x02", "PK\x03\x04", "solid ", "v 1 2 3\n"};
    const std::string_view start = starts[seed % 6];
    bytes.insert(bytes.begin(), as_bytes(start).begin(), as_bytes(start).end());
    expect_sound_or_refused(bytes, "seed " + std::to_string(seed));
  }
}

}  // namespace
}  // namespace formwright
