// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>

#include "formats/glb/glb.h"
#include "formats/glb/glb_accessors.h"
#include "formats/glb/gltf_texture_place.h"
#include "formats/shared/media_type.h"
#include "formats/shared/reader_limits.h"
#include "formats/shared/vertex_merge.h"

namespace formwright {
namespace {

using Object = GltfDocument::Object;

enum class Topology { triangles = 4, strip = 5, fan = 6 };

/// What one primitive of a mesh gives, checked.
struct Primitive {
  const Object* attributes;
  std::int64_t positions, indices;  // accessors; indices -1: in order
  std::int64_t triangles;
  Topology topology;
  int material;
};

/// "_NORMAL_ERROR_DEG" as "normal_error_deg".
std::string column_name(std::string_view attribute) {
  std::string name(attribute.substr(1));
  std::ranges::transform(name, name.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return clean_text(name);
}

class GlbReader {
 public:
  explicit GlbReader(const MeshSource& source) : source_(source), document_(source), model_(file_.model) {}

  ModelFile read() {
    file_.format = MeshFormat::glb;
    file_.unit = "m";
    const std::vector<GltfInstance> instances = scene_instances(document_);
    std::int64_t triangles = 0;
    for (const GltfInstance& instance : instances) {
      for (const Primitive& primitive : primitives_of(instance.mesh)) {
        triangles += primitive.triangles;
        source_.check_triangle_count(triangles);
        note_attributes(primitive);
      }
    }
    if (triangles == 0) source_.refuse_empty(left_out_ ? "points and lines" : "");
    F_.reserve(3 * static_cast<std::size_t>(triangles));

    read_materials();
    for (const GltfInstance& instance : instances) {
      if (primitives_of(instance.mesh).empty()) continue;
      add_instance(instance);
      source_.context().progress(static_cast<double>(F_.size() / 3) / static_cast<double>(triangles));
    }
    finish();
    return std::move(file_);
  }

 private:
  /// Primitives of triangles; each mesh is looked at once, however many nodes show it.
  const std::vector<Primitive>& primitives_of(std::int64_t mesh) {
    auto& known = primitives_[mesh];
    if (known) return *known;
    known.emplace();
    const Object& object = document_.at("meshes", mesh);
    const auto list = object.find("primitives");
    if (list == object.end() || !list->is_array()) return *known;
    for (const Object& entry : *list) {
      const auto attributes = entry.is_object() ? entry.find("attributes") : entry.end();
      if (!entry.is_object() || attributes == entry.end() || !attributes->is_object())
        source_.refuse("mesh " + std::to_string(mesh) + " in it is damaged; export it again.");
      const std::int64_t mode = document_.integer(entry, "mode", 4);
      const std::int64_t positions = document_.integer(*attributes, "POSITION", -1);
      if (mode < 4 || mode > 6 || positions < 0) {
        left_out_ = true;
        continue;
      }
      const std::int64_t indices = document_.integer(entry, "indices", -1);
      const std::int64_t corners = GltfAccessor(document_, indices >= 0 ? indices : positions).count();
      const std::int64_t material = document_.integer(entry, "material", -1);
      if (material >= document_.count("materials"))
        source_.refuse("it refers to a material that does not exist; export it again.");
      const Primitive primitive{&*attributes,
                                positions,
                                indices,
                                mode == 4 ? corners / 3 : corners - 2,
                                static_cast<Topology>(mode),
                                static_cast<int>(material)};
      if (primitive.triangles > 0) known->push_back(primitive);
    }
    return *known;
  }

  GltfTexturePlace texture_place(const Primitive& primitive) const {
    if (primitive.material < 0) return {};
    const Object* const texture = base_texture(document_.at("materials", primitive.material));
    return texture == nullptr ? GltfTexturePlace{} : read_texture_place(document_, *texture);
  }

  static const Object* base_texture(const Object& material) {
    const auto pbr = material.find("pbrMetallicRoughness");
    if (pbr == material.end() || !pbr->is_object()) return nullptr;
    const auto texture = pbr->find("baseColorTexture");
    return texture == pbr->end() || !texture->is_object() ? nullptr : &*texture;
  }

  /// Colours and texture coordinates count if any primitive has them, columns only if all have.
  void note_attributes(const Primitive& primitive) {
    const Object& attributes = *primitive.attributes;
    any_colours_ = any_colours_ || attributes.contains("COLOR_0");
    any_texture_ = any_texture_ || attributes.contains(texture_place(primitive).attribute);
    std::set<std::string> scalars;
    for (const auto& [name, accessor] : attributes.items())
      if (name.size() > 1 && name[0] == '_' && accessor.is_number_unsigned() &&
          GltfAccessor(document_, accessor.get<std::int64_t>()).components() == 1)
        scalars.insert(name);
    if (!columns_) columns_ = std::move(scalars);
    else std::erase_if(*columns_, [&](const std::string& name) { return !scalars.contains(name); });
  }

  std::optional<GltfAccessor> attribute(const Primitive& primitive, const std::string& name, std::int64_t count,
                                        int minimum, int maximum) const {
    const std::int64_t index = document_.integer(*primitive.attributes, name.c_str(), -1);
    if (index < 0) return std::nullopt;
    GltfAccessor accessor(document_, index);
    if (accessor.count() != count || accessor.components() < minimum || accessor.components() > maximum)
      source_.refuse("the attribute “" + clean_text(name, 40) + "” in it does not fit its mesh; export it again.");
    return accessor;
  }

  void add_instance(const GltfInstance& instance) {
    // In one product, so that a node's scale of 0.001 and metres to mm cancel exactly.
    const Eigen::Matrix4d to_mm = 1000 * instance.transform;
    const bool mirrored = to_mm.topLeftCorner<3, 3>().determinant() < 0;
    const auto first_vertex = static_cast<int>(V_.size() / 3);
    VertexMerger merger;
    const std::size_t first_face = F_.size() / 3;
    for (const Primitive& primitive : primitives_of(instance.mesh)) {
      source_.context().check_cancelled();
      add_primitive(primitive, to_mm, mirrored, first_vertex, merger);
    }
    std::string name = instance.name;
    if (name.empty()) name = clean_text(document_.text(document_.at("meshes", instance.mesh), "name"));
    if (name.empty()) name = "mesh " + std::to_string(instance.mesh);
    model_.group_names.push_back(name);
    model_.face_group.resize(first_face, -1);
    model_.face_group.resize(F_.size() / 3, static_cast<int>(model_.group_names.size()) - 1);
  }

  void add_primitive(const Primitive& primitive, const Eigen::Matrix4d& to_mm, bool mirrored, int first_vertex,
                     VertexMerger& merger) {
    const GltfAccessor positions(document_, primitive.positions);
    if (positions.components() != 3) source_.refuse("positions in it are not of three numbers; export it again.");
    std::optional<GltfAccessor> indices;
    if (primitive.indices >= 0) indices.emplace(document_, primitive.indices);
    if (indices && (!indices->is_unsigned_integer() || indices->components() != 1))
      source_.refuse("indices in it are not whole numbers; export it again.");
    const auto colours = attribute(primitive, "COLOR_0", positions.count(), 3, 4);
    const GltfTexturePlace place = texture_place(primitive);
    const auto texture = attribute(primitive, place.attribute, positions.count(), 2, 2);
    std::vector<GltfAccessor> columns;
    for (const std::string& name : *columns_)
      columns.push_back(std::move(*attribute(primitive, name, positions.count(), 1, 1)));
    column_values_.resize(columns.size());

    // Only vertices that faces use come along: primitives often share one large buffer.
    ++stamp_;
    if (static_cast<std::size_t>(positions.count()) > seen_.size())
      seen_.resize(static_cast<std::size_t>(positions.count()));
    const auto vertex = [&](std::uint32_t corner) -> const Seen& {
      if (corner >= positions.count())
        source_.refuse("a face in it refers to vertex " + std::to_string(corner) + ", but there are " +
                       std::to_string(positions.count()) + "; export it again.");
      Seen& seen = seen_[corner];
      if (seen.stamp == stamp_) return seen;
      Eigen::Vector4d p(0, 0, 0, 1);
      for (int k = 0; k < 3; ++k) p[k] = positions.number(corner, k);
      const Vec3 q = (to_mm * p).head<3>();
      for (const double c : q)
        if (!is_sane_coordinate(c)) source_.refuse(insane_coordinate("vertex", corner, c));
      const int index =
          source_.options().merge_duplicates ? first_vertex + merger.add(q) : static_cast<int>(V_.size() / 3);
      if (static_cast<std::size_t>(index) == V_.size() / 3) {
        V_.insert(V_.end(), {q.x(), q.y(), q.z()});
        if (any_colours_)
          for (int k = 0; k < 3; ++k) {
            const double c = colours ? colours->number(corner, k) : 1;
            colours_.push_back(c >= 0 ? std::min(c, 1.0) : 0);  // NaN becomes 0
          }
        // Many attributes may show one accessor.
        document_.take(3 * sizeof(double) * columns.size());
        for (std::size_t k = 0; k < columns.size(); ++k) column_values_[k].push_back(columns[k].number(corner, 0));
      }
      seen = {stamp_, index, static_cast<int>(UV_.size() / 2)};
      if (any_texture_) {
        std::array<double, 2> uv{0, 1};
        if (texture) uv = place({texture->number(corner, 0), texture->number(corner, 1)});
        for (const double t : uv)
          if (!is_sane_coordinate(t)) source_.refuse(insane_coordinate("texture vertex", corner, t));
        UV_.insert(UV_.end(), {uv[0], 1 - uv[1]});  // glTF's v points down
      }
      return seen;
    };
    for (std::int64_t t = 0; t < primitive.triangles; ++t) {
      if (t % 65536 == 0) source_.context().check_cancelled();
      std::array<std::int64_t, 3> corner{3 * t, 3 * t + 1, 3 * t + 2};
      if (primitive.topology == Topology::strip) corner = {t, t + 1 + t % 2, t + 2 - t % 2};
      if (primitive.topology == Topology::fan) corner = {0, t + 1, t + 2};
      if (mirrored) std::swap(corner[1], corner[2]);
      for (const std::int64_t c : corner) {
        const Seen& seen = vertex(indices ? indices->index(c) : static_cast<std::uint32_t>(c));
        F_.push_back(seen.vertex);
        if (any_texture_) FT_.push_back(seen.texture);
      }
      model_.face_material.push_back(primitive.material);
    }
  }

  void read_materials() {
    std::map<std::int64_t, int> texture_of_image;
    std::set<std::string> names;
    std::size_t picture_bytes = 0;
    for (std::int64_t i = 0; i < document_.count("materials"); ++i) {
      const Object& object = document_.at("materials", i);
      Material material;
      material.name = clean_text(document_.text(object, "name"));
      // Other formats know materials by their names.
      if (material.name.empty() || names.contains(material.name))
        material.name += (material.name.empty() ? "material " : " ") + std::to_string(i);
      names.insert(material.name);
      material.diffuse = Vec3::Ones();
      const auto pbr = object.find("pbrMetallicRoughness");
      std::array<double, 4> factor{1, 1, 1, 1};
      if (pbr != object.end() && pbr->is_object() && document_.numbers(*pbr, "baseColorFactor", factor.data(), 4))
        for (std::size_t k = 0; k < 3; ++k) material.diffuse[static_cast<int>(k)] = std::clamp(factor[k], 0.0, 1.0);
      if (const Object* const texture = base_texture(object)) {
        const std::int64_t image = image_of_texture(document_.integer(*texture, "index", -1));
        if (image >= 0) {
          const auto [place, fresh] = texture_of_image.try_emplace(image, static_cast<int>(model_.textures.size()));
          if (fresh) add_image(image, picture_bytes);
          material.diffuse_texture = place->second;
        }
      }
      model_.materials.push_back(material);
    }
  }

  std::int64_t image_of_texture(std::int64_t index) const {
    const Object& texture = document_.at("textures", index);
    std::int64_t image = document_.integer(texture, "source", -1);
    if (const auto extensions = texture.find("extensions");
        image < 0 && extensions != texture.end() && extensions->is_object())
      for (const char* name : {"EXT_texture_webp", "EXT_texture_avif", "KHR_texture_basisu"})
        if (const auto extension = extensions->find(name); extension != extensions->end() && extension->is_object())
          image = document_.integer(*extension, "source", image);
    return image;
  }

  void add_image(std::int64_t index, std::size_t& picture_bytes) {
    const Object& image = document_.at("images", index);
    Texture texture;
    texture.name = clean_text(document_.text(image, "name"));
    texture.media_type = clean_text(document_.text(image, "mimeType"), 40);
    const std::string uri = document_.text(image, "uri");
    ByteView bytes;
    if (image.contains("bufferView")) bytes = document_.view(document_.integer(image, "bufferView", 0));
    else if (!uri.empty()) bytes = document_.uri(uri);
    // Many images over one view would multiply a small file; pictures of real files do not overlap.
    picture_bytes += bytes.size();
    if (uri.empty() && picture_bytes > source_.bytes().size()) source_.refuse("its pictures overlap; export it again.");
    document_.take(bytes.size());
    texture.bytes.assign(bytes.begin(), bytes.end());
    if (texture.name.empty())
      texture.name =
          uri.empty() || uri.starts_with("data:") ? "texture " + std::to_string(index) : clean_text(uri, 1000);
    if (const std::string found = picture_media_type(texture.bytes); !found.empty()) texture.media_type = found;
    model_.textures.push_back(std::move(texture));
  }

  void finish() {
    const auto n = static_cast<Eigen::Index>(V_.size() / 3), m = static_cast<Eigen::Index>(F_.size() / 3);
    model_.mesh.V = Eigen::Map<const Positions>(V_.data(), n, 3);
    model_.mesh.F = Eigen::Map<const Triangles>(F_.data(), m, 3);
    if (any_colours_) model_.vertex_colours = Eigen::Map<const Positions>(colours_.data(), n, 3);
    if (any_texture_) {
      model_.UV = Eigen::Map<const TextureCoordinates>(UV_.data(), static_cast<Eigen::Index>(UV_.size() / 2), 2);
      model_.FT = Eigen::Map<const Triangles>(FT_.data(), m, 3);
    }
    if (model_.materials.empty()) model_.face_material.clear();
    if (model_.group_names.size() < 2) model_.group_names.clear(), model_.face_group.clear();
    std::size_t k = 0;
    for (const std::string& name : *columns_) {
      const auto& values = column_values_[k++];
      VertexColumn column{column_name(name), Eigen::Map<const Eigen::VectorXd>(values.data(), n), ColumnKind::float32};
      if (column.values.allFinite()) {
        file_.columns.push_back(std::move(column));
        continue;
      }
      file_.columns_not_numbers.push_back(column.name);
      file_.notes.push_back("The attribute “" + clean_text(name, 40) +
                            "” holds values that are not numbers and was left out.");
    }
    if (left_out_) file_.notes.push_back("Points and lines were left out.");
    if (document_.count("skins") > 0) file_.notes.push_back("The model has a skeleton; it was read in its rest pose.");
  }

  struct Seen {
    std::uint64_t stamp = 0;
    int vertex = 0, texture = 0;
  };

  const MeshSource& source_;
  GltfDocument document_;
  ModelFile file_;
  Model& model_;
  std::map<std::int64_t, std::optional<std::vector<Primitive>>> primitives_;
  bool left_out_ = false, any_colours_ = false, any_texture_ = false;
  std::optional<std::set<std::string>> columns_;
  std::uint64_t stamp_ = 0;
  std::vector<Seen> seen_;
  std::vector<double> V_, UV_, colours_;
  std::vector<int> F_, FT_;
  std::vector<std::vector<double>> column_values_;
};

}  // namespace

ModelFile read_glb(const MeshSource& source) { return GlbReader(source).read(); }

}  // namespace formwright
