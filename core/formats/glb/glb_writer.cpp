// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>

#include "base/error.h"
#include "base/data/json.h"
#include "formats/glb/glb.h"
#include "formats/glb/glb_assembly.h"
#include "formats/shared/media_type.h"
#include "geometry/mesh/measures.h"

namespace formwright {
namespace {

std::string attribute_name(std::string_view column) {
  std::string name = "_";
  for (const char c : column) {
    const bool lower = c >= 'a' && c <= 'z', keep = (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    name += lower ? static_cast<char>(c - 32) : keep ? c : '_';
  }
  return name;
}

class GlbWriter {
 public:
  GlbWriter(const Model& model, const WriteOptions& options, Context& context)
      : model_(model), options_(options), context_(context) {}

  Bytes write() {
    split_vertices();
    context_.check_cancelled();
    Json attributes = Json::object();
    attributes["POSITION"] = add_vertices(
        3, "VEC3", [&](int vertex, int, int k) { return model_.mesh.V(vertex, k); }, true);
    const Positions normals = vertex_normals(model_.mesh);
    attributes["NORMAL"] = add_vertices(3, "VEC3", [&](int vertex, int, int k) {
      return normals.row(vertex).isZero(0)
                 ? (k == 2 ? 1.0 : 0.0)
                 : normals(vertex, k);  // of unit length, as the standard wants, for unused vertices too
    });
    if (model_.vertex_colours.rows() > 0)
      attributes["COLOR_0"] = add_vertices(
          3, "VEC3", [&](int vertex, int, int k) { return std::clamp(model_.vertex_colours(vertex, k), 0.0, 1.0); });
    if (model_.FT.rows() > 0)
      attributes["TEXCOORD_0"] = add_vertices(2, "VEC2", [&](int, int t, int k) {
        return t < 0 ? 0.0 : k == 0 ? model_.UV(t, 0) : 1 - model_.UV(t, 1);  // glTF's v points down
      });
    for (const VertexColumn& column : options_.columns) {
      const std::string name = attribute_name(column.name);
      if (attributes.contains(name))
        throw Error(ErrorCode::internal, "",
                    "The column “" + clean_text(column.name) + "” cannot be written: its name is taken.");
      attributes[name] = add_vertices(1, "SCALAR", [&](int vertex, int, int) { return column.values[vertex]; });
    }
    Json primitives = Json::array();
    add_faces(attributes, primitives);
    add_materials();

    json_["scene"] = 0;
    json_["scenes"] = Json::array({{{"nodes", {0}}}});
    // The mesh is in mm, glTF in metres.
    json_["nodes"] =
        Json::array({{{"name", clean_text(options_.name)}, {"mesh", 0}, {"scale", {0.001, 0.001, 0.001}}}});
    json_["meshes"] = Json::array({{{"name", clean_text(options_.name)}, {"primitives", primitives}}});
    return glb_.finish(json_);
  }

 private:
  /// glTF has one index per corner: a vertex is split where its texture coordinates differ.
  void split_vertices() {
    const auto& [V, F] = model_.mesh;
    const bool split = model_.FT.rows() > 0 && model_.FT != F;
    if (!split) {
      vertex_.resize(static_cast<std::size_t>(V.rows()));
      for (std::size_t v = 0; v < vertex_.size(); ++v) vertex_[v] = static_cast<int>(v);
      if (model_.FT.rows() > 0) {
        texture_ = vertex_;
        for (int& t : texture_)  // unused vertices beyond the texture's
          if (t >= model_.UV.rows()) t = -1;
      }
      corner_ = F;
      return;
    }
    // Per vertex, the list of its copies: one for each texture vertex it is used with.
    std::vector<int> first(static_cast<std::size_t>(V.rows()), -1), next;
    corner_.resize(F.rows(), 3);
    for (Eigen::Index f = 0; f < F.rows(); ++f) {
      for (int k = 0; k < 3; ++k) {
        const int v = F(f, k), t = model_.FT(f, k);
        int copy = first[static_cast<std::size_t>(v)];
        while (copy >= 0 && texture_[static_cast<std::size_t>(copy)] != t) copy = next[static_cast<std::size_t>(copy)];
        if (copy < 0) {
          copy = static_cast<int>(vertex_.size());
          vertex_.push_back(v), texture_.push_back(t), next.push_back(first[static_cast<std::size_t>(v)]);
          first[static_cast<std::size_t>(v)] = copy;
        }
        corner_(f, k) = copy;
      }
    }
    // Vertices that no face uses stay, as in every other format.
    for (std::size_t v = 0; v < first.size(); ++v)
      if (first[v] < 0) vertex_.push_back(static_cast<int>(v)), texture_.push_back(-1);
  }

  template <class Value>
  int add_vertices(int components, const char* shape, const Value& value, bool bounds = false) {
    return glb_.add_floats(vertex_.size(), components, shape, bounds, GlbAssembly::Target::vertices,
                           [&](Eigen::Index i, int k) {
                             const auto at = static_cast<std::size_t>(i);
                             return value(vertex_[at], texture_.empty() ? -1 : texture_[at], k);
                           });
  }

  /// One primitive for each material in use, over the same vertices.
  void add_faces(const Json& attributes, Json& primitives) {
    const int groups = static_cast<int>(model_.materials.size()) + 1;  // the last: faces without a material
    std::vector<std::vector<Eigen::Index>> faces(static_cast<std::size_t>(groups));
    for (Eigen::Index f = 0; f < corner_.rows(); ++f) {
      const int material = model_.face_material.empty() ? -1 : model_.face_material[static_cast<std::size_t>(f)];
      faces[static_cast<std::size_t>(material < 0 ? groups - 1 : material)].push_back(f);
    }
    for (int group = 0; group < groups; ++group) {
      const auto& list = faces[static_cast<std::size_t>(group)];
      if (list.empty()) continue;
      const int indices = glb_.add_indices(3 * list.size(), vertex_.size(), [&](std::size_t i) {
        return corner_(list[i / 3], static_cast<int>(i % 3));
      });
      const bool plain = group == groups - 1;
      if (plain) has_plain_faces_ = true;
      primitives.push_back({{"attributes", attributes}, {"indices", indices}, {"material", group}});
    }
  }

  void add_materials() {
    Json materials = Json::array(), textures = Json::array(), images = Json::array();
    std::vector<int> texture_of(model_.textures.size(), -1);
    for (std::size_t i = 0; i < model_.textures.size(); ++i) {
      const Texture& texture = model_.textures[i];
      const std::string media_type = picture_media_type(texture.bytes);
      if (media_type != "image/png" && media_type != "image/jpeg") continue;  // glTF knows no others
      const int view = glb_.add_bytes(texture.bytes);
      images.push_back({{"name", clean_text(texture.name)}, {"mimeType", media_type}, {"bufferView", view}});
      textures.push_back({{"source", images.size() - 1}});
      texture_of[i] = static_cast<int>(textures.size()) - 1;
    }
    // Without a statement glTF's materials are polished metal.
    const auto add = [&](const std::string& name, const Vec3& colour, int texture) {
      Json surface = {{"baseColorFactor", {colour.x(), colour.y(), colour.z(), 1.0}},
                      {"metallicFactor", 0.0},
                      {"roughnessFactor", 0.8}};
      if (texture >= 0) surface["baseColorTexture"] = {{"index", texture}};
      materials.push_back({{"name", clean_text(name)}, {"pbrMetallicRoughness", surface}, {"doubleSided", true}});
    };
    for (const Material& material : model_.materials)
      add(material.name, material.diffuse.cwiseMax(0.0).cwiseMin(1.0),
          material.diffuse_texture < 0 ? -1 : texture_of[static_cast<std::size_t>(material.diffuse_texture)]);
    if (has_plain_faces_) add("plain", model_.vertex_colours.rows() > 0 ? Vec3(1, 1, 1) : Vec3(0.8, 0.8, 0.8), -1);
    json_["materials"] = materials;
    if (!images.empty()) json_["textures"] = textures, json_["images"] = images;
  }

  const Model& model_;
  const WriteOptions& options_;
  const Context& context_;
  Json json_ = {{"asset", {{"version", "2.0"}, {"generator", "Formwright"}}}};
  GlbAssembly glb_{options_.name, "The mesh is too large for GLB, which ends at 4 GB; choose PLY instead."};
  std::vector<int> vertex_, texture_;  // per written vertex: the mesh's vertex, its texture vertex (-1 for none)
  Triangles corner_;                   // faces in written vertices
  bool has_plain_faces_ = false;
};

}  // namespace

Bytes write_glb(const Model& model, const WriteOptions& options, Context& context) {
  return GlbWriter(model, options, context).write();
}

}  // namespace formwright
