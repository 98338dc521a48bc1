// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/glb/glb_assembly.h"

#include "base/error.h"

namespace formwright {

int GlbAssembly::add_view(std::size_t bytes, Target target) {
  binary_.resize((binary_.size() + 3) / 4 * 4);
  if (binary_.size() + bytes > std::numeric_limits<std::uint32_t>::max() - 1'000'000u)
    throw Error(ErrorCode::invalid_input, where_, too_large_);
  Json view = {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes}};
  if (target != Target::none) view["target"] = static_cast<int>(target);
  views_.push_back(std::move(view));
  binary_.resize(binary_.size() + bytes);
  return static_cast<int>(views_.size()) - 1;
}

int GlbAssembly::add_accessor(int view, int type, std::size_t count, const char* shape) {
  accessors_.push_back({{"bufferView", view}, {"componentType", type}, {"count", count}, {"type", shape}});
  return static_cast<int>(accessors_.size()) - 1;
}

int GlbAssembly::add_bytes(ByteView bytes) {
  const int view = add_view(bytes.size(), Target::none);
  std::copy(bytes.begin(), bytes.end(), binary_.end() - static_cast<std::ptrdiff_t>(bytes.size()));
  return view;
}

Bytes GlbAssembly::finish(Json json) {
  binary_.resize((binary_.size() + 3) / 4 * 4);
  json["bufferViews"] = views_;
  json["accessors"] = accessors_;
  json["buffers"] = Json::array({{{"byteLength", binary_.size()}}});
  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  Bytes bytes;
  bytes.reserve(28 + text.size() + binary_.size());
  const auto word = [&](std::size_t value) { append(bytes, static_cast<std::uint32_t>(value)); };
  word(0x46546C67), word(2), word(28 + text.size() + binary_.size());  // "glTF"
  word(text.size()), word(0x4E4F534A);
  const ByteView json_bytes = as_bytes(text);
  bytes.insert(bytes.end(), json_bytes.begin(), json_bytes.end());
  word(binary_.size()), word(0x004E4942);
  bytes.insert(bytes.end(), binary_.begin(), binary_.end());
  return bytes;
}

}  // namespace formwright
