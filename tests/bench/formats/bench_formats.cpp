// SPDX-License-Identifier: GPL-3.0-or-later
// bench_formats [vertices] [rounds] [format]: best of some rounds, on a generated closed mesh, each format (or one, as
// "3mf") written and read; OBJ also through tinyobjloader where it is installed, for comparison.
#include <sys/resource.h>
#ifdef FORMWRIGHT_WITH_TINYOBJLOADER
#include <tiny_obj_loader.h>
#endif

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <iostream>
#include <sstream>
#include <thread>

#include "base/data/json.h"
#include "base/peak_memory.h"
#include "formats/mesh_io.h"
#include "formats/model_samples.h"
#include "formats/png/png16.h"

namespace {

using namespace formwright;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Least wall-clock time and least processor time (of all threads together: on a busy machine the sounder figure).
Json best_seconds(int rounds, const std::function<void()>& work) {
  double wall = 1e9, cpu = 1e9;
  for (int i = 0; i < rounds; ++i) {
    const Stopwatch watch;
    const double before = cpu_seconds();
    work();
    wall = std::min(wall, watch.seconds()), cpu = std::min(cpu, cpu_seconds() - before);
  }
  return {{"wall", wall}, {"cpu", cpu}};
}

double peak_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

struct Case {
  const char* name;
  MeshFormat format;
  bool ascii = false, textured = false;
};

Json height_map_row(int rounds) {
  Grey16Image image;
  image.width = image.height = 2000;
  image.pixel_width_mm = image.pixel_height_mm = 0.1;
  for (int y = 0; y < 2000; ++y)
    for (int x = 0; x < 2000; ++x)
      image.levels.push_back(static_cast<std::uint16_t>(32767 + 32000 * std::sin(0.004 * x) * std::cos(0.003 * y)));
  Bytes png;
  const Json write = best_seconds(rounds, [&] { png = write_png16(image); });
  return {{"format", "png16 of 2000 x 2000"},
          {"megabytes", static_cast<double>(png.size()) / 1e6},
          {"seconds_write", write},
          {"seconds_read", best_seconds(rounds, [&] { read_png16(png, "bench"); })}};
}

}  // namespace

int main(int argc, char** argv) {
  const int vertices = argc > 1 ? std::atoi(argv[1]) : 300'000, rounds = argc > 2 ? std::atoi(argv[2]) : 5;
  const std::string only = argc > 3 ? argv[3] : "";
  const int side = std::max(3, static_cast<int>(std::sqrt(vertices)));
  const Model textured = test::wavy_torus(side, side);
  Model plain = textured;
  plain.UV.resize(0, 2), plain.FT.resize(0, 3);
  const std::vector<VertexColumn> columns = test::sample_columns(plain);
  Json result = {{"machine", {{"cores", std::thread::hardware_concurrency()}}},
                 {"vertices", plain.mesh.vertex_count()},
                 {"faces", plain.mesh.face_count()}};
  Context context;
  const Case cases[] = {{"obj", MeshFormat::obj},     {"obj with uv", MeshFormat::obj, false, true},
                        {"stl", MeshFormat::stl},     {"stl ascii", MeshFormat::stl, true},
                        {"ply", MeshFormat::ply},     {"ply ascii", MeshFormat::ply, true},
                        {"glb", MeshFormat::glb},     {"glb with uv", MeshFormat::glb, false, true},
                        {"3mf", MeshFormat::three_mf}};
  for (const Case& c : cases) {
    if (!only.empty() && c.name != only) continue;
    WriteOptions options;
    options.ascii = c.ascii;
    if (c.format == MeshFormat::ply || c.format == MeshFormat::glb) options.columns = columns;
    Bytes bytes;
    const Model& model = c.textured ? textured : plain;
    const Json write = best_seconds(rounds, [&] { bytes = write_model(model, c.format, options, context); });
    const std::optional<double> growth = test::peak_growth_mb([&] { read_model(bytes, "bench", context); });
    const Json read = best_seconds(rounds, [&] { read_model(bytes, "bench", context); });
    Json row = {{"format", c.name},
                {"megabytes", static_cast<double>(bytes.size()) / 1e6},
                {"seconds_write", write},
                {"seconds_read", read}};
    if (growth) row["megabytes_to_read"] = *growth;
#ifdef FORMWRIGHT_WITH_TINYOBJLOADER
    if (c.format == MeshFormat::obj) {
      row["seconds_read_tinyobjloader"] = best_seconds(std::min(rounds, 2), [&] {
        std::istringstream stream{std::string(as_text(bytes))};
        tinyobj::attrib_t attributes;
        std::vector<tinyobj::shape_t> shapes;
        std::vector<tinyobj::material_t> materials;
        std::string warnings, errors;
        tinyobj::LoadObj(&attributes, &shapes, &materials, &warnings, &errors, &stream, nullptr, true);
      });
    }
#endif
    result["formats"].push_back(row);
  }
  if (only.empty()) result["formats"].push_back(height_map_row(rounds));
  result["peak_memory_mb"] = peak_mb();
  // One format a line.
  const Json formats = result["formats"];
  result.erase("formats");
  std::string text = result.dump();
  text.pop_back();
  std::cout << text << ",\n\"formats\": [";
  for (std::size_t i = 0; i < formats.size(); ++i) std::cout << (i ? ",\n " : "\n ") << formats[i].dump();
  std::cout << "]}\n";
}
