// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the tests of the readers have in common.
#include <catch2/catch_test_macros.hpp>

#include <algorithm>
#include <array>
#include <set>
#include <string>

#include "base/error.h"
#include "formats/mesh_io.h"

namespace formwright::test {

inline ModelFile read_text(std::string_view text, const std::string& name, const ReadOptions& options = {}) {
  Context context;
  return read_model_file(as_bytes(text), name, options, context);
}

inline ModelFile read_bytes(const Bytes& bytes, const std::string& name, const ReadOptions& options = {}) {
  Context context;
  return read_model_file(bytes, name, options, context);
}

inline Bytes write(const Model& model, MeshFormat format, const WriteOptions& options = {}) {
  Context context;
  return write_model(model, format, options, context);
}

/// Reading must end in Error{invalid_input, "mesh"} of one sentence that names the file and holds `part`.
inline void expect_refused(ByteView bytes, const std::string& name, const std::string& part,
                           const ReadOptions& options = {}) {
  Context context;
  try {
    const ModelFile file = read_model_file(bytes, name, options, context);
    FAIL(name << " was read: " << file.model.mesh.face_count() << " faces, but should be refused for: " << part);
  } catch (const Error& error) {
    const std::string message = error.what();
    {
      INFO(message);
      CHECK(error.code() == ErrorCode::invalid_input);
    }
    CHECK(error.where() == options.where);
    {
      INFO(message);
      CHECK(message.find(name) != std::string::npos);
    }
    {
      INFO(message << "\nshould say: " << part);
      CHECK(message.find(part) != std::string::npos);
    }
    INFO(message);
    CHECK(message.ends_with('.'));
    CHECK(message.find('\n') == std::string::npos);
  }
}

/// Faces as the places of their corners, each from its smallest corner on, sorted: equal for equal meshes however
/// their vertices and faces are numbered.
inline std::multiset<std::array<std::array<double, 3>, 3>> faces_by_place(const TriangleMesh& mesh) {
  std::multiset<std::array<std::array<double, 3>, 3>> faces;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    std::array<std::array<double, 3>, 3> corners;
    for (int k = 0; k < 3; ++k)
      for (int c = 0; c < 3; ++c)
        corners[static_cast<std::size_t>(k)][static_cast<std::size_t>(c)] = mesh.V(mesh.F(f, k), c);
    std::ranges::rotate(corners, std::ranges::min_element(corners));
    faces.insert(corners);
  }
  return faces;
}

/// Number of edges that do not have exactly one face on each side in opposite directions: 0 for a closed mesh.
inline int unmatched_edges(const TriangleMesh& mesh) {
  std::multiset<std::pair<int, int>> edges;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) edges.emplace(mesh.F(f, k), mesh.F(f, (k + 1) % 3));
  int unmatched = 0;
  for (const auto& [a, b] : edges) unmatched += edges.count({b, a}) != 1 || edges.count({a, b}) != 1;
  return unmatched;
}

/// Rounded to what a float32 holds.
inline TriangleMesh as_float(TriangleMesh mesh) {
  mesh.V = mesh.V.cast<float>().cast<double>().eval();
  return mesh;
}

}  // namespace formwright::test
