// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <functional>

#include "base/data/json.h"
#include "formats/glb_builder.h"
#include "formats/io_test_tools.h"
#include "formats/model_samples.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinULP;
using namespace test;

/// One triangle in metres: positions (36 bytes), then indices of the given type.
struct Triangle {
  Bytes binary;
  Json json;
  explicit Triangle(int index_type = 5123) {
    put(binary, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 2.f, 0.f);
    if (index_type == 5121) put(binary, std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{2}, std::uint8_t{0});
    if (index_type == 5123) put(binary, std::uint16_t{0}, std::uint16_t{1}, std::uint16_t{2}, std::uint16_t{0});
    if (index_type == 5125) put(binary, 0u, 1u, 2u);
    json = Json::parse(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
      "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
      "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}]})");
    json["buffers"] = Json::array({{{"byteLength", binary.size()}}});
    json["bufferViews"][1]["byteLength"] = binary.size() - 36;
    json["accessors"][1]["componentType"] = index_type;
  }
  Bytes bytes() const { return make_glb(json.dump(), binary); }
  ModelFile read() const { return read_bytes(bytes(), "a.glb"); }
};

TEST_CASE("Glb.EveryTypeOfIndexAndNone") {
  for (const int type : {5121, 5123, 5125, 0}) {
    Triangle triangle(type);
    if (type == 0) triangle.json["meshes"][0]["primitives"][0].erase("indices");
    const ModelFile file = triangle.read();
    CHECK(file.unit == "m");
    CHECK(file.model.mesh.V == (Positions(3, 3) << 0, 0, 0, 1000, 0, 0, 0, 2000, 0).finished());
    CHECK(file.model.mesh.F == (Triangles(1, 3) << 0, 1, 2).finished());
  }
}

TEST_CASE("Glb.NodeTransformsAreMultiplied") {
  Triangle triangle;
  triangle.json["nodes"] = Json::parse(
      R"([{"children":[1,2],"translation":[1,2,3]},{"mesh":0,"name":"turned","rotation":[0,0,0.7071067811865476,0.7071067811865476],"scale":[2,1,1]},
                                          {"mesh":0,"matrix":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 5,0,0,1]}])");
  const Model model = triangle.read().model;
  REQUIRE(model.mesh.face_count() == 2);
  // Scaled by 2 along x, turned by 90° about z, moved.
  CHECK(model.mesh.V.topRows(3).isApprox(
      (Positions(3, 3) << 1000, 2000, 3000, 1000, 4000, 3000, -1000, 2000, 3000).finished(), 1e-12));
  // Mirrored, so the corners are turned to keep the front in front.
  const Vec3 a = model.mesh.V.row(model.mesh.F(1, 0)), b = model.mesh.V.row(model.mesh.F(1, 1)),
             c = model.mesh.V.row(model.mesh.F(1, 2));
  CHECK((b - a).cross(c - a).z() > 0);
  CHECK(model.group_names == std::vector<std::string>{"turned", "mesh 0"});
  CHECK(model.face_group == std::vector<int>{0, 1});
}

TEST_CASE("Glb.StripsAndFans") {
  Triangle triangle(5125);
  Bytes& binary = triangle.binary;
  binary.resize(36);
  put(binary, 1.f, 2.f, 0.f, 3.f, 3.f, 0.f);  // vertices 3 and 4
  triangle.json["buffers"][0]["byteLength"] = 60;
  triangle.json["bufferViews"][0]["byteLength"] = 60;
  triangle.json["accessors"][0]["count"] = 5;
  triangle.json["meshes"][0]["primitives"][0].erase("indices");
  triangle.json["meshes"][0]["primitives"][0]["mode"] = 5;
  CHECK(triangle.read().model.mesh.F == (Triangles(3, 3) << 0, 1, 2, 1, 3, 2, 2, 3, 4).finished());
  triangle.json["meshes"][0]["primitives"][0]["mode"] = 6;
  CHECK(triangle.read().model.mesh.F == (Triangles(3, 3) << 0, 1, 2, 0, 2, 3, 0, 3, 4).finished());
}

TEST_CASE("Glb.StridedSparseAndNormalisedAccessors") {
  Triangle triangle(5121);
  Bytes& binary = triangle.binary;
  binary.resize(36);
  put(binary, std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{2}, std::uint8_t{0});
  const std::size_t interleaved = binary.size();  // position, colour of three normalised bytes and padding
  for (int i = 0; i < 3; ++i)
    put(binary, 1.f * static_cast<float>(i == 1), 2.f * static_cast<float>(i == 2), 0.f, std::uint8_t{255},
        std::uint8_t{51}, static_cast<std::uint8_t>(i), std::uint8_t{0});
  const std::size_t sparse = binary.size();
  put(binary, std::uint16_t{2}, std::uint16_t{0}, 7.f, 8.f, 9.f);
  Json& json = triangle.json;
  json["buffers"][0]["byteLength"] = binary.size();
  json["bufferViews"] =
      Json::array({{{"buffer", 0}, {"byteOffset", interleaved}, {"byteLength", 48}, {"byteStride", 16}},
                   {{"buffer", 0}, {"byteOffset", 36}, {"byteLength", 3}},
                   {{"buffer", 0}, {"byteOffset", sparse}, {"byteLength", 2}},
                   {{"buffer", 0}, {"byteOffset", sparse + 4}, {"byteLength", 12}}});
  json["accessors"][0]["sparse"] = {
      {"count", 1}, {"indices", {{"bufferView", 2}, {"componentType", 5123}}}, {"values", {{"bufferView", 3}}}};
  json["accessors"].push_back({{"bufferView", 0},
                               {"byteOffset", 12},
                               {"componentType", 5121},
                               {"normalized", true},
                               {"count", 3},
                               {"type", "VEC3"}});
  json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = 2;
  const Model model = triangle.read().model;
  CHECK(model.mesh.V == (Positions(3, 3) << 0, 0, 0, 1000, 0, 0, 7000, 8000, 9000).finished());
  CHECK(model.vertex_colours.row(2).isApprox(Eigen::RowVector3d(1, 0.2, 2 / 255.0)));
}

TEST_CASE("Glb.SeveralPrimitivesMeetAgainAtTheirBorder") {
  Model model = wavy_torus(16, 12);
  add_materials_and_groups(model);  // two materials, so two primitives; texture seams, so split vertices
  const Bytes bytes = write(model, MeshFormat::glb);
  const Model again = read_bytes(bytes, "torus.glb").model;
  CHECK(again.mesh.vertex_count() == model.mesh.vertex_count());
  CHECK(unmatched_edges(again.mesh) == 0);
  CHECK(faces_by_place(again.mesh) == faces_by_place(as_float(model.mesh)));
  CHECK(again.face_material == model.face_material);  // faces were in the order of their materials
  REQUIRE(again.textures.size() == 1u);
  CHECK(again.textures[0].bytes == model.textures[0].bytes);
  CHECK(again.textures[0].name == "red.png");
  CHECK(again.materials[1].diffuse_texture == 0);
  CHECK(again.materials[0].diffuse.isApprox(model.materials[0].diffuse));
  for (int f = 0; f < model.mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) CHECK((again.UV.row(again.FT(f, k)) - model.UV.row(model.FT(f, k))).norm() < 2e-7);
  ReadOptions split;
  split.merge_duplicates = false;
  CHECK(read_bytes(bytes, "torus.glb", split).model.mesh.vertex_count() > model.mesh.vertex_count());
}

TEST_CASE("Glb.MillimetresSurviveExactly") {
  // mm under a scale of 0.001, read as metres times 1000: the same floats.
  const Model model = wavy_torus(9, 7);
  const Model again = read_bytes(write(model, MeshFormat::glb), "a.glb").model;
  CHECK(faces_by_place(again.mesh) == faces_by_place(as_float(model.mesh)));
}

TEST_CASE("Glb.ColumnsAndColours") {
  Model model = wavy_torus(9, 7);
  model.UV.resize(0, 2), model.FT.resize(0, 3);
  add_colours(model);
  const std::vector<VertexColumn> columns{
      {"normal_error_deg", Eigen::VectorXd::LinSpaced(63, 0, 1), ColumnKind::float64}};
  WriteOptions options;
  options.columns = columns;
  const Bytes bytes = write(model, MeshFormat::glb, options);
  CHECK(as_text(bytes).find("\"_NORMAL_ERROR_DEG\"") != std::string_view::npos);
  const ModelFile file = read_bytes(bytes, "a.glb");
  REQUIRE(file.columns.size() == 1u);
  CHECK(file.columns[0].name == "normal_error_deg");
  // Vertices come in the order in which faces use them.
  for (int f = 0; f < model.mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int now = file.model.mesh.F(f, k), was = model.mesh.F(f, k);
      CHECK_THAT(static_cast<float>(file.columns[0].values[now]),
                 WithinULP(static_cast<float>(columns[0].values[was]), 4));
      CHECK((file.model.vertex_colours.row(now) - model.vertex_colours.row(was)).norm() < 1e-6);
    }
}

TEST_CASE("Glb.WrittenFilesKeepTheRules") {
  // The specification's demands on alignment, targets, bounds and unit normals, checked on the bytes.
  Model model = wavy_torus(301, 301);  // more vertices than 16 bits count
  add_materials_and_groups(model);
  for (const bool large : {false, true}) {
    Model sample = large ? model : wavy_torus(7, 5);
    const Bytes bytes = write(sample, MeshFormat::glb);
    REQUIRE(bytes.size() % 4 == 0u);
    CHECK(load<std::uint32_t>(bytes.data() + 8) == bytes.size());
    const std::size_t json_bytes = load<std::uint32_t>(bytes.data() + 12), binary = 28 + json_bytes;
    REQUIRE(json_bytes % 4 == 0u);
    const Json json = Json::parse(as_text(ByteView(bytes).subspan(20, json_bytes)));
    CHECK(json["buffers"][0]["byteLength"] == bytes.size() - binary);
    for (const Json& accessor : json["accessors"]) {
      const Json& view = json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
      CHECK(view["byteOffset"].get<std::size_t>() % 4 == 0u);
      const bool indices = accessor["type"] == "SCALAR";
      CHECK(view["target"] == (indices ? 34963 : 34962));
      if (indices) {
        CHECK(accessor["componentType"] == (large ? 5125 : 5123));
      }
    }
    const Json& attributes = json["meshes"][0]["primitives"][0]["attributes"];
    const Json& position = json["accessors"][attributes["POSITION"].get<std::size_t>()];
    for (int k = 0; k < 3; ++k) {
      const auto column = sample.mesh.V.col(k).cast<float>();
      CHECK(position["min"][static_cast<std::size_t>(k)].get<float>() == column.minCoeff());
      CHECK(position["max"][static_cast<std::size_t>(k)].get<float>() == column.maxCoeff());
    }
    const Json& normal = json["accessors"][attributes["NORMAL"].get<std::size_t>()];
    const std::size_t offset =
        binary + json["bufferViews"][normal["bufferView"].get<std::size_t>()]["byteOffset"].get<std::size_t>();
    for (std::size_t i = 0; i < normal["count"].get<std::size_t>(); ++i) {
      double square = 0;
      for (std::size_t k = 0; k < 3; ++k) square += std::pow(load<float>(bytes.data() + offset + 12 * i + 4 * k), 2);
      REQUIRE_THAT(square, WithinAbs(1, 1e-5));
    }
    for (const Json& primitive : json["meshes"][0]["primitives"])
      CHECK(primitive["material"].get<std::size_t>() < json["materials"].size());
  }
}

TEST_CASE("Glb.TextFormWithEmbeddedDataAndCompanions") {
  Triangle triangle;
  triangle.json["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64(triangle.binary);
  CHECK(read_text(triangle.json.dump(), "a.gltf").model.mesh.face_count() == 1);
  triangle.json["buffers"][0]["uri"] = "scene%20data.bin";
  expect_refused(as_bytes(triangle.json.dump()), "a.gltf",
                 "its geometry is in another file, “scene%20data.bin”; export it as one GLB file");
  const std::vector<Companion> companions{{"scene%20data.bin", triangle.binary}};
  ReadOptions options;
  options.companions = companions;
  CHECK(read_text(triangle.json.dump(), "a.gltf", options).model.mesh.face_count() == 1);
}

TEST_CASE("Glb.PicturesLieWhereTheirTransformPutsThem") {
  Triangle triangle;
  Bytes& binary = triangle.binary;
  const std::size_t at = binary.size();
  put(binary, 0.f, 0.f, 1.f, 0.f, 0.f, 1.f);  // TEXCOORD_0
  put(binary, 9.f, 9.f, 9.f, 9.f, 9.f, 9.f);  // TEXCOORD_1
  Json& json = triangle.json;
  json["buffers"][0]["byteLength"] = binary.size();
  json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", at}, {"byteLength", 48}});
  for (const std::size_t offset : {std::size_t{0}, std::size_t{24}})
    json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1},
                                 {"byteOffset", offset},
                                 {"componentType", 5126},
                                 {"count", 3},
                                 {"type", "VEC2"}});
  auto& primitive = json["meshes"][0]["primitives"][0];
  primitive["attributes"]["TEXCOORD_0"] = json["accessors"].size() - 2;
  primitive["attributes"]["TEXCOORD_1"] = json["accessors"].size() - 1;
  primitive["material"] = 0;
  json["textures"] = Json::parse(R"([{"source":0}])");
  json["images"] = Json::array({{{"uri", "data:image/png;base64," + base64(red_pixel_png())}}});
  // Scaled by (2, 3), turned by a quarter (u to -v, v to u), moved by (0.5, 0.25); its own set goes before texCoord.
  json["materials"] = Json::parse(R"([{"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":1,"extensions":
    {"KHR_texture_transform":{"offset":[0.5,0.25],"rotation":1.5707963267948966,"scale":[2,3],"texCoord":0}}}}}])");
  const Model model = triangle.read().model;
  REQUIRE(model.UV.rows() == 3);
  const TextureCoordinates expected = (TextureCoordinates(3, 2) << 0.5, 0.75, 0.5, 2.75, 3.5, 0.75).finished();
  for (int k = 0; k < 3; ++k) {
    INFO(k);
    CHECK((model.UV.row(model.FT(0, k)) - expected.row(model.mesh.F(0, k))).norm() < 1e-6);
  }
  json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"]["scale"] = 2;
  CHECK_THROWS_AS(triangle.read(), Error);
}

TEST_CASE("Glb.ExternalPicturesAreReportedNotFatal") {
  Triangle triangle;
  triangle.json["materials"] =
      Json::parse(R"([{"pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,1,1],"baseColorTexture":{"index":0}}}])");
  triangle.json["textures"] = Json::parse(R"([{"source":0}])");
  triangle.json["images"] = Json::parse(R"([{"uri":"textures/skin.png"}])");
  triangle.json["meshes"][0]["primitives"][0]["material"] = 0;
  const ModelFile file = triangle.read();
  CHECK(file.missing_companions == std::vector<std::string>{"textures/skin.png"});
  CHECK(file.model.materials.at(0).diffuse == Vec3(0.5, 0.25, 1));
  triangle.json["images"][0]["uri"] = "data:image/png;base64," + base64(red_pixel_png());
  const ModelFile embedded = triangle.read();
  CHECK(embedded.missing_companions.empty());
  CHECK(embedded.model.textures.at(0).bytes == red_pixel_png());
}

TEST_CASE("Glb.BadFilesAreRefused") {
  const auto refused = [](const std::function<void(Triangle&)>& spoil, const std::string& part) {
    Triangle triangle;
    spoil(triangle);
    expect_refused(triangle.bytes(), "bad.glb", part);
  };
  const auto spoiled = [&](const char* pointer, const Json& value, const std::string& part) {
    refused([&](Triangle& t) { t.json[Json::json_pointer(pointer)] = value; }, part);
  };
  Bytes cut = Triangle().bytes();
  for (const std::size_t size : {10u, 19u, 30u, 200u})
    expect_refused(ByteView(cut).first(size), "bad.glb", "it ends too early");
  Bytes old = cut;
  store(old.data() + 4, 1u);
  expect_refused(old, "bad.glb", "not of glTF version 2");
  refused([](Triangle& t) { t.json = Json("text"); }, "JSON is damaged");
  spoiled("/asset/version", "1.0", "not of glTF version 2");
  spoiled("/extensionsRequired", {"KHR_draco_mesh_compression"}, "export it without mesh compression");
  spoiled("/accessors/0/count", 4, "accessor 0 in it reaches beyond its data");
  spoiled("/accessors/0/count", 4'000'000'000u, "accessor 0 in it reaches beyond its data");
  spoiled("/accessors/0/count", -1, "“count” in it must be a whole number");
  spoiled("/accessors/0/count", 1e300, "“count” in it must be a whole number");
  spoiled("/accessors/0/byteOffset", 4, "accessor 0 in it reaches beyond its data");
  spoiled("/accessors/0/bufferView", 9, "number 9 of its bufferViews, which does not exist");
  spoiled("/accessors/0/componentType", 5127, "accessor 0 in it is damaged");
  spoiled("/accessors/0/type", "VEC2", "positions in it are not of three numbers");
  spoiled("/accessors/1/componentType", 5122, "indices in it are not whole numbers");
  spoiled("/bufferViews/0/byteLength", 1000, "buffer view 0 in it reaches beyond its data");
  spoiled("/bufferViews/0/byteStride", 4, "accessor 0 in it reaches beyond its data");
  spoiled("/bufferViews/0/buffer", 1, "buffer view 0 in it is damaged");
  spoiled("/buffers/0/byteLength", 1000, "shorter than it should be");
  spoiled("/buffers/0/uri", "model.bin", "“model.bin”; export it as one GLB file");
  spoiled("/nodes/0/mesh", 3, "number 3 of its meshes, which does not exist");
  spoiled("/nodes/0/children", {0}, "node 0 in it stands twice");
  spoiled("/nodes/0/children", {7}, "a node that does not exist");
  spoiled("/nodes/0/scale", {1, 2}, "“scale” in it must be 3 numbers");
  spoiled("/nodes/0/scale", {1e200, 1, 1}, "beyond any real size");
  spoiled("/meshes/0/primitives/0/material", 2, "a material that does not exist");
  spoiled("/meshes/0/primitives/0/mode", 1, "it holds points and lines but no triangles");
  spoiled("/scenes/0/nodes", Json::array(), "it holds no triangles");
  refused(
      [](Triangle& t) { t.json["accessors"][0].erase("bufferView"), t.json["accessors"][0]["count"] = 4'000'000'000u; },
      "declares more elements than the file can hold");
  refused([](Triangle& t) { store(t.binary.data() + 40, std::uint16_t{3}); },
          "a face in it refers to vertex 3, but there are 3");
  refused([](Triangle& t) { store(t.binary.data() + 16, std::numeric_limits<float>::quiet_NaN()); },
          "a coordinate of vertex 1 is not a number");
  ReadOptions options;
  options.max_triangles = 1;
  Triangle twice;
  twice.json["nodes"].push_back({{"mesh", 0}});
  twice.json["scenes"][0]["nodes"] = {0, 1};
  expect_refused(twice.bytes(), "large.glb", "it holds 2 triangles, and at most 1 is read", options);
}

}  // namespace
}  // namespace formwright
