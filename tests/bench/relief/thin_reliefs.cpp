// SPDX-License-Identifier: GPL-3.0-or-later
// Solves thin reliefs of meshes and of the tests' thin shapes and prints one row for each: every vertex bounded, every
// depth order row kept.
//   thin_reliefs [--thickness 5,2,1] [--method automatic|exchange|interior_point] [--runs N] [MESH | SHAPE]...
// MESH is a file, SHAPE a name of tests/relief/thin_shapes.h; without any, all shapes. Meshes below 26,000 vertices are
// subdivided, those above 50,000 simplified. Thickness is in percent of the width. Seconds are of the fastest run:
// view, rays and energy (setup), order and factorisation (factor), the quadratic program (solve).
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "formats/mesh_io.h"
#include "geometry/mesh/simplify.h"
#include "geometry/mesh/subdivide.h"
#include "geometry/repair/repair.h"
#include "relief/relief.h"
#include "relief/thin_shapes.h"

using namespace formwright;

namespace {
constexpr int min_vertices = 26'000, max_vertices = 50'000, shape_vertices = 40'000;

TriangleMesh mesh_of(const std::string& name, Context& context) {
  for (const auto& shape : test::thin_shapes()) {
    if (shape.name == name) return shape.make(shape_vertices);
  }
  std::ifstream file(name, std::ios::binary);
  if (!file) throw Error(ErrorCode::invalid_input, "mesh", name + " cannot be read.");
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  TriangleMesh mesh = repair(read_model(as_bytes(text), name, context).mesh, {}, context).mesh;
  while (mesh.vertex_count() < min_vertices) mesh = subdivide(mesh, SubdivisionScheme::loop, 1, context);
  if (mesh.vertex_count() > max_vertices) {
    SimplifyOptions options;
    options.target_vertices = max_vertices;
    mesh = simplify(mesh, options, context);
  }
  return mesh;
}

struct Row {
  double setup, factor, solve, cpu;
  Relief relief;
};

Row run(const TriangleMesh& mesh, const ReliefOptions& options) {
  Context context;
  const std::clock_t start = std::clock();
  ReliefSolver solver(mesh, options, context);
  Stopwatch watch;
  Row row{solver.seconds_setup(), solver.seconds_factorise(), 0, 0, solver.solve(options, context)};
  row.solve = watch.seconds();
  row.cpu = double(std::clock() - start) / CLOCKS_PER_SEC;
  return row;
}
}  // namespace

int main(int count, char** argument) {
  std::vector<double> percents{5, 2, 1};
  std::vector<std::string> names;
  ReliefOptions options;
  int runs = 1;
  for (int k = 1; k < count; ++k) {
    const std::string flag = argument[k];
    const std::string value = k + 1 < count ? argument[k + 1] : "";
    if (flag == "--thickness") {
      percents.clear();
      std::istringstream list(value);
      for (std::string part; std::getline(list, part, ',');) percents.push_back(std::atof(part.c_str()));
    } else if (flag == "--method") {
      for (std::size_t m = 0; m < EnumNames<QpMethod>::names.size(); ++m) {
        if (EnumNames<QpMethod>::names[m] == value) options.method = static_cast<QpMethod>(m);
      }
    } else if (flag == "--runs") {
      runs = std::atoi(value.c_str());
    } else {
      names.push_back(flag);
      continue;
    }
    ++k;
  }
  if (names.empty()) {
    for (const auto& shape : test::thin_shapes()) names.push_back(shape.name);
  }
  std::puts(
      "| mesh | vertices | order rows | thickness % | method | iterations | setup s | factor s | solve s | sum s | "
      "processor s | active | KKT residual | energy | order violation |");
  std::puts("|---|---:|---:|---:|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|");
  for (const std::string& name : names) {
    try {
      Context context;
      const TriangleMesh mesh = mesh_of(name, context);
      for (const double percent : percents) {
        options.thickness_mm = percent / 100 * options.width_mm;
        Row best = run(mesh, options);
        for (int k = 1; k < runs; ++k) {
          Row again = run(mesh, options);
          if (again.setup + again.factor + again.solve < best.setup + best.factor + best.solve) best = std::move(again);
        }
        const BoundedQpSolution& qp = best.relief.qp;
        std::printf("| %s | %d | %d | %g | %s | %d | %.2f | %.2f | %.2f | %.2f | %.2f | %d | %.0e | %.12e | %.0e |\n",
                    name.substr(name.find_last_of('/') + 1).c_str(), static_cast<int>(mesh.V.rows()),
                    best.relief.order_rows, percent,
                    std::string(EnumNames<QpMethod>::names.at(static_cast<std::size_t>(qp.method_used))).c_str(),
                    qp.method_used == QpMethod::exchange ? qp.rounds : qp.interior_point_iterations, best.setup,
                    best.factor, best.solve, best.setup + best.factor + best.solve, best.cpu, qp.active_constraints,
                    qp.kkt_residual, best.relief.energy, best.relief.order_violation_max_mm);
        std::fflush(stdout);
      }
    } catch (const Error& error) {
      std::printf("| %s | %s |\n", name.c_str(), error.what());
    }
  }
  return 0;
}
