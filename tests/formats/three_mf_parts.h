// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// 3MF packages put together from parts of their XML.
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/container/zip.h"
#include "formats/io_test_tools.h"

namespace formwright::test {

inline constexpr std::string_view relationships =
    R"(<?xml version="1.0"?><Relationships xmlns="x"><Relationship Target="/3D/3dmodel.model" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>)";
inline constexpr std::string_view triangle_mesh =
    R"(<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="2" z="0"/></vertices>
<triangles><triangle v1="0" v2="1" v3="2"/></triangles></mesh>)";

inline Bytes package(const std::string& model, const std::vector<std::pair<std::string, std::string>>& more = {}) {
  ZipWriter zip;
  const Context context;
  zip.add("_rels/.rels", relationships, context);
  zip.add("3D/3dmodel.model", model, context);
  for (const auto& [name, text] : more) zip.add(name, text, context);
  return zip.finish();
}

inline std::string model_of(const std::string& resources, const std::string& build,
                            const std::string& attributes = "") {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- a comment with <tags> -->\n<model " + attributes +
         " xmlns=\"c\"><resources>\n" + resources + "\n</resources>\n<build>" + build + "</build></model>";
}

inline Model read_parts(const std::string& resources, const std::string& build, const std::string& attributes = "") {
  return read_bytes(package(model_of(resources, build, attributes)), "a.3mf").model;
}

inline std::string object(int id, const std::string& inside, const std::string& attributes = "") {
  return "<object id=\"" + std::to_string(id) + "\" " + attributes + ">" + inside + "</object>";
}

}  // namespace formwright::test
