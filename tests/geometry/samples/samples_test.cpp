// SPDX-License-Identifier: GPL-3.0-or-later
// Every sample of the gallery at several sizes. Prints what docs/samples.md says of them when FORMWRIGHT_SAMPLE_TABLE
// is set.
#include "geometry/samples/samples.h"

#include <gtest/gtest.h>

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
#include "geometry/adjacency.h"
#include "geometry/measures.h"
#include "geometry/samples/png_pixels.h"

namespace formwright {

void PrintTo(const SampleInfo& info, std::ostream* out) { *out << info.name; }

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

class Samples : public testing::TestWithParam<SampleInfo> {
 protected:
  const std::string& name() const { return GetParam().name; }
};

/// The least on offer, a preview, a good one.
std::vector<int> sizes() { return {least_sample_vertices, 3000, 12000}; }

/// Vertices of the shapes made of few planes come in steps.
bool structured(const std::string& name) { return name == "pyramid"; }

TEST_P(Samples, AreSoundAndAsLargeAsAsked) {
  for (const int asked : sizes()) {
    SCOPED_TRACE(asked);
    const TriangleMesh& mesh = sample(name(), asked).mesh;
    ASSERT_TRUE(mesh.V.allFinite());
    EXPECT_LE(std::abs(mesh.vertex_count() - asked), structured(name()) ? asked / 20 : 0);
    const Adjacency adjacency(mesh);
    EXPECT_TRUE(adjacency.is_manifold());
    EXPECT_EQ(face_components(adjacency).count, 1);
    EXPECT_EQ(vertex_components(adjacency).count, 1);  // no vertex without a face
    EXPECT_EQ(boundary_loops(adjacency).size(), GetParam().closed ? 0 : 1);
    // Outward: a volume, or for an open surface a top.
    if (GetParam().closed) {
      EXPECT_GT(signed_volume(mesh), 0);
    } else {
      // Some faces of the mountain's steepest gullies lean over; seen from above they cover no more than a thousandth.
      const Eigen::VectorXd from_above = face_normals(mesh).col(1).cwiseProduct(face_areas(mesh));
      EXPECT_GT(from_above.cwiseMin(0.0).sum(), -1e-3 * 100 * 100);
      EXPECT_NEAR(from_above.sum(), 100 * 100, 1e-6);
    }
    const BoundingBox box = bounding_box(mesh);
    EXPECT_GT(box.size().maxCoeff(), asked < 1000 ? 80 : 90);  // coarse limbs are short
    EXPECT_LT(box.size().maxCoeff(), 130);
    EXPECT_NEAR(box.lower.y(), 0, 1e-9);
    // The analytic ones stand exactly where they should, which the box of an inscribed polyhedron does not.
    EXPECT_NEAR(box.centre().x(), 0, 0.05);
    EXPECT_NEAR(box.centre().z(), 0, 0.05);
  }
}

TEST_P(Samples, AreEvenlyTriangulated) {
  for (const int asked : sizes()) {
    SCOPED_TRACE(asked);
    const TriangleMesh& mesh = sample(name(), asked).mesh;
    const Eigen::VectorXd least = corner_angles(mesh).rowwise().minCoeff() / degree;
    std::vector<double> sorted(least.begin(), least.end());
    std::sort(sorted.begin(), sorted.end());
    const double hundredth = sorted[sorted.size() / 100], median = sorted[sorted.size() / 2];
    if (std::getenv("FORMWRIGHT_SAMPLE_TABLE") != nullptr)
      std::cout << "angles " << name() << ' ' << asked << ' ' << sorted[0] << ' ' << hundredth << ' ' << median
                << " genus " << (GetParam().closed ? genus(Adjacency(mesh)) : 0) << " area " << surface_area(mesh)
                << " volume " << signed_volume(mesh) << " size " << bounding_box(mesh).size().transpose() << "\n";
    // The octopus's arms are thinner than the triangles of a mesh of 500, which fold there.
    const bool coarse = asked < 1000;
    EXPECT_GT(sorted[0], coarse ? 1 : 18);
    EXPECT_GT(hundredth, coarse ? 2 : 30);
    EXPECT_GT(median, coarse ? 45 : 48);
  }
}

TEST_P(Samples, AreColouredAndTextured) {
  for (const int asked : sizes()) {
    SCOPED_TRACE(asked);
    const Model& model = sample(name(), asked);
    if (model.vertex_colours.rows() > 0) {
      EXPECT_EQ(model.vertex_colours.rows(), model.mesh.V.rows());
      EXPECT_GE(model.vertex_colours.minCoeff(), 0);
      EXPECT_LE(model.vertex_colours.maxCoeff(), 1);
    }
    EXPECT_EQ(GetParam().has_texture, !model.textures.empty());
    if (!GetParam().has_texture) {
      EXPECT_EQ(model.UV.rows(), 0);
      continue;
    }
    ASSERT_EQ(model.FT.rows(), model.mesh.F.rows());
    ASSERT_GE(model.FT.minCoeff(), 0);
    ASSERT_LT(model.FT.maxCoeff(), model.UV.rows());
    EXPECT_GE(model.UV.minCoeff(), 0);
    EXPECT_LE(model.UV.maxCoeff(), 1);
    ASSERT_EQ(model.materials.size(), 1u);
    EXPECT_EQ(model.materials[0].diffuse_texture, 0);
    EXPECT_EQ(model.textures[0].media_type, "image/png");
    const test::RgbPicture picture = test::decode_png(model.textures[0].bytes);
    ASSERT_GE(picture.width, 256);
    ASSERT_EQ(picture.height, picture.width);
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
    EXPECT_LT(off, 0.07);
  }
}

TEST_P(Samples, AreTheSameBitsEveryTime) {
  Context context;
  const Model again = make_sample(name(), 3000, context);
  const Model& first = sample(name(), 3000);
  EXPECT_EQ(again.mesh.V, first.mesh.V);
  EXPECT_EQ(again.mesh.F, first.mesh.F);
  EXPECT_EQ(again.UV, first.UV);
  EXPECT_EQ(again.vertex_colours, first.vertex_colours);
  ASSERT_EQ(again.textures.size(), first.textures.size());
  for (std::size_t t = 0; t < again.textures.size(); ++t) EXPECT_EQ(again.textures[t].bytes, first.textures[t].bytes);
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

TEST_P(Samples, AreTheSameBitsOnEveryTarget) {
  // Natively and in WebAssembly, by g++ and clang. A change of a sample changes its line: look at it, then copy the
  // value that the failure shows.
  const std::map<std::string, std::string> expected{
      {"bust", "df7ab1f3afa3"},     {"cat", "8b6964142d9a"},        {"octopus", "07756fb3beea"},
      {"mountain", "fb7b3b8a17f4"}, {"fish", "bdb2b1048099"},       {"coin", "8034e93ba50d"},
      {"star", "ecb61671a96e"},     {"heart", "15c20b41ee13"},      {"pyramid", "182616b06580"},
      {"t_shape", "58e176917c71"},  {"hemisphere", "63417a549442"}, {"torus", "ef6d5e2fe23a"}};
  EXPECT_EQ(fingerprint(sample(name(), 3000)), expected.at(name()));
}

TEST_P(Samples, AskForCancelOften) {
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
  make_sample(name(), 12000, context);
  passed();
  const double seconds = double(longest) / CLOCKS_PER_SEC;
  if (std::getenv("FORMWRIGHT_SAMPLE_TABLE") != nullptr) std::cout << "cancel " << name() << ' ' << seconds << "\n";
  EXPECT_LT(seconds, 0.5);
}

TEST_P(Samples, AreLeftWhenCancelled) {
  for (const int questions : {0, 1, 5, 30}) {
    std::atomic<int> asked{0};
    Host host;
    host.cancel_requested = [&] { return asked++ >= questions; };
    Context context(host);
    try {
      make_sample(name(), 3000, context);
      EXPECT_LE(asked.load(), questions);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::cancelled);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Gallery, Samples, testing::ValuesIn(sample_catalog()),
                         [](const auto& each) { return each.param.name; });

TEST(SampleShapes, PyramidLiesOnItsPlanes) {
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
    EXPECT_TRUE(base == 0 || *std::min_element(side, side + 4) <= 1.5e-14);
  }
  EXPECT_NEAR(signed_volume(mesh), 100. * 100 * 60 / 3, 1e-8);
}

TEST(SampleShapes, TIsMadeOfBlocks) {
  const TriangleMesh& mesh = sample("t_shape", 5000).mesh;
  EXPECT_NEAR(signed_volume(mesh), (30. * 70 + 100 * 30) * 30, 1e-8);
  EXPECT_NEAR(surface_area(mesh), 2 * (30. * 70 + 100 * 30) + 30 * (100 + 30 + 35 + 70 + 30 + 70 + 35 + 30), 1e-8);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3 p = mesh.V.row(v);
    const double x = std::abs(p.x());
    EXPECT_TRUE(std::abs(p.z()) == 15 || p.y() == 0 || p.y() == 100 || (p.y() == 70 && x >= 15) ||
                (x == 15 && p.y() <= 70) || (x == 50 && p.y() >= 70))
        << p.transpose();
  }
}

TEST(SampleShapes, HemisphereHasItsRadius) {
  const TriangleMesh& mesh = sample("hemisphere", 5000).mesh;
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3 p = mesh.V.row(v);
    EXPECT_GE(p.y(), 0);
    if (p.y() > 0) {
      EXPECT_NEAR(p.norm(), 50, 1e-13);
    } else {
      EXPECT_LE(p.norm(), 50 + 1e-13);
    }
  }
  // An inscribed polyhedron of edge h lacks a share of about (h / R)^2 / 4.
  const double exact = 2. / 3 * std::numbers::pi * 50 * 50 * 50;
  EXPECT_LT(signed_volume(mesh), exact);
  EXPECT_GT(signed_volume(mesh), exact * (1 - 1e-3));
}

TEST(SampleShapes, TorusHasItsRadii) {
  const TriangleMesh& mesh = sample("torus", 10000).mesh;
  EXPECT_EQ(genus(Adjacency(mesh)), 1);
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
  EXPECT_LT(farthest, 1e-6);
  const double exact = 2 * std::numbers::pi * std::numbers::pi * 35 * 15 * 15;
  EXPECT_NEAR(signed_volume(mesh), exact, 2e-3 * exact);
}

TEST(SampleShapes, UnknownNamesAndSizesAreRefused) {
  Context context;
  const auto where = [&](const char* name, int vertices) -> std::string {
    try {
      make_sample(name, vertices, context);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_input);
      EXPECT_TRUE(std::string(error.what()).ends_with('.'));
      return error.where();
    }
    return "nothing";
  };
  EXPECT_EQ(where("teapot", 1000), "sample");
  EXPECT_EQ(where("", 1000), "sample");
  EXPECT_EQ(where("torus", least_sample_vertices - 1), "vertices");
  EXPECT_EQ(where("torus", most_sample_vertices + 1), "vertices");
  EXPECT_EQ(where("torus", -1), "vertices");
}

}  // namespace
}  // namespace formwright
