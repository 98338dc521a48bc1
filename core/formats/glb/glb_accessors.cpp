// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/glb/glb_accessors.h"

#include <algorithm>

#include "formats/shared/byte_order.h"

namespace formwright {
namespace {

std::size_t component_size(std::int64_t type) {
  switch (type) {
    case 5120:
    case 5121: return 1;
    case 5122:
    case 5123: return 2;
    case 5125:
    case 5126: return 4;
    default: return 0;
  }
}

int component_count(std::string_view type) {
  if (type == "SCALAR") return 1;
  if (type.size() == 4 && type.starts_with("VEC") && type[3] >= '2' && type[3] <= '4') return type[3] - '0';
  return 0;
}

/// The first byte of `count` elements of `size` bytes, `stride` apart, from `offset` on; nullptr if they do not fit.
const std::byte* fitting(ByteView view, std::int64_t offset, std::int64_t count, std::size_t stride, std::size_t size) {
  const auto bytes = static_cast<std::int64_t>(view.size());
  if (offset > bytes || count > bytes || stride > 65536) return nullptr;  // so that nothing below overflows
  if ((count - 1) * static_cast<std::int64_t>(stride) + static_cast<std::int64_t>(size) > bytes - offset)
    return nullptr;
  return view.data() + offset;
}

}  // namespace

GltfAccessor::GltfAccessor(const GltfDocument& document, std::int64_t index) {
  const auto& accessor = document.at("accessors", index);
  const MeshSource& source = document.source();
  const std::string name = "accessor " + std::to_string(index) + " in it ";
  count_ = document.integer(accessor, "count", 0);
  const std::int64_t type = document.integer(accessor, "componentType", 0);
  component_bytes_ = component_size(type);
  type_ = static_cast<int>(type);
  components_ = component_count(document.text(accessor, "type"));
  if (count_ < 1 || component_bytes_ == 0 || components_ == 0) source.refuse(name + "is damaged; export it again.");
  const auto normalised = accessor.find("normalized");
  normalised_ = normalised != accessor.end() && normalised->is_boolean() && normalised->get<bool>();

  const std::size_t size = component_bytes_ * static_cast<std::size_t>(components_);
  stride_ = size;
  if (accessor.contains("bufferView")) {
    const std::int64_t view_index = document.integer(accessor, "bufferView", 0);
    const ByteView view = document.view(view_index);
    const std::int64_t stride = document.integer(document.at("bufferViews", view_index), "byteStride", 0);
    if (stride != 0) stride_ = static_cast<std::size_t>(std::min<std::int64_t>(stride, 1 << 20));
    if (stride_ >= size) data_ = fitting(view, document.integer(accessor, "byteOffset", 0), count_, stride_, size);
    if (data_ == nullptr) source.refuse(name + "reaches beyond its data; export it or copy it again.");
  } else if (count_ > static_cast<std::int64_t>(source.bytes().size())) {  // zeros, for sparse values to stand in
    source.refuse(name + "declares more elements than the file can hold; export it again.");
  }
  if (const auto sparse = accessor.find("sparse"); sparse != accessor.end()) {
    if (!sparse->is_object()) source.refuse(name + "is damaged; export it again.");
    apply_sparse(document, *sparse, index);
  }
}

void GltfAccessor::apply_sparse(const GltfDocument& document, const GltfDocument::Object& sparse, std::int64_t index) {
  const MeshSource& source = document.source();
  const auto damaged = [&] {
    source.refuse("the sparse part of accessor " + std::to_string(index) + " in it is damaged; export it again.");
  };
  const auto indices = sparse.find("indices"), values = sparse.find("values");
  if (indices == sparse.end() || values == sparse.end() || !indices->is_object() || !values->is_object()) damaged();
  const std::int64_t changes = document.integer(sparse, "count", 0);
  const std::int64_t type = document.integer(*indices, "componentType", 0);
  if (changes < 1 || changes > count_ || (type != 5121 && type != 5123 && type != 5125)) damaged();
  const std::size_t size = component_bytes_ * static_cast<std::size_t>(components_);
  const ByteView index_view = document.view(document.integer(*indices, "bufferView", 0));
  const ByteView value_view = document.view(document.integer(*values, "bufferView", 0));
  const std::byte* const places = fitting(index_view, document.integer(*indices, "byteOffset", 0), changes,
                                          component_size(type), component_size(type));
  const std::byte* const news = fitting(value_view, document.integer(*values, "byteOffset", 0), changes, size, size);
  if (places == nullptr || news == nullptr) damaged();

  const Bytes& dense = document.dense(index, [&] {
    document.take(static_cast<std::uint64_t>(count_) * size);
    Bytes numbers(static_cast<std::size_t>(count_) * size);
    if (data_ != nullptr)
      for (std::int64_t i = 0; i < count_; ++i)
        std::memcpy(numbers.data() + static_cast<std::size_t>(i) * size, data_ + static_cast<std::size_t>(i) * stride_,
                    size);
    for (std::int64_t i = 0; i < changes; ++i) {
      std::uint32_t element = 0;  // little endian: the low bytes come first
      std::memcpy(&element, places + static_cast<std::size_t>(i) * component_size(type), component_size(type));
      if (element >= count_) damaged();
      std::memcpy(numbers.data() + element * size, news + static_cast<std::size_t>(i) * size, size);
    }
    return numbers;
  });
  data_ = dense.data();
  stride_ = size;
}

const std::byte* GltfAccessor::place(std::int64_t element, int component) const {
  return data_ + static_cast<std::size_t>(element) * stride_ + static_cast<std::size_t>(component) * component_bytes_;
}

double GltfAccessor::number(std::int64_t element, int component) const {
  if (data_ == nullptr) return 0;
  const std::byte* const at = place(element, component);
  const auto integer = [&](auto value, double largest) {
    return normalised_ ? std::max(static_cast<double>(value) / largest, -1.0) : static_cast<double>(value);
  };
  switch (type_) {
    case 5120: return integer(load<std::int8_t>(at), 127);
    case 5121: return integer(load<std::uint8_t>(at), 255);
    case 5122: return integer(load<std::int16_t>(at), 32767);
    case 5123: return integer(load<std::uint16_t>(at), 65535);
    case 5125: return integer(load<std::uint32_t>(at), 4294967295.0);
    default: return static_cast<double>(load<float>(at));
  }
}

std::uint32_t GltfAccessor::index(std::int64_t element) const {
  if (data_ == nullptr) return 0;
  const std::byte* const at = place(element, 0);
  switch (type_) {
    case 5121: return load<std::uint8_t>(at);
    case 5123: return load<std::uint16_t>(at);
    default: return load<std::uint32_t>(at);
  }
}

}  // namespace formwright
