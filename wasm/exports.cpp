// SPDX-License-Identifier: GPL-3.0-or-later
// What JavaScript may call: docs/job_contract.md, "In WASM". Nothing else lives here.
#include <emscripten.h>
#include <emscripten/heap.h>

#include <cstring>
#include <map>
#include <new>

#include "base/data/json_text.h"
#include "job/catalog.h"
#include "job/run.h"

namespace {

using namespace formwright;

std::map<std::string, std::shared_ptr<Bytes>> blobs;
Session session(1024);
JobResult last;
std::string answer;

const char* keep(std::string text) {
  answer = std::move(text);
  return answer.c_str();
}

// clang-format off
EM_JS(void, tell_progress, (double fraction, const char* stage, double seconds_left), {
  if (Module["onProgress"]) Module["onProgress"](fraction, UTF8ToString(stage), seconds_left);
});
EM_JS(int, asked_to_cancel, (), { return Module["cancelRequested"] && Module["cancelRequested"]() ? 1 : 0; });
// clang-format on

}  // namespace

extern "C" {

EMSCRIPTEN_KEEPALIVE const char* fw_catalog() { return keep(catalog_json().dump()); }

EMSCRIPTEN_KEEPALIVE void* fw_blob_new(const char* sha256, std::size_t bytes) {
  try {
    auto blob = std::make_shared<Bytes>(bytes);
    void* data = blob->data();
    blobs[sha256] = std::move(blob);
    return data;
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}
EMSCRIPTEN_KEEPALIVE int fw_blob_has(const char* sha256) { return blobs.contains(sha256) ? 1 : 0; }
EMSCRIPTEN_KEEPALIVE void fw_blob_drop(const char* sha256) { blobs.erase(sha256); }

EMSCRIPTEN_KEEPALIVE const char* fw_run(const char* job) {
  last = {};
  const Host host{[](const Progress& p) { tell_progress(p.fraction, p.stage.c_str(), p.seconds_left.value_or(-1)); },
                  [] { return asked_to_cancel() != 0; },
                  [] { return static_cast<double>(emscripten_get_heap_size()) / 1e6; }};
  const Json message = parse_json_text(job);
  const auto find = [](const std::string& hash) -> std::shared_ptr<const Bytes> {
    const auto it = blobs.find(hash);
    return it == blobs.end() ? nullptr : it->second;
  };
  last = run_job(message, find, session, host);
  return keep(result_json(last).dump());
}

EMSCRIPTEN_KEEPALIVE const void* fw_output_data(const char* name) {
  for (const OutputBlob& output : last.outputs)
    if (output.name == name) return output.bytes->data();
  return nullptr;
}
EMSCRIPTEN_KEEPALIVE std::size_t fw_output_size(const char* name) {
  for (const OutputBlob& output : last.outputs)
    if (output.name == name) return output.bytes->size();
  return 0;
}

EMSCRIPTEN_KEEPALIVE double fw_memory_mb() { return static_cast<double>(emscripten_get_heap_size()) / 1e6; }
}
