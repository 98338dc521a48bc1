// SPDX-License-Identifier: GPL-3.0-or-later
// mesh_tool read FILE               what our reader finds in a file, as JSON
// mesh_tool write FORMAT FILE [-a] [-p]  a generated torus in a format; -a as text, -p without texture coordinates
// The files of other programs, and ours in them: see other_programs.py.
#include <filesystem>
#include <fstream>
#include <iostream>

#include "base/error.h"
#include "base/data/json.h"
#include "formats/io_test_tools.h"
#include "formats/model_samples.h"

namespace {

using namespace formwright;

Bytes load_file(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  return to_bytes(text);
}

Json describe(const ModelFile& file) {
  const TriangleMesh& mesh = file.model.mesh;
  const Eigen::RowVector3d low = mesh.V.colwise().minCoeff(), high = mesh.V.colwise().maxCoeff();
  return {{"format", mesh_format_info(file.format).extension},
          {"unit", file.unit},
          {"vertices", mesh.vertex_count()},
          {"faces", mesh.face_count()},
          {"unmatched_edges", test::unmatched_edges(mesh)},
          {"volume_mm3", test::signed_volume(mesh)},
          {"low", {low.x(), low.y(), low.z()}},
          {"high", {high.x(), high.y(), high.z()}},
          {"texture_vertices", file.model.UV.rows()},
          {"coloured", file.model.vertex_colours.rows() > 0},
          {"materials", file.model.materials.size()},
          {"notes", file.notes}};
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  try {
    if (words.size() == 2 && words[0] == "read") {
      const Bytes bytes = load_file(words[1]);
      Context context;
      std::cout
          << describe(read_model_file(bytes, std::filesystem::path(words[1]).filename().string(), {}, context)).dump()
          << '\n';
      return 0;
    }
    if (words.size() >= 3 && words[0] == "write") {
      const auto format = mesh_format_of_extension(words[1]);
      if (!format) return 2;
      Model model = test::wavy_torus(24, 16);
      const auto flag = [&](const char* name) { return std::ranges::find(words, name) != words.end(); };
      if (flag("-p") || *format == MeshFormat::stl || *format == MeshFormat::three_mf)
        model.UV.resize(0, 2), model.FT.resize(0, 3);
      if (*format == MeshFormat::ply && !flag("-p"))
        test::add_colours(model), model.UV = model.mesh.V.leftCols<2>() / 100, model.FT = model.mesh.F;
      WriteOptions options;
      options.ascii = flag("-a");
      const Bytes bytes = test::write(model, *format, options);
      std::ofstream(words[2], std::ios::binary)
          .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
      ModelFile file;
      file.model = std::move(model), file.format = *format;
      std::cout << describe(file).dump() << '\n';
      return 0;
    }
  } catch (const Error& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
  std::cerr << "mesh_tool read FILE | write FORMAT FILE [-a] [-p]\n";
  return 2;
}
