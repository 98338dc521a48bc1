// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "formats/io_test_tools.h"
#include "formats/model_samples.h"
#include "formats/shared/colour.h"
#include "formats/three_mf/three_mf.h"
#include "formats/three_mf_parts.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinULP;
using namespace test;

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

}  // namespace
}  // namespace formwright
