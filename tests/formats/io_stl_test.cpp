// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/shared/byte_order.h"
#include "formats/io_test_tools.h"
#include "formats/model_samples.h"

namespace formwright {
namespace {
using namespace test;

constexpr std::string_view facet =
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n endloop\nendfacet\n";

Bytes binary_stl(const std::string& header, std::uint32_t declared, int triangles) {
  Bytes bytes = to_bytes(header);
  bytes.resize(80);
  append(bytes, declared);
  for (int i = 0; i < triangles; ++i) {
    for (const float x : {0.f, 0.f, 1.f, 0.f, 0.f, static_cast<float>(i), 1.f, 0.f, static_cast<float>(i), 0.f, 1.f,
                          static_cast<float>(i)})
      append(bytes, x);
    append(bytes, std::uint16_t{0});
  }
  return bytes;
}

TEST_CASE("Stl.BinaryAndAsciiGiveTheSameClosedMesh") {
  Model model = wavy_torus(20, 16);
  const TriangleMesh expected = as_float(model.mesh);
  for (const bool ascii : {false, true}) {
    WriteOptions options;
    options.ascii = ascii;
    const ModelFile file = read_bytes(write(model, MeshFormat::stl, options), "torus.stl");
    CHECK(file.format == MeshFormat::stl);
    CHECK(file.model.mesh.vertex_count() == 20 * 16);
    CHECK(unmatched_edges(file.model.mesh) == 0);
    CHECK(faces_by_place(as_float(file.model.mesh)) == faces_by_place(expected));
    CHECK(signed_volume(file.model.mesh) > 0);
  }
}

TEST_CASE("Stl.WithoutMergingItIsASoup") {
  ReadOptions options;
  options.merge_duplicates = false;
  const Model model = wavy_torus(5, 4);
  const Model soup = read_bytes(write(model, MeshFormat::stl), "torus.stl", options).model;
  CHECK(soup.mesh.vertex_count() == 3 * model.mesh.face_count());
  CHECK(faces_by_place(soup.mesh) == faces_by_place(as_float(model.mesh)));
}

TEST_CASE("Stl.BothZerosAreOnePlace") {
  const Model model =
      read_text(
          "solid\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
          "facet normal 0 0 0\nouter loop\nvertex -0 -0.0 0\nvertex 0 1 -0\nvertex -1 0 0\nendloop\nendfacet\nendsolid\n",
          "a.stl")
          .model;
  CHECK(model.mesh.vertex_count() == 4);
}

TEST_CASE("Stl.BinaryThatBeginsWithSolid") {
  CHECK(read_bytes(binary_stl("solid made by a careless program", 3, 3), "a.stl").model.mesh.face_count() == 3);
  // Even when its size is wrong as well.
  CHECK(read_bytes(binary_stl("solid made by a careless program", 0, 3), "a.stl").model.mesh.face_count() == 3);
}

TEST_CASE("Stl.WrongCountsAreReadByTheSize") {
  for (const std::uint32_t declared : {0u, 2u, 9u, 4'000'000'000u}) {
    const ModelFile file = read_bytes(binary_stl("x", declared, 3), "a.stl");
    CHECK(file.model.mesh.face_count() == 3);
    REQUIRE(file.notes.size() == 1u);
    CHECK(file.notes[0].find("the file holds 3") != std::string::npos);
  }
  Bytes annex = binary_stl("x", 3, 3);
  annex.resize(annex.size() + 17);
  const ModelFile file = read_bytes(annex, "a.stl");
  CHECK(file.model.mesh.face_count() == 3);
  CHECK(file.notes.size() == 1u);
}

TEST_CASE("Stl.AsciiDialects") {
  for (
      const char* text :
      {"SOLID A\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1 0 0\nVERTEX 0 1 0\nENDLOOP\nENDFACET\nENDSOLID A\n",
       "\n  solid\r\n facet normal nan nan nan\r\n outer loop\r\n vertex 0.0e+00 0 0\r\n vertex +1 0 0\r\n vertex 0 1. 0\r\n endloop\r\n endfacet\r\n endsolid",
       "solid facet normal vertex endsolid\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet\nendsolid facet vertex\n"}) {
    const Model model = read_text(text, "a.stl").model;
    INFO(text);
    CHECK(model.mesh.face_count() == 1);
    CHECK(model.mesh.V == (Positions(3, 3) << 0, 0, 0, 1, 0, 0, 0, 1, 0).finished());
  }
}

TEST_CASE("Stl.SeveralSolidsAreGroups") {
  const std::string text = "solid a\n" + std::string(facet) + "endsolid a\nsolid b c\n" + std::string(facet) +
                           std::string(facet) + "endsolid\n";
  const Model model = read_text(text, "a.stl").model;
  CHECK(model.group_names == std::vector<std::string>{"a", "b c"});
  CHECK(model.face_group == std::vector<int>{0, 1, 1});
}

TEST_CASE("Stl.BadFilesAreRefused") {
  const auto refused = [](const Bytes& bytes, const std::string& part) { expect_refused(bytes, "bad.stl", part); };
  const auto refused_text = [](const std::string& text, const std::string& part) {
    expect_refused(as_bytes(text), "bad.stl", part);
  };
  refused(binary_stl("x", 0, 0), "it holds no triangles");
  refused_text("solid of 0 triangles\nendsolid\n", "it holds no triangles");
  Bytes cut = binary_stl("x", 5, 5);
  cut.resize(cut.size() - 60);
  refused(cut, "it should hold 5 triangles but ends within triangle 4");
  refused(to_bytes("\x01\x02 short"), "within the header");
  Bytes nan = binary_stl("x", 2, 2);
  store(nan.data() + 84 + 50 + 12 + 4, std::numeric_limits<float>::quiet_NaN());
  refused(nan, "a coordinate of triangle 2 is not a number");
  store(nan.data() + 84 + 50 + 12 + 4, std::numeric_limits<float>::infinity());
  refused(nan, "a coordinate of triangle 2 is infinite");
  const std::string f(facet);
  refused_text("solid x\n" + f + f, "it ends before “endsolid”");
  refused_text("solid x\n" + f + f.substr(0, 60), "it ends before “endsolid”");
  refused_text("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\nendsolid\n",
               "line 7: a facet has 2 vertices");
  refused_text(
      "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n",
      "line 7: a facet has more than three vertices");
  refused_text("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 zero 0\n", "line 4: “zero” is not a coordinate");
  refused_text("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 nan 0\n",
               "line 4: a coordinate of triangle 1 is not a number");
  refused_text("solid x\nwhatever\n", "line 2: “whatever” is not a word of STL");
  ReadOptions options;
  options.max_triangles = 4;
  expect_refused(binary_stl("x", 5, 5), "large.stl", "at most 4 are read", options);
  expect_refused(as_bytes("solid x\n" + f + f + f + f + f + "endsolid\n"), "large.stl", "at most 4 are read", options);
}

TEST_CASE("Stl.WrittenNormalsAreUnitOrZero") {
  Model model;
  model.mesh.V = (Positions(4, 3) << 0, 0, 0, 2, 0, 0, 0, 2, 0, 1, 0, 0).finished();
  model.mesh.F = (Triangles(2, 3) << 0, 1, 2, 0, 1, 3).finished();  // the second has no area
  const Bytes bytes = write(model, MeshFormat::stl);
  REQUIRE(bytes.size() == 84u + 100u);
  CHECK_FALSE(as_text(bytes).starts_with("solid"));
  CHECK(load<float>(bytes.data() + 84 + 8) == 1);
  CHECK(load<float>(bytes.data() + 134 + 8) == 0);
}

}  // namespace
}  // namespace formwright
