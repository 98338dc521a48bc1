// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/design_files.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "base/error.h"
#include "base/data/json_text.h"
#include "formats/mesh_io.h"
#include "formats/shared/text_out.h"

namespace formwright {
namespace {

[[noreturn]] void refuse_segments(const std::string& sentence) {
  throw Error(ErrorCode::invalid_input, "segments", sentence);
}

Json vector_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Vec3 read_point(const Json& item, const std::string& what) {
  Vec3 point = Vec3::Zero();
  bool good = item.is_array() && item.size() == 3;
  for (int k = 0; k < 3 && good; ++k) {
    good = item[k].is_number() && std::abs(item[k].get<double>()) < 1e9;
    if (good) point[k] = item[k].get<double>();
  }
  if (!good) refuse_segments("segments.json: " + what + " must be a point [x, y, z].");
  return point;
}

std::vector<Vec3> read_points(const Json& list, const std::string& name) {
  std::vector<Vec3> points;
  for (const Json& item : list)
    points.push_back(read_point(item, "entry " + std::to_string(points.size() + 1) + " of " + name));
  return points;
}

/// Holes are points, cuts are lists of two points or more.
void read_punctures(const Json& list, ZippableParts& parts) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    const bool cut = list[i].is_array() && !list[i].empty() && list[i][0].is_array();
    const std::string name = "entry " + std::to_string(i + 1) + " of punctures";
    if (!cut) {
      parts.punctures.push_back(read_point(list[i], name));
      continue;
    }
    if (list[i].size() < 2 || list[i].size() > 1000)
      refuse_segments("segments.json: " + name + " is a cut and must have 2 to 1000 points [x, y, z].");
    parts.cuts.push_back(read_points(list[i], name));
  }
}

/// A list of points, or {"points": [...], "snap": true or false}.
DrawnCurve read_curve(const Json& item, const std::string& name) {
  const Json* points = &item;
  DrawnCurve curve;
  curve.closed = name == "loops";
  if (item.is_object()) {
    for (const auto& [key, value] : item.items())
      if (key != "points" && key != "snap")
        refuse_segments("segments.json: an entry of " + name + " has \"" + key + "\": it may have points and snap.");
    if (const auto snap = item.find("snap"); snap != item.end()) {
      if (!snap->is_boolean())
        refuse_segments("segments.json: snap of an entry of " + name + " must be true or false.");
      curve.snap = snap->get<bool>();
    }
    const auto found = item.find("points");
    if (found == item.end()) refuse_segments("segments.json: an entry of " + name + " has no points.");
    points = &*found;
  }
  if (!points->is_array() || points->size() > 1000)
    refuse_segments("segments.json: each of " + name + " must be a list of up to 1000 points [x, y, z].");
  curve.points = read_points(*points, name);
  return curve;
}

/// Of every part whether it is a cylinder, and if not, why.
Json parts_json(const Segmentation& s) {
  Json parts = Json::array();
  for (int part = 0; part < s.part_count(); ++part) {
    const std::string& problem = s.problems[part];
    parts.push_back({{"cylinder", problem.empty()}, {"why_not", problem.empty() ? Json(nullptr) : Json(problem)}});
  }
  return parts;
}

/// Per cut its length and both sides: runs of vertices that follow `first_vertex` on the boundary, and where they lie
/// along the cut.
Json closures_json(const std::vector<HandleClosure>& closures) {
  Json list = Json::array();
  for (const HandleClosure& closure : closures) {
    Json sides = Json::array();
    for (const auto& side : closure.sides) {
      Json runs = Json::array();
      for (const ClosureRun& run : side)
        runs.push_back({{"first_vertex", run.first_vertex}, {"along_mm", run.along_mm}});
      sides.push_back(runs);
    }
    list.push_back({{"length_mm", closure.length_mm}, {"closed", closure.closed}, {"sides", sides}});
  }
  return list;
}

/// To a micrometre: what a laser can tell apart is a hundred times as much.
double micrometres(double mm) { return std::round(1000 * mm) / 1000; }

}  // namespace

ZippableParts read_segments(ByteView bytes) {
  const Json json = parse_json_text(as_text(bytes));
  if (!json.is_object())
    refuse_segments("segments.json is not a JSON object: it holds punctures, loops, lines, start and end.");
  ZippableParts parts;
  for (const auto& [name, value] : json.items()) {
    if (name == "start" || name == "end") {
      (name == "start" ? parts.start : parts.end) = read_point(value, name);
      continue;
    }
    if (name != "punctures" && name != "loops" && name != "lines")
      refuse_segments("segments.json has \"" + name +
                      "\", which is not known: it may have punctures, loops, lines, start and end.");
    if (!value.is_array() || value.size() > 100)
      refuse_segments("segments.json: " + name + " must be a list of up to 100 entries.");
    if (name == "punctures") {
      read_punctures(value, parts);
      continue;
    }
    for (const Json& item : value) parts.curves.push_back(read_curve(item, name));
  }
  if (parts.punctures.empty() && parts.cuts.empty() && parts.curves.empty() && !parts.start && !parts.end)
    refuse_segments("segments.json is empty: give punctures, loops or lines, or leave the file out.");
  return parts;
}

Bytes write_design_json(const ParameterisedModel& model, const ZippableDesign& design) {
  const Segmentation& s = model.proposal.segmentation;
  const Parameterisation& p = model.parameterisation;
  Json parts = parts_json(s);
  for (int part = 0; part < s.part_count(); ++part)
    parts[std::size_t(part)].update(Json{
        {"period_mm", p.period_mm[part]}, {"height_mm", p.height_mm[part]}, {"windings", design.curve.windings[part]}});
  Json punctures = Json::array();
  for (std::size_t i = 0; i < model.proposal.punctures.size(); ++i)
    punctures.push_back({{"position_mm", vector_json(model.proposal.punctures[i])},
                         {"radius_mm", model.proposal.puncture_radius_mm[i]}});
  for (const auto& slit : model.proposal.slits) {
    Json path = Json::array();
    for (const Vec3& point : slit) path.push_back(vector_json(point));
    punctures.push_back({{"position_mm", vector_json(slit[slit.size() / 2])}, {"radius_mm", 0}, {"path_mm", path}});
  }
  Json boundary = Json::array();
  for (std::size_t i = 0; i < design.ribbon.boundary.size(); ++i) {
    const RibbonVertex& v = design.ribbon.boundary[i];
    boundary.push_back({{"position_mm", vector_json(v.position_mm)},
                        {"flat_mm", {design.ribbon.flat_mm[i].x(), design.ribbon.flat_mm[i].y()}},
                        {"zipper_sample", v.sample},
                        {"side", v.sample < 0 ? "opening"
                                 : v.left     ? "left"
                                              : "right"}});
  }
  Json faces = Json::array();
  for (Eigen::Index f = 0; f < design.ribbon.F.rows(); ++f)
    faces.push_back({design.ribbon.F(f, 0), design.ribbon.F(f, 1), design.ribbon.F(f, 2)});
  Json ribbon = {{"boundary", boundary}, {"triangles", faces}};
  if (design.fabrics) ribbon["fabric"] = design.fabrics->of_face;
  Json json = {{"format", "formwright zippable design"},
               {"version", 1},
               {"scale", model.scale},
               {"order", design.traversal.traversal.parts},
               {"parts", parts},
               {"punctures", punctures},
               {"handles_cut", model.proposal.handles_cut},
               {"zipper_mm", design.ribbon.zipper_mm},
               {"pieces", design.curve.pieces},
               {"ribbon", ribbon}};
  if (!design.ribbon.closures.empty()) json["handle_cuts"] = closures_json(design.ribbon.closures);
  return to_bytes(json.dump());
}

Bytes write_parts_json(const ParameterisedModel& model) {
  const Json json = {{"format", "formwright zippable design"},
                     {"version", 1},
                     {"scale", model.scale},
                     {"parts", parts_json(model.proposal.segmentation)}};
  return to_bytes(json.dump());
}

Bytes write_parameterised_ply(const ParameterisedModel& parameterised, Context& context) {
  const Segmentation& s = parameterised.proposal.segmentation;
  const Parameterisation& p = parameterised.parameterisation;
  // A vertex of the file: a vertex of the surface, a part, and on which side of the part's cut.
  std::map<std::tuple<int, int, long>, int> number;
  std::vector<int> corner_of;
  Model model;
  model.mesh.F.resize(s.mesh.F.rows(), 3);
  for (int f = 0; f < s.mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int part = s.face_segment[f], v = s.mesh.F(f, k);
      const long u = std::lround(16 * p.corners_mm(3 * f + k, 0) / p.period_mm[part]);
      int& index = number.try_emplace({v, part, u}, -1).first->second;
      if (index < 0) index = static_cast<int>(corner_of.size()), corner_of.push_back(3 * f + k);
      model.mesh.F(f, k) = index;
    }
  const auto count = static_cast<Eigen::Index>(corner_of.size());
  model.mesh.V.resize(count, 3);
  std::vector<VertexColumn> columns{{"u", Eigen::VectorXd(count), ColumnKind::float64},
                                    {"v", Eigen::VectorXd(count), ColumnKind::float64},
                                    {"segment", Eigen::VectorXd(count), ColumnKind::int32},
                                    {"distortion", Eigen::VectorXd::Zero(count), ColumnKind::float32}};
  for (Eigen::Index i = 0; i < count; ++i) {
    const int corner = corner_of[i];
    model.mesh.V.row(i) = s.mesh.V.row(s.mesh.F(corner / 3, corner % 3));
    columns[0].values[i] = p.corners_mm(corner, 0);
    columns[1].values[i] = p.corners_mm(corner, 1);
    columns[2].values[i] = s.face_segment[corner / 3];
  }
  for (int f = 0; f < s.mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) {
      double& worst = columns[3].values[model.mesh.F(f, k)];
      worst = std::max(worst, p.face_distortion[f]);
    }
  WriteOptions options;
  options.columns = columns;
  return write_model(model, MeshFormat::ply, options, context);
}

Bytes write_curve_obj(const ZippableDesign& design) {
  TextOut out;
  out << "# zipper's course, mm\n";
  int written = 0;
  std::vector<int> piece;
  for (const SpiralLine& line : design.curve.lines) {
    const auto& points = line.trace.position_mm;
    const std::size_t count = points.size();
    for (std::size_t k = 0; k < count; ++k) {
      if (k == 0 && !piece.empty()) continue;  // the crossing is there already
      const Vec3& q = points[line.upward ? k : count - 1 - k];
      out << "v " << q.x() << ' ' << q.y() << ' ' << q.z() << '\n';
      piece.push_back(++written);
    }
    if (!line.upward) continue;
    out << 'l';
    for (const int v : piece) out << ' ' << v;
    out << '\n';
    piece.clear();
  }
  return to_bytes(out.text());
}

Bytes write_ribbon_svg(const ZippableDesign& design) {
  const Ribbon& ribbon = design.ribbon;
  constexpr double margin_mm = 5;
  Vec2 lower = Vec2::Constant(1e300), upper = Vec2::Constant(-1e300);
  for (const Vec2& q : ribbon.flat_mm) lower = lower.cwiseMin(q), upper = upper.cwiseMax(q);
  const Vec2 size = upper - lower + Vec2::Constant(2 * margin_mm);
  const auto x = [&](int i) { return micrometres(ribbon.flat_mm[i].x() - lower.x() + margin_mm); };
  const auto y = [&](int i) {
    return micrometres(upper.y() + margin_mm - ribbon.flat_mm[i].y());
  };  // SVG's y runs down
  const int count = static_cast<int>(ribbon.boundary.size());
  TextOut out;
  out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\""
      << micrometres(size.x()) << "mm\" height=\"" << micrometres(size.y()) << "mm\" viewBox=\"0 0 "
      << micrometres(size.x()) << ' ' << micrometres(size.y()) << "\">\n<title>Zippable ribbon</title>\n";
  const auto begin = [&](const char* id, const char* colour) {
    out << "<path id=\"" << id << "\" fill=\"none\" stroke=\"" << colour << "\" stroke-width=\"0.2\" d=\"";
  };
  const auto segment = [&](int a, int b) { out << 'M' << x(a) << ' ' << y(a) << 'L' << x(b) << ' ' << y(b); };
  begin("ruling", "#c0c0c0");
  for (Eigen::Index f = 0; f < ribbon.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = ribbon.F(f, k), b = ribbon.F(f, (k + 1) % 3);
      if (a < b && b - a != 1 && b - a != count - 1) segment(a, b);
    }
  out << "\"/>\n";
  for (const bool opening : {false, true}) {
    begin(opening ? "opening" : "zipper", opening ? "#0000ff" : "#ff0000");
    for (int i = 0; i < count; ++i) {
      const int next = (i + 1) % count;
      const RibbonVertex &a = ribbon.boundary[i], &b = ribbon.boundary[next];
      const bool along_opening = a.piece < 0 || a.piece != b.piece || a.left != b.left;
      if (along_opening == opening) segment(i, next);
    }
    out << "\"/>\n";
  }
  out << "</svg>\n";
  return to_bytes(out.text());
}

}  // namespace formwright
