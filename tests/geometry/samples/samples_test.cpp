// SPDX-License-Identifier: GPL-3.0-or-later
// Every sample of the gallery at several sizes. Prints what docs/samples.md says of them when FORMWRIGHT_SAMPLE_TABLE
// is set.
#include "geometry/samples/samples.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/generators/catch_generators.hpp>
#include <catch2/generators/catch_generators_range.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/LU>
#include <algorithm>
#include <atomic>
#include <ctime>
#include <cstdlib>
#include <iostream>
#include <map>
#include <numbers>
#include <span>

#include "base/error.h"
#include "base/sha256.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "geometry/samples/png_pixels.h"

namespace formwright {
using Catch::Matchers::WithinAbs;

namespace {

constexpr double degree = std::numbers::pi / 180;

/// Made once for all tests.
const Model& sample(const std::string& name, int vertices) {
  static std::map<std::pair<std::string, int>, Model> made;
  const auto [place, fresh] = made.try_emplace({name, vertices});
  if (fresh) {
    Context context;
    place->second = make_sample(name, vertices, context);
  }
  return place->second;
}

/// The least on offer, a preview, a good one.
std::vector<int> sizes() { return {min_sample_vertices, 3000, 12000}; }

/// Vertices of the shapes made of few planes come in steps.
bool structured(const std::string& name) { return name == "pyramid"; }

TEST_CASE("Samples.AreSoundAndAsLargeAsAsked") {
  const SampleInfo info = GENERATE(from_range(sample_catalog()));
  CAPTURE(info.name);
  for (const int asked : sizes()) {
    CAPTURE(asked);
    const TriangleMesh& mesh = sample(info.name, asked).mesh;
    REQUIRE(mesh.V.allFinite());
    CHECK(std::abs(mesh.vertex_count() - asked) <= (structured(info.name) ? asked / 20 : 0));
    const Adjacency adjacency(mesh);
    CHECK(adjacency.is_manifold());
    CHECK(face_components(adjacency).count == 1);
    CHECK(vertex_components(adjacency).count == 1);  // no vertex without a face
    CHECK(boundary_loops(adjacency).size() == (info.closed ? 0 : 1));
    // Outward: a volume, or for an open surface a top.
    if (info.closed) {
      CHECK(signed_volume(mesh) > 0);
    } else {
      // Some faces of the mountain's steepest gullies lean over; seen from above they cover no more than a thousandth.
      const Eigen::VectorXd from_above = face_normals(mesh).col(1).cwiseProduct(face_areas(mesh));
      CHECK(from_above.cwiseMin(0.0).sum() > -1e-3 * 100 * 100);
      CHECK_THAT(from_above.sum(), WithinAbs(100 * 100, 1e-6));
    }
    const BoundingBox box = bounding_box(mesh);
    CHECK(box.size().maxCoeff() > (asked < 1000 ? 80 : 90));  // coarse limbs are short
    CHECK(box.size().maxCoeff() < 130);
    CHECK_THAT(box.lower.y(), WithinAbs(0, 1e-9));
    // The analytic ones stand exactly where they should, which the box of an inscribed polyhedron does not.
    CHECK_THAT(box.centre().x(), WithinAbs(0, 0.05));
    CHECK_THAT(box.centre().z(), WithinAbs(0, 0.05));
  }
}

TEST_CASE("Samples.AreEvenlyTriangulated") {
  const SampleInfo info = GENERATE(from_range(sample_catalog()));
  CAPTURE(info.name);
  for (const int asked : sizes()) {
    CAPTURE(asked);
    const TriangleMesh& mesh = sample(info.name, asked).mesh;
    const Eigen::VectorXd minimum = corner_angles(mesh).rowwise().minCoeff() / degree;
    std::vector<double> sorted(minimum.begin(), minimum.end());
    std::sort(sorted.begin(), sorted.end());
    const double hundredth = sorted[sorted.size() / 100], median = sorted[sorted.size() / 2];
    if (std::getenv("FORMWRIGHT_SAMPLE_TABLE") != nullptr)
      std::cout << "angles " << info.name << ' ' << asked << ' ' << sorted[0] << ' ' << hundredth << ' ' << median
                << " genus " << (info.closed ? genus(Adjacency(mesh)) : 0) << " area " << surface_area(mesh)
                << " volume " << signed_volume(mesh) << " size " << bounding_box(mesh).size().transpose() << "\n";
    // The octopus's arms are thinner than the triangles of a mesh of 500, which fold there.
    const bool coarse = asked < 1000;
    CHECK(sorted[0] > (coarse ? 1 : 18));
    CHECK(hundredth > (coarse ? 2 : 30));
    CHECK(median > (coarse ? 45 : 48));
  }
}

TEST_CASE("Samples.AreColouredAndTextured") {
  const SampleInfo info = GENERATE(from_range(sample_catalog()));
  CAPTURE(info.name);
  for (const int asked : sizes()) {
    CAPTURE(asked);
    const Model& model = sample(info.name, asked);
    if (model.vertex_colours.rows() > 0) {
      CHECK(model.vertex_colours.rows() == model.mesh.V.rows());
      CHECK(model.vertex_colours.minCoeff() >= 0);
      CHECK(model.vertex_colours.maxCoeff() <= 1);
    }
    CHECK(info.has_texture == !model.textures.empty());
    if (!info.has_texture) {
      CHECK(model.UV.rows() == 0);
      continue;
    }
    REQUIRE(model.FT.rows() == model.mesh.F.rows());
    REQUIRE(model.FT.minCoeff() >= 0);
    REQUIRE(model.FT.maxCoeff() < model.UV.rows());
    CHECK(model.UV.minCoeff() >= 0);
    CHECK(model.UV.maxCoeff() <= 1);
    REQUIRE(model.materials.size() == 1u);
    CHECK(model.materials[0].diffuse_texture == 0);
    CHECK(model.textures[0].media_type == "image/png");
    const test::RgbPicture picture = test::decode_png(model.textures[0].bytes);
    REQUIRE(picture.width >= 256);
    REQUIRE(picture.height == picture.width);
    // The picture at a vertex is what the vertex is coloured, but for details finer than the mesh.
    double off = 0;
    for (int f = 0; f < model.mesh.face_count(); ++f) {
      const Vec2 uv = model.UV.row(model.FT(f, 0));
      const auto at = [&](double u) { return std::min(picture.width - 1, static_cast<int>(u * picture.width)); };
      const std::uint8_t* pixel = picture.pixel(at(uv.x()), at(1 - uv.y()));
      for (int c = 0; c < 3; ++c) {
        const double linear = std::pow((pixel[c] / 255.0 + 0.055) / 1.055, 2.4);
        off += std::abs(linear - model.vertex_colours(model.mesh.F(f, 0), c)) / (3.0 * model.mesh.face_count());
      }
    }
    CHECK(off < 0.07);
  }
}

TEST_CASE("Samples.AreTheSameBitsEveryTime") {
  const std::string name = GENERATE(from_range(sample_catalog())).name;
  CAPTURE(name);
  Context context;
  const Model again = make_sample(name, 3000, context);
  const Model& first = sample(name, 3000);
  CHECK(again.mesh.V == first.mesh.V);
  CHECK(again.mesh.F == first.mesh.F);
  CHECK(again.UV == first.UV);
  CHECK(again.vertex_colours == first.vertex_colours);
  REQUIRE(again.textures.size() == first.textures.size());
  for (std::size_t t = 0; t < again.textures.size(); ++t) CHECK(again.textures[t].bytes == first.textures[t].bytes);
}

/// The first digits of the SHA-256 of positions, faces, colours and texture.
std::string fingerprint(const Model& model) {
  Bytes bytes;
  const auto add = [&](const auto& matrix) {
    const auto view = std::as_bytes(std::span(matrix.data(), static_cast<std::size_t>(matrix.size())));
    bytes.insert(bytes.end(), view.begin(), view.end());
  };
  add(model.mesh.V), add(model.mesh.F), add(model.vertex_colours), add(model.UV);
  for (const Texture& texture : model.textures) bytes.insert(bytes.end(), texture.bytes.begin(), texture.bytes.end());
  return sha256_hex(bytes).substr(0, 12);
}

TEST_CASE("Samples.AreTheSameBitsOnEveryTarget") {
  const std::string name = GENERATE(from_range(sample_catalog())).name;
  CAPTURE(name);
  // Natively and in WebAssembly, by g++ and clang. A change of a sample changes its line: look at it, then copy the
  // value that the failure shows.
  const std::map<std::string, std::string> expected{
      {"bust", "df7ab1f3afa3"},     {"cat", "8b6964142d9a"},        {"octopus", "07756fb3beea"},
      {"mountain", "fb7b3b8a17f4"}, {"fish", "bdb2b1048099"},       {"coin", "8034e93ba50d"},
      {"star", "ecb61671a96e"},     {"heart", "15c20b41ee13"},      {"pyramid", "182616b06580"},
      {"t_shape", "58e176917c71"},  {"hemisphere", "63417a549442"}, {"torus", "ef6d5e2fe23a"}};
  CHECK(fingerprint(sample(name, 3000)) == expected.at(name));
}

TEST_CASE("Samples.AskForCancelOften") {
  const std::string name = GENERATE(from_range(sample_catalog())).name;
  CAPTURE(name);
  // The longest stretch of work between two questions to the host; measured, since cancelling at one moment
  // would only try one of them. In processor time: a busy machine is no fault.
  std::atomic<std::clock_t> last{std::clock()}, longest{0};
  const auto passed = [&] {
    const std::clock_t at = std::clock(), stretch = at - last.exchange(at);
    for (std::clock_t before = longest; stretch > before && !longest.compare_exchange_weak(before, stretch);) {}
  };
  Host host;
  host.cancel_requested = [&] {
    passed();
    return false;
  };
  Context context(host);
  make_sample(name, 12000, context);
  passed();
  const double seconds = double(longest) / CLOCKS_PER_SEC;
  if (std::getenv("FORMWRIGHT_SAMPLE_TABLE") != nullptr) std::cout << "cancel " << name << ' ' << seconds << "\n";
  CHECK(seconds < 0.5);
}

TEST_CASE("Samples.AreLeftWhenCancelled") {
  const std::string name = GENERATE(from_range(sample_catalog())).name;
  CAPTURE(name);
  for (const int questions : {0, 1, 5, 30}) {
    std::atomic<int> asked{0};
    Host host;
    host.cancel_requested = [&] { return asked++ >= questions; };
    Context context(host);
    try {
      make_sample(name, 3000, context);
      CHECK(asked.load() <= questions);
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::cancelled);
    }
  }
}

TEST_CASE("SampleShapes.PyramidLiesOnItsPlanes") {
  // Four sides through the apex (0, 60, 0), the base through y = 0; to the last bit of 50 and 60 mm.
  const TriangleMesh& mesh = sample("pyramid", 5000).mesh;
  for (int f = 0; f < mesh.face_count(); ++f) {
    double side[4] = {0, 0, 0, 0}, base = 0;
    for (int k = 0; k < 3; ++k) {
      const Vec3 p = mesh.V.row(mesh.F(f, k));
      base = std::max(base, p.y());
      const double out[4] = {p.x(), -p.x(), p.z(), -p.z()};
      for (int s = 0; s < 4; ++s) side[s] = std::max(side[s], std::abs(out[s] + p.y() * 50 / 60 - 50));
    }
    CHECK((base == 0 || *std::min_element(side, side + 4) <= 1.5e-14));
  }
  CHECK_THAT(signed_volume(mesh), WithinAbs(100. * 100 * 60 / 3, 1e-8));
}

TEST_CASE("SampleShapes.TIsMadeOfBlocks") {
  const TriangleMesh& mesh = sample("t_shape", 5000).mesh;
  CHECK_THAT(signed_volume(mesh), WithinAbs((30. * 70 + 100 * 30) * 30, 1e-8));
  CHECK_THAT(surface_area(mesh),
             WithinAbs(2 * (30. * 70 + 100 * 30) + 30 * (100 + 30 + 35 + 70 + 30 + 70 + 35 + 30), 1e-8));
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3 p = mesh.V.row(v);
    const double x = std::abs(p.x());
    INFO(p.transpose());
    CHECK((std::abs(p.z()) == 15 || p.y() == 0 || p.y() == 100 || (p.y() == 70 && x >= 15) ||
           (x == 15 && p.y() <= 70) || (x == 50 && p.y() >= 70)));
  }
}

TEST_CASE("SampleShapes.HemisphereHasItsRadius") {
  const TriangleMesh& mesh = sample("hemisphere", 5000).mesh;
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3 p = mesh.V.row(v);
    CHECK(p.y() >= 0);
    if (p.y() > 0) {
      CHECK_THAT(p.norm(), WithinAbs(50, 1e-13));
    } else {
      CHECK(p.norm() <= 50 + 1e-13);
    }
  }
  // An inscribed polyhedron of edge h lacks a share of about (h / R)^2 / 4.
  const double exact = 2. / 3 * std::numbers::pi * 50 * 50 * 50;
  CHECK(signed_volume(mesh) < exact);
  CHECK(signed_volume(mesh) > exact * (1 - 1e-3));
}

TEST_CASE("SampleShapes.TorusHasItsRadii") {
  const TriangleMesh& mesh = sample("torus", 10000).mesh;
  CHECK(genus(Adjacency(mesh)) == 1);
  // It stands on its lowest vertex, so its centre is known to a part of an edge only: the best by Gauss and Newton.
  Vec3 centre = bounding_box(mesh).centre();
  double farthest = 0;
  for (int iteration = 0; iteration < 6; ++iteration) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Vec3 right = Vec3::Zero();
    farthest = 0;
    for (int v = 0; v < mesh.vertex_count(); ++v) {
      const Vec3 p = Vec3(mesh.V.row(v)) - centre, ring = Vec3(p.x(), p.y(), 0).normalized() * 35;
      const double off = (p - ring).norm() - 15;
      const Vec3 gradient = (p - ring).normalized();
      normal += gradient * gradient.transpose();
      right += gradient * off;
      farthest = std::max(farthest, std::abs(off));
    }
    centre += normal.inverse() * right;
  }
  CHECK(farthest < 1e-6);
  const double exact = 2 * std::numbers::pi * std::numbers::pi * 35 * 15 * 15;
  CHECK_THAT(signed_volume(mesh), WithinAbs(exact, 2e-3 * exact));
}

TEST_CASE("SampleShapes.UnknownNamesAndSizesAreRefused") {
  Context context;
  const auto where = [&](const char* name, int vertices) -> std::string {
    try {
      make_sample(name, vertices, context);
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::invalid_input);
      CHECK(std::string(error.what()).ends_with('.'));
      return error.where();
    }
    return "nothing";
  };
  CHECK(where("teapot", 1000) == "sample");
  CHECK(where("", 1000) == "sample");
  CHECK(where("torus", min_sample_vertices - 1) == "vertices");
  CHECK(where("torus", max_sample_vertices + 1) == "vertices");
  CHECK(where("torus", -1) == "vertices");
}

}  // namespace
}  // namespace formwright
