// SPDX-License-Identifier: GPL-3.0-or-later
// Jobs of painted models: what is read, what is refused, what comes back.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include <cmath>
#include <map>
#include <optional>

#include "base/sha256.h"
#include "formats/mesh_io.h"
#include "job/run.h"

namespace formwright::relief_painting_tests {
namespace {
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::WithinAbs;

struct File {
  std::string name;
  Bytes bytes;
};
using Files = std::map<std::string, File>;

JobResult run(Session& session, const std::string& operation, const Json& parameters, const Files& files,
              const std::vector<std::string>& outputs) {
  Json inputs = Json::object();
  std::map<std::string, std::shared_ptr<const Bytes>> blobs;
  for (const auto& [input, file] : files) {
    const std::string hash = sha256_hex(file.bytes);
    blobs[hash] = std::make_shared<const Bytes>(file.bytes);
    inputs[input] = {{"sha256", hash}, {"file_name", file.name}};
  }
  const Json job = {{"operation", operation}, {"parameters", parameters}, {"inputs", inputs}, {"outputs", outputs}};
  return run_job(job, [&](const std::string& hash) { return blobs[hash]; }, session, {});
}

JobResult relief(Session& session, const Files& files, const std::vector<std::string>& outputs = {"relief.ply"},
                 Json parameters = Json::object()) {
  parameters["pixel_mm"] = 1;
  return run(session, "relief", parameters, files, outputs);
}

const Bytes& output(const JobResult& result, const std::string& name) {
  INFO((result.error ? result.error->message : ""));
  REQUIRE_FALSE(result.error.has_value());
  for (const OutputBlob& blob : result.outputs)
    if (blob.name == name) return *blob.bytes;
  FAIL(name << " is missing");
  return *result.outputs.front().bytes;
}

/// A ball with waves.
Model ball(int rows = 16) {
  Model model;
  const int columns = 2 * rows;
  std::vector<Vec3> points{{0, 1, 0}, {0, -1, 0}};
  std::vector<Eigen::Vector3i> faces;
  for (int i = 1; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const double v = M_PI * i / rows, u = 2 * M_PI * j / columns;
      const double r = 1 + 0.1 * std::sin(4 * u) * std::sin(v) * std::sin(v);
      points.emplace_back(r * std::sin(v) * std::sin(u), r * std::cos(v), r * std::sin(v) * std::cos(u));
    }
  const auto at = [&](int i, int j) { return 2 + (i - 1) * columns + j % columns; };
  for (int j = 0; j < columns; ++j) {
    faces.emplace_back(0, at(1, j), at(1, j + 1));
    faces.emplace_back(1, at(rows - 1, j + 1), at(rows - 1, j));
    for (int i = 1; i + 1 < rows; ++i) {
      faces.emplace_back(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      faces.emplace_back(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  model.mesh.V.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i)
    model.mesh.V.row(static_cast<Eigen::Index>(i)) = points[i].transpose();
  model.mesh.F.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t i = 0; i < faces.size(); ++i) model.mesh.F.row(static_cast<Eigen::Index>(i)) = faces[i].transpose();
  return model;
}

std::vector<VertexColumn> columns_of(const Model& model) {
  const Eigen::VectorXd x = model.mesh.V.col(0);
  return {{"weight", x.unaryExpr([](double v) { return v > 0.2 ? 3.0 : 1.0; })},
          {"region", x.unaryExpr([](double v) { return v < -0.7   ? 2.0
                                                       : v < -0.3 ? 3.0
                                                       : v > 0.7  ? 1.0
                                                                  : 0.0; }),
           ColumnKind::uint8},
          {"thickness_mm", x.unaryExpr([](double v) { return v < -0.3 && v >= -0.7 ? 2.0 : 0.0; })}};
}

File file_of(const Model& model, MeshFormat format, const std::vector<VertexColumn>& columns) {
  Context context;
  WriteOptions write;
  write.columns = columns;
  return {"ball." + std::string(mesh_format_info(format).extension), write_model(model, format, write, context)};
}

File json_file(const Json& json) { return {"painting.json", to_bytes(json.dump())}; }

ModelFile read(const Bytes& bytes) {
  Context context;
  return read_model_file(bytes, "relief.ply", {}, context);
}

Eigen::VectorXd column(const ModelFile& file, const std::string& name) {
  for (const VertexColumn& c : file.columns)
    if (c.name == name) return c.values;
  FAIL(name << " is missing");
  return {};
}

std::string refusal(const Files& files, const std::string& where) {
  Session session;
  const JobResult result = relief(session, files);
  REQUIRE(result.error.has_value());
  CHECK(result.error->code == ErrorCode::invalid_input);
  CHECK(result.error->where == where);
  return result.error->message;
}

Json runs_of(const Model& model) {
  const std::vector<VertexColumn> columns = columns_of(model);
  Json json = {{"vertices", model.mesh.vertex_count()}};
  for (const VertexColumn& c : columns) {
    Json runs = Json::array();
    for (Eigen::Index i = 0; i < c.values.size(); ++i) runs.push_back({i, 1, c.values[i]});
    json[c.name] = runs;
  }
  return json;
}

}  // namespace

TEST_CASE("ReliefPainting.ComesBackWithTheReliefAndCanBeUsedAgain") {
  const Model model = ball();
  const std::vector<VertexColumn> painted = columns_of(model);
  Session session;
  const JobResult first = relief(session, {{"mesh", file_of(model, MeshFormat::ply, painted)}});
  const ModelFile back = read(output(first, "relief.ply"));
  CHECK(column(back, "weight") == painted[0].values);
  CHECK(column(back, "region") == painted[1].values);
  CHECK(first.report["painted_vertices"]["on_base"] == (painted[1].values.array() == 2).count());
  CHECK(first.report["painted_vertices"]["matters_more"] == (painted[0].values.array() > 1).count());
  CHECK(first.report["bound_violation_max_mm"] == 0.0);
  CHECK(first.report["stands_out_max_mm"].get<double>() > 5);
  // As the painting of the same model without colours of its own, and as JSON.
  const File plain = file_of(model, MeshFormat::ply, {});
  const Files again{{"mesh", plain}, {"painting", {"relief.ply", output(first, "relief.ply")}}},
      json{{"mesh", plain}, {"painting", json_file(runs_of(model))}};
  for (const Files& files : {again, json}) {
    Session fresh;  // a second solve of one solver starts from the first one's solution
    const JobResult second = relief(fresh, files);
    const bool equal = column(read(output(second, "relief.ply")), "lambda") == column(back, "lambda");
    CHECK(equal);
  }
  const JobResult unpainted = relief(session, {{"mesh", plain}});
  CHECK_FALSE(unpainted.report.contains("painted_vertices"));
  const bool changed = column(read(output(unpainted, "relief.ply")), "lambda") != column(back, "lambda");
  CHECK(changed);
}

TEST_CASE("ReliefPainting.GltfAttributesAreReadAndImportKeepsThem") {
  const Model model = ball();
  const std::vector<VertexColumn> painted = columns_of(model);
  Session session;
  Model metres = model;
  const File glb = file_of(metres, MeshFormat::glb, painted);
  const JobResult imported = run(session, "import", Json::object(), {{"mesh", glb}}, {"model.ply"});
  const ModelFile kept = read(output(imported, "model.ply"));
  CHECK((column(kept, "region").array() == 2).count() == (painted[1].values.array() == 2).count());
  const JobResult result = relief(session, {{"mesh", glb}});
  CHECK(result.report["painted_vertices"]["free"] == (painted[1].values.array() == 1).count());
}

TEST_CASE("ReliefPainting.AnotherMeshOfTheShapeTakesTheNearestValues") {
  const Model fine = ball(24), coarse = ball(12);
  Session session;
  const Files files{{"mesh", file_of(coarse, MeshFormat::ply, {})},
                    {"painting", json_file(runs_of(fine))},
                    {"painted_mesh", file_of(fine, MeshFormat::ply, {})}};
  const ModelFile back = read(output(relief(session, files), "relief.ply"));
  // Every vertex of the coarse ball is one of the fine one.
  CHECK(column(back, "region") == columns_of(coarse)[1].values);
  CHECK(column(back, "weight") == columns_of(coarse)[0].values);
  Model other = fine;
  other.mesh.V *= 2;
  Files wrong = files;
  wrong["painted_mesh"] = file_of(other, MeshFormat::ply, {});
  CHECK_THAT(refusal(wrong, "painted_mesh"), ContainsSubstring("another shape"));
  wrong.erase("painting");
  CHECK_THAT(refusal(wrong, "painted_mesh"), ContainsSubstring("without a painting"));
}

TEST_CASE("ReliefPainting.TheWeightsAreInTheKeyOfTheFactorAndRegionsAreNot") {
  const Model model = ball();
  Session session;
  const File plain = file_of(model, MeshFormat::ply, {});
  Json painting = {{"vertices", model.mesh.vertex_count()}, {"weight", {{0, 50, 2}}}};
  const auto reused = [&] {
    const JobResult result = relief(session, {{"mesh", plain}, {"painting", json_file(painting)}});
    REQUIRE_FALSE(result.error.has_value());
    return result.report["factor_reused"].get<bool>();
  };
  CHECK_FALSE(reused());
  painting["region"] = {{0, 20, "on_base"}, {30, 20, 1}};
  CHECK(reused());
  painting["weight"] = {{0, 50, 3}};
  CHECK_FALSE(reused());
}

TEST_CASE("ReliefPainting.VerticesAtOnePlaceKeepTheFirstOnesValueAndAreReported") {
  Model model = ball();
  // The first triangle gets corners of its own, painted otherwise.
  const Eigen::Index n = model.mesh.V.rows();
  model.mesh.V.conservativeResize(n + 3, 3);
  for (int k = 0; k < 3; ++k) {
    model.mesh.V.row(n + k) = model.mesh.V.row(model.mesh.F(0, k)).eval();
    model.mesh.F(0, k) = static_cast<int>(n) + k;
  }
  std::vector<VertexColumn> painted{{"weight", Eigen::VectorXd::Ones(n + 3)}};
  painted[0].values.tail(2).setConstant(5);
  Session session;
  const JobResult result = relief(session, {{"mesh", file_of(model, MeshFormat::ply, painted)}});
  const ModelFile back = read(output(result, "relief.ply"));
  CHECK(column(back, "weight") == Eigen::VectorXd::Ones(n));
  CHECK_THAT(result.report["notes"].dump(), ContainsSubstring("2 vertices were painted otherwise"));
  // A painting may count the vertices of the file, or those after its repair.
  for (const Eigen::Index count : {n, n + 3}) {
    const Json json = {{"vertices", count}, {"weight", {{count - 1, 1, 2}}}};
    CHECK_FALSE(relief(session, {{"mesh", file_of(model, MeshFormat::ply, {})}, {"painting", json_file(json)}}).error);
  }
}

TEST_CASE("ReliefPainting.WrongValuesAreRefusedInOneSentence") {
  const Model model = ball();
  const int n = model.mesh.vertex_count();
  const File plain = file_of(model, MeshFormat::ply, {});
  const auto with_column = [&](const std::string& name, double value) {
    std::vector<VertexColumn> columns{{name, Eigen::VectorXd::Ones(n)}};
    columns[0].values[7] = value;
    return Files{{"mesh", file_of(model, MeshFormat::ply, columns)}};
  };
  CHECK_THAT(refusal(with_column("weight", -1), "mesh"),
             ContainsSubstring("ball.ply: vertex 7 has weight -1, which must be from 0.01 to 100"));
  CHECK_THAT(refusal(with_column("weight", 0), "mesh"), ContainsSubstring("weight 0"));
  CHECK_THAT(refusal(with_column("region", 9), "mesh"), ContainsSubstring("vertex 7 has region 9, which is not known"));
  CHECK_THAT(refusal(with_column("thickness_mm", -2), "mesh"), ContainsSubstring("thickness_mm -2"));
  // ASCII can say that a value is not a number.
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "property float weight\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 1\n1 0 0 nan\n0 1 0 1\n0 0 1 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  CHECK_THAT(refusal({{"mesh", {"a.ply", to_bytes(text)}}}, "mesh"),
             ContainsSubstring("a.ply: the vertices' weight holds values that are not numbers"));

  const auto painted = [&](const Json& json) { return Files{{"mesh", plain}, {"painting", json_file(json)}}; };
  const std::map<std::string, Json> wrong{
      {"painting.json: it is painted for 5 vertices, and ball.ply has", {{"vertices", 5}, {"weight", Json::array()}}},
      {"does not say how many vertices", {{"weight", {{0, 1, 2}}}}},
      {"weight has 2 values for", {{"vertices", n}, {"weight", {1, 2}}}},
      {"a run of weight begins at vertex 3 and has 100000 vertices", {{"vertices", n}, {"weight", {{3, 100000, 2}}}}},
      {"a run of weight is not of the form", {{"vertices", n}, {"weight", {{3, 2}}}}},
      {"there is no region called", {{"vertices", n}, {"region", {{3, 2, "loose"}}}}},
      {"a value of weight is not a number", {{"vertices", n}, {"weight", {{3, 2, nullptr}}}}},
      {"the runs of weight overlap", {{"vertices", n}, {"weight", {{0, n, 2}, {3, 1, 2}}}}},
      {"weight must be a list", {{"vertices", n}, {"weight", 3}}},
      {"it has \"colour\", which is not known", {{"vertices", n}, {"colour", 3}}},
      {"which must be from 0.01 to 100", {{"vertices", n}, {"weight", {{3, 2, 1e9}}}}}};
  for (const auto& [sentence, json] : wrong)
    CHECK_THAT(refusal(painted(json), "painting"), ContainsSubstring(sentence));
  CHECK_THAT(refusal({{"mesh", plain}, {"painting", {"p.json", to_bytes("{\"vertices\": ")}}}, "painting"),
             ContainsSubstring("it is not a painting"));
  CHECK_THAT(refusal({{"mesh", plain}, {"painting", plain}}, "painting"),
             ContainsSubstring("its vertices have no weight, region"));
  CHECK_THAT(
      refusal({{"mesh", plain}, {"painting", file_of(ball(8), MeshFormat::ply, columns_of(ball(8)))}}, "painting"),
      ContainsSubstring("it is painted for"));
}

TEST_CASE("ReliefPainting.TheSolidStandsOutWhereItIsFree") {
  const Model model = ball();
  Session session;
  const Json everything = {{"vertices", model.mesh.vertex_count()},
                           {"region", {{0, model.mesh.vertex_count(), "free"}}}};
  const JobResult result =
      relief(session, {{"mesh", file_of(model, MeshFormat::ply, {})}, {"painting", json_file(everything)}},
             {"relief.stl", "heightmap.png"}, {{"projection", "orthographic"}, {"width_mm", 100}});
  REQUIRE_FALSE(result.error.has_value());
  CHECK(result.report["watertight"] == true);
  // The ball itself, about as deep as it is wide, with its plate of 3 mm.
  const double depth = result.report["size_mm"][2].get<double>();
  CHECK(depth > 90);
  CHECK(depth < 110);
  CHECK_THAT(result.report["stands_out_max_mm"].get<double>(), WithinAbs(depth - 3, 1e-9));
}

TEST_CASE("ReliefPainting.LightFallsOnThePaintedRelief") {
  const Model model = ball(10);
  Session session;
  const File plain = file_of(model, MeshFormat::ply, {});
  const Json painting = {{"vertices", model.mesh.vertex_count()},
                         {"region", {{0, model.mesh.vertex_count(), "on_base"}}}};
  const Json parameters = {{"light_pixel_mm", 3}, {"light_samples", 8}, {"pixel_mm", 1}, {"day_table", false}};
  const JobResult flat =
      run(session, "relief-light", parameters, {{"mesh", plain}, {"painting", json_file(painting)}}, {});
  const JobResult usual = run(session, "relief-light", parameters, {{"mesh", plain}}, {});
  REQUIRE_FALSE(flat.error.has_value());
  REQUIRE_FALSE(usual.error.has_value());
  CHECK(flat.report["light_similarity"] != usual.report["light_similarity"]);
}

}  // namespace formwright::relief_painting_tests
