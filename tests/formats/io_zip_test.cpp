// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch_test_macros.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>

#include "formats/container/zip.h"
#include "formats/io_test_tools.h"
#include "formats/shared/byte_order.h"
#include "formats/three_mf_parts.h"

namespace formwright {
namespace {
using namespace test;

TEST_CASE("Zip.DamagedArchivesAreRefused") {
  const Bytes good = package(model_of(object(1, std::string(triangle_mesh)), "<item objectid=\"1\"/>"));
  CHECK(read_bytes(good, "a.3mf").model.mesh.face_count() == 1);
  for (const std::size_t size : {30u, 200u})
    expect_refused(ByteView(good).first(size), "cut.3mf", "zip archive ends too early");
  expect_refused(to_bytes("PK\x03\x04"), "cut.3mf", "ends too early");
  Bytes flipped = good;
  flipped[good.size() / 2] ^= std::byte{0xff};
  expect_refused(flipped, "flipped.3mf", "is damaged");
  ZipWriter zip;
  zip.add("readme.txt", "nothing", Context());
  expect_refused(zip.finish(), "other.3mf", "this zip archive holds no 3MF model");
  // Encrypted, or packed by a method other than deflate: flags and method in the directory's entries.
  for (const auto& [place, value, part] :
       {std::tuple{8u, 1u, "is encrypted"}, std::tuple{10u, 14u, "packed in an unusual way"}}) {
    Bytes marked = good;
    for (std::size_t i = 0; i + 4 < marked.size(); ++i)
      if (load<std::uint32_t>(marked.data() + i) == 0x02014b50)
        store(marked.data() + i + place, static_cast<std::uint16_t>(value));
    expect_refused(marked, "marked.3mf", part);
  }
}

TEST_CASE("Zip.CommentsAndZip64AreRead") {
  Bytes bytes = package(model_of(object(1, std::string(triangle_mesh)), "<item objectid=\"1\"/>"));
  const std::size_t end = bytes.size() - 22;
  // Move directory offset and entry count into a Zip64 end record, as some writers do for any size.
  const std::uint64_t count = load<std::uint16_t>(bytes.data() + end + 10),
                      directory = load<std::uint32_t>(bytes.data() + end + 16), size = end - directory;
  bytes.resize(end);
  const std::uint64_t end64 = bytes.size();
  append(bytes, 0x06064b50u), append(bytes, std::uint64_t{44}), append(bytes, std::uint16_t{45}),
      append(bytes, std::uint16_t{45}), append(bytes, 0u), append(bytes, 0u);
  append(bytes, count), append(bytes, count), append(bytes, size), append(bytes, directory);
  append(bytes, 0x07064b50u), append(bytes, 0u), append(bytes, end64), append(bytes, 1u);
  append(bytes, 0x06054b50u), append(bytes, 0u), append(bytes, std::uint16_t{0xFFFF}),
      append(bytes, std::uint16_t{0xFFFF}), append(bytes, static_cast<std::uint32_t>(size)), append(bytes, 0xFFFFFFFFu);
  append(bytes, std::uint16_t{7});
  for (const char c : std::string_view("comment")) bytes.push_back(static_cast<std::byte>(c));
  CHECK(read_bytes(bytes, "a.3mf").model.mesh.face_count() == 1);
}

}  // namespace
}  // namespace formwright
