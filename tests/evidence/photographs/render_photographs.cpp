// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a pattern.json, photographs of a virtual sheet and truth.csv into a folder, for tests of the command line.
// Usage: render_photographs FOLDER PATTERN COUNT WIDTH
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "evidence/photographs/photograph_studio.h"

int main(int argc, char** argv) {
  using namespace formwright;
  if (argc != 5) return std::fputs("Usage: render_photographs FOLDER PATTERN COUNT WIDTH\n", stderr), 2;
  const std::string folder = argv[1];
  std::ifstream file(argv[2], std::ios::binary);
  const std::string json{std::istreambuf_iterator<char>(file), {}};
  test::Scene scene;
  scene.sheet = read_mark_sheet(to_bytes(json));
  scene.bump.radius_mm = 0.47 * scene.sheet.opening_mm.minCoeff();
  scene.bump.peak_mm = 0.35 * scene.bump.radius_mm;
  test::Phone phone;
  phone.width = std::atoi(argv[4]);
  phone.height = phone.width * 3 / 4;
  const auto views = test::ring_of_views(std::atoi(argv[3]), 2.15 * scene.sheet.opening_mm.maxCoeff());
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Bytes bytes = test::photograph(scene, phone, views[i], i + 1);
    std::ofstream out(folder + "/photo" + std::to_string(i + 1) + ".jpg", std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  std::ofstream truth(folder + "/truth.csv");
  for (const PlacedMark& mark : scene.sheet.marks)
    for (int corner = 0; corner < 4; ++corner) {
      const Vec2 s = mark.corner_mm(corner);
      const Vec3 p = scene.bump.place_mm(s);
      truth << s.x() << ',' << s.y() << ',' << p.x() << ',' << p.y() << ',' << p.z() << '\n';
    }
}
