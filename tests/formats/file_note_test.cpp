// SPDX-License-Identifier: GPL-3.0-or-later
// A note changes nothing of what a file holds. Readers of others: tests/native_worker/made_by_test.py.
#include "formats/shared/file_note.h"

#include "formats/io_test_tools.h"
#include "formats/model_samples.h"
#include "formats/png/png16.h"

namespace formwright {
namespace {
using namespace test;

constexpr std::string_view note = R"({"operation":"relief","name":"a < b & c > d \u00e4","job":"0123456789abcdef"})";
constexpr std::string_view words = ", job 0123456789abcdef";

Bytes noted(Bytes file, std::string_view media_type) {
  add_note(file, media_type, note, words);
  return file;
}

bool holds(const Bytes& file, std::string_view text) { return as_text(file).find(text) != std::string_view::npos; }

TEST_CASE("FileNote.AMeshWithANoteIsReadAsWithout") {
  const Model model = wavy_torus(6, 8);
  for (const auto& [format, media_type, held] : {std::tuple{MeshFormat::ply, "application/x-ply", note},
                                                 {MeshFormat::obj, "model/obj", note},
                                                 {MeshFormat::glb, "model/gltf-binary", note},
                                                 {MeshFormat::three_mf, "model/3mf", note},
                                                 {MeshFormat::stl, "model/stl", words}}) {
    INFO(media_type);
    const std::string name = "model." + std::string(mesh_format_info(format).extension);
    const Bytes plain = write(model, format), file = noted(plain, media_type);
    REQUIRE(takes_note(media_type));
    CHECK(holds(file, held));
    const Model before = read_bytes(plain, name).model, after = read_bytes(file, name).model;
    CHECK(after.mesh.V == before.mesh.V);
    CHECK(after.mesh.F == before.mesh.F);
  }
}

TEST_CASE("FileNote.APictureWithANoteHasTheSamePixels") {
  Grey16Image image{3, 2, 0.1, 0.1, {0, 1, 2, 40'000, 50'000, 65'535}};
  const Bytes file = noted(write_png16(image), "image/png");
  CHECK(holds(file, note));
  const Grey16Image read = read_png16(file, "height.png");
  CHECK(read.levels == image.levels);
  CHECK(read.pixel_width_mm == image.pixel_width_mm);
}

TEST_CASE("FileNote.ADrawingsNoteIsEscaped") {
  const Bytes file = noted(to_bytes("<svg xmlns='http://www.w3.org/2000/svg'>\n</svg>\n"), "image/svg+xml");
  CHECK(holds(file, "<metadata id=\"made_by\">{\"operation\":\"relief\",\"name\":\"a &lt; b &amp; c &gt; d"));
  CHECK(as_text(file).ends_with("</metadata>\n</svg>\n"));
}

TEST_CASE("FileNote.ADrawingOfLinesHasTheWordsAboveItsFirstSection") {
  const Bytes file = noted(to_bytes("0\nSECTION\n2\nHEADER\n"), "image/vnd.dxf");
  CHECK(as_text(file) == "999\nFormwright, job 0123456789abcdef\n0\nSECTION\n2\nHEADER\n");
}

TEST_CASE("FileNote.ADocumentKeepsItsPropertiesAndGetsASubject") {
  // As libharu writes: objects, a table of references, a trailer.
  const std::string objects =
      "%PDF-1.6\n1 0 obj\n<<\n/Type /Catalog\n>>\nendobj\n2 0 obj\n<<\n/Title (A \\) >> b)\n>>\nendobj\n";
  const std::string file = objects + "xref\n0 3\n...\ntrailer\n<<\n/Root 1 0 R\n/Info 2 0 R\n/Size 3\n>>\nstartxref\n" +
                           std::to_string(objects.size()) + "\n%%EOF\n";
  Bytes with = to_bytes(file);
  add_note(with, "application/pdf", R"({"a":"(b) \\"})", words);
  const std::string_view text = as_text(with);
  REQUIRE(text.starts_with(file));
  const std::string_view update = text.substr(file.size());
  CHECK(update.starts_with(
      "2 0 obj\n<<\n/Title (A \\) >> b)\n/Subject ({\"a\":\"\\(b\\) \\\\\\\\\"})\n>>\nendobj\nxref\n2 1\n"));
  char entry[32];
  std::snprintf(entry, sizeof entry, "\n%010zu 00000 n\r\ntrailer", file.size());
  CHECK(update.find(entry) != std::string_view::npos);
  CHECK(update.find("/Prev " + std::to_string(objects.size()) + "\n") != std::string_view::npos);
  const std::size_t table = update.find("xref");
  CHECK(update.ends_with("startxref\n" + std::to_string(file.size() + table) + "\n%%EOF\n"));
}

TEST_CASE("FileNote.WhatIsNotAsThisProgramWritesItStays") {
  for (const char* media_type :
       {"application/pdf", "application/x-ply", "application/zip", "image/png", "image/svg+xml", "image/vnd.dxf",
        "model/3mf", "model/gltf-binary", "model/obj", "model/stl"})
    for (const std::string& text : {std::string(), std::string("\x89PNG"), std::string("glTF"), std::string(200, 'x'),
                                    std::string("%PDF-1.6\n"), std::string("%PDF-1.6\nstartxref\n0\n%%EOF\n"),
                                    std::string("%PDF-1.6\nstartxref\n99999\n%%EOF\n"), std::string("PK\x05\x06")}) {
      INFO(media_type << " " << text);
      CHECK(noted(to_bytes(text), media_type) == to_bytes(text));
    }
  CHECK_FALSE(takes_note("text/plain"));
  CHECK(noted(to_bytes("words"), "text/plain") == to_bytes("words"));
}

TEST_CASE("FileNote.AnStlWithoutRoomStays") {
  Bytes file = write(wavy_torus(6, 8), MeshFormat::stl);
  const Bytes plain = file;
  add_note(file, "model/stl", note, std::string(60, 'x'));
  CHECK(file == plain);
}

}  // namespace
}  // namespace formwright
