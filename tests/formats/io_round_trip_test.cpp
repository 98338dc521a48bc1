// SPDX-License-Identifier: GPL-3.0-or-later
// Every format to every other, and what each step may lose.
#include <catch2/generators/catch_generators.hpp>
#include <catch2/generators/catch_generators_range.hpp>
#include <map>

#include "formats/io_test_tools.h"
#include "formats/model_samples.h"
#include "formats/obj/obj.h"

namespace formwright {
namespace {
using namespace test;

struct Route {
  MeshFormat first, second;
};

bool has_double_positions(MeshFormat format) { return format == MeshFormat::obj || format == MeshFormat::ply; }
bool has_texture(MeshFormat format) { return format != MeshFormat::stl; }
bool has_colours(MeshFormat format) { return format != MeshFormat::stl; }

/// Writes and reads again, with the companions an OBJ needs.
Model through(const Model& model, MeshFormat format) {
  WriteOptions write_options;
  if (format == MeshFormat::obj) write_options.material_library = "library.mtl";
  const Bytes bytes = write(model, format, write_options), mtl = write_mtl(model);
  std::vector<Companion> companions{{"library.mtl", mtl}};
  for (const Texture& texture : model.textures) companions.push_back({texture.name, texture.bytes});
  ReadOptions read_options;
  read_options.companions = companions;
  return read_bytes(bytes, "model." + std::string(mesh_format_info(format).extension), read_options).model;
}

/// Texture coordinates and colours by the place of the corner (as float32), which no renumbering changes.
std::map<std::array<float, 3>, Vec3> colours_by_place(const Model& model) {
  std::map<std::array<float, 3>, Vec3> result;
  for (Eigen::Index v = 0; v < model.mesh.V.rows(); ++v) {
    const Eigen::RowVector3f p = model.mesh.V.row(v).cast<float>();
    result[{p.x(), p.y(), p.z()}] = model.vertex_colours.row(v).transpose();
  }
  return result;
}

std::map<std::array<float, 9>, Eigen::Matrix<double, 3, 2>> texture_by_place(const Model& model) {
  std::map<std::array<float, 9>, Eigen::Matrix<double, 3, 2>> result;
  for (Eigen::Index f = 0; f < model.mesh.F.rows(); ++f) {
    std::array<float, 9> place;
    Eigen::Matrix<double, 3, 2> texture;
    for (int k = 0; k < 3; ++k) {
      for (int c = 0; c < 3; ++c)
        place[static_cast<std::size_t>(3 * k + c)] = static_cast<float>(model.mesh.V(model.mesh.F(f, k), c));
      texture.row(k) = model.UV.row(model.FT(f, k));
    }
    result[place] = texture;
  }
  return result;
}

std::vector<Route> all_routes() {
  std::vector<Route> routes;
  for (const auto& first : mesh_formats)
    for (const auto& second : mesh_formats) routes.push_back({first.format, second.format});
  return routes;
}

TEST_CASE("RoundTrip.ShapeTextureAndColours") {
  const auto [first, second] = GENERATE(from_range(all_routes()));
  INFO(mesh_format_info(first).extension << " to " << mesh_format_info(second).extension);
  Model model = wavy_torus(14, 11);
  model.textures.push_back({"red.png", "image/png", red_pixel_png()});
  model.materials.push_back({"picture", Vec3(1, 1, 1), 0});
  model.face_material.assign(static_cast<std::size_t>(model.mesh.face_count()), 0);
  const Model again = through(through(model, first), second);

  const bool exact = has_double_positions(first) && has_double_positions(second);
  if (exact) {
    CHECK(again.mesh.V == model.mesh.V);
  }
  CHECK(faces_by_place(as_float(again.mesh)) == faces_by_place(as_float(model.mesh)));
  CHECK(unmatched_edges(again.mesh) == 0);
  CHECK(again.mesh.vertex_count() == model.mesh.vertex_count());

  if (has_texture(first) && has_texture(second)) {
    const auto expected = texture_by_place(model), found = texture_by_place(again);
    REQUIRE(found.size() == expected.size());
    for (const auto& [place, texture] : expected) CHECK((found.at(place) - texture).cwiseAbs().maxCoeff() < 3e-7);
  } else {
    CHECK(again.FT.rows() == 0);
  }

  // Colours by themselves: in 3MF a face has either a picture or its corners' colours.
  Model coloured;
  coloured.mesh = model.mesh;
  add_colours(coloured);
  const Model back = through(through(coloured, first), second);
  if (has_colours(first) && has_colours(second)) {
    const auto expected = colours_by_place(coloured), found = colours_by_place(back);
    REQUIRE(found.size() == expected.size());
    for (const auto& [place, colour] : expected)
      CHECK((found.at(place) - colour).cwiseAbs().maxCoeff() < 0.5 / 255 * 2.4 + 1e-6);
  } else {
    CHECK(back.vertex_colours.rows() == 0);
  }
}

TEST_CASE("RoundTrip.Columns") {
  const auto [first, second] = GENERATE(from_range(all_routes()));
  INFO(mesh_format_info(first).extension << " to " << mesh_format_info(second).extension);
  const auto holds = [](MeshFormat format) { return format == MeshFormat::ply || format == MeshFormat::glb; };
  if (!holds(first) || !holds(second)) return;
  Model model = wavy_torus(6, 5);
  model.UV.resize(0, 2), model.FT.resize(0, 3);
  const std::vector<VertexColumn> columns{{"from_place", model.mesh.V.col(0) / 7, ColumnKind::float64}};
  WriteOptions options;
  options.columns = columns;
  const ModelFile once = read_bytes(write(model, first, options), "a");
  options.columns = once.columns;
  const ModelFile twice = read_bytes(write(once.model, second, options), "b");
  REQUIRE(twice.columns.size() == 1u);
  CHECK(twice.columns[0].name == "from_place");
  CHECK((twice.columns[0].values - twice.model.mesh.V.col(0) / 7).cwiseAbs().maxCoeff() < 1e-6);
}

}  // namespace
}  // namespace formwright
