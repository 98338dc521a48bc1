// SPDX-License-Identifier: GPL-3.0-or-later
// How reliefs look beside their models, by method; JSON on standard output.
//   compare_appearance MODEL... [--vertices N] [--percent LIST] [--views LIST] [--methods LIST] [--pixels F] [--runs N]
//                      [--pictures FOLDER] [--picture-pixels F]
// MODEL is a built-in sample, made with N vertices (20,000), or a file, seen along -z with y up, and repaired first.
// --percent: thickness of the width (2,5,10). --views: near, far. --methods: linear, gradient [WDB07], detail_W and
// balanced_W with hidden vertices at weight W, normals_W: normals alone in the same bounds, by the same solver with a
// falling price on the energy that ends at 0. --pixels: size of a pixel of the comparison in those of eye_grid (1).
// Seconds are processor time of setting up, factoring and solving, the least of N runs (1), in a process in which
// nothing is reused. --pictures writes MODEL_VIEW_PERCENT.png: the model, then every method, under one light; its
// pixels are F of eye_grid's (2.5).
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "base/data/json.h"
#include "base/parallel.h"
#include "bench/relief/picture_sheet.h"
#include "formats/mesh_io.h"
#include "geometry/repair/repair.h"
#include "geometry/samples/samples.h"
#include "relief/appearance_energy.h"
#include "relief/balanced_relief.h"
#include "relief/baselines.h"
#include "relief/relief.h"
#include "relief/seen/picture_similarity.h"
#include "relief/seen/seen_difference.h"

namespace {
using namespace formwright;

struct Arguments {
  std::vector<std::string> models, percents{"2", "5", "10"}, views{"near", "far"},
      methods{"linear", "gradient", "detail_1", "detail_0.01", "normals_0.01", "balanced_0.01"};
  int vertices = 20'000, runs = 1;
  double pixels = 1, picture_pixels = 2.5;
  std::string pictures;
};

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at <= list.size();) {
    const std::size_t end = std::min(list.find(',', at), list.size());
    parts.push_back(list.substr(at, end - at));
    at = end + 1;
  }
  return parts;
}

Arguments read_arguments(int argc, char** argv) {
  Arguments a;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word.rfind("--", 0) != 0) {
      a.models.push_back(word);
      continue;
    }
    if (++k == argc) throw std::runtime_error(word + " needs a value");
    const std::string value = argv[k];
    if (word == "--vertices") a.vertices = std::stoi(value);
    else if (word == "--runs") a.runs = std::stoi(value);
    else if (word == "--pixels") a.pixels = std::stod(value);
    else if (word == "--percent") a.percents = split(value);
    else if (word == "--views") a.views = split(value);
    else if (word == "--methods") a.methods = split(value);
    else if (word == "--pictures") a.pictures = value;
    else if (word == "--picture-pixels") a.picture_pixels = std::stod(value);
    else throw std::runtime_error(word + " is not known");
  }
  return a;
}

struct Subject {
  std::string name;
  TriangleMesh mesh;
  ReliefOptions options;  // of the view
};

Subject subject_of(const std::string& name, int vertices, Context& context) {
  Subject subject{std::filesystem::path(name).stem().string(), {}, {}};
  TriangleMesh mesh;
  if (std::filesystem::exists(name)) {
    std::ifstream file(name, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    mesh = read_model(ByteView(reinterpret_cast<const std::byte*>(text.data()), text.size()), name, context).mesh;
  } else {
    mesh = make_sample(name, vertices, context).mesh;
    for (const SampleInfo& info : sample_catalog())
      if (info.name == name)
        for (int k = 0; k < 3; ++k) {
          subject.options.direction[static_cast<std::size_t>(k)] = info.view_direction[k];
          subject.options.up[static_cast<std::size_t>(k)] = info.view_up[k];
        }
  }
  subject.mesh = repair(mesh, {}, context).mesh;
  return subject;
}

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Made {
  Eigen::VectorXd u;
  double seconds = 0;
  int steps = 0;
};

/// "detail_0.01": the method and the weight of hidden vertices.
Made make(const Subject& subject, const ReliefOptions& view, const std::string& method, const ReliefSolver& seen,
          Context& context) {
  const double thickness = view.thickness_mm / view.width_mm;
  const std::size_t mark = method.find('_');
  const std::string kind = method.substr(0, mark);
  const DepthBounds slab = depth_bounds(seen.frame(), seen.visibility(), BaseSurface(), view, context);
  const double start = processor_seconds();
  if (kind == "linear") return {linear_compression(seen.frame(), slab), processor_seconds() - start, 0};
  if (kind == "gradient") {
    Made made{gradient_domain_compression(seen.frame(), seen.F(), seen.visibility(), thickness, {}, context), 0, 0};
    made.seconds = processor_seconds() - start;
    return made;
  }
  ReliefOptions options = view;
  options.hidden_weight = std::stod(method.substr(mark + 1));
  options.appearance = kind == "balanced" ? Appearance::balanced : Appearance::detail;
  ReliefSolver solver(subject.mesh, options, context);
  const Relief relief = solver.solve(options, context);
  Made made{relief.u, processor_seconds() - start, relief.balanced_steps};
  if (kind != "normals") return made;
  const ViewFrame& frame = solver.frame();
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(made.u.size());
  Eigen::VectorXd lower(made.u.size()), upper(made.u.size());
  for (int i = 0; i < made.u.size(); ++i) {
    if (!solver.visibility().vertex[static_cast<std::size_t>(i)]) weights[i] = options.hidden_weight;
    lower[i] = frame.u_for_depth(i, -thickness);
    upper[i] = frame.u_for_depth(i, 0);
  }
  const AppearanceEnergy energy(frame, solver.F(), weights);
  const std::vector<InequalityRow> rows =
      depth_order_rows(frame, solver.F(), RayCaster(TriangleMesh{frame.P, solver.F()}), context);
  BalancedSolver balanced(frame, solver.F(), solver.visibility(), energy.lower_hessian(context), context);
  BalancedSettings settings;
  settings.last_beta = 0;
  settings.max_steps = 100;
  const BalancedResult result = balanced_relief(
      balanced, {frame, solver.visibility(), slab, true, thickness, lower, upper, rows}, made.u, settings, context);
  return {result.u, processor_seconds() - start, result.steps};
}

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown";
}

void write_pictures(const Arguments& a, const std::string& name, const std::vector<NormalPicture>& pictures,
                    const Context& context) {
  const int width = pictures[0].grid.columns, gap = 8;
  Image sheet((width + gap) * static_cast<int>(pictures.size()) - gap, pictures[0].grid.rows, Rgba{255, 255, 255, 255});
  for (std::size_t k = 0; k < pictures.size(); ++k)
    test::shade_into(sheet, pictures[k], {static_cast<int>(k) * (width + gap), 0});
  test::write_sheet(sheet, a.pictures, name, context);
}

Json compare(const Arguments& a, const Subject& subject, const std::string& view, const std::string& percent,
             Context& context) {
  ReliefOptions options = subject.options;
  options.width_mm = 100;
  options.thickness_mm = std::stod(percent);
  options.projection = view == "near" ? Projection::perspective : Projection::orthographic;
  const ReliefSolver seen(subject.mesh, options, context);
  const SeenComparison comparison(seen.frame(), seen.F(), a.pixels, context);
  const PictureGrid small = eye_grid(seen.frame(), a.picture_pixels);
  std::vector<NormalPicture> pictures{draw_normals(seen.frame(), seen.frame().P, seen.F(), small, context)};
  Json rows = Json::array();
  for (const std::string& method : a.methods) {
    Made made = make(subject, options, method, seen, context);
    for (int k = 1; k < a.runs; ++k)
      made.seconds = std::min(made.seconds, make(subject, options, method, seen, context).seconds);
    const Positions moved = seen.frame().moved(made.u);
    Stopwatch watch;
    const SeenDifference difference = comparison.with(moved, context);
    const double comparing = watch.seconds();
    const NormalError error = normal_error(seen.frame(), seen.F(), seen.visibility(), moved);
    if (!a.pictures.empty()) pictures.push_back(draw_normals(seen.frame(), moved, seen.F(), small, context));
    rows.push_back({{"model", subject.name},
                    {"vertices", subject.mesh.vertex_count()},
                    {"view", view},
                    {"percent", options.thickness_mm},
                    {"method", method},
                    {"similarity", difference.similarity},
                    {"false_edges_percent", difference.false_edges_percent},
                    {"normal_error_mean_deg_image", error.mean_deg_image},
                    {"processor_seconds", made.seconds},
                    {"steps", made.steps}});
    std::fprintf(
        stderr,
        "%-12s %6d %-4s %4s %% %-14s similarity %.4f false edges %6.3f %% angle %5.2f s %.2f steps %d (compared in %.2f)\n",
        subject.name.c_str(), subject.mesh.vertex_count(), view.c_str(), percent.c_str(), method.c_str(),
        difference.similarity, difference.false_edges_percent, error.mean_deg_image, made.seconds, made.steps,
        comparing);
  }
  if (!a.pictures.empty()) write_pictures(a, subject.name + "_" + view + "_" + percent, pictures, context);
  return rows;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const Arguments a = read_arguments(argc, argv);
    Context context;
    Json rows = Json::array();
    for (const std::string& model : a.models) {
      const Subject subject = subject_of(model, a.vertices, context);
      for (const std::string& view : a.views)
        for (const std::string& percent : a.percents)
          for (Json& row : compare(a, subject, view, percent, context)) rows.push_back(std::move(row));
    }
    const Json result = {{"bench", "relief_appearance"},
                         {"machine", {{"processor", processor_name()}, {"threads", thread_count()}}},
                         {"width_mm", 100},
                         {"pixel_arc_minutes", a.pixels},
                         {"runs_each", a.runs},
                         {"rows", rows}};
    std::printf("%s\n", result.dump(1).c_str());
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "compare_appearance: %s\n", error.what());
    return 1;
  }
}
