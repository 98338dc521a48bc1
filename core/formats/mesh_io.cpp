// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/mesh_io.h"

#include <algorithm>
#include <set>
#include <unordered_map>

#include "base/error.h"
#include "formats/glb/glb.h"
#include "formats/shared/media_type.h"
#include "formats/shared/mesh_source.h"
#include "formats/obj/obj.h"
#include "formats/ply/ply.h"
#include "formats/stl/stl.h"
#include "formats/shared/text_scan.h"
#include "formats/three_mf/three_mf.h"

namespace formwright {
namespace {

const Companion* find_companion(std::span<const Companion> companions, std::string_view name) {
  const auto found =
      std::ranges::find_if(companions, [&](const Companion& c) { return bare_name(c.name) == bare_name(name); });
  return found == companions.end() ? nullptr : &*found;
}

bool indices_within(const Triangles& F, Eigen::Index rows) {
  return F.rows() == 0 || (F.minCoeff() >= 0 && F.maxCoeff() < rows);
}

bool numbers_within(const std::vector<int>& values, std::size_t size) {
  return std::ranges::all_of(values, [&](int value) { return value >= -1 && value < static_cast<int>(size); });
}

/// A model that disagrees with itself is a mistake of the caller's: better said than written.
void check_model(const Model& model, std::span<const VertexColumn> columns) {
  const auto n = model.mesh.V.rows(), m = model.mesh.F.rows();
  const auto require = [](bool good, const char* what) {
    if (!good) throw Error(ErrorCode::internal, "", std::string("The mesh to write is not sound: ") + what + ".");
  };
  require(n > 0 && m > 0, "it is empty");
  require(model.mesh.V.allFinite(), "a coordinate is not finite");
  require(indices_within(model.mesh.F, n), "a face refers to a vertex that does not exist");
  require(model.FT.rows() == 0 || model.FT.rows() == m, "texture corners are not one row a face");
  require(indices_within(model.FT, model.UV.rows()), "a face refers to a texture vertex that does not exist");
  require(model.UV.allFinite(), "a texture coordinate is not finite");
  require(model.vertex_colours.rows() == 0 || (model.vertex_colours.rows() == n && model.vertex_colours.allFinite()),
          "colours are not one a vertex");
  require(model.face_group.empty() || (static_cast<Eigen::Index>(model.face_group.size()) == m &&
                                       numbers_within(model.face_group, model.group_names.size())),
          "groups are not one a face");
  require(model.face_material.empty() || (static_cast<Eigen::Index>(model.face_material.size()) == m &&
                                          numbers_within(model.face_material, model.materials.size())),
          "materials are not one a face");
  for (const Material& material : model.materials)
    require(material.diffuse_texture >= -1 && material.diffuse_texture < static_cast<int>(model.textures.size()) &&
                material.diffuse.allFinite(),
            "a material has a texture or colour that does not exist");
  for (const VertexColumn& column : columns)
    require(column.values.size() == n && column.values.allFinite(), "a column is not one finite number a vertex");
}

/// Materials of all libraries that are there. A line may name one file with blanks in it, or several without.
std::vector<MtlMaterial> load_libraries(ModelFile& file, std::span<const Companion> companions,
                                        const ReadOptions& options) {
  std::vector<MtlMaterial> materials;
  std::set<const Companion*> loaded;
  Context silent;
  const auto load = [&](const Companion& companion) {
    if (!loaded.insert(&companion).second) return;  // named before
    for (MtlMaterial& material : read_mtl(MeshSource(companion.bytes, companion.name, options, silent)))
      materials.push_back(std::move(material));
  };
  for (const std::string& line : file.material_libraries) {
    if (const Companion* const whole = find_companion(companions, line)) {
      load(*whole);
      continue;
    }
    TextScan scan(line);
    std::vector<std::string> absent;
    bool any = false;
    for (std::string_view name = scan.word(); !name.empty(); name = scan.word()) {
      const Companion* const part = find_companion(companions, name);
      if (part != nullptr) load(*part), any = true;
      else absent.emplace_back(name);
    }
    if (!any) absent = {line};
    file.missing_companions.insert(file.missing_companions.end(), absent.begin(), absent.end());
  }
  return materials;
}

}  // namespace

ModelFile read_model_file(ByteView bytes, std::string_view file_name, const ReadOptions& options, Context& context) {
  const MeshFormat format = detect_mesh_format(bytes, file_name, options.where);
  const MeshSource source(bytes, file_name, options, context);
  ModelFile file;
  switch (format) {
    case MeshFormat::obj: file = read_obj(source); break;
    case MeshFormat::stl: file = read_stl(source); break;
    case MeshFormat::ply: file = read_ply(source); break;
    case MeshFormat::glb: file = read_glb(source); break;
    case MeshFormat::three_mf: file = read_three_mf(source); break;
  }
  read_model_materials(file, options.companions, options);
  return file;
}

Model read_model(ByteView bytes, std::string_view file_name, Context& context) {
  return read_model_file(bytes, file_name, {}, context).model;
}

void read_model_materials(ModelFile& file, std::span<const Companion> companions, const ReadOptions& options) {
  file.missing_companions.clear();
  Model& model = file.model;
  const std::vector<MtlMaterial> library = load_libraries(file, companions, options);
  std::unordered_map<std::string_view, const MtlMaterial*> of_name;  // the first of each name
  for (const MtlMaterial& material : library) of_name.try_emplace(material.material.name, &material);
  // One texture for all names of one picture: companions are found by the bare name, and each is kept once.
  std::unordered_map<std::string, int> texture_of;
  for (std::size_t i = 0; i < model.textures.size(); ++i)
    texture_of.try_emplace(bare_name(model.textures[i].name), static_cast<int>(i));
  for (Material& material : model.materials) {
    const auto found = of_name.find(material.name);
    if (found == of_name.end()) continue;
    const auto& [described, picture] = *found->second;
    material = described;
    if (picture.empty()) continue;
    const auto [place, fresh] = texture_of.try_emplace(bare_name(picture), static_cast<int>(model.textures.size()));
    material.diffuse_texture = place->second;
    if (fresh) model.textures.push_back({picture, "", {}});
  }
  for (Texture& texture : model.textures) {
    if (!texture.bytes.empty()) continue;
    const Companion* const picture = find_companion(companions, texture.name);
    if (picture == nullptr || picture->bytes.empty()) {
      file.missing_companions.push_back(texture.name);
      continue;
    }
    texture.bytes.assign(picture->bytes.begin(), picture->bytes.end());
    texture.media_type = picture_media_type(texture.bytes);
  }
}

Bytes write_model(const Model& model, MeshFormat format, const WriteOptions& options, Context& context) {
  check_model(model, options.columns);
  switch (format) {
    case MeshFormat::obj: return write_obj(model, options, context);
    case MeshFormat::stl: return write_stl(model, options, context);
    case MeshFormat::ply: return write_ply(model, options, context);
    case MeshFormat::glb: return write_glb(model, options, context);
    case MeshFormat::three_mf: return write_three_mf(model, options, context);
  }
  return {};
}

Bytes write_model(const Model& model, MeshFormat format, Context& context) {
  return write_model(model, format, {}, context);
}

}  // namespace formwright
