// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>

#include "formats/shared/byte_order.h"
#include "formats/shared/mesh_format.h"
#include "formats/stl/stl.h"
#include "formats/shared/text_out.h"

namespace formwright {
namespace {

struct Facet {
  std::array<Eigen::Vector3f, 3> corners;
  Eigen::Vector3f normal;  // unit length, or zero for a face without area
};

Facet facet_of(const TriangleMesh& mesh, std::size_t face) {
  Facet facet;
  std::array<Vec3, 3> p;
  for (int k = 0; k < 3; ++k) {
    const auto corner = static_cast<std::size_t>(k);
    p[corner] = mesh.V.row(mesh.F(static_cast<Eigen::Index>(face), k)).transpose();
    facet.corners[corner] = p[corner].cast<float>();
  }
  const Vec3 normal = (p[1] - p[0]).cross(p[2] - p[0]);
  const double length = normal.norm();
  facet.normal = length > 0 ? Vec3(normal / length).cast<float>() : Eigen::Vector3f::Zero().eval();
  return facet;
}

Bytes write_binary(const TriangleMesh& mesh, const Context& context) {
  const auto count = static_cast<std::size_t>(mesh.F.rows());
  Bytes bytes(stl_header_bytes + count * stl_triangle_bytes);
  // Never "solid", by which some readers take a binary file for text.
  constexpr std::string_view header = "Binary STL by Formwright, lengths in mm";
  std::ranges::copy(as_bytes(header), bytes.begin());
  store(bytes.data() + 80, static_cast<std::uint32_t>(count));
  parallel_for(count, 65536, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (std::size_t i = begin; i < end; ++i) {
      const Facet facet = facet_of(mesh, i);
      std::byte* const at = bytes.data() + stl_header_bytes + i * stl_triangle_bytes;
      std::memcpy(at, facet.normal.data(), 12);
      for (std::size_t k = 0; k < 3; ++k) std::memcpy(at + 12 + 12 * k, facet.corners[k].data(), 12);
    }
  });
  return bytes;
}

}  // namespace

Bytes write_stl(const Model& model, const WriteOptions& options, Context& context) {
  if (!options.ascii) return write_binary(model.mesh, context);
  const std::string name = clean_text(options.name);
  std::vector<std::string> pieces{"solid " + name + "\n"};
  const auto vector = [](TextOut& out, const Eigen::Vector3f& v) {
    out << ' ' << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
  };
  std::ranges::move(format_rows(static_cast<std::size_t>(model.mesh.F.rows()), 220, context,
                                [&](TextOut& out, std::size_t i) {
                                  const Facet facet = facet_of(model.mesh, i);
                                  out << "facet normal", vector(out, facet.normal);
                                  out << "outer loop\n";
                                  for (const auto& corner : facet.corners) out << "vertex", vector(out, corner);
                                  out << "endloop\nendfacet\n";
                                }),
                    std::back_inserter(pieces));
  pieces.push_back("endsolid " + name + "\n");
  return concatenate(pieces);
}

}  // namespace formwright
