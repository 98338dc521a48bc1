// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/glb/glb_scene.h"

#include <Eigen/Geometry>
#include <cmath>

#include "base/data/json_text.h"
#include "formats/shared/byte_order.h"
#include "formats/shared/text_scan.h"

namespace formwright {
namespace {

constexpr std::uint32_t chunk_json = 0x4E4F534A, chunk_binary = 0x004E4942;

Bytes decode_base64(std::string_view text) {
  Bytes bytes;
  bytes.reserve(text.size() / 4 * 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    std::uint32_t value = 0;
    if (c >= 'A' && c <= 'Z') value = static_cast<std::uint32_t>(c - 'A');
    else if (c >= 'a' && c <= 'z') value = static_cast<std::uint32_t>(c - 'a') + 26;
    else if (c >= '0' && c <= '9') value = static_cast<std::uint32_t>(c - '0') + 52;
    else if (c == '+' || c == '-') value = 62;
    else if (c == '/' || c == '_') value = 63;
    else continue;  // padding, line ends
    bits = (bits << 6) | value;
    if (++count == 4) {
      for (const unsigned shift : {16u, 8u, 0u}) bytes.push_back(static_cast<std::byte>(bits >> shift));
      bits = 0, count = 0;
    }
  }
  if (count >= 2) bytes.push_back(static_cast<std::byte>(bits >> (count == 2 ? 4 : 10)));
  if (count == 3) bytes.push_back(static_cast<std::byte>(bits >> 2));
  return bytes;
}

Eigen::Matrix4d node_transform(const GltfDocument& document, const GltfDocument::Object& node) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  if (document.numbers(node, "matrix", matrix.data(), 16)) return matrix;  // both are column-major
  Vec3 translation = Vec3::Zero(), scale = Vec3::Ones();
  Eigen::Vector4d rotation(0, 0, 0, 1);
  document.numbers(node, "translation", translation.data(), 3);
  document.numbers(node, "scale", scale.data(), 3);
  document.numbers(node, "rotation", rotation.data(), 4);
  if (rotation.x() != 0 || rotation.y() != 0 || rotation.z() != 0) {
    const double length = rotation.norm();
    const Eigen::Quaterniond quaternion(Eigen::Vector4d(rotation / (length > 0 ? length : 1)));
    matrix.topLeftCorner<3, 3>() = quaternion.toRotationMatrix();
  }
  for (int k = 0; k < 3; ++k) matrix.col(k).head<3>() *= scale[k];
  matrix.topRightCorner<3, 1>() = translation;
  return matrix;
}

std::uint64_t bytes_with_companions(const MeshSource& source) {
  std::uint64_t bytes = source.bytes().size();
  for (const Companion& companion : source.options().companions) bytes += companion.bytes.size();
  return bytes;
}

}  // namespace

void GltfDocument::take(std::uint64_t bytes) const {
  if (!budget_.take(bytes))
    source_.refuse("its parts are repeated so often that it takes far more than a file of its size; export it again.");
}

GltfDocument::GltfDocument(const MeshSource& source) : source_(source), budget_(bytes_with_companions(source)) {
  open_container();
  json_ = parse_json_text<Object>(json_text_);
  if (!json_.is_object()) source_.refuse("its JSON is damaged; export it or copy it again.");
  const auto asset = json_.find("asset");
  if (asset == json_.end() || !asset->is_object() || !text(*asset, "version").starts_with("2"))
    source_.refuse("it is not of glTF version 2; export it with a newer program.");
  if (const auto required = json_.find("extensionsRequired"); required != json_.end() && required->is_array()) {
    for (const Object& extension : *required) {
      if (!extension.is_string()) continue;
      const auto& name = extension.get_ref<const std::string&>();
      if (name == "KHR_draco_mesh_compression" || name.starts_with("EXT_meshopt_compression") ||
          name.starts_with("KHR_meshopt"))
        source_.refuse("its meshes are compressed (" + name + "); export it without mesh compression.");
    }
  }
  load_buffers();
}

void GltfDocument::open_container() {
  const ByteView bytes = source_.bytes();
  if (!source_.text().starts_with("glTF")) {  // a .gltf, which is nothing but the JSON
    json_text_ = source_.text();
    if (json_text_.starts_with("\xef\xbb\xbf")) json_text_.remove_prefix(3);
    return;
  }
  const auto cut_short = [&] { source_.refuse("it ends too early; export it or copy it again."); };
  if (bytes.size() < 20) cut_short();
  if (load<std::uint32_t>(bytes.data() + 4) != 2)
    source_.refuse("it is not of glTF version 2; export it with a newer program.");
  const std::size_t length = load<std::uint32_t>(bytes.data() + 8);
  if (length > bytes.size()) cut_short();
  for (std::size_t at = 12; at + 8 <= length;) {
    const std::size_t size = load<std::uint32_t>(bytes.data() + at);
    const std::uint32_t type = load<std::uint32_t>(bytes.data() + at + 4);
    at += 8;
    if (size > length - at) cut_short();
    const ByteView chunk = bytes.subspan(at, size);
    if (type == chunk_json && json_text_.empty()) json_text_ = as_text(chunk);
    if (type == chunk_binary && !has_binary_chunk_) binary_chunk_ = chunk, has_binary_chunk_ = true;
    at += size;
  }
  if (json_text_.empty()) source_.refuse("it has no JSON part; export it or copy it again.");
}

void GltfDocument::load_buffers() {
  for (std::int64_t i = 0; i < count("buffers"); ++i) {
    const Object& buffer = at("buffers", i);
    const std::int64_t length = integer(buffer, "byteLength", 0);
    const std::string name = text(buffer, "uri");
    ByteView bytes;
    if (i == 0 && name.empty() && has_binary_chunk_) bytes = binary_chunk_;
    else if (!name.empty()) bytes = uri(name);
    if (static_cast<std::uint64_t>(length) > bytes.size()) {
      if (!name.empty() && !name.starts_with("data:"))
        source_.refuse("its geometry is in another file, “" + clean_text(name, 60) +
                       "”; export it as one GLB file with everything in it.");
      source_.refuse("a buffer in it is shorter than it should be; export it or copy it again.");
    }
    buffers_.push_back(bytes.first(static_cast<std::size_t>(length)));
  }
}

std::int64_t GltfDocument::count(const char* array) const {
  const auto found = json_.find(array);
  return found != json_.end() && found->is_array() ? static_cast<std::int64_t>(found->size()) : 0;
}

const GltfDocument::Object& GltfDocument::at(const char* array, std::int64_t index) const {
  if (index < 0 || index >= count(array))
    source_.refuse("it refers to number " + std::to_string(index) + " of its " + array +
                   ", which does not exist; export it again.");
  const Object& object = json_.find(array)->at(static_cast<std::size_t>(index));
  if (!object.is_object())
    source_.refuse("number " + std::to_string(index) + " of its " + array + " is damaged; export it again.");
  return object;
}

std::int64_t GltfDocument::integer(const Object& object, const char* key, std::int64_t fallback) const {
  const auto found = object.find(key);
  if (found == object.end()) return fallback;
  const double value = found->is_number() ? found->get<double>() : -1;  // some exporters write 3.0
  if (!(value >= 0 && value <= 9e15) || value != std::floor(value))
    source_.refuse("“" + std::string(key) + "” in it must be a whole number; export it again.");
  return static_cast<std::int64_t>(value);
}

bool GltfDocument::numbers(const Object& object, const char* key, double* values, std::size_t size) const {
  const auto found = object.find(key);
  if (found == object.end()) return false;
  bool good = found->is_array() && found->size() == size;
  for (std::size_t k = 0; good && k < size; ++k) {
    good = (*found)[k].is_number();
    if (good) values[k] = (*found)[k].get<double>();
    good = good && std::isfinite(values[k]);
  }
  if (!good)
    source_.refuse("“" + std::string(key) + "” in it must be " + std::to_string(size) + " numbers; export it again.");
  return true;
}

std::string GltfDocument::text(const Object& object, const char* key) const {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

ByteView GltfDocument::view(std::int64_t index) const {
  const Object& view = at("bufferViews", index);
  const std::int64_t buffer = integer(view, "buffer", -1), offset = integer(view, "byteOffset", 0),
                     length = integer(view, "byteLength", -1);
  if (buffer < 0 || buffer >= static_cast<std::int64_t>(buffers_.size()) || length < 0)
    source_.refuse("buffer view " + std::to_string(index) + " in it is damaged; export it again.");
  const ByteView bytes = buffers_[static_cast<std::size_t>(buffer)];
  const auto size = static_cast<std::int64_t>(bytes.size());
  if (offset > size || length > size - offset)
    source_.refuse("buffer view " + std::to_string(index) +
                   " in it reaches beyond its data; export it or copy it again.");
  return bytes.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
}

ByteView GltfDocument::uri(const std::string& text) {
  if (text.starts_with("data:")) {
    const std::size_t comma = text.find(',');
    if (comma == std::string::npos || text.substr(0, comma).find(";base64") == std::string::npos)
      source_.refuse("embedded data in it is not in base64; export it as GLB.");
    take(text.size());
    decoded_.push_back(std::make_unique<Bytes>(decode_base64(std::string_view(text).substr(comma + 1))));
    return *decoded_.back();
  }
  for (const Companion& companion : source_.options().companions)
    if (bare_name(companion.name) == bare_name(text)) return companion.bytes;
  return {};
}

std::vector<GltfInstance> scene_instances(const GltfDocument& document) {
  const MeshSource& source = document.source();
  const std::int64_t nodes = document.count("nodes");
  std::vector<GltfInstance> instances;
  std::vector<std::pair<std::int64_t, Eigen::Matrix4d>> stack;
  const auto children = [&](const GltfDocument::Object& object, const char* key) {
    std::vector<std::int64_t> result;
    const auto found = object.find(key);
    if (found != object.end() && found->is_array())
      for (const auto& child : *found) {
        if (!child.is_number_unsigned() || child.get<std::uint64_t>() >= static_cast<std::uint64_t>(nodes))
          source.refuse("it refers to a node that does not exist; export it again.");
        result.push_back(child.get<std::int64_t>());
      }
    return result;
  };
  std::vector<std::int64_t> roots;
  if (document.count("scenes") > 0) {
    roots = children(document.at("scenes", document.integer(document.root(), "scene", 0)), "nodes");
  } else {
    std::vector<char> is_child(static_cast<std::size_t>(nodes), 0);
    for (std::int64_t i = 0; i < nodes; ++i)
      for (const std::int64_t child : children(document.at("nodes", i), "children"))
        is_child[static_cast<std::size_t>(child)] = 1;
    for (std::int64_t i = 0; i < nodes; ++i)
      if (!is_child[static_cast<std::size_t>(i)]) roots.push_back(i);
  }
  if (nodes == 0)
    for (std::int64_t i = 0; i < document.count("meshes"); ++i)
      instances.push_back({i, "", Eigen::Matrix4d::Identity()});

  for (auto root = roots.rbegin(); root != roots.rend(); ++root) stack.emplace_back(*root, Eigen::Matrix4d::Identity());
  std::vector<char> reached(static_cast<std::size_t>(nodes), 0);
  while (!stack.empty()) {
    const auto [index, above] = stack.back();
    stack.pop_back();
    if (reached[static_cast<std::size_t>(index)]++)
      source.refuse("node " + std::to_string(index) + " in it stands twice in the scene's tree; export it again.");
    const auto& node = document.at("nodes", index);
    const Eigen::Matrix4d transform = above * node_transform(document, node);
    if (node.contains("mesh"))
      instances.push_back({document.integer(node, "mesh", 0), clean_text(document.text(node, "name")), transform});
    const auto below = children(node, "children");
    for (auto child = below.rbegin(); child != below.rend(); ++child) stack.emplace_back(*child, transform);
  }
  return instances;
}

}  // namespace formwright
