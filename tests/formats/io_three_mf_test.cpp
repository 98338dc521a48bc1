// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "formats/three_mf/three_mf.h"
#include "formats/shared/byte_order.h"
#include "formats/shared/colour.h"
#include "formats/io_test_tools.h"
#include "formats/model_samples.h"
#include "formats/container/xml_reader.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinULP;
using namespace test;

constexpr std::string_view relationships =
    R"(<?xml version="1.0"?><Relationships xmlns="x"><Relationship Target="/3D/3dmodel.model" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>)";
constexpr std::string_view triangle_mesh =
    R"(<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="2" z="0"/></vertices>
<triangles><triangle v1="0" v2="1" v3="2"/></triangles></mesh>)";

Bytes package(const std::string& model, const std::vector<std::pair<std::string, std::string>>& more = {}) {
  ZipWriter zip;
  const Context context;
  zip.add("_rels/.rels", relationships, context);
  zip.add("3D/3dmodel.model", model, context);
  for (const auto& [name, text] : more) zip.add(name, text, context);
  return zip.finish();
}

std::string model_of(const std::string& resources, const std::string& build, const std::string& attributes = "") {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- a comment with <tags> -->\n<model " + attributes +
         " xmlns=\"c\"><resources>\n" + resources + "\n</resources>\n<build>" + build + "</build></model>";
}

Model read_parts(const std::string& resources, const std::string& build, const std::string& attributes = "") {
  return read_bytes(package(model_of(resources, build, attributes)), "a.3mf").model;
}

std::string object(int id, const std::string& inside, const std::string& attributes = "") {
  return "<object id=\"" + std::to_string(id) + "\" " + attributes + ">" + inside + "</object>";
}

TEST_CASE("ThreeMf.GroupsAsObjectsOfTheirOwn") {
  Model model;
  model.mesh.V = (Positions(6, 3) << 0, 0, 0, 1, 0, 0, 0, 2, 0, 5, 0, 0, 6, 0, 0, 5, 2, 0).finished();
  model.mesh.F = (Triangles(2, 3) << 3, 4, 5, 0, 1, 2).finished();
  model.face_group = {0, 1};
  model.group_names = {"first <1>", "second"};
  WriteOptions options;
  options.object_per_group = true;
  const Model again = read_bytes(write(model, MeshFormat::three_mf, options), "a.3mf").model;
  CHECK(again.group_names == model.group_names);
  CHECK(again.face_group == model.face_group);
  for (int f = 0; f < 2; ++f)
    for (int k = 0; k < 3; ++k) CHECK(again.mesh.V.row(again.mesh.F(f, k)) == model.mesh.V.row(model.mesh.F(f, k)));
  CHECK(read_bytes(write(model, MeshFormat::three_mf, {}), "a.3mf").model.group_names.size() ==
        0u);               // unless asked for, one object
  model.mesh.F(1, 0) = 3;  // groups of one surface stay together
  CHECK(read_bytes(write(model, MeshFormat::three_mf, options), "a.3mf").model.mesh.vertex_count() == 6);
  CHECK(read_bytes(write(model, MeshFormat::three_mf, options), "a.3mf").model.group_names.size() == 0u);
}

TEST_CASE("ThreeMf.UnitsBecomeMillimetres") {
  const std::pair<const char*, double> units[] = {{"micron", 0.001}, {"millimeter", 1}, {"centimeter", 10},
                                                  {"inch", 25.4},    {"foot", 304.8},   {"meter", 1000}};
  for (const auto& [name, mm] : units) {
    const ModelFile file = read_bytes(package(model_of(object(1, std::string(triangle_mesh)),
                                                       "<item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 10 0 0\"/>",
                                                       std::string("unit=\"") + name + "\"")),
                                      "a.3mf");
    CHECK(file.unit == name);
    CHECK(file.model.mesh.V.isApprox((Positions(3, 3) << 10, 0, 0, 11, 0, 0, 10, 2, 0).finished() * mm, 1e-14));
  }
  CHECK(read_parts(object(1, std::string(triangle_mesh)), "<item objectid=\"1\"/>").mesh.V(1, 0) == 1);
}

TEST_CASE("ThreeMf.ComponentsAndTransforms") {
  // Row vectors: the item's matrix acts after the component's.
  const Model model = read_parts(
      object(1, std::string(triangle_mesh), "name=\"part &amp; piece\"") +
          object(
              2,
              "<components><component objectid=\"1\" transform=\"0 1 0 -1 0 0 0 0 1 5 0 0\"/><component objectid=\"1\" transform=\"-1 0 0 0 1 0 0 0 1 0 0 0\"/></components>"),
      "<item objectid=\"2\" transform=\"2 0 0 0 2 0 0 0 2 0 0 100\"/><item objectid=\"1\"/>");
  REQUIRE(model.mesh.face_count() == 3);
  CHECK(model.mesh.V.topRows(3).isApprox((Positions(3, 3) << 10, 0, 100, 10, 2, 100, 6, 0, 100).finished(), 1e-14));
  for (int f = 0; f < 3; ++f) {  // the mirrored one too
    const Vec3 a = model.mesh.V.row(model.mesh.F(f, 0)), b = model.mesh.V.row(model.mesh.F(f, 1)),
               c = model.mesh.V.row(model.mesh.F(f, 2));
    CHECK((b - a).cross(c - a).z() > 0);
  }
  CHECK(model.group_names == std::vector<std::string>{"object 2", "part & piece"});
  CHECK(model.face_group == std::vector<int>{0, 0, 1});
}

TEST_CASE("ThreeMf.ObjectsInOtherParts") {
  // The production extension, as Bambu Studio and newer PrusaSlicers write it; here the other part is in inches.
  const Bytes bytes =
      package(model_of(object(7, "<components><component objectid=\"1\" p:path=\"/3D/Objects/a.model\"/></components>"),
                       "<item objectid=\"7\"/>"),
              {{"3D/Objects/a.model", model_of(object(1, std::string(triangle_mesh)), "", "unit=\"inch\"")}});
  CHECK_THAT(read_bytes(bytes, "a.3mf").model.mesh.V(1, 0), WithinULP(25.4, 4));
  expect_refused(
      package(model_of(object(7, "<components><component objectid=\"1\" p:path=\"/3D/gone.model\"/></components>"),
                       "<item objectid=\"7\"/>")),
      "bad.3mf", "the part “3D/gone.model” is missing");
}

TEST_CASE("ThreeMf.BaseMaterialsAndColours") {
  const std::string vertices =
      "<mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/><vertex x=\"0\" y=\"2\" z=\"0\"/></vertices><triangles>";
  const std::string groups =
      "<basematerials id=\"5\"><base name=\"red\" displaycolor=\"#FF0000\"/><base name=\"blue\" displaycolor=\"#0000FF80\"/></basematerials>"
      "<m:colorgroup id=\"6\"><m:color color=\"#00FF00\"/><m:color color=\"#336699\"/></m:colorgroup>";
  const Model materials = read_parts(
      groups +
          object(
              1,
              vertices +
                  "<triangle v1=\"0\" v2=\"1\" v3=\"2\"/><triangle v1=\"0\" v2=\"1\" v3=\"2\" p1=\"0\"/><triangle v1=\"0\" v2=\"1\" v3=\"2\" pid=\"6\" p1=\"1\"/></triangles></mesh>",
              "pid=\"5\" pindex=\"1\""),
      "<item objectid=\"1\"/>");
  REQUIRE(materials.face_material.size() == 3u);
  CHECK(materials.materials[static_cast<std::size_t>(materials.face_material[0])].name == "blue");
  CHECK(materials.materials[static_cast<std::size_t>(materials.face_material[1])].name == "red");
  CHECK(materials.materials[static_cast<std::size_t>(materials.face_material[2])].name == "#336699");
  CHECK(materials.vertex_colours.rows() == 0);
  const Model corners = read_parts(
      groups +
          object(1,
                 vertices +
                     "<triangle v1=\"0\" v2=\"1\" v3=\"2\" pid=\"6\" p1=\"1\" p2=\"0\" p3=\"1\"/></triangles></mesh>"),
      "<item objectid=\"1\"/>");
  REQUIRE(corners.vertex_colours.rows() == 3);
  CHECK(corners.vertex_colours.row(1) == Eigen::RowVector3d(0, 1, 0));
  CHECK(corners.vertex_colours.row(2).isApprox(
      Eigen::RowVector3d(linear_of_srgb(0.2), linear_of_srgb(0.4), linear_of_srgb(0.6))));
}

TEST_CASE("ThreeMf.ColoursThatAreNotKeptAreNamed") {
  const std::string begin =
      "<m:colorgroup id=\"6\"><m:color color=\"#00FF00\"/><m:color color=\"#0000FF\"/></m:colorgroup><object id=\"1\"><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/><vertex x=\"0\" y=\"2\" z=\"0\"/><vertex x=\"1\" y=\"2\" z=\"0\"/></vertices><triangles>";
  const std::string end = "</triangles></mesh></object>", item = "<item objectid=\"1\"/>";
  const auto read = [&](const std::string& faces, const std::string& before = "") {
    return read_bytes(package(model_of(before + begin + faces + end, item)), "a.3mf");
  };
  // One colour a face, said once or three times: kept whole, as materials.
  const ModelFile faces = read(
      "<triangle v1=\"0\" v2=\"1\" v3=\"2\" pid=\"6\" p1=\"0\"/><triangle v1=\"2\" v2=\"1\" v3=\"3\" pid=\"6\" p1=\"1\" p2=\"1\" p3=\"1\"/>");
  CHECK(faces.model.vertex_colours.rows() == 0);
  REQUIRE(faces.model.face_material.size() == 2u);
  CHECK(faces.model.materials[static_cast<std::size_t>(faces.model.face_material[0])].name == "#00FF00");
  CHECK(faces.model.materials[static_cast<std::size_t>(faces.model.face_material[1])].name == "#0000FF");
  CHECK(faces.notes.empty());
  // Corners that agree where they meet: kept whole, as colours of vertices.
  const ModelFile agreeing = read(
      "<triangle v1=\"0\" v2=\"1\" v3=\"2\" pid=\"6\" p1=\"0\" p2=\"1\" p3=\"0\"/><triangle v1=\"2\" v2=\"1\" v3=\"3\" pid=\"6\" p1=\"0\" p2=\"1\" p3=\"1\"/>");
  CHECK(agreeing.model.vertex_colours == (Positions(4, 3) << 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 0, 1).finished());
  CHECK(agreeing.notes.empty());
  // Corners that do not: the first is kept, and a note says so.
  const ModelFile differing = read(
      "<triangle v1=\"0\" v2=\"1\" v3=\"2\" pid=\"6\" p1=\"0\" p2=\"1\" p3=\"0\"/><triangle v1=\"2\" v2=\"1\" v3=\"3\" pid=\"6\" p1=\"1\" p2=\"0\" p3=\"0\"/>");
  CHECK(differing.model.vertex_colours.row(2) == Eigen::RowVector3d(0, 1, 0));
  REQUIRE(differing.notes.size() == 1u);
  CHECK(differing.notes[0].find("At 2 vertices, faces of different colours meet") != std::string::npos);
  const ModelFile mixed = read("<triangle v1=\"0\" v2=\"1\" v3=\"2\" pid=\"9\" p1=\"0\"/>",
                               "<m:multiproperties id=\"9\" pids=\"6\"><m:multi pindices=\"0\"/></m:multiproperties>");
  CHECK(mixed.notes == std::vector<std::string>{"Mixed materials and colours were left out."});
  for (const char* const paint : {"paint_color=\"4\"", "slic3rpe:mmu_segmentation=\"8\""})
    CHECK(read("<triangle v1=\"0\" v2=\"1\" v3=\"2\" " + std::string(paint) + "/>").notes ==
          std::vector<std::string>{"Colours painted in a slicer were left out."});
}

TEST_CASE("ThreeMf.SupportsAreLeftOutAndAnEmptyPlateIsAll") {
  const std::string two =
      object(1, std::string(triangle_mesh)) + object(2, std::string(triangle_mesh), "type=\"support\"");
  CHECK(read_parts(two, "<item objectid=\"1\"/><item objectid=\"2\"/>").mesh.face_count() == 1);
  CHECK(read_parts(two, "").mesh.face_count() == 1);
}

TEST_CASE("ThreeMf.WritesWhatItReads") {
  Model model = wavy_torus(15, 12);
  const Model plain = read_bytes(write(model, MeshFormat::three_mf), "a.3mf").model;
  CHECK(as_float(plain.mesh).V == as_float(model.mesh).V);
  CHECK(plain.mesh.F == model.mesh.F);
  Model coloured = model;
  add_colours(coloured);
  const Model colours = read_bytes(write(coloured, MeshFormat::three_mf), "a.3mf").model;
  CHECK((colours.vertex_colours - coloured.vertex_colours).cwiseAbs().maxCoeff() < 0.5 / 255 * 2.4);
  add_materials_and_groups(model);
  const Model textured = read_bytes(write(model, MeshFormat::three_mf), "a.3mf").model;
  REQUIRE(textured.textures.size() == 1u);
  CHECK(textured.textures[0].bytes == model.textures[0].bytes);
  for (int f = 0; f < model.mesh.face_count(); ++f) {
    const Material& material =
        textured.materials[static_cast<std::size_t>(textured.face_material[static_cast<std::size_t>(f)])];
    CHECK(material.diffuse_texture == (model.face_material[static_cast<std::size_t>(f)] == 1 ? 0 : -1));
    if (material.diffuse_texture < 0) {
      CHECK(material.name == "grey");
    } else {
      for (int k = 0; k < 3; ++k)
        CHECK((textured.UV.row(textured.FT(f, k)) - model.UV.row(model.FT(f, k))).norm() < 1e-6);
    }
  }
}

TEST_CASE("ThreeMf.LargePartsArePackedInPieces") {
  // More rows than one piece of 16384 holds: joined, they are one deflate stream.
  const Model model = wavy_torus(200, 150);
  const Bytes bytes = write(model, MeshFormat::three_mf);
  const Model again = read_bytes(bytes, "a.3mf").model;
  CHECK(again.mesh.F == model.mesh.F);
  CHECK(write(model, MeshFormat::three_mf) == bytes);  // and always the same bytes
}

TEST_CASE("ThreeMf.BadFilesAreRefused") {
  const auto refused = [](const std::string& resources, const std::string& build, const std::string& part,
                          const std::string& attributes = "") {
    expect_refused(package(model_of(resources, build, attributes)), "bad.3mf", part);
  };
  const std::string mesh(triangle_mesh), item = "<item objectid=\"1\"/>";
  const auto spoiled = [&](const std::string& from, const std::string& to) {
    std::string text = mesh;
    text.replace(text.find(from), from.size(), to);
    return object(1, text);
  };
  refused(spoiled("v3=\"2\"", "v3=\"3\""), item,
          "(3D/3dmodel.model), line 5: a triangle refers to vertex 3, but its object has 3 vertices");
  refused(spoiled("v3=\"2\"", "v3=\"-1\""), item, "“v3” must be a whole number, not “-1”");
  refused(spoiled("v3=\"2\"", ""), item, "“v3” must be a whole number, not “”");
  refused(spoiled("y=\"2\"", "y=\"two\""), item, "“y” must be a number, not “two”");
  refused(spoiled("y=\"2\"", "y=\"nan\""), item, "a coordinate of vertex 3 is not a number");
  refused(spoiled("y=\"2\"", "y=\"1e300\""), item, "a coordinate of vertex 3 is beyond any real size");
  refused(object(1, mesh), "<item objectid=\"9\"/>", "object 9, which does not exist");
  refused(object(1, mesh) + object(1, mesh), item, "object 1 is defined twice");
  refused(object(1, mesh), "<item objectid=\"1\" transform=\"1 0 0\"/>", "a transform is not twelve numbers");
  refused(object(1, mesh), item, "“furlong” is not a unit", "unit=\"furlong\"");
  refused(object(1, ""), item, "it holds no triangles");
  refused(object(1, mesh, "pid=\"4\"") + "<basematerials id=\"4\"></basematerials>", item,
          "refers to property 0 of group 4");
  refused("<m:colorgroup id=\"6\"><m:color color=\"red\"/></m:colorgroup>", "", "“red” is not a colour");
  refused("<object id=\"1\">" + mesh.substr(0, mesh.find("</mesh>")), item, "does not match its beginning");
  expect_refused(package(model_of(object(1, mesh), item).substr(0, 250)), "bad.3mf", "its XML ends too early");
  expect_refused(package("<!DOCTYPE lolz [<!ENTITY lol \"lol\">]><model/>"), "bad.3mf", "a document type");
  expect_refused(package("\xff\xfe<model/>"), "bad.3mf", "UTF-16");
  expect_refused(package("no XML at all"), "bad.3mf", "its XML ends too early");
}

TEST_CASE("ThreeMf.CirclesAndDoublingAreRefusedAtOnce") {
  const std::string mesh(triangle_mesh);
  const auto component = [](int id) { return "<component objectid=\"" + std::to_string(id) + "\"/>"; };
  expect_refused(package(model_of(object(1, "<components>" + component(2) + "</components>") +
                                      object(2, "<components>" + component(1) + "</components>"),
                                  "<item objectid=\"1\"/>")),
                 "bad.3mf", "in a circle");
  expect_refused(
      package(model_of(object(1, "<components>" + component(1) + "</components>"), "<item objectid=\"1\"/>")),
      "bad.3mf", "in a circle");
  // Forty objects, each twice the one before: a billion triangles from five kilobytes.
  for (const bool empty : {false, true}) {
    std::string doubling = object(1, empty ? std::string() : mesh);
    for (int i = 2; i <= 40; ++i)
      doubling += object(i, "<components>" + component(i - 1) + component(i - 1) + "</components>");
    doubling += object(41, mesh);
    expect_refused(package(model_of(doubling, "<item objectid=\"40\"/><item objectid=\"41\"/>")), "bad.3mf",
                   empty ? "repeated more than a million times" : "at most");
  }
  // A deep tree is refused even if every level has been counted before.
  std::string chain = object(1, mesh), items;
  for (int i = 2; i <= 100; ++i)
    chain += object(i, "<components>" + component(i - 1) + "</components>"),
        items += "<item objectid=\"" + std::to_string(i) + "\"/>";
  expect_refused(package(model_of(chain, items)), "bad.3mf", "nested more than 64 deep");
}

TEST_CASE("ThreeMf.LimitsHold") {
  ReadOptions options;
  options.max_triangles = 1;
  const std::string two = object(1, std::string(triangle_mesh)), twice = "<item objectid=\"1\"/><item objectid=\"1\"/>";
  expect_refused(package(model_of(two, twice)), "large.3mf", "it holds 2 triangles, and at most 1 is read", options);
}

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
