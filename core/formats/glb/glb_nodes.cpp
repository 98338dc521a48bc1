// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/glb/glb_nodes.h"

#include "formats/glb/glb_assembly.h"

namespace formwright {

Bytes write_glb_nodes(std::span<const NamedMesh> meshes, Context& context) {
  GlbAssembly glb("mesh", "The meshes are too large for GLB, which ends at 4 GB; choose 3MF instead.");
  Json nodes = Json::array(), list = Json::array(), roots = Json::array();
  for (const NamedMesh& one : meshes) {
    context.check_cancelled();
    const auto& [V, F] = one.mesh;
    const auto vertices = static_cast<std::size_t>(V.rows());
    const int positions = glb.add_floats(vertices, 3, "VEC3", true, GlbAssembly::Target::vertices,
                                         [&](Eigen::Index i, int k) { return V(i, k); });
    const int indices = glb.add_indices(3 * static_cast<std::size_t>(F.rows()), vertices, [&](std::size_t i) {
      return F(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3));
    });
    const Json primitive = {{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"material", 0}};
    const std::size_t number = list.size();
    list.push_back({{"name", one.name}, {"primitives", Json::array({primitive})}});
    nodes.push_back({{"name", one.name}, {"mesh", number}, {"scale", {0.001, 0.001, 0.001}}});
    roots.push_back(number);
  }
  Json json = {{"asset", {{"version", "2.0"}, {"generator", "Formwright"}}}};
  json["scene"] = 0;
  json["scenes"] = Json::array({{{"nodes", roots}}});
  json["nodes"] = nodes;
  json["meshes"] = list;
  const Json surface = {{"baseColorFactor", {0.8, 0.8, 0.8, 1.0}}, {"metallicFactor", 0.0}, {"roughnessFactor", 0.8}};
  json["materials"] = Json::array({{{"name", "plain"}, {"pbrMetallicRoughness", surface}}});
  return glb.finish(json);
}

}  // namespace formwright
