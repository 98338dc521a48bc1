// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The container, the JSON and the node tree of a glTF file, for its reader.
#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <map>
#include <memory>
#include <vector>

#include "base/read_budget.h"
#include "formats/shared/mesh_source.h"

namespace formwright {

/// A glTF document with its buffers. Everything is checked when it is looked up; what is wrong refuses the file.
class GltfDocument {
 public:
  using Object = nlohmann::json;

  explicit GltfDocument(const MeshSource& source);
  GltfDocument(const GltfDocument&) = delete;

  const MeshSource& source() const { return source_; }
  const Object& root() const { return json_; }

  /// Number of objects in a top-level array, 0 if there is none.
  std::int64_t count(const char* array) const;
  /// Object `index` of a top-level array such as "nodes".
  const Object& at(const char* array, std::int64_t index) const;
  /// A whole number >= 0; `fallback` if the key is absent.
  std::int64_t integer(const Object& object, const char* key, std::int64_t fallback) const;
  /// `size` finite numbers; false if the key is absent.
  bool numbers(const Object& object, const char* key, double* values, std::size_t size) const;
  /// Text; "" if absent.
  std::string text(const Object& object, const char* key) const;

  /// Bytes of a buffer view.
  ByteView view(std::int64_t index) const;
  /// For what is made of the document beside its own numbers. Throws Error{invalid_input} once the file, with its
  /// companions, has taken more than it may.
  void take(std::uint64_t bytes) const;
  /// A sparse accessor's numbers, made by `make` when they are asked for first.
  template <class Make>
  const Bytes& dense(std::int64_t accessor, const Make& make) const {
    const auto found = dense_.find(accessor);
    return found != dense_.end() ? found->second : dense_.emplace(accessor, make()).first->second;
  }

  /// Bytes behind a data: URI, or a companion of that name; empty if there are none.
  ByteView uri(const std::string& text);

 private:
  void open_container();
  void load_buffers();

  const MeshSource& source_;
  std::string_view json_text_;
  ByteView binary_chunk_;
  bool has_binary_chunk_ = false;
  Object json_;
  mutable ReadBudget budget_;
  mutable std::map<std::int64_t, Bytes> dense_;
  std::vector<ByteView> buffers_;
  std::vector<std::unique_ptr<Bytes>> decoded_;  // what data: URIs held
};

struct GltfInstance {
  std::int64_t mesh;
  std::string name;
  Eigen::Matrix4d transform;  // to the scene, in metres
};

/// Every mesh the scene shows (the default scene, else all root nodes, else all meshes as they are).
std::vector<GltfInstance> scene_instances(const GltfDocument& document);

}  // namespace formwright
