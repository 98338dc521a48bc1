// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/relief/painting/painting_file.h"

#include <algorithm>
#include <cmath>

#include "base/data/json_text.h"
#include "base/error.h"
#include "base/format.h"

namespace formwright {
namespace {

using Column = Eigen::VectorXd;

/// The four lists as they stand in a file; NaN where nothing is painted.
struct RawPainting {
  std::array<Column, 4> values;  // in the order of painted_columns; empty where there is none
};

class Checker {
 public:
  Checker(std::string where, std::string file) : where_(std::move(where)), file_(std::move(file)) {}

  [[noreturn]] void refuse(const std::string& sentence) const {
    throw Error(ErrorCode::invalid_input, where_, file_ + ": " + sentence);
  }

  /// Throws where a value is out of its range.
  Painting checked(const RawPainting& raw) const {
    const auto& [weight, region, thickness, carve] = raw.values;
    Painting painting;
    if (weight.size() > 0) painting.weight = in_range(weight, "weight", min_painted_weight, max_painted_weight, 1);
    if (region.size() > 0) painting.region = regions_of(region);
    const Column* const depth = thickness.size() > 0 ? &thickness : carve.size() > 0 ? &carve : nullptr;
    if (depth == nullptr) return painting;
    // Without regions, vertices that have a depth of their own have it by that.
    if (region.size() == 0)
      for (Eigen::Index i = 0; i < depth->size(); ++i) {
        const bool own =
            (thickness.size() > 0 && !std::isnan(thickness[i])) || (carve.size() > 0 && !std::isnan(carve[i]));
        painting.region.push_back(own ? PaintedRegion::own_thickness : PaintedRegion::usual);
      }
    if (thickness.size() > 0) painting.thickness_mm = depths_of(thickness, painting, "thickness_mm", 0);
    if (carve.size() > 0) painting.carve_depth_mm = depths_of(carve, painting, "carve_depth_mm", -max_painted_depth_mm);
    return painting;
  }

 private:
  std::string vertex(Eigen::Index i) const { return "vertex " + std::to_string(i); }

  Column in_range(const Column& values, const std::string& name, double min, double max, double otherwise) const {
    Column result = values;
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      if (std::isnan(values[i])) result[i] = otherwise;
      else if (!(values[i] >= min && values[i] <= max))
        refuse(vertex(i) + " has " + name + " " + with_digits(values[i], 6) + ", which must be from " +
               with_digits(min, 6) + " to " + with_digits(max, 6) + ": change it, or remove " + name +
               " from the file.");
    }
    return result;
  }

  /// Only where the region is own_thickness: what stands elsewhere does not count.
  Column depths_of(const Column& values, const Painting& painting, const std::string& name, double min) const {
    Column counted = values;
    for (Eigen::Index i = 0; i < counted.size(); ++i)
      if (painting.region_of(i) != PaintedRegion::own_thickness) counted[i] = NAN;
    return in_range(counted, name, min, max_painted_depth_mm, NAN);
  }

  std::vector<PaintedRegion> regions_of(const Column& values) const {
    std::vector<PaintedRegion> regions;
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      const double value = std::isnan(values[i]) ? 0 : values[i];
      if (!(value >= 0 && value < static_cast<double>(painted_region_names.size())) || value != std::floor(value))
        refuse(vertex(i) + " has region " + with_digits(value, 6) +
               ", which is not known: give 0 (as the rest), 1 (free), 2 (on the base) or 3 (own thickness).");
      regions.push_back(static_cast<PaintedRegion>(static_cast<int>(value)));
    }
    return regions;
  }

  std::string where_, file_;
};

double region_number(const std::string& name) {
  for (std::size_t k = 0; k < painted_region_names.size(); ++k)
    if (painted_region_names[k] == name) return static_cast<double>(k);
  return -1;
}

/// One list of the JSON form.
Column column_of(const Checker& checker, const Json& list, const std::string& name, int vertices) {
  const auto value_of = [&](const Json& value) {
    double number = NAN;
    if (value.is_number()) number = value.get<double>();
    else if (value.is_string() && name == "region") number = region_number(value.get<std::string>());
    if (number < 0 && value.is_string())
      checker.refuse("there is no region called " + value.dump().substr(0, 40) +
                     ": give usual, free, on_base or own_thickness.");
    if (!std::isfinite(number))
      checker.refuse("a value of " + name + " is not a number: give one for every vertex that is painted.");
    return number;
  };
  if (!list.is_array()) checker.refuse(name + " must be a list of values or of runs [first, count, value].");
  Column column = Column::Constant(vertices, NAN);
  const bool runs = !list.empty() && list.front().is_array();
  if (!runs && static_cast<int>(list.size()) != vertices)
    checker.refuse(name + " has " + std::to_string(list.size()) + " values for " + std::to_string(vertices) +
                   " vertices: give one for each, or runs [first, count, value].");
  Eigen::Index next = 0;
  std::int64_t in_runs = 0;
  for (const Json& item : list) {
    if (!runs) {
      column[next++] = value_of(item);
      continue;
    }
    if (!item.is_array() || item.size() != 3 || !item[0].is_number_integer() || !item[1].is_number_integer())
      checker.refuse("a run of " + name + " is not of the form [first vertex, number of vertices, value]: correct it.");
    const auto first = item[0].get<std::int64_t>(), count = item[1].get<std::int64_t>();
    if (first < 0 || count < 0 || first > vertices || count > vertices - first)
      checker.refuse("a run of " + name + " begins at vertex " + std::to_string(first) + " and has " +
                     std::to_string(count) + " vertices, but they count from 0 to " + std::to_string(vertices - 1) +
                     ": correct it.");
    in_runs += count;
    if (in_runs > vertices) checker.refuse("the runs of " + name + " overlap: give every vertex at most one value.");
    column.segment(static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(count)).setConstant(value_of(item[2]));
  }
  return column;
}

}  // namespace

PaintingFile read_painting(ByteView text, const std::string& where, const std::string& file_name,
                           const std::vector<int>& vertex_counts, const std::string& of) {
  const Checker checker(where, file_name);
  const Json file = parse_json_text(as_text(text));
  if (!file.is_object())
    checker.refuse("it is not a painting: give a JSON object with \"vertices\", \"weight\" and \"region\".");
  for (const auto& [name, value] : file.items())
    if (name != "vertices" && std::ranges::find(painted_columns, std::string_view(name)) == painted_columns.end())
      checker.refuse("it has \"" + name.substr(0, 40) +
                     "\", which is not known; there are vertices, weight, region, thickness_mm and carve_depth_mm.");
  const auto vertices = file.find("vertices");
  if (vertices == file.end() || !vertices->is_number_integer())
    checker.refuse("it does not say how many vertices are painted: add \"vertices\".");
  const auto count = vertices->get<std::int64_t>();
  if (std::ranges::find(vertex_counts, count) == vertex_counts.end())
    checker.refuse("it is painted for " + std::to_string(count) + " vertices, and " + of + " has " +
                   std::to_string(vertex_counts.front()) +
                   ": paint this model, or give the model that was painted as painted_mesh.");
  PaintingFile result;
  result.vertices = static_cast<int>(count);
  RawPainting raw;
  for (std::size_t k = 0; k < painted_columns.size(); ++k) {
    const std::string name(painted_columns[k]);
    if (file.contains(name)) raw.values[k] = column_of(checker, file[name], name, result.vertices);
  }
  result.painting = checker.checked(raw);
  return result;
}

Painting painting_of_columns(const ModelColumns& columns, const std::string& where, const std::string& file_name) {
  const Checker checker(where, file_name);
  RawPainting raw;
  for (std::size_t k = 0; k < painted_columns.size(); ++k) {
    const std::string name(painted_columns[k]);
    if (std::ranges::find(columns.not_numbers, name) != columns.not_numbers.end())
      checker.refuse("the vertices' " + name +
                     " holds values that are not numbers: give a number for every vertex, or remove " + name +
                     " from the file.");
    if (const ModelColumn* const found = columns.find(name)) raw.values[k] = found->column.values;
  }
  return checker.checked(raw);
}

std::vector<VertexColumn> columns_of_painting(const Painting& painting, double thickness_mm, double carve_depth_mm) {
  std::vector<VertexColumn> columns;
  if (painting.weight.size() > 0) columns.push_back({"weight", painting.weight, ColumnKind::float64});
  if (painting.region.empty()) return columns;
  Eigen::VectorXd region(static_cast<Eigen::Index>(painting.region.size()));
  for (Eigen::Index i = 0; i < region.size(); ++i) region[i] = static_cast<double>(painting.region_of(i));
  columns.push_back({"region", region, ColumnKind::uint8});
  const auto add = [&](const char* name, const Eigen::VectorXd& values, double otherwise) {
    if (values.size() == 0) return;
    columns.push_back(
        {name, values.unaryExpr([&](double v) { return std::isnan(v) ? otherwise : v; }), ColumnKind::float64});
  };
  add("thickness_mm", painting.thickness_mm, thickness_mm);
  add("carve_depth_mm", painting.carve_depth_mm, carve_depth_mm);
  return columns;
}

}  // namespace formwright
