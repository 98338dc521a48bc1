// SPDX-License-Identifier: GPL-3.0-or-later
// bench_rays [rounds] [triangles...]: times and memory of Embree's tree and of our own on generated meshes, as JSON.
// Processor time, the least of the rounds: of one thread for rays, of all threads for trees; wall-clock time of trees.
// docs/ray_casting.md has the table that ray_table.py makes of it.
#include <malloc.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <limits>
#include <optional>
#include <vector>

#include "base/context.h"
#include "base/data/json.h"
#include "base/parallel.h"
#include "bench/geometry/bench_tools.h"
#include "geometry/queries/bvh_rays.h"
#include "geometry/queries/embree_rays.h"

namespace {
using namespace formwright;
constexpr double infinity = std::numeric_limits<double>::infinity();

double resident_bytes() {
  malloc_trim(0);
  std::ifstream file("/proc/self/statm");
  double pages = 0;
  file >> pages >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

struct Times {
  double wall = infinity, cpu = infinity;
};
Times minimum(int rounds, const std::function<void()>& work) {
  Times result;
  for (int i = 0; i < rounds; ++i) {
    const Stopwatch watch;
    const double before = bench::cpu_seconds();
    work();
    result.wall = std::min(result.wall, watch.seconds());
    result.cpu = std::min(result.cpu, bench::cpu_seconds() - before);
  }
  return result;
}

struct Ray {
  Vec3 origin, direction;
};
struct RaySet {
  const char* name;
  std::vector<Ray> rays;
};

/// As the crafts cast them: from an eye to every vertex (visibility), straight down on a grid (height maps, vents),
/// from the surface along its normal (thickness), and between random points (the worst order for caches).
std::vector<RaySet> ray_sets(const TriangleMesh& mesh, int count) {
  const BoundingBox box = bounding_box(mesh);
  const Vec3 eye = box.centre() + 2 * box.diagonal() * Vec3(0.3, 0.4, 1).normalized();
  const Positions normals = vertex_normals(mesh);
  std::vector<RaySet> sets{{"eye", {}}, {"down", {}}, {"normal", {}}, {"random", {}}};
  test::Random random(1);
  const int side = static_cast<int>(std::sqrt(count));
  for (int i = 0; i < count; ++i) {
    // From all over the mesh, neighbours after one another, as in the crafts' loops.
    const auto v = static_cast<Eigen::Index>(static_cast<double>(i) / count * mesh.vertex_count());
    const Vec3 vertex = mesh.V.row(v), normal = normals.row(v);
    sets[0].rays.push_back({eye, (vertex - eye).normalized()});
    const double x = (i % side + 0.5) / side - 0.5, y = (i / side + 0.5) / side - 0.5;
    const Vec3 size = box.diagonal() * Vec3(1, 1, 1);
    sets[1].rays.push_back({box.centre() + Vec3(0.7 * x * size.x(), 0.7 * y * size.y(), size.z()), -Vec3::UnitZ()});
    sets[2].rays.push_back({vertex - 1e-3 * normal, -normal});
    const Vec3 from = box.centre() + box.diagonal() * random.direction();
    sets[3].rays.push_back({from, (box.centre() + 0.35 * box.diagonal() * random.in_cube() - from).normalized()});
  }
  return sets;
}

template <class Rays>
Json measured(const TriangleMesh& mesh, const std::vector<RaySet>& sets, int rounds) {
  std::optional<Rays> rays;
  const double before = resident_bytes();
  rays.emplace(mesh);
  Json report{{"bytes_per_triangle", (resident_bytes() - before) / mesh.face_count()}};
  const Times all_threads = minimum(rounds, [&] { rays.emplace(mesh); });
  report["build_wall_seconds"] = all_threads.wall;
  report["build_cpu_seconds"] = all_threads.cpu;
  {
    const ThreadLimit one(1);
    report["build_one_thread_seconds"] = minimum(rounds, [&] { rays.emplace(mesh); }).cpu;
  }
  for (const RaySet& set : sets) {
    const auto microseconds = [&](const Times& times) {
      return 1e6 * times.cpu / static_cast<double>(set.rays.size());
    };
    std::size_t first = 0, all = 0;
    report["first_hit_microseconds"][set.name] = microseconds(minimum(rounds, [&] {
      first = 0;
      for (const Ray& ray : set.rays) first += rays->first_hit(ray.origin, ray.direction, 0, infinity) ? 1 : 0;
    }));
    report["all_hits_microseconds"][set.name] = microseconds(minimum(rounds, [&] {
      all = 0;
      for (const Ray& ray : set.rays) all += rays->all_hits(ray.origin, ray.direction, 0, infinity).size();
    }));
    report["hit"][set.name] = first;
    report["hits"][set.name] = all;
  }
  return report;
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 5;
  std::vector<int> sizes;
  for (int i = 2; i < argc; ++i) sizes.push_back(std::atoi(argv[i]));
  if (sizes.empty()) sizes = {10000, 100000, 1000000};
  const double before = resident_bytes();
  EmbreeRays(bench::generated(100)).first_hit(Vec3::Zero(), Vec3::UnitX(), 0, infinity);
  Json report{{"rounds", rounds},
              {"threads", thread_count()},
              {"embree_once_bytes", resident_bytes() - before},  // its device and code, whatever the meshes
              {"meshes", Json::array()}};
  for (const int triangles : sizes) {
    const TriangleMesh mesh = bench::generated(triangles / 2);
    const std::vector<RaySet> sets = ray_sets(mesh, 40000);
    const Json embree = measured<EmbreeRays>(mesh, sets, rounds), ours = measured<BvhRays>(mesh, sets, rounds);
    if (embree.at("hits") != ours.at("hits") || embree.at("hit") != ours.at("hit")) {
      std::cerr << "The two trees do not find the same hits.\n";
      return 1;
    }
    report["meshes"].push_back({{"triangles", mesh.face_count()}, {"embree", embree}, {"ours", ours}});
  }
  std::cout << report.dump(2) << "\n";
}
