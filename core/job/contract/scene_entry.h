// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Scenes of several models as JSON files: one entry read with sentences for what is wrong, and the models it names.
#include <array>
#include <initializer_list>
#include <memory>
#include <string>

#include "base/bytes.h"
#include "base/data/json.h"
#include "geometry/samples/samples.h"
#include "job/contract/model_input.h"

namespace formwright {

/// Error{invalid_input, "scene"}.
[[noreturn]] void refuse_scene(const std::string& sentence);

/// The file as a JSON object. Throws Error{invalid_input, "scene"} where it is none, or has other names than `known`.
Json read_scene_object(ByteView bytes, std::initializer_list<const char*> known);

/// The list called `key`, empty where it is not there. Throws Error{invalid_input, "scene"}: no list, or longer than
/// `max_size`.
const Json& scene_list(const Json& scene, const char* key, std::size_t max_size);

/// One entry of a list, such as "Viewpoint 2". All throw Error{invalid_input, "scene"} in one sentence that names it.
/// The object must outlive it.
class SceneEntry {
 public:
  SceneEntry(const Json& object, std::string name, std::initializer_list<const char*> known);

  bool has(const char* key) const { return object_.contains(key); }
  const Json& value(const char* key) const;
  double number(const char* key) const { return checked(value(key), key, "a number"); }
  double number(const char* key, double otherwise) const { return has(key) ? number(key) : otherwise; }
  int whole(const char* key) const;
  std::string text(const char* key) const;
  template <std::size_t N>
  std::array<double, N> numbers(const char* key) const {
    return numbers_of<N>(value(key), key);
  }
  template <std::size_t N>
  std::array<double, N> numbers_of(const Json& list, const char* key) const {
    const std::string kind = "a list of " + std::to_string(N) + " numbers";
    std::array<double, N> result{};
    if (!list.is_array() || list.size() != N) wrong(key, kind);
    for (std::size_t k = 0; k < N; ++k) result[k] = checked(list[k], key, kind);
    return result;
  }
  [[noreturn]] void wrong(const char* key, const std::string& kind) const;
  const std::string& name() const { return name_; }

 private:
  double checked(const Json& n, const char* key, const std::string& kind) const;
  const Json& object_;
  std::string name_;
};

/// A model of a scene: a built-in sample, or an input of the job.
struct SceneModelSource {
  std::string sample;
  int sample_vertices = 0;  // 0: the sample's default
  int input_number = 0;     // 1 for "model", 2 for "model_2", ...; 0 for a sample
  std::string name() const { return input_number > 0 ? "model " + std::to_string(input_number) : sample; }
};

/// Of the entry's `sample` and `vertices`, or `model`.
SceneModelSource read_model_source(const SceneEntry& entry);
/// Into an entry that read_model_source reads.
void write_model_source(const SceneModelSource& source, Json& entry);
/// Throws Error{invalid_input, "scene"} where no sample has the name; `whose`: of the entry.
const SampleInfo& sample_called(const std::string& name, const std::string& whose);

inline std::array<double, 3> array_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

inline constexpr const char* scene_model_input = "model";

inline constexpr const char* scene_input = "scene";

/// Declaration of the optional input "scene".
InputInfo scene_input_info(std::string help);
/// Declaration of the input "model", which may be given several times.
InputInfo scene_models_info();
/// "model", "model_2", ...
std::string scene_model_name(int number);
/// Reads and repairs it, or finds it in the session. `whose`: "Viewpoint 2". Throws Error{invalid_input, "scene"}
/// where the input is not there; see load_model.
std::shared_ptr<const LoadedModel> load_scene_model(const OperationCall& call, const SceneModelSource& source,
                                                    const std::string& whose);

}  // namespace formwright
