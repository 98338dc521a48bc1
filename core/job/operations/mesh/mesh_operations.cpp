// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/mesh/mesh_operations.h"

#include <cmath>

#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/simplify.h"
#include "geometry/mesh/subdivide.h"
#include "job/contract/model_input.h"
#include "job/contract/operation_options.h"
#include "job/operations/relief/painting/painting_file.h"

namespace formwright {
namespace {

struct NoOptions {
  static constexpr auto parameters = std::tuple<>{};
};

struct SubdivideJobOptions {
  int levels = 1;
  SubdivisionScheme scheme = SubdivisionScheme::loop;
  static constexpr auto parameters = std::tuple{
      parameter("levels", &SubdivideJobOptions::levels, "Levels", unit::none, 1, 6,
                "How many times every triangle is split into four. Each level makes four times as many triangles."),
      parameter("scheme", &SubdivideJobOptions::scheme, "Scheme", "Midpoint keeps the shape exactly; Loop rounds it.")};
};

/// What is painted on the model, as numbers of its vertices.
std::vector<VertexColumn> painted_on(const LoadedModel& loaded) {
  std::vector<VertexColumn> columns;
  for (const std::string_view name : painted_columns)
    if (const ModelColumn* const found = loaded.columns.find(name)) columns.push_back(found->column);
  return columns;
}

enum class ResultVertices { own, of_the_model };

/// An operation on the model input whose body fills report and outputs. Where the result has the model's vertices, what
/// is painted on them goes along.
template <class Options, class Body>
Operation mesh_operation(std::string name, std::string title, std::string summary, std::vector<OutputInfo> outputs,
                         std::vector<ReportField> report, Body body, ResultVertices vertices = ResultVertices::own) {
  Operation operation;
  operation.name = std::move(name);
  operation.title = std::move(title);
  operation.summary = std::move(summary);
  operation.inputs = {model_input_info()};
  operation.outputs = outputs;
  operation.report = std::move(report);
  take_options<Options>(operation, [outputs, body, vertices](const OperationCall& call, const Options& options) {
    std::shared_ptr<const LoadedModel> loaded;
    {
      const auto span = call.context.span(0, 0.4, "Reading the model");
      loaded = load_model(call);
    }
    OperationResult result;
    Stopwatch watch;
    const Model model = body(*loaded, options, result.report, call.context);
    result.report["seconds_work"] = watch.lap();
    call.context.progress(0.9, "Writing");
    const std::vector<VertexColumn> painted =
        vertices == ResultVertices::of_the_model ? painted_on(*loaded) : std::vector<VertexColumn>();
    result.outputs = write_mesh_outputs(call, outputs, model, painted);
    result.report["seconds_write"] = watch.lap();
    return result;
  });
  return operation;
}

Json size_json(const TriangleMesh& mesh) {
  const Vec3 size = mesh.V.colwise().maxCoeff() - mesh.V.colwise().minCoeff();
  return {size.x(), size.y(), size.z()};
}

std::vector<ReportField> with_counts(std::vector<ReportField> fields) {
  fields.insert(fields.begin(), {{"vertices", "Vertices", "", "Number of vertices of the result."},
                                 {"faces", "Triangles", "", "Number of triangles of the result."}});
  fields.push_back({"seconds_work", "Working", "s", "Time for the operation itself."});
  fields.push_back({"seconds_write", "Writing", "s", "Time for writing the output files."});
  return fields;
}

Model describe_import(const LoadedModel& loaded, const NoOptions&, Json& report, Context&) {
  const TriangleMesh& mesh = loaded.model.mesh;
  const Adjacency adjacency(mesh);
  report["vertices"] = mesh.vertex_count();
  report["faces"] = mesh.face_count();
  report["components"] = vertex_components(adjacency).count;
  report["closed"] = adjacency.is_closed();
  report["repairs"] = loaded.repairs;
  report["size_mm"] = size_json(mesh);
  report["file_format"] = loaded.file_format;
  report["seconds_read"] = loaded.seconds_read;
  report["seconds_repair"] = loaded.seconds_repair;
  return loaded.model;
}

}  // namespace

Operation import_operation() {
  return mesh_operation<NoOptions>(
      "import", "Import", "Reads a model, repairs it and reports what was found.",
      mesh_outputs("model", MeshFormat::ply),
      with_counts({{"components", "Parts", "", "Number of separate parts of the model."},
                   {"closed", "Closed", "", "Whether the model has no holes."},
                   {"repairs", "Repairs", "", "What was repaired, as sentences."},
                   {"size_mm", "Size", "mm", "Size of the model along x, y and z."},
                   {"file_format", "Format", "", "File format as recognised from the content."},
                   {"seconds_read", "Reading", "s", "Time for reading the file; 0 if it was read before."},
                   {"seconds_repair", "Repairing", "s", "Time for repairing the model; 0 if it was repaired before."}}),
      describe_import, ResultVertices::of_the_model);
}

Operation simplify_operation() {
  return mesh_operation<SimplifyOptions>(
      "simplify", "Simplify", "Reduces the number of vertices while keeping the shape, for a preview.",
      mesh_outputs("simplified", MeshFormat::ply), with_counts({}),
      [](const LoadedModel& loaded, const SimplifyOptions& options, Json& report, Context& context) {
        Model result;
        const auto span = context.span(0.4, 0.9, "Simplifying");
        result.mesh = simplify(loaded.model.mesh, options, context);
        report["vertices"] = result.mesh.vertex_count();
        report["faces"] = result.mesh.face_count();
        return result;
      });
}

Operation subdivide_operation() {
  return mesh_operation<SubdivideJobOptions>(
      "subdivide", "Subdivide", "Splits every triangle into four.", mesh_outputs("subdivided", MeshFormat::ply),
      with_counts({}),
      [](const LoadedModel& loaded, const SubdivideJobOptions& options, Json& report, Context& context) {
        if (static_cast<double>(loaded.model.mesh.face_count()) * std::pow(4.0, options.levels) > 20e6)
          throw Error(ErrorCode::invalid_input, "levels",
                      "The result would have more than 20 million triangles: choose fewer levels.");
        Model result = subdivide(loaded.model, options.scheme, options.levels, context);
        report["vertices"] = result.mesh.vertex_count();
        report["faces"] = result.mesh.face_count();
        return result;
      });
}

Operation convert_operation() {
  return mesh_operation<NoOptions>(
      "convert", "Convert", "Repairs a model and writes it in another format.", mesh_outputs("model", MeshFormat::obj),
      with_counts({}),
      [](const LoadedModel& loaded, const NoOptions&, Json& report, Context&) {
        report["vertices"] = loaded.model.mesh.vertex_count();
        report["faces"] = loaded.model.mesh.face_count();
        return loaded.model;
      },
      ResultVertices::of_the_model);
}

}  // namespace formwright
