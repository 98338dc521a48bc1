// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "formats/ply/ply.h"
#include "formats/shared/byte_order.h"
#include "formats/shared/colour.h"
#include "formats/io_test_tools.h"
#include "formats/model_samples.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinULP;
using namespace test;

TEST_CASE("Ply.AsciiWithPropertiesInAnyOrder") {
  const ModelFile file = read_text(
      "ply\nformat ascii 1.0\ncomment by hand\nobj_info anything\nelement vertex 4\nproperty uchar blue\nproperty float z\nproperty uchar red\nproperty float quality\nproperty double x\n"
      "property uchar green\nproperty int8 y\nelement face 2\nproperty uchar flags\nproperty list uchar uint vertex_index\nend_header\n"
      "0 0 255 0.5 0 51 0\n0 0 0 1.5 1 0 0\n0 0 0 2.5 1 0 1\n0 0 0 3.5 0 0 1\n7 3 0 1 2\n7 3 0\n2 3\n",
      "a.ply");
  const Model& model = file.model;
  CHECK(model.mesh.V == (Positions(4, 3) << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0).finished());
  CHECK(model.mesh.F == (Triangles(2, 3) << 0, 1, 2, 0, 2, 3).finished());
  CHECK(model.vertex_colours.row(0).isApprox(Eigen::RowVector3d(1, linear_of_srgb(0.2), 0)));
  REQUIRE(file.columns.size() == 1u);
  CHECK(file.columns[0].name == "quality");
  CHECK(file.columns[0].kind == ColumnKind::float32);
  CHECK(file.columns[0].values == Eigen::Vector4d(0.5, 1.5, 2.5, 3.5));
}

/// One file of every type of number, in one byte order.
template <bool big_endian>
Bytes every_type() {
  Bytes bytes = to_bytes(
      std::string("ply\r\nformat ") + (big_endian ? "binary_big_endian" : "binary_little_endian") +
      " 1.0\r\nelement other 2\r\nproperty list ushort double junk\r\nelement vertex 3\r\nproperty char x\r\nproperty ushort y\r\nproperty double z\r\n"
      "property short a\r\nproperty uint b\r\nproperty int c\r\nproperty uchar d\r\nproperty float e\r\nelement face 1\r\nproperty list int short vertex_indices\r\nend_header\r\n");
  const auto put = [&](auto value) {
    auto raw = std::bit_cast<std::array<std::byte, sizeof(value)>>(value);
    if (big_endian) std::ranges::reverse(raw);
    bytes.insert(bytes.end(), raw.begin(), raw.end());
  };
  put(std::uint16_t{0}), put(std::uint16_t{2}), put(1.5), put(2.5);
  for (int i = 0; i < 3; ++i) {
    put(static_cast<std::int8_t>(-i)), put(static_cast<std::uint16_t>(60000 + i)), put(0.1 * i * i);
    put(std::int16_t{-300}), put(std::uint32_t{4'000'000'000u}), put(std::int32_t{-2'000'000'000}),
        put(std::uint8_t{200}), put(0.25f);
  }
  put(std::int32_t{3}), put(std::int16_t{2}), put(std::int16_t{0}), put(std::int16_t{1});
  return bytes;
}

TEST_CASE("Ply.EveryTypeInBothByteOrders") {
  for (const Bytes& bytes : {every_type<false>(), every_type<true>()}) {
    const ModelFile file = read_bytes(bytes, "a.ply");
    CHECK(file.model.mesh.V == (Positions(3, 3) << 0, 60000, 0, -1, 60001, 0.1, -2, 60002, 0.1 * 4).finished());
    CHECK(file.model.mesh.F.row(0) == Eigen::RowVector3i(2, 0, 1));
    REQUIRE(file.columns.size() == 5u);
    const double expected[] = {-300, 4e9, -2e9, 200, 0.25};
    const ColumnKind kinds[] = {ColumnKind::int32, ColumnKind::float64, ColumnKind::int32, ColumnKind::uint8,
                                ColumnKind::float32};
    for (std::size_t k = 0; k < 5; ++k) {
      CHECK(file.columns[k].values == Eigen::VectorXd::Constant(3, expected[k]));
      CHECK(file.columns[k].kind == kinds[k]);
    }
  }
}

constexpr std::string_view quad_header = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";

TEST_CASE("Ply.PolygonsAndTextureOfCorners") {
  // A concave quadrangle, with MeshLab's texture coordinates per corner, and a triangle without any.
  const ModelFile file = read_text(
      "ply\nformat ascii 1.0\ncomment TextureFile my picture.png\n" + std::string(quad_header) +
          "element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n"
          "0 0 0\n4 0 0\n1 1 0\n0 4 0\n4 1 2 3 0 8 0.1 0.9 0.2 0.8 0.3 0.7 0 1\n3 0 1 2 0\n",
      "a.ply");
  const Model& model = file.model;
  REQUIRE(model.mesh.face_count() == 3);
  for (int f = 0; f < 2; ++f)
    for (int k = 0; k < 3; ++k)
      CHECK_THAT(static_cast<float>(model.UV(model.FT(f, k), 0)),
                 WithinULP(0.1f * static_cast<float>(model.mesh.F(f, k)), 4));
  CHECK(signed_volume({model.mesh.V.rowwise() + Eigen::RowVector3d(0, 0, 1), model.mesh.F.topRows(2)}) > 0);
  CHECK(model.textures.at(0).name == "my picture.png");
  CHECK(file.missing_companions == std::vector<std::string>{"my picture.png"});
  CHECK(file.notes.size() == 1u);
}

TEST_CASE("Ply.TextureOfVertices") {
  for (const char* names : {"s t", "u v", "texture_u texture_v"}) {
    std::string text =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float " +
        std::string(names) +
        "\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0.25 0.5\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n";
    text.replace(text.find(std::string(names)) + std::string(names).find(' '), 1, "\nproperty float ");
    const Model model = read_text(text, "a.ply").model;
    {
      INFO(names);
      CHECK(model.UV.row(0) == Eigen::RowVector2d(0.25, 0.5));
    }
    CHECK(model.FT == model.mesh.F);
  }
}

TEST_CASE("Ply.TriangleStrips") {
  const Model model =
      read_text(
          "ply\nformat ascii 1.0\n" + std::string(quad_header) +
              "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 2 1 3\n",
          "a.ply")
          .model;
  CHECK(model.mesh.F == (Triangles(3, 3) << 0, 1, 2, 2, 1, 3, 2, 1, 3).finished());
}

TEST_CASE("Ply.FacesBeforeVertices") {
  const Model model = read_text("ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\n" +
                                    std::string(quad_header) + "end_header\n4 0 1 2 3\n0 0 0\n4 0 0\n1 1 0\n0 4 0\n",
                                "a.ply")
                          .model;
  CHECK(model.mesh.face_count() == 2);
  CHECK((model.mesh.F(0, 0) == 2 || model.mesh.F(0, 1) == 2 || model.mesh.F(0, 2) == 2));
}

TEST_CASE("Ply.ColumnsThatAreNotNumbersAreLeftOut") {
  const ModelFile file = read_text(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float q\nproperty float r\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0 nan 1\n1 0 0 0 2\n0 1 0 0 3\n3 0 1 2\n",
      "a.ply");
  REQUIRE(file.columns.size() == 1u);
  CHECK(file.columns[0].name == "r");
  CHECK(file.notes.size() == 1u);
}

TEST_CASE("Ply.WritesWhatItReads") {
  Model model = wavy_torus(13, 11);
  add_colours(model);
  const auto columns = sample_columns(model);
  WriteOptions options;
  options.columns = columns;
  for (const bool ascii : {false, true}) {
    options.ascii = ascii;
    const ModelFile file = read_bytes(write(model, MeshFormat::ply, options), "torus.ply");
    CHECK(file.model.mesh.V == model.mesh.V);  // every bit of a double
    CHECK(file.model.mesh.F == model.mesh.F);
    CHECK((file.model.vertex_colours - model.vertex_colours).cwiseAbs().maxCoeff() <
          0.5 / 255 * 2.4);  // half a step times the curve's slope
    REQUIRE(file.columns.size() == columns.size());
    for (std::size_t k = 0; k < columns.size(); ++k) {
      CHECK(file.columns[k].name == columns[k].name);
      CHECK(file.columns[k].kind == columns[k].kind);
      const double error = (file.columns[k].values - columns[k].values).cwiseAbs().maxCoeff();
      CHECK(error <= (columns[k].kind == ColumnKind::float32 ? 1e-7 : 0));
    }
    for (int f = 0; f < model.mesh.face_count(); ++f)
      for (int k = 0; k < 3; ++k)
        CHECK((file.model.UV.row(file.model.FT(f, k)) - model.UV.row(model.FT(f, k))).norm() < 1e-7);
  }
}

TEST_CASE("Ply.TextureWithoutSeamsIsPerVertex") {
  Model model = wavy_torus(6, 5);
  model.UV = model.mesh.V.leftCols<2>() / 100;
  model.FT = model.mesh.F;
  const Bytes bytes = write(model, MeshFormat::ply);
  CHECK(as_text(bytes).find("property double s") != std::string_view::npos);
  const Model again = read_bytes(bytes, "a.ply").model;
  CHECK(again.UV == model.UV);
  CHECK(again.FT == model.FT);
}

TEST_CASE("Ply.ColumnNamesThatAreTakenAreRefused") {
  const Model model = wavy_torus(4, 4);
  const std::vector<VertexColumn> columns{{"x", Eigen::VectorXd::Zero(16), ColumnKind::float64}};
  WriteOptions options;
  options.columns = columns;
  CHECK_THROWS_AS(write(model, MeshFormat::ply, options), Error);
}

TEST_CASE("Ply.BadFilesAreRefused") {
  const auto refused = [](const std::string& text, const std::string& part) {
    expect_refused(as_bytes(text), "bad.ply", part);
  };
  const std::string ascii = "ply\nformat ascii 1.0\n", vertices(quad_header),
                    faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string points = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  refused("ply\nformat ascii 1.0\nelement vertex 4\n", "its header has no end");
  refused("ply\nformat morse 1.0\nend_header\n", "line 2: “morse” is not a format");
  refused("ply\nelement vertex 1\nproperty float x\nend_header\n", "no “format” line");
  refused(ascii + "element vertex -3\nend_header\n", "line 3: an element needs a name and a count");
  refused(ascii + "element vertex 3\nproperty float80 x\nend_header\n", "line 4: “float80” is not a type");
  refused(ascii + "element vertex 3\nproperty float x\nproperty float x\nend_header\n", "declared twice");
  refused(ascii + "property float x\nend_header\n", "before any element");
  refused(ascii + "element vertex 0\nproperty list float int x\nend_header\n", "length of a list");
  refused(ascii + "nonsense\nend_header\n", "line 3: “nonsense”");
  refused(
      ascii +
          "element vertex 4\nproperty float x\nproperty float y\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0\n1 0\n1 1\n0 1\n3 0 1 2\n",
      "no x, y and z");
  refused(ascii + vertices + faces + points + "3 0 1 4\n",
          "line 14: face 1 refers to vertex 4, but the vertices count from 0 to 3");
  refused(ascii + vertices + faces + points + "3 0 1 -1\n", "face 1 refers to vertex -1");
  refused(ascii + vertices + faces + points + "3 0 1 0.5\n", "face 1 refers to vertex 0");
  refused(ascii + vertices + faces + points + "3 0 1 nan\n", "refers to vertex NaN");
  refused(ascii + vertices + faces + "0 0 0\n1 inf 0\n1 1 0\n0 1 0\n3 0 1 2\n",
          "line 11: a coordinate of vertex 2 is infinite");
  refused(ascii + vertices + faces + "0 0 0\n1 zwei 0\n1 1 0\n0 1 0\n3 0 1 2\n", "line 11: “zwei” is not a number");
  refused(ascii + vertices + faces + points + "3 0 1", "it ends too early");
  refused(ascii + vertices + faces + points + "3000000000 0 1 2\n", "a list in it is longer than the file");
  refused(ascii + vertices + "end_header\n" + points, "a cloud of points");
  refused(ascii + vertices + faces + points + "2 0 1\n", "no triangles");
  refused(ascii + "element vertex 0\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
          "no triangles");
  // A header of a hundred bytes with four billion vertices must not ask for memory.
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    refused(
        "ply\nformat " + std::string(format) +
            " 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n",
        "it declares 4 000 000 000 rows");
    refused("ply\nformat " + std::string(format) +
                " 1.0\nelement face 999999999999999\nproperty list uchar int vertex_indices\nend_header\n0\n",
            "more than it holds");
  }
  std::string binary = "ply\nformat binary_little_endian 1.0\n" + vertices + faces;
  binary += std::string(48, '\0');
  refused(binary, "more than it holds");
  refused(binary + "\x03" + std::string(8, '\0'), "a list in it is longer than the file");
  Bytes nan = to_bytes(binary + "\x03" + std::string(12, '\0'));
  store(nan.data() + nan.size() - 13 - 8, std::numeric_limits<float>::quiet_NaN());
  expect_refused(nan, "bad.ply", "a coordinate of vertex 4 is not a number");
  ReadOptions options;
  options.max_triangles = 1;
  expect_refused(as_bytes(ascii + vertices + faces + points + "4 0 1 2 3\n"), "large.ply", "at most 1 is read",
                 options);
}

}  // namespace
}  // namespace formwright
