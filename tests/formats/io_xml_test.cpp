// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch_test_macros.hpp>

#include <string>
#include <string_view>

#include "base/error.h"
#include "formats/container/xml_reader.h"
#include "formats/shared/mesh_source.h"

namespace formwright {
namespace {

TEST_CASE("Xml.EntitiesCommentsAndCdata") {
  const ReadOptions options;
  Context context;
  const std::string_view text =
      "<?xml version='1.0'?><!-- <x> --><a:root one='1 &lt;&#x41;&#66;&amp;amp;' b:two = \"'\"><![CDATA[</root>]]><leaf/></a:root> junk";
  const MeshSource source(as_bytes(text), "x.xml", options, context);
  XmlReader xml(source);
  REQUIRE(xml.next());
  CHECK(xml.name() == "root");
  CHECK(xml.text_attribute("one") == "1 <AB&amp;");
  CHECK(xml.attribute("two") == "'");
  REQUIRE(xml.next());
  CHECK(xml.name() == "leaf");
  REQUIRE(xml.next());
  CHECK(xml.tag() == XmlReader::Tag::end);
  REQUIRE(xml.next());
  CHECK(xml.name() == "root");
  CHECK_FALSE(xml.next());
}

/// Reads all of it: "<a k='v'><b></b></a>" gives "a(k=v) b() /b /a ".
std::string tags_of(std::string_view text) {
  const ReadOptions options;
  Context context;
  const MeshSource source(as_bytes(text), "x.xml", options, context);
  std::string tags;
  for (XmlReader xml(source); xml.next();)
    tags += xml.tag() == XmlReader::Tag::end ? "/" + std::string(xml.name()) + " "
                                             : std::string(xml.name()) + "(" + std::string(xml.attribute("k")) + ")" +
                                                   std::to_string(xml.depth()) + " ";
  return tags;
}

void expect_no_xml(std::string_view text, const std::string& message) {
  INFO(message);
  try {
    tags_of(text);
    FAIL("It was read.");
  } catch (const Error& error) {
    CHECK(std::string(error.what()).find(message) != std::string::npos);
  }
}

TEST_CASE("Xml.TagsAtEveryPlaceInAPiece") {
  CHECK(tags_of("<a k='v'><b><c/></b><d></d></a>") == "a(v)1 b()2 c()3 /c /b d()2 /d /a ");
  CHECK(tags_of("<a/>") == "a()1 /a ");
  // Whatever lies at the end of a piece of 64 kB: a tag of several bytes moves over it, one byte at a time.
  for (std::size_t before = (64 << 10) - 20; before < (64 << 10) + 2; ++before) {
    const std::string text = "<a>" + std::string(before - 3, ' ') + "<b k='&lt;ä'/></a>";
    CHECK(tags_of(text) == "a()1 b(<ä)2 /b /a ");
  }
  const std::string long_value(200'000, 'x');
  CHECK(tags_of("<a><b k='" + long_value + "'/><c/></a>") == "a()1 b(" + long_value + ")2 /b c()2 /c /a ");
}

TEST_CASE("Xml.EncodingsAreThoseThatFilesDeclare") {
  CHECK(tags_of("<?xml version='1.0' encoding='ISO-8859-1'?><a k='\xe4'/>") == "a(ä)1 /a ");
  CHECK(tags_of("\xef\xbb\xbf<a k='ä'/>") == "a(ä)1 /a ");
  expect_no_xml("<?xml version='1.0' encoding='EBCDIC'?><a/>",
                "line 1: its XML is in an unusual encoding; export it in UTF-8.");
  expect_no_xml("<a k='\xe4'/>", "its XML is damaged");
}

TEST_CASE("Xml.WhatIsNotWellFormedIsRefusedWithItsLine") {
  expect_no_xml("<a>\n<b>\n</c></a>", "x.xml, line 3: the end of “c” does not match its beginning");
  expect_no_xml("<a>\n<b k=v/></a>", "x.xml, line 2: its XML is damaged; export it or copy it again.");
  expect_no_xml("<a k='1' k='2'/>", "x.xml, line 1: its XML is damaged");
  expect_no_xml("<a>&unknown;</a>", "its XML is damaged");
  expect_no_xml("<a>\n<b>", "x.xml: its XML ends too early; export it or copy it again.");
  expect_no_xml("<a><![CDATA[ x", "x.xml: its XML ends too early");
  expect_no_xml("<!DOCTYPE a [\n<!ENTITY b 'bbbb'>\n<!ENTITY c '&b;&b;&b;'>]><a>&c;</a>",
                "x.xml, line 1: its XML has a document type, which 3MF forbids");
}

TEST_CASE("Xml.LimitsHold") {
  std::string deep, wide = "<a";
  for (int i = 0; i < 256; ++i) deep += "<a>", wide += " k" + std::to_string(i) + "='1'";
  std::string closed = deep;
  for (int i = 0; i < 256; ++i) closed += "</a>";
  CHECK(tags_of(closed).ends_with("a()256 " + tags_of(closed).substr(tags_of(closed).find("/a"))));
  expect_no_xml(deep + "<a>", "its XML is nested more than 256 deep; export it again.");
  CHECK(tags_of(wide + "/>") == "a()1 /a ");
  expect_no_xml(wide + " k='1'/>", "a tag has more than 256 attributes; export it again.");
  expect_no_xml("<a>\n<b k='" + std::string(600'000, 'x') + "'/></a>",
                "x.xml, line 2: one of its tags is longer than 256 kB; export it again.");
  // Text and comments may be longer.
  CHECK(tags_of("<a>" + std::string(2'000'000, 'x') + "</a>") == "a()1 /a ");
  for (std::size_t bytes = 600'000; bytes < 600'010; ++bytes) {
    const std::string comment = "<!--" + std::string(bytes, '\n') + "\xc3\xa4-->";
    CHECK(tags_of(comment + "<a>" + comment + "<b/></a>" + comment) == "a()1 b()2 /b /a ");
    expect_no_xml(comment + "<a>" + comment + "<b></a>",
                  "x.xml, line " + std::to_string(2 * bytes + 1) + ": the end of “a”");
  }
  expect_no_xml("<a><!--" + std::string(600'000, 'x') + "--", "x.xml: its XML ends too early");
}

}  // namespace
}  // namespace formwright
