// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// 3MF: core specification 1.3, materials and properties 1.2, production 1.1 (3MF Consortium).
#include <array>
#include <map>
#include <optional>

#include "formats/shared/mesh_source.h"
#include "formats/container/zip.h"

namespace formwright {

/// All items of the build plate (all model objects, if it is empty) with components and transforms, in mm; objects
/// in other parts of the archive too. Base materials and single colours become materials, colours per corner vertex
/// colours, texture groups UV. Several items become groups. Supports and beams are left out.
ModelFile read_three_mf(const MeshSource& source);

/// In mm; one object, or one a group (WriteOptions::object_per_group). A face has one property: its material's texture,
/// else the vertices' colours, else its base material. Positions are float32, as everything that slices has them, in
/// the fewest digits. UV without a texture's picture has no place in the format.
Bytes write_three_mf(const Model& model, const WriteOptions& options, Context& context);

// ---- what the model parts say, for the reader ----

/// Which part a resource is in, by its number in ThreeMfContent::parts, and its id there.
using ThreeMfId = std::pair<int, std::int64_t>;

struct ThreeMfCorner {
  std::int64_t property = -1;           // id of a property group, -1 for none
  std::array<std::int64_t, 3> index{};  // one a corner
  bool per_corner = false;              // not the same for all three
};

struct ThreeMfComponent {
  ThreeMfId object;
  Eigen::Matrix4d transform;
};

struct ThreeMfObject {
  std::string name;
  bool printed = true;  // neither support nor other
  double unit_mm = 1;
  std::vector<double> V;
  std::vector<int> F;
  std::vector<ThreeMfCorner> corners;  // one a face; empty if no face has properties
  std::vector<ThreeMfComponent> components;
};

struct ThreeMfProperties {
  enum class Kind { base_materials, colours, texture } kind = Kind::base_materials;
  std::vector<std::string> names;  // base materials
  std::vector<Vec3> colours;       // linear; base materials, colours
  std::vector<Vec2> coordinates;   // texture
  std::int64_t texture = -1;       // id of the texture
};

struct ThreeMfContent {
  std::vector<std::string> parts;
  std::map<ThreeMfId, ThreeMfObject> objects;
  std::map<ThreeMfId, ThreeMfProperties> properties;
  std::map<ThreeMfId, std::string> texture_paths;
  std::vector<ThreeMfComponent> items;
  std::string unit;  // of the root part
  bool beams = false;
  bool mixed_properties = false;  // multiproperties, compositematerials
  bool painted = false;           // a slicer's own painting: PrusaSlicer's, Bambu Studio's
};

/// Reads the root model part and those it refers to. Nothing is resolved yet. What it makes counts against the
/// archive's budget.
ThreeMfContent read_three_mf_content(const MeshSource& source, ZipArchive& archive);

}  // namespace formwright
