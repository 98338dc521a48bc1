// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <functional>

#include "formats/io_test_tools.h"
#include "formats/shared/mesh_source.h"
#include "formats/model_samples.h"

namespace formwright {
namespace {
using namespace test;

TEST_CASE("MeshFormat.TableIsInOrder") {
  for (std::size_t i = 0; i < mesh_formats.size(); ++i) {
    CHECK(static_cast<std::size_t>(mesh_formats[i].format) == i);
    CHECK(mesh_format_of_extension("model." + std::string(mesh_formats[i].extension)) == mesh_formats[i].format);
  }
  CHECK(mesh_format_of_extension(".OBJ") == MeshFormat::obj);
  CHECK(mesh_format_of_extension("3mf") == MeshFormat::three_mf);
  CHECK(mesh_format_of_extension("x.gltf") == MeshFormat::glb);
  CHECK(mesh_format_of_extension("x.txt") == std::nullopt);
  CHECK(mesh_format_of_extension("") == std::nullopt);
}

TEST_CASE("MeshFormat.ContentGoesBeforeTheName") {
  const Model model = wavy_torus(5, 4);
  for (const auto& info : mesh_formats) {
    for (const auto& wrong : mesh_formats) {
      const ModelFile file = read_bytes(write(model, info.format), "mislabelled." + std::string(wrong.extension));
      {
        INFO("named " << wrong.extension);
        CHECK(file.format == info.format);
      }
      CHECK(file.model.mesh.face_count() == model.mesh.face_count());
    }
    CHECK(read_bytes(write(model, info.format), "").format == info.format);
  }
}

TEST_CASE("MeshFormat.TheNameDecidesWhereTheContentDoesNot") {
  // An unknown first keyword and a binary STL of the wrong size.
  CHECK(read_text("mg 1\nbevel off\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj").format == MeshFormat::obj);
  expect_refused(as_bytes("mg 1\nbevel off\n"), "a.txt", "this is not a mesh that can be read here");
}

TEST_CASE("MeshFormat.ForeignFilesAreNamed") {
  const std::pair<std::string_view, const char*> files[] = {{"Kaydara FBX Binary  ", "an FBX file"},
                                                            {"ISO-10303-21;\nHEADER;", "a STEP file"},
                                                            {"OFF\n3 1 0\n", "an OFF file"},
                                                            {"<?xml version=\"1.0\"?><COLLADA/>", "an XML file"},
                                                            {"\x1f\x8b\x08", "a gzip archive"}};
  for (const auto& [text, name] : files) expect_refused(as_bytes(text), "model.obj", name);
  expect_refused({}, "nothing.stl", "it is empty");
}

TEST_CASE("MeshFormat.NamesInErrorsAreClean") {
  try {
    read_text("", std::string("bad\nname\xFF") + std::string(1000, 'x'));
    FAIL();
  } catch (const Error& error) {
    const std::string message = error.what();
    CHECK(message.starts_with("bad nameÿxxx"));
    CHECK(message.size() < 300u);
  }
}

TEST_CASE("MeshFormat.WritingAnUnsoundModelIsOurMistake") {
  const Model good = wavy_torus(5, 4);
  const auto refused = [&](const std::function<void(Model&)>& spoil) {
    Model model = good;
    spoil(model);
    for (const auto& info : mesh_formats) {
      try {
        write(model, info.format);
        FAIL();
      } catch (const Error& error) {
        CHECK(error.code() == ErrorCode::internal);
      }
    }
  };
  refused([](Model& m) { m.mesh.F(0, 0) = 20; });
  refused([](Model& m) { m.mesh.F(0, 0) = -1; });
  refused([](Model& m) { m.mesh.V(0, 0) = std::nan(""); });
  refused([](Model& m) { m.mesh.F.resize(0, 3), m.FT.resize(0, 3); });
  refused([](Model& m) { m.FT(0, 0) = 30; });
  refused([](Model& m) { m.vertex_colours.resize(3, 3); });
  refused([](Model& m) { m.face_group = {1}; });
  refused([](Model& m) { m.face_material.assign(40, 0); });
}

TEST_CASE("MeshFormat.CountsReadWell") {
  CHECK(counted(1, "face", "faces") == "1 face");
  CHECK(counted(0, "face", "faces") == "0 faces");
  CHECK(counted(999, "face", "faces") == "999 faces");
  CHECK(counted(20'000'000, "face", "faces") == "20 000 000 faces");
}

}  // namespace
}  // namespace formwright
