// SPDX-License-Identifier: GPL-3.0-or-later
// The XML within a 3MF: a mutated archive fails its checksum long before its model is read.
#include "fuzz/fuzz_reader.h"
#include "formats/three_mf/three_mf.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace formwright;
  ZipWriter zip;
  zip.add_stored("3D/3dmodel.model", ByteView(reinterpret_cast<const std::byte*>(data), size));
  const Bytes bytes = zip.finish();
  fuzz::read_and_write(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), read_three_mf);
  return 0;
}
