// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>

#include "formats/shared/byte_order.h"
#include "formats/shared/mesh_format.h"
#include "formats/shared/reader_limits.h"
#include "formats/stl/stl.h"
#include "formats/shared/text_scan.h"
#include "formats/shared/vertex_merge.h"

namespace formwright {
namespace {

/// Collects corners into a mesh, merged or not.
class CornerSink {
 public:
  CornerSink(const MeshSource& source, std::size_t expected_triangles)
      : merge_(source.options().merge_duplicates), merger_(merge_ ? expected_triangles / 2 : 0) {
    F_.reserve(3 * expected_triangles);
  }

  void add(const std::array<double, 3>& p) {
    if (merge_) {
      F_.push_back(merger_.add(p[0], p[1], p[2]));
    } else {
      F_.push_back(static_cast<int>(F_.size()));
      soup_.insert(soup_.end(), p.begin(), p.end());
    }
  }

  std::size_t corner_count() const { return F_.size(); }

  TriangleMesh mesh() const {
    TriangleMesh mesh;
    mesh.V = merge_
                 ? merger_.positions()
                 : Positions(Eigen::Map<const Positions>(soup_.data(), static_cast<Eigen::Index>(soup_.size() / 3), 3));
    mesh.F = Eigen::Map<const Triangles>(F_.data(), static_cast<Eigen::Index>(F_.size() / 3), 3);
    return mesh;
  }

 private:
  bool merge_;
  VertexMerger merger_;
  std::vector<double> soup_;
  std::vector<int> F_;
};

ModelFile read_binary(const MeshSource& source) {
  const ByteView bytes = source.bytes();
  if (bytes.size() < stl_header_bytes)
    source.refuse("it ends after " + counted(static_cast<std::int64_t>(bytes.size()), "byte", "bytes") +
                  ", within the header of an STL file; export it or copy it again.");
  const std::uint32_t declared = load<std::uint32_t>(bytes.data() + 80);
  const std::size_t body = bytes.size() - stl_header_bytes;
  std::size_t count = body / stl_triangle_bytes;
  ModelFile file;
  file.format = MeshFormat::stl;
  if (body % stl_triangle_bytes != 0) {
    // Too much is somebody's annex; too little is a file cut short.
    if (declared > count)
      source.refuse("it should hold " + counted(declared, "triangle", "triangles") + " but ends within triangle " +
                    std::to_string(count + 1) + "; export it or copy it again.");
    if (declared > 0) count = declared;
    file.notes.push_back("Bytes after the last triangle were left out.");
  } else if (declared != count) {
    file.notes.push_back("The header says " + counted(declared, "triangle", "triangles") + ", but the file holds " +
                         std::to_string(count) + ", which were read.");
  }
  source.check_triangle_count(static_cast<std::int64_t>(count));
  if (count == 0) source.refuse_empty("");

  CornerSink sink(source, count);
  for (std::size_t i = 0; i < count; ++i) {
    if (i % 65536 == 0) source.context().progress(static_cast<double>(i) / static_cast<double>(count));
    const std::byte* const corners = bytes.data() + stl_header_bytes + i * stl_triangle_bytes + 12;  // after the normal
    std::array<float, 9> x;
    std::memcpy(x.data(), corners, sizeof x);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::array<double, 3> p{x[3 * k], x[3 * k + 1], x[3 * k + 2]};
      for (const double c : p)
        if (!is_sane_coordinate(c)) source.refuse(insane_coordinate("triangle", static_cast<std::int64_t>(i) + 1, c));
      sink.add(p);
    }
  }
  file.model.mesh = sink.mesh();
  return file;
}

class AsciiReader {
 public:
  explicit AsciiReader(const MeshSource& source)
      : source_(source),
        scan_(source.text()),
        sink_(source, std::min<std::size_t>(source.bytes().size() / 150, 100'000'000)) {}

  ModelFile read() {
    if (source_.text().starts_with("\xef\xbb\xbf")) scan_.at += 3;
    for (std::string_view word = scan_.word(); !word.empty(); word = scan_.word()) {
      word_at_ = word.data();
      if (equal_ignoring_case(word, "vertex")) vertex();
      else if (equal_ignoring_case(word, "facet")) facet();
      else if (equal_ignoring_case(word, "endfacet")) end_facet();
      else if (equal_ignoring_case(word, "solid")) solid();
      else if (equal_ignoring_case(word, "endsolid")) end_solid();
      else if (!equal_ignoring_case(word, "outer") && !equal_ignoring_case(word, "loop") &&
               !equal_ignoring_case(word, "endloop"))
        refuse("“" + clean_text(word, 40) + "” is not a word of STL; export it again.");
    }
    if (in_facet_ || in_solid_)
      source_.refuse("it ends before “endsolid”, so a part is missing; export it or copy it again.");
    const auto triangles = static_cast<std::int64_t>(sink_.corner_count() / 3);
    if (triangles == 0) source_.refuse_empty("");
    ModelFile file;
    file.format = MeshFormat::stl;
    file.model.mesh = sink_.mesh();
    if (solids_.size() > 1) {
      file.model.face_group.reserve(static_cast<std::size_t>(triangles));
      for (std::size_t s = 0; s < solids_.size(); ++s) {
        file.model.group_names.push_back(solids_[s].name);
        const std::size_t end =
            s + 1 < solids_.size() ? solids_[s + 1].first_triangle : static_cast<std::size_t>(triangles);
        file.model.face_group.resize(end, static_cast<int>(s));
      }
    }
    return file;
  }

 private:
  struct Solid {
    std::string name;
    std::size_t first_triangle;
  };

  [[noreturn]] void refuse(const std::string& what) const {
    source_.refuse_line(static_cast<std::size_t>(word_at_ - source_.text().data()), what);
  }

  std::string_view rest_of_line() {
    const char* const from = scan_.at;
    while (!scan_.done() && *scan_.at != '\n' && *scan_.at != '\r') ++scan_.at;
    return trimmed({from, static_cast<std::size_t>(scan_.at - from)});
  }

  void solid() {
    if (in_solid_) refuse("a solid begins within another; export it again.");
    in_solid_ = true;
    solids_.push_back({clean_text(rest_of_line()), sink_.corner_count() / 3});
  }

  void end_solid() {
    if (in_facet_) refuse("the solid ends within a facet; export it again.");
    if (!in_solid_) refuse("“endsolid” comes without “solid”; export it again.");
    in_solid_ = false;
    rest_of_line();
  }

  void facet() {
    if (in_facet_ || !in_solid_) refuse("a facet begins where none can; export it again.");
    in_facet_ = true;
    corners_ = 0;
    if (++facets_ % 4096 == 0) {
      source_.check_triangle_count(facets_);
      source_.context().progress(static_cast<double>(scan_.at - source_.text().data()) /
                                 static_cast<double>(source_.bytes().size()));
    }
    rest_of_line_numbers();
  }

  /// "normal x y z": words that are not needed, and are often not even numbers.
  void rest_of_line_numbers() {
    if (!equal_ignoring_case(scan_.word(), "normal")) refuse("“facet” comes without “normal”; export it again.");
    for (int k = 0; k < 3; ++k) scan_.word();
  }

  void vertex() {
    if (!in_facet_ || corners_ == 3) refuse("a facet has more than three vertices; export the model as triangles.");
    std::array<double, 3> p;
    for (double& c : p) {
      scan_.skip_spaces();
      const char* const from = scan_.at;
      if (!scan_.number(c) || !(scan_.done() || is_space(*scan_.at))) {
        scan_.at = from;
        refuse("“" + clean_text(scan_.word(), 40) + "” is not a coordinate; export it again.");
      }
      if (!is_sane_coordinate(c)) refuse(insane_coordinate("triangle", facets_, c));
    }
    sink_.add(p);
    ++corners_;
  }

  void end_facet() {
    if (!in_facet_ || corners_ != 3)
      refuse("a facet has " + std::to_string(corners_) + " vertices instead of three; export it again.");
    in_facet_ = false;
  }

  const MeshSource& source_;
  TextScan scan_;
  CornerSink sink_;
  std::vector<Solid> solids_;
  const char* word_at_ = nullptr;
  std::int64_t facets_ = 0;
  int corners_ = 0;
  bool in_solid_ = false, in_facet_ = false;
};

bool is_ascii(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  text = trimmed(text.substr(0, 4096));
  return equal_ignoring_case(text.substr(0, 5), "solid") && text.find('\0') == std::string_view::npos;
}

}  // namespace

ModelFile read_stl(const MeshSource& source) {
  if (has_binary_stl_size(source.bytes()) || !is_ascii(source.text())) return read_binary(source);
  ModelFile file = AsciiReader(source).read();
  source.check_triangle_count(file.model.mesh.F.rows());
  return file;
}

}  // namespace formwright
