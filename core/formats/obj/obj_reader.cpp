// SPDX-License-Identifier: GPL-3.0-or-later
// OBJ in two passes over the same chunks of whole lines: the first counts, the second writes each thing to its final
// place. So memory is the file plus the model, chunks are read in parallel, and the result is the same on any number
// of threads.
#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <optional>
#include <unordered_map>

#include "base/error.h"
#include "base/parallel.h"
#include "formats/shared/colour.h"
#include "formats/obj/obj.h"
#include "formats/obj/obj_lines.h"
#include "formats/shared/polygon_fan.h"
#include "formats/shared/reader_limits.h"
#include "formats/shared/text_scan.h"

namespace formwright {
namespace {

struct Counts {
  std::int64_t vertices = 0, texture_vertices = 0, triangles = 0;
};

/// A change of group or material, from this triangle on.
struct Switch {
  std::int64_t triangle;
  bool material;
  std::string_view name;
};

struct Failure {
  std::size_t offset;  // of the line, in the file
  std::string what;
};

struct Chunk {
  const char *begin = nullptr, *end = nullptr;
  Counts count, base;  // in this chunk; before it
  bool coloured = false, large_colours = false, textured = false;
  bool lines = false, free_form = false;
  std::int64_t short_faces = 0, untextured_faces = 0;
  std::vector<Switch> switches;
  std::vector<std::string_view> libraries;
  std::vector<PolygonFan> polygons;
  std::optional<Failure> failure;
};

void count_chunk(Chunk& chunk, char terminator) {
  TextScan rest("");
  for (ObjLines lines(chunk.begin, chunk.end, terminator); lines.next();) {
    switch (keyword_of(lines.line(), rest)) {
      case ObjKeyword::vertex:
        ++chunk.count.vertices;
        chunk.coloured = chunk.coloured || count_words(rest) >= 6;
        break;
      case ObjKeyword::texture_vertex: ++chunk.count.texture_vertices; break;
      case ObjKeyword::face: chunk.count.triangles += std::max(0, count_words(rest) - 2); break;
      default: break;
    }
  }
}

class ChunkReader {
 public:
  ChunkReader(const MeshSource& source, Chunk& chunk, Model& model, const Counts& total)
      : source_(source), chunk_(chunk), model_(model), total_(total), now_(chunk.base) {}

  void read(char terminator) {
    ObjLines lines(chunk_.begin, chunk_.end, terminator);
    TextScan rest("");
    while (!chunk_.failure && lines.next()) {
      offset_ = static_cast<std::size_t>(lines.start() - source_.text().data());
      switch (keyword_of(lines.line(), rest)) {
        case ObjKeyword::vertex: vertex(rest); break;
        case ObjKeyword::texture_vertex: texture_vertex(rest); break;
        case ObjKeyword::face: face(rest); break;
        case ObjKeyword::group: chunk_.switches.push_back({now_.triangles, false, in_file(rest, lines)}); break;
        case ObjKeyword::material: chunk_.switches.push_back({now_.triangles, true, in_file(rest, lines)}); break;
        case ObjKeyword::library: chunk_.libraries.push_back(in_file(rest, lines)); break;
        case ObjKeyword::line: chunk_.lines = true; break;
        case ObjKeyword::free_form: chunk_.free_form = true; break;
        case ObjKeyword::other: break;
      }
    }
  }

 private:
  void fail(const std::string& what) {
    if (!chunk_.failure) chunk_.failure = Failure{offset_, what};
  }

  /// What is left of the line, as a view into the file: names must outlive the line. A continued name is cut.
  std::string_view in_file(const TextScan& rest, const ObjLines& lines) const {
    const char* const text = source_.text().data();
    const bool inside =
        std::greater_equal<>{}(rest.at, text) && std::less_equal<>{}(rest.end, text + source_.text().size());
    if (inside) return trimmed(rest.rest());
    const char* const stop = static_cast<const char*>(
        std::memchr(lines.start(), '\\', static_cast<std::size_t>(chunk_.end - lines.start())));
    const std::string_view line = trimmed({lines.start(), static_cast<std::size_t>(stop - lines.start())});
    return trimmed(line.substr(std::min(line.size(), line.find_first_of(" \t"))));
  }

  /// Up to `most` numbers of a line; fewer than `least`, or anything but numbers, is a failure.
  int numbers(TextScan& rest, double* values, int minimum, int maximum, const char* what) {
    int count = 0;
    for (; count < maximum; ++count) {
      rest.skip_blanks();
      if (rest.done() || *rest.at == '#') break;
      const char* const from = rest.at;
      if (!rest.number(values[count]) || !(rest.done() || is_blank(*rest.at))) {
        rest.at = from;
        fail("“" + clean_text(next_word(rest), 40) + "” in " + what + " is not a number; export the model again.");
        return -1;
      }
    }
    if (count >= minimum) return count;
    fail(std::string(what) + " has " + counted(count, "number", "numbers") + " instead of " + std::to_string(minimum) +
         "; export the model again.");
    return -1;
  }

  void vertex(TextScan& rest) {
    std::array<double, 7> values;
    const int count = numbers(rest, values.data(), 3, 7, "a vertex");
    if (count < 0) return;
    for (std::size_t k = 0; k < 3; ++k)
      if (!is_sane_coordinate(values[k])) return fail(insane_coordinate("vertex", now_.vertices + 1, values[k]));
    const auto row = static_cast<Eigen::Index>(now_.vertices++);
    model_.mesh.V.row(row) << values[0], values[1], values[2];
    if (model_.vertex_colours.rows() == 0 || count < 6) return;
    for (std::size_t k = 0; k < 3; ++k) {
      const double c = values[3 + k];
      chunk_.large_colours = chunk_.large_colours || c > 1.001;
      model_.vertex_colours(row, static_cast<int>(k)) = c >= 0 ? c : 0;  // NaN becomes 0
    }
  }

  void texture_vertex(TextScan& rest) {
    std::array<double, 2> values{0, 0};
    if (numbers(rest, values.data(), 1, 2, "a texture vertex") < 0) return;
    for (const double value : values)
      if (!is_sane_coordinate(value))
        return fail(insane_coordinate("texture vertex", now_.texture_vertices + 1, value));
    model_.UV.row(static_cast<Eigen::Index>(now_.texture_vertices++)) << values[0], values[1];
  }

  /// 0-based index of what a face calls `written`; counts from 1, or backwards from the newest with -1.
  bool resolve(std::int64_t written, std::int64_t so_far, std::int64_t all, const char* what, int& index) {
    const std::int64_t i = written > 0 ? written - 1 : so_far + written;
    if (written == 0)
      fail(std::string("a face refers to ") + what + " 0, but OBJ counts from 1; export the model again.");
    else if (i < 0 || i >= all)
      fail(std::string("a face refers to ") + what + ' ' + std::to_string(written) + ", but the file has " +
           std::to_string(written > 0 ? all : so_far) + (written > 0 ? "" : " up to there") +
           "; export the model again.");
    index = static_cast<int>(i);
    return !chunk_.failure;
  }

  /// "7", "7/3", "7//5" or "7/3/5": vertex, texture vertex (-1 if absent), normal (checked to be a number only).
  bool corner(std::string_view word, int& vertex, int& texture) {
    TextScan scan(word);
    std::int64_t number = 0;
    bool good = scan.integer(number);
    if (good && !resolve(number, now_.vertices, total_.vertices, "vertex", vertex)) return false;
    texture = -1;
    if (good && !scan.done() && *scan.at == '/') {
      ++scan.at;
      if (scan.integer(number) &&
          !resolve(number, now_.texture_vertices, total_.texture_vertices, "texture vertex", texture))
        return false;
      if (!scan.done() && *scan.at == '/') {
        ++scan.at;
        scan.integer(number);
      }
    }
    good = good && scan.done();
    if (!good) fail("“" + clean_text(word, 40) + "” is not a corner of a face; export the model again.");
    return good;
  }

  void face(TextScan& rest) {
    std::array<int, 2> vertex{}, texture{};  // the first corner and the one before
    const std::int64_t first = now_.triangles;
    const bool with_texture = model_.FT.rows() > 0;
    int corners = 0;
    bool textured = true;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest), ++corners) {
      int v = -1, t = -1;
      if (!corner(word, v, t)) return;
      textured = textured && t >= 0;
      if (t < 0) t = static_cast<int>(total_.texture_vertices);  // the spare row
      if (corners >= 2) {
        // A fan for now; polygons are triangulated properly once all vertices are known.
        const auto row = static_cast<Eigen::Index>(now_.triangles++);
        model_.mesh.F.row(row) << vertex[0], vertex[1], v;
        if (with_texture) model_.FT.row(row) << texture[0], texture[1], t;
      }
      const std::size_t place = corners == 0 ? 0 : 1;
      vertex[place] = v, texture[place] = t;
    }
    if (corners < 3) ++chunk_.short_faces;
    else if (textured) chunk_.textured = true;
    else ++chunk_.untextured_faces;
    if (corners > 3) chunk_.polygons.push_back({first, corners});
  }

  const MeshSource& source_;
  Chunk& chunk_;
  Model& model_;
  const Counts& total_;
  Counts now_;  // read so far, in the whole file
  std::size_t offset_ = 0;
};

std::vector<Chunk> split(std::string_view text, char terminator) {
  constexpr std::size_t chunk_bytes = 1 << 20;
  std::vector<Chunk> chunks;
  const char* const end = text.data() + text.size();
  for (const char* at = text.data(); at != end;) {
    const char* stop = at + std::min(chunk_bytes, static_cast<std::size_t>(end - at));
    while (stop != end) {
      stop = static_cast<const char*>(std::memchr(stop, terminator, static_cast<std::size_t>(end - stop)));
      if (stop == nullptr) stop = end;
      else ++stop;
      if (stop == end) break;
      const char* last = stop - 2;  // before the terminator; the chunk is far longer than that
      while (last > at && is_blank(*last)) --last;
      if (*last != '\\') break;
    }
    chunks.emplace_back();
    chunks.back().begin = at, chunks.back().end = stop;
    at = stop;
  }
  return chunks;
}

/// Groups and materials per face from the switches of all chunks in order.
void assign_switches(const std::vector<Chunk>& chunks, std::int64_t triangles, Model& model) {
  std::unordered_map<std::string, int> group_of, material_of;
  for (const bool material : {false, true}) {
    auto& numbers = material ? material_of : group_of;
    auto& per_face = material ? model.face_material : model.face_group;
    std::int64_t from = 0;
    std::string_view current;
    bool any = false;
    const auto fill = [&](std::int64_t to) {
      if (from == to) return;
      if (!any && to == triangles) {  // nothing is named, or nothing but an empty end
        from = to;
        return;
      }
      int number = -1;
      if (any) {
        const std::string name = clean_text(current);
        const auto [place, fresh] = numbers.try_emplace(name, static_cast<int>(numbers.size()));
        number = place->second;
        if (fresh && material) model.materials.emplace_back().name = name;
        else if (fresh) model.group_names.push_back(name);
      }
      per_face.resize(static_cast<std::size_t>(triangles), -1);
      std::fill(per_face.begin() + static_cast<std::ptrdiff_t>(from),
                per_face.begin() + static_cast<std::ptrdiff_t>(to), number);
      from = to;
    };
    for (const Chunk& chunk : chunks) {
      for (const Switch& change : chunk.switches) {
        if (change.material != material) continue;
        fill(change.triangle);
        current = change.name;
        any = true;
      }
    }
    fill(triangles);
  }
}

}  // namespace

ModelFile read_obj(const MeshSource& source) {
  std::string_view text = source.text();
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  if (text.substr(0, 4096).find('\0') != std::string_view::npos)
    source.refuse("it is not a text file, as OBJ must be; export the model again.");
  const char terminator = text.find('\n') == std::string_view::npos ? '\r' : '\n';
  Context& context = source.context();

  std::vector<Chunk> chunks = split(text, terminator);
  parallel_for(chunks.size(), 1, [&](std::size_t begin, std::size_t) {
    context.check_cancelled();
    count_chunk(chunks[begin], terminator);
  });
  Counts total;
  bool coloured = false;
  for (Chunk& chunk : chunks) {
    chunk.base = total;
    total.vertices += chunk.count.vertices;
    total.texture_vertices += chunk.count.texture_vertices;
    total.triangles += chunk.count.triangles;
    coloured = coloured || chunk.coloured;
  }
  source.check_triangle_count(total.triangles);
  check_vertex_count(source, std::max(total.vertices, total.texture_vertices + 1));
  // A vertex takes at least "v 0 0 0" and a line end: lines without numbers are no reason for gigabytes.
  if (total.vertices > static_cast<std::int64_t>(text.size() / 7))
    source.refuse("its vertices have too few numbers; export the model again.");
  context.progress(0.2);

  ModelFile file;
  file.format = MeshFormat::obj;
  Model& model = file.model;
  model.mesh.V.resize(static_cast<Eigen::Index>(total.vertices), 3);
  model.mesh.F.resize(static_cast<Eigen::Index>(total.triangles), 3);
  if (coloured) model.vertex_colours = Positions::Ones(static_cast<Eigen::Index>(total.vertices), 3);
  if (total.texture_vertices > 0) {
    model.UV = TextureCoordinates::Zero(static_cast<Eigen::Index>(total.texture_vertices) + 1, 2);
    model.FT.resize(static_cast<Eigen::Index>(total.triangles), 3);
  }
  parallel_for(chunks.size(), 1, [&](std::size_t begin, std::size_t) {
    context.check_cancelled();
    ChunkReader(source, chunks[begin], model, total).read(terminator);
  });
  for (const Chunk& chunk : chunks)
    if (chunk.failure) source.refuse_line(chunk.failure->offset, chunk.failure->what);
  context.progress(0.8);

  bool lines = false, free_form = false, textured = false, large_colours = false;
  std::int64_t short_faces = 0, untextured = 0;
  for (const Chunk& chunk : chunks) {
    lines = lines || chunk.lines, free_form = free_form || chunk.free_form;
    textured = textured || chunk.textured, large_colours = large_colours || chunk.large_colours;
    short_faces += chunk.short_faces, untextured += chunk.untextured_faces;
    for (const std::string_view library : chunk.libraries) file.material_libraries.push_back(clean_text(library, 1000));
  }
  if (total.triangles == 0)
    source.refuse_empty(free_form            ? "free-form curves and surfaces"
                        : lines              ? "points and lines"
                        : total.vertices > 0 ? "a cloud of points"
                                             : "");

  parallel_for(chunks.size(), 1,
               [&](std::size_t begin, std::size_t) { triangulate_fans(chunks[begin].polygons, model, context); });
  assign_switches(chunks, total.triangles, model);
  if (coloured) {
    const double scale = large_colours ? 1.0 / 255 : 1.0;
    model.vertex_colours = model.vertex_colours.unaryExpr([&](double c) { return linear_of_srgb(c * scale); }).eval();
  }
  if (!textured) model.UV.resize(0, 2), model.FT.resize(0, 3);
  else if (untextured == 0) model.UV.conservativeResize(model.UV.rows() - 1, 2);
  if (short_faces > 0)
    file.notes.push_back(counted(short_faces, "face", "faces") + " with fewer than three corners left out.");
  if (textured && untextured > 0)
    file.notes.push_back(counted(untextured, "face has", "faces have") + " no texture coordinates and got (0, 0).");
  if (free_form) file.notes.push_back("Free-form curves and surfaces were left out.");
  return file;
}

}  // namespace formwright
