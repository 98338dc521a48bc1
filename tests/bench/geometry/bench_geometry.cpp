// SPDX-License-Identifier: GPL-3.0-or-later
// bench_geometry [vertices | file.obj] [rounds] [simplify target]: least seconds of some rounds, on a
// generated closed mesh or on a file. Wall-clock and processor time; the latter, of all threads together,
// is the sounder figure on a busy machine.
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>

#include "base/data/json.h"
#include "base/parallel.h"
#include "bench/geometry/bench_tools.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/operators/laplacian.h"
#include "geometry/mesh/measures.h"
#include "geometry/queries/point_distance.h"
#include "geometry/queries/ray_caster.h"
#include "geometry/ray_oracles.h"
#include "geometry/repair/repair.h"
#include "geometry/mesh/simplify.h"
#include "geometry/mesh/subdivide.h"
#include "geometry/test_meshes.h"

namespace {
using namespace formwright;
constexpr double infinity = std::numeric_limits<double>::infinity();

struct Bench {
  int rounds;
  Json seconds = Json::object();
  void operator()(const std::string& name, const std::function<void()>& work) {
    double wall = infinity, cpu = infinity;
    for (int i = 0; i < rounds; ++i) {
      const Stopwatch watch;
      const double before = bench::cpu_seconds();
      work();
      wall = std::min(wall, watch.seconds()), cpu = std::min(cpu, bench::cpu_seconds() - before);
    }
    seconds[name] = {{"wall", wall}, {"cpu", cpu}};
  }
};

TriangleMesh read_obj(const std::string& path) {
  std::ifstream file(path);
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> faces;
  for (std::string line, word; std::getline(file, line);) {
    std::istringstream words(line);
    words >> word;
    if (word == "v") {
      Vec3 p;
      words >> p[0] >> p[1] >> p[2];
      points.push_back(p);
    } else if (word == "f") {
      std::array<int, 3> f{};
      for (int& v : f) words >> word, v = std::stoi(word) - 1;
      faces.push_back(f);
    }
  }
  return test::make_mesh(points, faces);
}

Json shape_report(const TriangleMesh& mesh) {
  const Eigen::VectorXd minimum = corner_angles(mesh).rowwise().minCoeff() * (180 / std::numbers::pi);
  std::vector<double> sorted(minimum.begin(), minimum.end());
  std::sort(sorted.begin(), sorted.end());
  const auto part = [&](double share) {
    return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
  };
  return {{"least", part(0)}, {"1_percent", part(0.01)}, {"median", part(0.5)}};
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "35000";
  const int rounds = argc > 2 ? std::atoi(argv[2]) : 3, target = argc > 3 ? std::atoi(argv[3]) : 10000;
  const bool from_file = what.ends_with(".obj");
  const TriangleMesh mesh = from_file ? read_obj(what) : bench::generated(std::atoi(what.c_str()));
  const TriangleMesh soup = test::unwelded(mesh);
  const int n = mesh.vertex_count();
  Context context;
  Bench bench{rounds};

  bench("adjacency", [&] { Adjacency{mesh}; });
  bench("cotangent_laplacian", [&] { cotangent_laplacian(mesh); });
  bench("vertex_areas", [&] { vertex_areas(mesh); });
  bench("intrinsic_delaunay", [&] { intrinsic_delaunay(mesh, context); });
  bench("vertex_normals", [&] { vertex_normals(mesh); });
  RepairedMesh repaired;
  bench("repair", [&] { repaired = repair(mesh, {}, context); });
  bench("repair_soup", [&] { repair(soup, {}, context); });
  const TriangleMesh& sound = repaired.mesh;
  TriangleMesh small;
  bench("simplify", [&] { small = simplify(sound, {target, false}, context); });
  bench("subdivide_loop", [&] { subdivide(sound, SubdivisionScheme::loop, 1, context); });
  std::optional<RayCaster> caster;
  bench("ray_caster_build", [&] { caster.emplace(mesh); });
  // From an eye to every vertex, as the visibility test casts them.
  const BoundingBox box = bounding_box(mesh);
  const Vec3 eye = box.centre() + 2 * box.diagonal() * Vec3(0.3, 0.4, 1).normalized();
  const auto to_vertex = [&](int v) { return Vec3((Vec3(mesh.V.row(v)) - eye).normalized()); };
  int hits = 0, cgal_hits = 0;
  bench("first_hit_every_vertex", [&] {
    hits = 0;
    for (int v = 0; v < n; ++v) hits += caster->first_hit(eye, to_vertex(v), 0, infinity) ? 1 : 0;
  });
  bench("all_hits_every_vertex", [&] {
    for (int v = 0; v < n; ++v) caster->all_hits(eye, to_vertex(v), 0, infinity);
  });
  std::optional<test::CgalRays> cgal;
  bench("cgal_build", [&] { cgal.emplace(mesh); });
  const int cgal_rays = std::min(n, 50000);
  bench("cgal_first_hit_" + std::to_string(cgal_rays), [&] {
    cgal_hits = 0;
    for (int v = 0; v < cgal_rays; ++v) cgal_hits += cgal->first_distance(eye, to_vertex(v)) ? 1 : 0;
  });
#ifndef __EMSCRIPTEN__
  std::optional<test::EmbreeTriangles> embree;
  bench("embree_build", [&] { embree.emplace(mesh); });
  bench("embree_first_hit_every_vertex", [&] {
    for (int v = 0; v < n; ++v) embree->first_hit(eye, to_vertex(v));
  });
#endif
  bench("point_distance_every_vertex", [&] {
    const PointDistance to(small);
    for (int v = 0; v < n; ++v) to.nearest(mesh.V.row(v));
  });

  Json report{{"mesh", from_file ? what : "generated"},
              {"vertices", n},
              {"faces", mesh.face_count()},
              {"threads", thread_count()},
              {"rounds", rounds},
              {"seconds", bench.seconds},
              {"repair_sentences", repaired.sentences}};
  report["simplified"] = {{"vertices", small.vertex_count()},
                          {"min_angle_degrees", shape_report(small)},
                          {"min_angle_degrees_before", shape_report(sound)}};
  const SurfaceDistance off = surface_distance(sound, PointDistance(small), infinity, context);
  report["simplified"]["distance_percent_of_diagonal"] = {{"maximum", 100 * off.maximum / box.diagonal()},
                                                          {"mean", 100 * off.mean / box.diagonal()}};
  report["hits"] = {{"ours", hits}, {"cgal", cgal_hits}};
#ifndef __EMSCRIPTEN__
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  report["peak_memory_mb"] = static_cast<double>(usage.ru_maxrss) / 1024;
#endif
  std::cout << report.dump(2) << "\n";
}
