// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/print/upload.h"

#include <curl/curl.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <mutex>

#include "base/error.h"
#include "base/sha256.h"
#include "machines/print/upload_answers.h"
#include "system/machine_errors.h"

namespace formwright {
namespace {

constexpr std::size_t max_answer_bytes = 1 << 20;
constexpr std::size_t max_gcode_bytes = std::size_t{1} << 30;
constexpr long connect_patience_s = 10, silence_patience_s = 30, ask_patience_s = 20, upload_patience_s = 3600;

struct Conversation {
  const std::atomic<bool>* cancelled = nullptr;
  std::string answer;
  ByteView document;
  std::size_t sent = 0;
  const std::function<void(double)>* progress = nullptr;
};

std::size_t take_answer(char* data, std::size_t size, std::size_t count, void* conversation) {
  auto& c = *static_cast<Conversation*>(conversation);
  if (c.answer.size() + size * count > max_answer_bytes) return 0;
  c.answer.append(data, size * count);
  return size * count;
}

std::size_t give_document(char* to, std::size_t size, std::size_t count, void* conversation) {
  auto& c = *static_cast<Conversation*>(conversation);
  const std::size_t part = std::min(size * count, c.document.size() - c.sent);
  std::memcpy(to, c.document.data() + c.sent, part);
  c.sent += part;
  if (c.progress && *c.progress)
    (*c.progress)(static_cast<double>(c.sent) / static_cast<double>(std::max<std::size_t>(c.document.size(), 1)));
  return part;
}

int seek_document(void* conversation, curl_off_t offset, int origin) {
  auto& c = *static_cast<Conversation*>(conversation);
  if (origin != SEEK_SET || offset < 0 || static_cast<std::size_t>(offset) > c.document.size())
    return CURL_SEEKFUNC_FAIL;
  c.sent = static_cast<std::size_t>(offset);
  return CURL_SEEKFUNC_OK;
}

int look_for_cancel(void* conversation, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  return *static_cast<Conversation*>(conversation)->cancelled ? 1 : 0;
}

/// One request to a registered machine. Nothing but http and https, no redirects (the key would travel along), no
/// proxy.
class Request {
 public:
  Request(const Machine& machine, const std::string& path, const std::atomic<bool>& cancelled) : machine_(machine) {
    static std::once_flag once;
    std::call_once(once, [] { curl_global_init(CURL_GLOBAL_DEFAULT); });
    curl_.reset(curl_easy_init());
    if (!curl_) fail_at_machine("No connection to " + machine.name + " could be made: the system has no room for one.");
    conversation_.cancelled = &cancelled;
    const std::string url = machine.url + path;
    set(CURLOPT_URL, url.c_str());
    set(CURLOPT_PROTOCOLS_STR, "http,https");
    set(CURLOPT_FOLLOWLOCATION, 0L);
    set(CURLOPT_PROXY, "");
    set(CURLOPT_NOSIGNAL, 1L);
    set(CURLOPT_CONNECTTIMEOUT, connect_patience_s);
    set(CURLOPT_LOW_SPEED_LIMIT, 1L);
    set(CURLOPT_LOW_SPEED_TIME, silence_patience_s);
    set(CURLOPT_TIMEOUT, ask_patience_s);
    set(CURLOPT_USERAGENT, "formwright");
    set(CURLOPT_WRITEFUNCTION, take_answer);
    set(CURLOPT_WRITEDATA, &conversation_);
    set(CURLOPT_NOPROGRESS, 0L);
    set(CURLOPT_XFERINFOFUNCTION, look_for_cancel);
    set(CURLOPT_XFERINFODATA, &conversation_);
    if (!machine.api_key.empty()) add_header("X-Api-Key: " + machine.api_key);
    add_header("Expect:");
  }
  void post_json(const std::string& body) {
    add_header("Content-Type: application/json");
    set(CURLOPT_COPYPOSTFIELDS, body.c_str());
  }
  void form_field(const char* name, const std::string& value) {
    curl_mimepart* part = curl_mime_addpart(form());
    curl_mime_name(part, name);
    curl_mime_data(part, value.data(), value.size());
  }
  void form_file(const std::string& file_name, ByteView document, const std::function<void(double)>& progress) {
    conversation_.document = document;
    conversation_.progress = &progress;
    curl_mimepart* part = curl_mime_addpart(form());
    curl_mime_name(part, "file");
    curl_mime_filename(part, file_name.c_str());
    curl_mime_type(part, "application/octet-stream");
    curl_mime_data_cb(part, static_cast<curl_off_t>(document.size()), give_document, seek_document, nullptr,
                      &conversation_);
    set(CURLOPT_TIMEOUT, upload_patience_s);
  }
  UploadReply perform() {
    if (form_) set(CURLOPT_MIMEPOST, form_.get());
    set(CURLOPT_HTTPHEADER, headers_.get());
    const CURLcode code = curl_easy_perform(curl_.get());
    if (*conversation_.cancelled) throw Error(ErrorCode::cancelled, "", "Cancelled.");
    if (code == CURLE_OPERATION_TIMEDOUT)
      fail_at_machine(machine_.name + " did not answer at " + machine_.url +
                      ": see whether it is switched on and reachable, and try again.");
    if (code == CURLE_PEER_FAILED_VERIFICATION)
      fail_at_machine("The certificate of " + machine_.name +
                      " is not one this computer trusts: install it, or register the machine with http.");
    if (code == CURLE_WRITE_ERROR)
      fail_at_machine(machine_.name +
                      " sent an answer of more than 1 MB, so it is probably another program: check its address.");
    if (code != CURLE_OK)
      fail_at_machine(machine_.name + " cannot be reached at " + machine_.url + " (" +
                      std::string(curl_easy_strerror(code)) +
                      "): see whether it is switched on and its address is right.");
    long status = 0;
    curl_easy_getinfo(curl_.get(), CURLINFO_RESPONSE_CODE, &status);
    return read_reply(machine_, status, conversation_.answer);
  }

 private:
  template <class Value>
  void set(CURLoption option, Value value) {
    curl_easy_setopt(curl_.get(), option, value);
  }
  void add_header(const std::string& line) { headers_.reset(curl_slist_append(headers_.release(), line.c_str())); }
  curl_mime* form() {
    if (!form_) form_.reset(curl_mime_init(curl_.get()));
    return form_.get();
  }

  const Machine& machine_;
  Conversation conversation_;
  std::unique_ptr<CURL, void (*)(CURL*)> curl_{nullptr, curl_easy_cleanup};
  std::unique_ptr<curl_slist, void (*)(curl_slist*)> headers_{nullptr, curl_slist_free_all};
  std::unique_ptr<curl_mime, void (*)(curl_mime*)> form_{nullptr, curl_mime_free};
};

}  // namespace

std::string upload_file_name(const std::string& file_name) {
  std::string name = file_name.substr(std::min(
      file_name.size(), file_name.find_last_of("/\\") == std::string::npos ? 0 : file_name.find_last_of("/\\") + 1));
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '_' && c != '-') c = '_';
  name.erase(0, std::min(name.find_first_not_of('.'), name.size()));
  for (const std::string_view ending : {".gcode", ".gco", ".g", ".nc"})
    if (name.size() > ending.size() && name.ends_with(ending)) name.resize(name.size() - ending.size());
  if (name.empty()) throw Error(ErrorCode::invalid_input, "file_name", "Give the file a name, such as mould.gcode.");
  return name.substr(0, 100) + ".gcode";
}

Json upload_gcode(const Machine& machine, const UploadOrder& order, const std::atomic<bool>& cancelled,
                  const std::function<void(double)>& progress) {
  if (order.gcode.empty()) throw Error(ErrorCode::invalid_input, "sha256", "The file is empty: slice the model first.");
  if (order.gcode.size() > max_gcode_bytes)
    throw Error(ErrorCode::invalid_input, "sha256", "The file is larger than 1 GB: slice it coarser.");
  const std::string name = upload_file_name(order.file_name);
  const bool octoprint = machine.kind == MachineKind::octoprint;
  Request request(machine, octoprint ? "/api/files/local" : "/server/files/upload", cancelled);
  if (octoprint) {
    request.form_field("select", order.print ? "true" : "false");
  } else {
    request.form_field("root", "gcodes");
    request.form_field("checksum", sha256_hex(order.gcode));
  }
  request.form_field("print", order.print ? "true" : "false");
  request.form_file(name, order.gcode, progress);
  return read_uploaded(machine, order.print, request.perform());
}

Json upload_machine_state(const Machine& machine, const std::atomic<bool>& cancelled) {
  if (machine.kind == MachineKind::octoprint) {
    const std::string software = read_octoprint_version(machine, Request(machine, "/api/version", cancelled).perform());
    return read_octoprint_state(software, Request(machine, "/api/printer?exclude=sd", cancelled).perform());
  }
  Json state;
  if (read_moonraker_state(machine, Request(machine, "/server/info", cancelled).perform(), state))
    read_moonraker_printing(Request(machine, "/printer/objects/query?print_stats", cancelled).perform(), state);
  return state;
}

void cancel_print(const Machine& machine, const std::atomic<bool>& cancelled) {
  const bool octoprint = machine.kind == MachineKind::octoprint;
  Request request(machine, octoprint ? "/api/job" : "/printer/print/cancel", cancelled);
  request.post_json(octoprint ? R"({"command": "cancel"})" : "{}");
  read_cancelled(machine, request.perform());
}

}  // namespace formwright
