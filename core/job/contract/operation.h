// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What an operation declares, and what it is handed when it runs.
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "base/context.h"
#include "base/data/parameters.h"
#include "base/data/presets.h"
#include "job/contract/session.h"

namespace formwright {

struct InputInfo {
  std::string name, label, help;
  std::vector<std::string> extensions;
  bool required = true;
  bool accepts_sample = false;
  std::string object_file =
      "";  // its name in the folder of a measured object, "" when it has none: --object DIR gives them all
  std::vector<std::string> folder_files =
      {};  // a zip of these files, which the command line packs from a folder; empty for plain files
  std::vector<std::string> optional_folder_files = {};  // packed with them where the folder has them
  bool repeatable = false;                              // more of them as name_2, name_3, ...
};

struct OutputInfo {
  std::string name, media_type, label, help;
  bool made_by_default = true;
};

struct ReportField {
  std::string name, label, unit, help;
  std::string old_name{};  // of the release before this one, reported as well; "" where there is none
};

/// A resolved input: bytes under their hash, or one of our own shapes.
struct InputBlob {
  std::string sha256, file_name;
  std::shared_ptr<const Bytes> bytes;  // null for a sample
  std::string sample;
  int sample_vertices = 0;  // 0: the sample's default
  /// Names the content: equal keys, equal content.
  std::string key() const { return bytes ? sha256 : "sample:" + sample + ":" + std::to_string(sample_vertices); }
};

struct OutputBlob {
  std::string name, media_type;
  std::shared_ptr<const Bytes> bytes;
};

struct OperationResult {
  Json report = Json::object();
  std::vector<OutputBlob> outputs;
};

struct OperationCall {
  const std::map<std::string, InputBlob>& inputs;
  std::function<bool(const std::string& output)> wants;  // is this output asked for?
  Session& session;
  Context& context;
};

/// An operation whose parameters are read.
using PreparedOperation = std::function<OperationResult(const OperationCall&)>;

struct Operation {
  std::string name, title, summary;
  std::string module =
      "formwright";  // of WebAssembly, with its code (wasm/CMakeLists.txt); natively all are in one program
  std::vector<InputInfo> inputs;
  std::vector<ParameterInfo> parameters;
  std::vector<PresetList> presets;  // of values for them, to choose by name
  std::vector<OutputInfo> outputs;
  std::vector<ReportField> report;
  bool keeps_results = false;  // has expensive intermediate results that the host should keep (Context::keep_result)
  /// Reads the parameters (operation_options.h). Throws Error{invalid_input} for a wrong one.
  std::function<PreparedOperation(const Json& parameters)> prepare;

  const OutputInfo* output(const std::string& output_name) const {
    for (const OutputInfo& info : outputs)
      if (info.name == output_name) return &info;
    return nullptr;
  }
};

}  // namespace formwright
