// SPDX-License-Identifier: GPL-3.0-or-later
// Small files that would become large: each is refused in words, or read within 64 MB and 200 times its size. The
// memory is measured where the kernel tells it.
#include <zlib.h>

#include "base/peak_memory.h"
#include "formats/shared/byte_order.h"
#include "formats/glb_builder.h"
#include "formats/io_test_tools.h"
#include "formats/model_samples.h"
#include "formats/png/png16.h"
#include "formats/png/png_stream.h"
#include "formats/container/zip.h"

namespace formwright {
namespace {
using namespace test;

/// `text`, then `bytes` times `filling`, as raw deflate: a thousand to one.
struct Packed {
  Bytes bytes;
  std::uint32_t crc = 0;
  std::size_t size = 0;
};
Packed packed(const std::string& begin, char filling, std::size_t count, const std::string& end = "") {
  Packed result;
  z_stream stream{};
  if (deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 9, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
  Bytes out(1 << 16);
  const auto feed = [&](std::string_view text, int flush) {
    const auto* const data = reinterpret_cast<const Bytef*>(text.data());
    result.crc = static_cast<std::uint32_t>(crc32(result.crc, data, static_cast<uInt>(text.size())));
    result.size += text.size();
    stream.next_in = const_cast<Bytef*>(data);
    stream.avail_in = static_cast<uInt>(text.size());
    do {
      stream.next_out = reinterpret_cast<Bytef*>(out.data());
      stream.avail_out = static_cast<uInt>(out.size());
      deflate(&stream, flush);
      result.bytes.insert(result.bytes.end(), out.begin(), out.end() - static_cast<std::ptrdiff_t>(stream.avail_out));
    } while (stream.avail_out == 0);
  };
  feed(begin, Z_NO_FLUSH);
  const std::string piece(1 << 20, filling);
  for (std::size_t left = count; left > 0; left -= std::min(left, piece.size()))
    feed(std::string_view(piece).substr(0, left), Z_NO_FLUSH);
  feed(end, Z_FINISH);
  deflateEnd(&stream);
  return result;
}

/// An archive of plain texts and, under each of `names`, one packed entry that is there once; `declared` is the size
/// that the directory gives it.
Bytes archive(const std::vector<std::pair<std::string, std::string>>& texts, const std::vector<std::string>& names,
              const Packed& content, std::size_t declared) {
  Bytes bytes, directory;
  std::size_t count = 0;
  const auto local = [&](const std::string& name, ByteView data, std::uint32_t crc, std::size_t size, int method) {
    const auto offset = bytes.size();
    append(bytes, 0x04034b50u), append(bytes, std::uint16_t{20}), append(bytes, std::uint16_t{0});
    append(bytes, static_cast<std::uint16_t>(method)), append(bytes, 0u), append(bytes, crc);
    append(bytes, static_cast<std::uint32_t>(data.size())), append(bytes, static_cast<std::uint32_t>(size));
    append(bytes, static_cast<std::uint16_t>(name.size())), append(bytes, std::uint16_t{0});
    bytes.insert(bytes.end(), as_bytes(name).begin(), as_bytes(name).end());
    bytes.insert(bytes.end(), data.begin(), data.end());
    return offset;
  };
  const auto listed = [&](const std::string& name, std::size_t offset, std::size_t packed_size, std::uint32_t crc,
                          std::size_t size, int method) {
    append(directory, 0x02014b50u), append(directory, std::uint16_t{20}), append(directory, std::uint16_t{20});
    append(directory, std::uint16_t{0}), append(directory, static_cast<std::uint16_t>(method));
    append(directory, 0u), append(directory, crc), append(directory, static_cast<std::uint32_t>(packed_size));
    append(directory, static_cast<std::uint32_t>(size)), append(directory, static_cast<std::uint16_t>(name.size()));
    for (int k = 0; k < 4; ++k) append(directory, std::uint16_t{0});
    append(directory, 0u), append(directory, static_cast<std::uint32_t>(offset));
    directory.insert(directory.end(), as_bytes(name).begin(), as_bytes(name).end());
    ++count;
  };
  for (const auto& [name, text] : texts) {
    const auto crc = static_cast<std::uint32_t>(
        crc32(0, reinterpret_cast<const Bytef*>(text.data()), static_cast<uInt>(text.size())));
    listed(name, local(name, as_bytes(text), crc, text.size(), 0), text.size(), crc, text.size(), 0);
  }
  const std::size_t place = local("shared", content.bytes, content.crc, content.size, 8);
  for (const std::string& name : names) listed(name, place, content.bytes.size(), content.crc, declared, 8);
  const auto start = static_cast<std::uint32_t>(bytes.size());
  bytes.insert(bytes.end(), directory.begin(), directory.end());
  append(bytes, 0x06054b50u), append(bytes, 0u);
  for (int k = 0; k < 2; ++k) append(bytes, static_cast<std::uint16_t>(count));
  append(bytes, static_cast<std::uint32_t>(directory.size())), append(bytes, start), append(bytes, std::uint16_t{0});
  return bytes;
}

Bytes archive(const std::vector<std::pair<std::string, std::string>>& texts, const std::vector<std::string>& names,
              const Packed& content) {
  return archive(texts, names, content, content.size);
}

void expect_within(ByteView bytes, const std::optional<double>& grown_mb) {
  if (!grown_mb) return;
  CHECK(*grown_mb <= 64 + 200 * static_cast<double>(bytes.size()) / (1 << 20));
  std::printf("%zu bytes took %.1f MB\n", bytes.size(), *grown_mb);
}

void expect_refused_within(ByteView bytes, const std::string& name, const std::string& part,
                           const ReadOptions& options = {}) {
  expect_within(bytes, peak_growth_mb([&] { expect_refused(bytes, name, part, options); }));
}

/// However it ends, in an answer or in a refusal.
void expect_answered_within(ByteView bytes, const std::string& name, const ReadOptions& options = {}) {
  expect_within(bytes, peak_growth_mb([&] {
                  Context context;
                  try {
                    read_model_file(bytes, name, options, context);
                  } catch (const Error& error) {
                    INFO(error.what());
                    CHECK(error.code() == ErrorCode::invalid_input);
                  }
                }));
}

const std::string model_begin = "<model><resources>";
const std::string triangle =
    "<object id='1'><mesh><vertices><vertex x='0' y='0' z='0'/><vertex x='1' y='0' z='0'/><vertex x='0' y='1' "
    "z='0'/></vertices><triangles><triangle v1='0' v2='1' v3='2'/></triangles></mesh></object>";
const std::string build = "</resources><build><item objectid='1'/></build></model>";

TEST_CASE("Limits.ManyTexturesOnOneEntryAreCountedAsOftenAsTheyAreUnpacked") {
  std::string model = model_begin;
  std::vector<std::string> pictures;
  std::string faces;
  for (int i = 0; i < 16; ++i) {
    const std::string id = std::to_string(2 * i + 10), group = std::to_string(2 * i + 11);
    pictures.push_back("p" + std::to_string(i) + ".png");
    model += "<m:texture2d id='" + id + "' path='/" + pictures.back() + "'/><m:texture2dgroup id='" + group +
             "' texid='" + id + "'><m:tex2coord u='0' v='0'/></m:texture2dgroup>";
    faces += "<triangle v1='0' v2='1' v3='2' pid='" + group + "' p1='0'/>";
  }
  std::string object = triangle;
  object.insert(object.find("<triangle "), faces);
  const auto bomb = [&](std::size_t megabytes) {
    return archive({{"3D/3dmodel.model", model + object + build}}, pictures,
                   packed("\x89PNG\r\n\x1a\n", '\0', megabytes << 20));
  };
  const Bytes large = bomb(128), many = bomb(20);
  REQUIRE(large.size() < 150'000u);
  expect_refused_within(large, "large.3mf", "unpacks to more than");
  expect_refused_within(many, "many.3mf", "unpacks to more than");
}

TEST_CASE("Limits.OnePictureUnderSeveralNumbersIsKeptOnce") {
  const std::string groups =
      "<m:texture2d id='10' path='/a.png'/><m:texture2d id='11' path='/A.png'/>"
      "<m:texture2dgroup id='20' texid='10'><m:tex2coord u='0' v='0'/></m:texture2dgroup>"
      "<m:texture2dgroup id='21' texid='11'><m:tex2coord u='0' v='0'/></m:texture2dgroup>";
  std::string object = triangle;
  object.insert(object.find("<triangle "),
                "<triangle v1='0' v2='1' v3='2' pid='20' p1='0'/><triangle v1='0' v2='1' v3='2' pid='21' p1='0'/>");
  const Bytes bytes = archive({{"3D/3dmodel.model", model_begin + groups + object + build}}, {"a.png"},
                              packed(std::string(as_text(red_pixel_png())), '\0', 0));
  const Model model = read_bytes(bytes, "a.3mf").model;
  CHECK(model.textures.size() == 1u);
  CHECK(model.textures[0].bytes == red_pixel_png());
}

TEST_CASE("Limits.CommentsInTwentyPartsAreUnpackedNoFurtherThanTheFileMay") {
  std::string components;
  std::vector<std::string> parts;
  for (int i = 0; i < 20; ++i) {
    parts.push_back("3D/part" + std::to_string(i) + ".model");
    components += "<component objectid='2' path='/" + parts.back() + "'/>";
  }
  const std::string root = model_begin + "<object id='1'><components>" + components + "</components></object>" + build;
  const Bytes bomb = archive({{"3D/3dmodel.model", root}}, parts,
                             packed("<model><!--", 'x', 48u << 20, "--><object id='2'/></model>"));
  REQUIRE(bomb.size() < 100'000u);
  expect_refused_within(bomb, "bomb.3mf", "unpacks to more than");
}

TEST_CASE("Limits.WhatAPackedTextBecomesIsCountedToo") {
  // 40 MB of text within the budget; its elements as numbers, names and nodes are not.
  const auto repeated = [](std::string_view element, std::size_t bytes) {
    std::string text;
    while (text.size() < bytes) text += element;
    return text;
  };
  for (const std::string_view element :
       {"<base/>", "<base name='abcdefghijklmnopq'/>", "<component objectid='1'/>", "<item objectid='1'/>"}) {
    const bool in_group = element.starts_with("<base"), in_object = element.starts_with("<component");
    const std::string model = model_begin +
                              (in_group    ? "<basematerials id='5'>"
                               : in_object ? "<object id='7'>"
                                           : "") +
                              repeated(element, 40u << 20) +
                              (in_group    ? "</basematerials>"
                               : in_object ? "</object>"
                                           : "") +
                              triangle + build;
    const Bytes bytes = archive({}, {"3D/3dmodel.model"}, packed(model, ' ', 0));
    CHECK(bytes.size() < 500'000u);
    expect_answered_within(bytes, "many.3mf");
  }
}

TEST_CASE("Limits.XmlNestsSoDeepAndTagsHaveSoManyAttributes") {
  std::string deep = "<model>", wide = "<model ";
  for (int i = 0; i < 300; ++i) deep += "<a>", wide += "a" + std::to_string(i) + "='' ";
  expect_refused(archive({{"3D/3dmodel.model", deep}}, {}, {}), "deep.3mf", "nested more than 256 deep");
  expect_refused(archive({{"3D/3dmodel.model", wide + "/>"}}, {}, {}), "wide.3mf", "more than 256 attributes");
}

TEST_CASE("Limits.SizesThatTheDirectoryDeclaresAreChecked") {
  const std::string text = model_begin + triangle + build;
  const auto declared = [&](std::size_t size) { return archive({}, {"3D/3dmodel.model"}, packed(text, ' ', 0), size); };
  CHECK(read_bytes(declared(text.size()), "a.3mf").model.mesh.face_count() == 1);
  for (const std::size_t small : {std::size_t{0}, std::size_t{1}, text.size() - 1})
    expect_refused_within(declared(small), "small.3mf", "unpacks to more than its directory says");
  expect_refused_within(declared(50u << 20), "large.3mf", "is damaged");
  expect_refused_within(declared(0xFFFFFFF0u), "large.3mf", "unpacks to more than");
}

TEST_CASE("Limits.GltfNestsSoDeep") {
  const std::string deep = R"({"asset":{"version":"2.0"},"extras":)" + std::string(200'000, '[');
  expect_refused_within(to_bytes(deep), "deep.gltf", "its JSON is damaged");
  expect_refused_within(make_glb(deep + std::string(200'000, ']') + "}", {}), "deep.glb", "its JSON is damaged");
}

TEST_CASE("Limits.SparseAccessorsAreUnpackedOnce") {
  // A thousand primitives whose positions are one sparse accessor of 100 000 zeros but one.
  Bytes binary;
  put(binary, std::uint32_t{1}, 1.f, 2.f, 3.f, std::uint16_t{0}, std::uint16_t{1}, std::uint16_t{2}, std::uint16_t{0});
  const auto document = [&](int primitives, int sparse) {
    std::string list, accessors, nodes, meshes;
    for (int i = 0; i < primitives; ++i)
      list += (i ? "," : "") + std::string(R"({"attributes":{"POSITION":)") + std::to_string(i % sparse) +
              R"(},"indices":)" + std::to_string(sparse) + "}";
    for (int i = 0; i < sparse; ++i)
      accessors +=
          R"({"componentType":5126,"count":40000,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":0,"componentType":5125},"values":{"bufferView":1}}},)";
    return make_glb(
        R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[)" + list +
            R"(]}],"buffers":[{"byteLength":24}],"bufferViews":[{"buffer":0,"byteLength":4},{"buffer":0,"byteOffset":4,"byteLength":12},{"buffer":0,"byteOffset":16,"byteLength":6}],"accessors":[)" +
            accessors + R"({"bufferView":2,"componentType":5123,"count":3,"type":"SCALAR"}]})",
        binary);
  };
  const Bytes shared = document(1000, 1);
  expect_within(shared, peak_growth_mb([&] { read_bytes(shared, "a.glb"); }));
  const Bytes each = document(1000, 1000);
  expect_answered_within(each, "each.glb");
}

TEST_CASE("Limits.ColumnsOverOneAccessorAreCounted") {
  const int vertices = 20'000;
  std::string attributes = R"("POSITION":0)";
  for (int i = 0; i < 4000; ++i) attributes += ",\"_C" + std::to_string(i) + "\":1";
  Bytes binary(static_cast<std::size_t>(vertices) * 12);
  for (int v = 0; v < vertices; ++v) store(binary.data() + 12 * v, static_cast<float>(v));
  const std::string count = std::to_string(vertices), bytes = std::to_string(binary.size());
  const Bytes file = make_glb(
      R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{)" + attributes +
          R"(},"mode":5}]}],"buffers":[{"byteLength":)" + bytes + R"(}],"bufferViews":[{"buffer":0,"byteLength":)" +
          bytes + R"(}],"accessors":[{"bufferView":0,"componentType":5126,"count":)" + count +
          R"(,"type":"VEC3"},{"bufferView":0,"componentType":5126,"count":)" + count + R"(,"type":"SCALAR"}]})",
      binary);
  expect_refused_within(file, "columns.glb", "repeated so often");
}

TEST_CASE("Limits.OneLibraryAndOnePictureUnderManyNamesAreReadOnce") {
  std::string obj, mtl;
  for (int i = 0; i < 20'000; ++i) obj += "mtllib a.mtl\n";
  obj += "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int i = 0; i < 20'000; ++i) {
    obj += "usemtl m" + std::to_string(i) + "\nf 1 2 3\n";
    mtl += "newmtl m" + std::to_string(i) + "\nmap_Kd f" + std::to_string(i) + "/p.png\n";
  }
  Bytes picture = red_pixel_png();
  picture.resize(100'000);
  const Bytes library = to_bytes(mtl), text = to_bytes(obj);
  const Companion companions[] = {{"a.mtl", library}, {"p.png", picture}};
  ReadOptions options;
  options.companions = companions;
  expect_within(text, peak_growth_mb([&] {
                  const ModelFile file = read_bytes(text, "a.obj", options);
                  CHECK(file.model.materials.size() == 20'000u);
                  CHECK(file.model.textures.size() == 1u);
                  CHECK(file.model.textures.at(0).bytes.size() == picture.size());
                }));
}

TEST_CASE("Limits.PlyDeclaresSoManyElements") {
  std::string header = "ply\nformat ascii 1.0\n";
  for (int i = 0; i < 1500; ++i) header += "element e" + std::to_string(i) + " 0\n";
  expect_refused(to_bytes(header + "end_header\n"), "many.ply", "more than 1000 elements");
}

TEST_CASE("Limits.PicturesKeepNoPackedTexts") {
  // Forty texts, each of 8 kB that unpack to 7.9 MB.
  Grey16Image image{2, 2, 0.1, 0.1, std::vector<std::uint16_t>(4, 7)};
  const Bytes good = write_png16(image);
  Packed text = packed("", 'a', 7'900'000);
  Bytes chunk = to_bytes(std::string("k\0\0", 3));
  chunk.push_back(std::byte{0x78}), chunk.push_back(std::byte{0xda});
  chunk.insert(chunk.end(), text.bytes.begin(), text.bytes.end());
  uLong sum = adler32(0, nullptr, 0);
  const std::string piece(7'900'000, 'a');
  sum = adler32(sum, reinterpret_cast<const Bytef*>(piece.data()), static_cast<uInt>(piece.size()));
  const auto big_endian = [](Bytes& out, std::uint32_t value) {
    for (const unsigned shift : {24u, 16u, 8u, 0u}) out.push_back(static_cast<std::byte>(value >> shift));
  };
  big_endian(chunk, static_cast<std::uint32_t>(sum));
  Bytes bomb(good.begin(), good.begin() + 33);  // signature and IHDR
  for (int i = 0; i < 40; ++i) {
    big_endian(bomb, static_cast<std::uint32_t>(chunk.size()));
    Bytes named = to_bytes("zTXt");
    named.insert(named.end(), chunk.begin(), chunk.end());
    bomb.insert(bomb.end(), named.begin(), named.end());
    big_endian(bomb, static_cast<std::uint32_t>(
                         crc32(0, reinterpret_cast<const Bytef*>(named.data()), static_cast<uInt>(named.size()))));
  }
  bomb.insert(bomb.end(), good.begin() + 33, good.end());
  const auto grown = peak_growth_mb([&] { CHECK(read_png16(bomb, "a.png").levels == image.levels); });
  CHECK(grown.value_or(0) < 64);
}

}  // namespace
}  // namespace formwright
