// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "formats/obj/obj.h"
#include "formats/shared/colour.h"
#include "formats/io_test_tools.h"
#include "formats/model_samples.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinULP;
using namespace test;

constexpr std::string_view square_corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST_CASE("Obj.VerticesAndTriangles") {
  const Model model =
      read_text("# comment\no thing\nv 1.5 -2e-3 +3\nv 1 0 0 1.0\nv\t0  1 0 \nvn 0 0 1\nf 1 2 3\n", "a.obj").model;
  REQUIRE(model.mesh.vertex_count() == 3);
  CHECK(model.mesh.V(0, 0) == 1.5);
  CHECK(model.mesh.V(0, 1) == -2e-3);
  CHECK(model.mesh.V(0, 2) == 3);
  CHECK(model.mesh.F.row(0) == Eigen::RowVector3i(0, 1, 2));
  CHECK(model.vertex_colours.rows() == 0);
  CHECK(model.UV.rows() == 0);
}

TEST_CASE("Obj.EveryFormOfCorner") {
  const Model model =
      read_text(
          std::string(square_corners) +
              "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nf 1/1 2/2 3/3\nf 1/1/1 3/3/1 4/2/1\nf -4/-3 -3/-2 -2/-1\nf 1//1 2//1 3//1\nf 1 2 4\n",
          "a.obj")
          .model;
  REQUIRE(model.mesh.face_count() == 5);
  CHECK(model.mesh.F.row(2) == Eigen::RowVector3i(0, 1, 2));
  CHECK(model.FT.row(1) == Eigen::RowVector3i(0, 2, 1));
  CHECK(model.FT.row(2) == Eigen::RowVector3i(0, 1, 2));
  // Faces without texture vertices get one row of their own.
  REQUIRE(model.UV.rows() == 4);
  CHECK(model.FT.row(4) == Eigen::RowVector3i(3, 3, 3));
  CHECK(model.UV.row(3) == Eigen::RowVector2d(0, 0));
}

TEST_CASE("Obj.RelativeIndicesCountFromWhereTheyStand") {
  const Model model =
      read_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf -3 -2 -1\nf 1 -2 -1\n", "a.obj")
          .model;
  CHECK(model.mesh.F.row(0) == Eigen::RowVector3i(0, 1, 2));
  CHECK(model.mesh.F.row(1) == Eigen::RowVector3i(3, 4, 5));
  CHECK(model.mesh.F.row(2) == Eigen::RowVector3i(0, 4, 5));
}

TEST_CASE("Obj.LineEndsContinuationsAndComments") {
  for (const char* end : {"\n", "\r\n", "\r"}) {
    std::string text = "# C:\\models\\|v 0 0 0|v 1 0 0 # here|v 0 1 \\|0|f 1 2 \\|3 # there|";
    for (std::size_t bar = text.find('|'); bar != std::string::npos; bar = text.find('|')) text.replace(bar, 1, end);
    // Files of old Macintoshes have no \n at all, so a continued line cannot be told there.
    if (std::string_view(end) == "\r") text = "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r";
    const Model model = read_text(text, "a.obj").model;
    REQUIRE(model.mesh.vertex_count() == 3);
    CHECK(model.mesh.V.row(2) == Eigen::RowVector3d(0, 1, 0));
    CHECK(model.mesh.F.row(0) == Eigen::RowVector3i(0, 1, 2));
  }
}

TEST_CASE("Obj.ConcavePolygonsAreNotFans") {
  // A U: a fan from the first corner covers the gap. Its area is 7.
  const Model model =
      read_text(
          "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 2 3 0\nv 2 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\nvt 0 0\nf 1/1 2/1 3/1 4/1 5/1 6/1 7/1 8/1\n",
          "u.obj")
          .model;
  REQUIRE(model.mesh.face_count() == 6);
  double area = 0;
  for (int f = 0; f < 6; ++f) {
    const Vec3 a = model.mesh.V.row(model.mesh.F(f, 0)), b = model.mesh.V.row(model.mesh.F(f, 1)),
               c = model.mesh.V.row(model.mesh.F(f, 2));
    const double z = (b - a).cross(c - a).z() / 2;
    CHECK(z > 0);
    area += z;
  }
  CHECK_THAT(area, WithinULP(7.0, 4));
}

TEST_CASE("Obj.TextureCornersFollowTheTriangulation") {
  // Each vertex has its own texture vertex: wherever a corner goes, both go.
  std::string text =
      "v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nv -1 1 0\nvt 1 0\nvt 2 0\nvt 3 0\nvt 4 0\nvt 5 0\nf 5/5 1/1 2/2 3/3 4/4\n";
  const Model model = read_text(text, "a.obj").model;
  REQUIRE(model.mesh.face_count() == 3);
  CHECK(model.FT == model.mesh.F);
}

TEST_CASE("Obj.GroupsAndMaterials") {
  const ModelFile file = read_text(
      std::string("mtllib my materials.mtl other.mtl\n") + std::string(square_corners) +
          "f 1 2 3\no first  name\nusemtl red\nf 1 3 4\ng\ng second\nusemtl blue\nf 2 3 4\nusemtl red\nf 1 2 4\ng unused\n",
      "a.obj");
  const Model& model = file.model;
  CHECK(model.group_names == std::vector<std::string>{"first  name", "second"});
  CHECK(model.face_group == std::vector<int>{-1, 0, 1, 1});
  REQUIRE(model.materials.size() == 2u);
  CHECK(model.materials[1].name == "blue");
  CHECK(model.face_material == std::vector<int>{-1, 0, 1, 0});
  CHECK(file.material_libraries == std::vector<std::string>{"my materials.mtl other.mtl"});
  CHECK(file.missing_companions == std::vector<std::string>{"my materials.mtl other.mtl"});
}

TEST_CASE("Obj.MaterialsComeFromCompanions") {
  const std::string_view mtl =
      "newmtl red\nKd 1 0 0.5\nmap_Kd -s 1 1 1 -o 0.5 -clamp on Textures\\My Picture.PNG\nnewmtl unused\nKd 0 0 0\nnewmtl plain\nmap_Kd missing.jpg\n";
  const Bytes picture = red_pixel_png();
  const std::vector<Companion> companions{{"folder/MATERIALS.MTL", as_bytes(mtl)}, {"my picture.png", picture}};
  ReadOptions options;
  options.companions = companions;
  const ModelFile file =
      read_text("mtllib materials.mtl\n" + std::string(square_corners) + "usemtl red\nf 1 2 3\nusemtl plain\nf 1 3 4\n",
                "a.obj", options);
  REQUIRE(file.model.materials.size() == 2u);
  CHECK(file.model.materials[0].diffuse.isApprox(Vec3(1, 0, linear_of_srgb(0.5))));
  REQUIRE(file.model.textures.size() == 2u);
  CHECK(file.model.materials[0].diffuse_texture == 0);
  CHECK(file.model.textures[0].bytes == picture);
  CHECK(file.model.textures[0].media_type == "image/png");
  CHECK(file.model.materials[1].diffuse == Vec3(1, 1, 1));  // nothing dims a texture
  CHECK(file.model.textures[1].bytes.empty());
  CHECK(file.missing_companions == std::vector<std::string>{"missing.jpg"});
}

TEST_CASE("Obj.VertexColours") {
  const Model unit = read_text("v 0 0 0 1 0.5 0\nv 1 0 0 0 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj").model;
  REQUIRE(unit.vertex_colours.rows() == 3);
  CHECK(unit.vertex_colours.row(0).isApprox(Eigen::RowVector3d(1, linear_of_srgb(0.5), 0)));
  CHECK(unit.vertex_colours.row(2) == Eigen::RowVector3d(1, 1, 1));
  const Model bytes = read_text("v 0 0 0 255 51 0\nv 1 0 0 0 0 0\nv 0 1 0 0 0 0\nf 1 2 3\n", "a.obj").model;
  CHECK(bytes.vertex_colours.row(0).isApprox(Eigen::RowVector3d(1, linear_of_srgb(0.2), 0)));
}

TEST_CASE("Obj.WhatIsLeftOutIsSaid") {
  const ModelFile file = read_text(std::string(square_corners) + "f 1 2\nl 1 2 3\np 1\nf 1 2 3\n", "a.obj");
  CHECK(file.model.mesh.face_count() == 1);
  REQUIRE(file.notes.size() == 1u);
  CHECK(file.notes[0] == "1 face with fewer than three corners left out.");
}

TEST_CASE("Obj.NamesBecomeUtf8") {
  const ModelFile file = read_text(std::string(square_corners) +
                                       "g Gr\xFC\xDF"
                                       "e\nf 1 2 3\ng Gr\xC3\xBC\xC3\x9F"
                                       "e\nf 1 3 4\n",
                                   "a.obj");
  CHECK(file.model.group_names == std::vector<std::string>{"Grüße"});
}

TEST_CASE("Obj.ChunksDoNotShow") {
  // Many chunks of one megabyte: the same as one, also for what refers across their borders.
  Model model = wavy_torus(300, 300);
  add_materials_and_groups(model);
  WriteOptions options;
  options.material_library = "m.mtl";
  const Bytes bytes = write(model, MeshFormat::obj, options);
  REQUIRE(bytes.size() > 8u << 20);
  const Model again = read_bytes(bytes, "torus.obj").model;
  CHECK(again.mesh.V == model.mesh.V);
  CHECK(again.mesh.F == model.mesh.F);
  CHECK(again.UV == model.UV);
  CHECK(again.FT == model.FT);
  CHECK(again.face_group == model.face_group);
  CHECK(again.group_names == model.group_names);
  CHECK(again.face_material == model.face_material);
  // Relative indices of one vertex before another chunk, and continued lines, across the borders.
  std::string text;
  int vertices = 0;
  for (int i = 0; text.size() < (3u << 20); ++i) {
    text += "v " + std::to_string(i) + " 0 \\\n  0\nv 0 1 0\nv 0 0 1\nf -3 \\\n-2 -1\n";
    vertices += 3;
  }
  const Model long_file = read_text(text, "long.obj").model;
  REQUIRE(long_file.mesh.vertex_count() == vertices);
  for (int f = 0; f < long_file.mesh.face_count(); ++f)
    REQUIRE(long_file.mesh.F.row(f) == Eigen::RowVector3i(3 * f, 3 * f + 1, 3 * f + 2));
}

TEST_CASE("Obj.BadFilesAreRefusedWithTheLine") {
  const std::string good(square_corners);
  const auto refused = [](const std::string& text, const std::string& part) {
    expect_refused(as_bytes(text), "bad.obj", part);
  };
  refused(good + "f 1 2 5\n", "line 5: a face refers to vertex 5, but the file has 4");
  refused(good + "\n# x\nf 1 2 -5\n", "line 7: a face refers to vertex -5, but the file has 4 up to there");
  refused(good + "f 0 1 2\n", "vertex 0, but OBJ counts from 1");
  refused(good + "vt 0 0\nf 1/1 2/2 3/1\n", "line 6: a face refers to texture vertex 2");
  refused(good + "f 1 2 99999999999999999999999\n", "a face refers to vertex");
  refused("v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n", "line 2: a coordinate of vertex 2 is not a number (NaN)");
  refused("v 0 0 0\nv 1 -inf 0\nv 0 1 0\nf 1 2 3\n", "line 2: a coordinate of vertex 2 is infinite");
  refused("v 0 0 0\nv 1 1e999 0\nv 0 1 0\nf 1 2 3\n", "line 2: a coordinate of vertex 2");
  refused("v 0 0 0\nv 1 1e30 0\nv 0 1 0\nf 1 2 3\n", "beyond any real size");
  refused("v 0 0 0\nv 1,5 0 0\nv 0 1 0\nf 1 2 3\n", "line 2: “1,5” in a vertex is not a number");
  refused("v 0 0 0\nv 1 0\nv 0 1 0\nf 1 2 3\n", "line 2: a vertex has 2 numbers instead of 3");
  refused(good + "vt nan 0\nf 1/1 2/1 3/1\n", "texture vertex 1 is not a number");
  refused(good + "f 1 2 x\n", "“x” is not a corner of a face");
  refused(good + "vt 0 0\nf 1 2 3/1/1/1\n", "is not a corner of a face");
  refused(good, "it holds a cloud of points but no triangles");
  refused(good + "l 1 2\n", "points and lines");
  refused(good + "cstype bezier\nsurf 0 1 0 1 1 2 3 4\n", "free-form");
  refused("# nothing\n", "it holds no triangles");
  std::string binary = good + "f 1 2 3\n";
  binary[20] = '\0';
  refused(binary, "not a text file");
  std::string lines = "f 1 1 1\n";
  for (int i = 0; i < 1000; ++i) lines += "v 1\n";
  refused(lines, "too few numbers");
}

TEST_CASE("Obj.TooManyTrianglesAreRefusedBeforeTheyAreRead") {
  ReadOptions options;
  options.max_triangles = 3;
  options.where = "shape";
  expect_refused(as_bytes(std::string(square_corners) + "f 1 2 3 4\nf 1 2 3 4\n"), "large.obj",
                 "it holds 4 triangles, and at most 3 are read here", options);
  CHECK(read_text(std::string(square_corners) + "f 1 2 3 4\nf 1 2 3\n", "fits.obj", options).model.mesh.face_count() ==
        3);
}

TEST_CASE("Obj.CancelReachesTheReader") {
  Context context(Host{{}, [] { return true; }, {}});
  const Bytes bytes = to_bytes(std::string(square_corners) + "f 1 2 3\n");
  try {
    read_model_file(bytes, "a.obj", {}, context);
    FAIL();
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::cancelled);
  }
}

TEST_CASE("Mtl.ColoursAndOptions") {
  Context context;
  const ReadOptions options;
  const std::string_view text =
      "# c\nKd 1 1 1\nnewmtl a b\nKa 1 1 1\nKd 0.5\nnewmtl c\nKd spectral file.rfl 1\nmap_Kd -mm 0 1 -texres 512 -o 1 2 3 9 lives.png\n";
  const auto materials = read_mtl(MeshSource(as_bytes(text), "x.mtl", options, context));
  REQUIRE(materials.size() == 2u);
  CHECK(materials[0].material.name == "a b");
  CHECK(materials[0].material.diffuse.isApprox(Vec3::Constant(linear_of_srgb(0.5))));
  CHECK(materials[1].texture == "9 lives.png");
}

TEST_CASE("Mtl.BadColoursAreRefused") {
  const std::string_view mtl = "newmtl red\nKd red\n";
  const std::vector<Companion> companions{{"m.mtl", as_bytes(mtl)}};
  ReadOptions options;
  options.companions = companions;
  try {
    read_text("mtllib m.mtl\n" + std::string(square_corners) + "usemtl red\nf 1 2 3\n", "a.obj", options);
    FAIL();
  } catch (const Error& error) {
    CHECK(std::string(error.what()) == "m.mtl, line 2: Kd needs three numbers: red, green and blue; correct the line.");
  }
}

}  // namespace
}  // namespace formwright
