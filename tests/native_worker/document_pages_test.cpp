// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/print/document_pages.h"

#include <cups/raster.h>
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <algorithm>

#include <cstring>
#include <qpdf/Pl_Buffer.hh>
#include <qpdf/Pl_Flate.hh>

#include "base/error.h"
#include "base/peak_memory.h"
#include "machines/print/print_media.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinULP;

Bytes pdf(const std::string& page_words) {
  std::string text = "%PDF-1.7\n";
  std::vector<std::size_t> offsets;
  const auto add = [&](const std::string& object) {
    offsets.push_back(text.size());
    text += std::to_string(offsets.size()) + " 0 obj\n" + object + "\nendobj\n";
  };
  add("<</Type/Catalog/Pages 2 0 R>>");
  add("<</Type/Pages/Kids[3 0 R]/Count 1/MediaBox[0 0 595 842]>>");
  add("<</Type/Page/Parent 2 0 R" + page_words + ">>");
  const std::size_t start = text.size();
  text += "xref\n0 4\n0000000000 65535 f \n";
  for (const std::size_t offset : offsets) {
    char line[24];
    std::snprintf(line, sizeof line, "%010zu 00000 n \n", offset);
    text += line;
  }
  return to_bytes(text + "trailer\n<</Size 4/Root 1 0 R>>\nstartxref\n" + std::to_string(start) + "\n%%EOF\n");
}

PageSize size_of(const std::string& page_words) { return read_document_pages(pdf(page_words)).pages.at(0); }

TEST_CASE("document_pages.the_size_is_what_is_shown") {
  CHECK_THAT(size_of("").width_mm, WithinAbs(595 * 25.4 / 72, 1e-9));  // inherited
  CHECK_THAT(size_of("/MediaBox[0 0 720 360]").width_mm, WithinAbs(254, 1e-9));
  CHECK_THAT(size_of("/MediaBox[0 0 720 360]/Rotate 90").height_mm, WithinAbs(254, 1e-9));
  CHECK_THAT(size_of("/MediaBox[0 0 720 360]/Rotate -270").height_mm, WithinAbs(254, 1e-9));
  CHECK_THAT(size_of("/MediaBox[0 0 720 360]/Rotate 180").width_mm, WithinAbs(254, 1e-9));
  CHECK_THAT(size_of("/MediaBox[0 0 720 720]/CropBox[72 72 648 360]").height_mm, WithinAbs(101.6, 1e-9));
  CHECK_THAT(size_of("/MediaBox[720 360 0 0]").width_mm, WithinAbs(254, 1e-9));
  CHECK_THAT(size_of("/MediaBox[0 0 72 72]/UserUnit 10").width_mm, WithinAbs(254, 1e-9));
}

/// A PDF whose pages stand in an object stream (PDF 1.5) that is filled up with blanks. `type`: how its type is spelt.
Bytes pdf_with_object_stream(std::size_t blanks, const std::string& type = "/ObjStm",
                             const std::string& filter = "/FlateDecode") {
  const auto packed = [](const std::string& content) {
    Pl_Buffer collected("packed");
    Pl_Flate deflate("deflate", &collected, Pl_Flate::a_deflate);
    deflate.write(reinterpret_cast<const unsigned char*>(content.data()), content.size());
    deflate.finish();
    const auto buffer = collected.getBufferSharedPointer();
    return std::string(reinterpret_cast<const char*>(buffer->getBuffer()), buffer->getSize());
  };
  const std::string catalog = "<</Type/Catalog/Pages 2 0 R>> ",
                    pages = "<</Type/Pages/Kids[3 0 R]/Count 1/MediaBox[0 0 595 842]>> ",
                    page = "<</Type/Page/Parent 2 0 R>> ";
  const std::string numbers =
      "1 0 2 " + std::to_string(catalog.size()) + " 3 " + std::to_string(catalog.size() + pages.size()) + " ";
  const std::string objects = packed(numbers + catalog + pages + page + std::string(blanks, ' '));
  std::string text = "%PDF-1.5\n";
  const std::size_t stream_at = text.size();
  text += "4 0 obj\n<</Type" + type + "/N 3/First " + std::to_string(numbers.size()) + "/Filter" + filter + "/Length " +
          std::to_string(objects.size()) + ">>\nstream\n" + objects + "\nendstream\nendobj\n";
  const std::size_t table_at = text.size();
  std::string table;
  const auto row = [&](int kind, std::size_t a, int b) {
    table += static_cast<char>(kind);
    for (const unsigned shift : {16u, 8u, 0u}) table += static_cast<char>(a >> shift & 0xff);
    table += static_cast<char>(b);
  };
  row(0, 0, 0), row(2, 4, 0), row(2, 4, 1), row(2, 4, 2), row(1, stream_at, 0), row(1, table_at, 0);
  text += "5 0 obj\n<</Type/XRef/Size 6/Root 1 0 R/W[1 3 1]/Length " + std::to_string(table.size()) + ">>\nstream\n" +
          table + "\nendstream\nendobj\nstartxref\n" + std::to_string(table_at) + "\n%%EOF\n";
  return to_bytes(text);
}

TEST_CASE("document_pages.what_a_pdf_unpacks_to_is_counted") {
  CHECK_THAT(read_document_pages(pdf_with_object_stream(1000)).pages.at(0).width_mm, WithinAbs(595 * 25.4 / 72, 1e-9));
  const auto refused = [](const Bytes& bytes) -> std::string {
    try {
      read_document_pages(bytes);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  const Bytes bomb = pdf_with_object_stream(100u << 20);
  CHECK(bomb.size() < 110'000u);
  std::string sentence;
  const auto grown = test::peak_growth_mb([&] { sentence = refused(bomb); });
  {
    INFO(sentence);
    CHECK(sentence.find("far larger when unpacked") != std::string::npos);
  }
  CHECK(grown.value_or(0) < 64);
  CHECK(refused(pdf_with_object_stream(100u << 20, "/Obj#53tm")).find("far larger when unpacked") != std::string::npos);
  CHECK(refused(pdf_with_object_stream(1000, "/ObjStm", "[/FlateDecode/FlateDecode]")).find("an unusual way") !=
        std::string::npos);
}

TEST_CASE("document_pages.what_cannot_be_printed_says_why") {
  const auto sentence = [](ByteView bytes) -> std::string {
    try {
      read_document_pages(bytes);
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::invalid_input);
      CHECK(error.where() == "sha256");
      return error.what();
    }
    return "";
  };
  CHECK(sentence(pdf("/MediaBox[0 0 0 0]")).find("smaller than 1 mm") != std::string::npos);
  CHECK(sentence(pdf("/MediaBox[0 0 99999999 100]")).find("smaller than 1 mm") != std::string::npos);
  CHECK(sentence(to_bytes("%PDF-1.7\n")).find("cannot be read") != std::string::npos);
  CHECK(sentence({}).find("Only PDF") != std::string::npos);
  CHECK(sentence(to_bytes("RaS2 and nothing")).find("PWG raster") != std::string::npos);
}

std::string chunk(const std::string& name, const std::string& content) {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8) text += static_cast<char>(content.size() >> shift & 255);
  return text + name + content + "crc.";
}

std::string number(std::uint32_t value) {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8) text += static_cast<char>(value >> shift & 255);
  return text;
}

TEST_CASE("document_pages.a_png_is_as_large_as_its_density_says") {
  const std::string head = std::string("\x89PNG\r\n\x1a\n", 8) +
                           chunk("IHDR", number(2000) + number(1000) + "\x08\x02" + std::string(3, '\0'));
  const auto pages = read_document_pages(to_bytes(head + chunk("pHYs", number(10000) + number(5000) + "\x01")));
  CHECK(pages.media_type == "image/png");
  CHECK_THAT(pages.pages.at(0).width_mm, WithinULP(200.0, 4));
  CHECK_THAT(pages.pages.at(0).height_mm, WithinULP(200.0, 4));
  // A ratio only, after the pixels, or nothing: no size.
  for (const std::string& tail : {chunk("pHYs", number(1) + number(1) + std::string(1, '\0')),
                                  chunk("IDAT", "x") + chunk("pHYs", number(10000) + number(5000) + "\x01"),
                                  std::string(), number(0xffffffff) + "pHYs"})
    CHECK_THROWS_AS(read_document_pages(to_bytes(head + tail)), Error);
}

TEST_CASE("document_pages.a_pwg_raster_says_its_pixels_and_density") {
  Bytes written;
  const cups_raster_iocb_t take = [](void* context, unsigned char* data, std::size_t count) {
    auto& to = *static_cast<Bytes*>(context);
    to.insert(to.end(), reinterpret_cast<std::byte*>(data), reinterpret_cast<std::byte*>(data) + count);
    return static_cast<ssize_t>(count);
  };
  cups_raster_t* raster = cupsRasterOpenIO(take, &written, CUPS_RASTER_WRITE_PWG);
  cups_page_header2_t header{};
  header.HWResolution[0] = header.HWResolution[1] = 300;
  header.cupsWidth = 600, header.cupsHeight = 900;
  header.cupsBitsPerColor = header.cupsBitsPerPixel = 8;
  header.cupsBytesPerLine = 600;
  header.cupsNumColors = 1;
  header.cupsColorSpace = CUPS_CSPACE_SW;
  REQUIRE(cupsRasterWriteHeader2(raster, &header) == 1u);
  cupsRasterClose(raster);
  const auto pages = read_document_pages(written);
  CHECK(pages.media_type == "image/pwg-raster");
  CHECK_THAT(pages.pages.at(0).width_mm, WithinAbs(50.8, 1e-6));
  CHECK_THAT(pages.pages.at(0).height_mm, WithinAbs(76.2, 1e-6));
}

TEST_CASE("document_pages.mirroring_twice_keeps_the_page") {
  const Bytes once = mirrored_pdf(pdf("/MediaBox[0 0 720 360]/Rotate 90")), twice = mirrored_pdf(once);
  CHECK_THAT(read_document_pages(twice).pages.at(0).height_mm, WithinAbs(254, 1e-9));
  CHECK(once == mirrored_pdf(pdf("/MediaBox[0 0 720 360]/Rotate 90")));  // deterministic
  CHECK_THROWS_AS(mirrored_pdf(to_bytes("%PDF-1.7 nothing")), Error);
}

TEST_CASE("print_media.database_ready_margins_and_names") {
  ipp_t* answer = ippNew();
  const auto add = [&](const char* name, std::initializer_list<std::array<int, 4>> sizes) {
    std::vector<ipp_t*> all;
    for (const auto& [x, y, side, top] : sizes) {
      ipp_t *size = ippNew(), *media = ippNew();
      ippAddInteger(size, IPP_TAG_ZERO, IPP_TAG_INTEGER, "x-dimension", x);
      ippAddInteger(size, IPP_TAG_ZERO, IPP_TAG_INTEGER, "y-dimension", y);
      ippAddCollection(media, IPP_TAG_ZERO, "media-size", size);
      ippDelete(size);
      for (const char* margin : {"media-left-margin", "media-right-margin"})
        ippAddInteger(media, IPP_TAG_ZERO, IPP_TAG_INTEGER, margin, side);
      for (const char* margin : {"media-top-margin", "media-bottom-margin"})
        ippAddInteger(media, IPP_TAG_ZERO, IPP_TAG_INTEGER, margin, top);
      all.push_back(media);
    }
    ippAddCollections(answer, IPP_TAG_PRINTER, name, static_cast<int>(all.size()),
                      const_cast<const ipp_t**>(all.data()));
    for (ipp_t* media : all) ippDelete(media);
  };
  add("media-col-database",
      {{21000, 29700, 300, 400}, {21000, 29700, 0, 0}, {29700, 42000, 300, 400}, {12345, 6789, 1, 2}});
  add("media-col-ready", {{21000, 29700, 300, 400}});
  const auto media = read_print_media(answer);
  ippDelete(answer);
  REQUIRE(media.size() == 4u);
  const PrintMedia* a4 = find_print_media(media, "a4");
  REQUIRE(a4);
  CHECK(a4->name == "iso_a4_210x297mm");
  CHECK(a4->left_hmm == 300);  // the wider margins, which every tray keeps
  CHECK(a4->loaded);
  CHECK_FALSE(find_print_media(media, "iso_a3_297x420mm")->loaded);
  CHECK_FALSE(find_print_media(media, "A3")->by_hand);
  CHECK(find_print_media(media, "Legal") == nullptr);
  CHECK(media.back().width_mm() == 123.45);
  CHECK(page_matches(*a4, {209.9, 297.04}));
  CHECK(page_matches(*a4, {297, 210}));
  CHECK_FALSE(page_matches(*a4, {215.9, 279.4}));
}

TEST_CASE("document_pages.a_pwg_raster_in_either_order_of_bytes_whatever_it_claims_of_its_lines") {
  // Found by fuzzing: libcups set aside what the header said of a line, here 1.3 GB, for a file of 21 kB.
  cups_page_header2_t header{};
  header.HWResolution[0] = header.HWResolution[1] = 300;
  header.cupsWidth = 2480;
  header.cupsHeight = 3508;
  header.cupsBytesPerLine = 1349675374;
  Bytes low_end_first = to_bytes("2SaR");
  const auto* bytes = reinterpret_cast<const std::byte*>(&header);
  low_end_first.insert(low_end_first.end(), bytes, bytes + sizeof header);
  Bytes high_end_first = low_end_first;
  for (std::size_t at = 0; at + 4 <= high_end_first.size(); at += 4)
    std::reverse(high_end_first.begin() + static_cast<std::ptrdiff_t>(at),
                 high_end_first.begin() + static_cast<std::ptrdiff_t>(at + 4));
  for (const Bytes& raster : {low_end_first, high_end_first}) {
    const DocumentPages pages = read_document_pages(raster);
    REQUIRE(pages.pages.size() == 1u);
    CHECK_THAT(pages.pages[0].width_mm, WithinAbs(25.4 * 2480 / 300, 1e-9));
    CHECK_THAT(pages.pages[0].height_mm, WithinAbs(25.4 * 3508 / 300, 1e-9));
  }
  CHECK_THROWS_AS(read_document_pages(ByteView(low_end_first).first(1000)), Error);
}

}  // namespace
}  // namespace formwright
