// SPDX-License-Identifier: GPL-3.0-or-later
// The routes of docs/job_contract.md, "In the worker".
#include <sys/statvfs.h>
#include <unistd.h>

#include <fstream>

#include "base/data/json_text.h"
#include "system/files.h"
#include "system/host.h"
#include "server/http_server.h"
#include "job/catalog.h"
#include "job/run.h"

namespace formwright {
namespace {

constexpr std::size_t max_queued = 32, max_kept_jobs = 200;
constexpr double max_blob_mb = 8192;
constexpr std::int64_t triangle_limit = 20'000'000;

void set_common_headers(auto& response, const Head& head) {
  response.version(head.version());
  response.keep_alive(head.keep_alive());
  response.set(http::field::server, "formwright");
  response.set("Cross-Origin-Opener-Policy", "same-origin");
  response.set("Cross-Origin-Embedder-Policy", "require-corp");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Referrer-Policy", "no-referrer");
  response.set("X-Frame-Options", "DENY");
  // 'self' covers ws: in new browsers only; Host has been checked before anything but a refusal is sent.
  const std::string host = text_of(head[http::field::host]);
  const bool plain = host.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789.:") == std::string::npos;
  response.set("Content-Security-Policy",
               "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self' blob:; style-src 'self' "
               "'unsafe-inline'; "
               "img-src 'self' data: blob:; connect-src 'self' blob: " +
                   (plain ? "ws://" + host : std::string()) +
                   "; object-src 'none'; base-uri 'none'; frame-ancestors 'none'; form-action 'none'");
}

const char* media_type_of(const std::filesystem::path& path) {
  const std::string e = path.extension().string();
  if (e == ".html") return "text/html; charset=utf-8";
  if (e == ".js" || e == ".mjs") return "text/javascript";
  if (e == ".css") return "text/css";
  if (e == ".wasm") return "application/wasm";
  if (e == ".json" || e == ".map") return "application/json";
  if (e == ".webmanifest") return "application/manifest+json";
  if (e == ".svg") return "image/svg+xml";
  if (e == ".png") return "image/png";
  if (e == ".webp") return "image/webp";
  if (e == ".woff2") return "font/woff2";
  if (e == ".txt") return "text/plain; charset=utf-8";
  return "application/octet-stream";
}

Response file_response(const Head& head, const std::filesystem::path& path, const std::string& type) {
  FileResponse response;
  boost::system::error_code error;
  response.body().open(path.c_str(), beast::file_mode::scan, error);
  if (error)
    return error_response(head, http::status::not_found, "invalid_input", "", "There is nothing at this address.");
  set_common_headers(response, head);
  response.set(http::field::content_type, type);
  response.set(http::field::cache_control, "no-store");
  response.content_length(response.body().size());
  if (head.method() == http::verb::head) {
    TextResponse only_head;
    set_common_headers(only_head, head);
    only_head.set(http::field::content_type, type);
    only_head.set(http::field::cache_control, "no-store");
    only_head.content_length(response.body().size());
    return only_head;
  }
  return response;
}

Json job_summary(const StoredJob& job) {
  Json summary = {{"id", job.id},
                  {"state", to_string(job.state)},
                  {"operation", job.job.value("operation", "")},
                  {"submitted_unix_s", job.submitted_unix_s},
                  {"finished_unix_s", job.finished_unix_s},
                  {"job", job.job}};
  summary["report"] = job.state == JobState::done ? job.result["report"] : Json(nullptr);
  return summary;
}

Json job_detail(const StoredJob& job) {
  Json detail = {{"id", job.id}, {"state", to_string(job.state)}, {"progress", job.progress}, {"job", job.job}};
  if (job.finished()) {
    if (job.result.contains("error")) detail["error"] = job.result["error"];
    else detail["result"] = job.result;
  }
  return detail;
}

double machine_memory_mb() {
  return static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGE_SIZE)) * 1e-6;
}

}  // namespace

TextResponse text_response(const Head& head, http::status status, std::string body, const std::string& type) {
  TextResponse response;
  set_common_headers(response, head);
  response.result(status);
  response.set(http::field::content_type, type);
  response.set(http::field::cache_control, "no-store");
  response.body() = std::move(body);
  response.prepare_payload();
  if (head.method() == http::verb::head) response.body().clear();
  return response;
}

TextResponse error_response(const Head& head, http::status status, const std::string& code, const std::string& where,
                            const std::string& message) {
  return text_response(head, status, json_text({{"error", {{"code", code}, {"where", where}, {"message", message}}}}));
}

Response HttpServer::answer(const Head& head, const std::string& body) {
  std::string path = text_of(head.target());
  const std::string query = path.find('?') == std::string::npos ? "" : path.substr(path.find('?') + 1);
  path.resize(std::min(path.find('?'), path.size()));
  const bool reads = head.method() == http::verb::get || head.method() == http::verb::head;
  if (!path.starts_with("/api/"))
    return reads ? page_file(head, path)
                 : error_response(head, http::status::method_not_allowed, "invalid_input", "",
                                  "This address can only be read.");
  if (path == "/api/status" && reads)
    return text_response(head, http::status::ok,
                         Json{{"version", version()},
                              {"cores", ::sysconf(_SC_NPROCESSORS_ONLN)},
                              {"memory_mb", machine_memory_mb()},
                              {"jobs_running", queue_.running() ? 1 : 0},
                              {"jobs_queued", queue_.waiting()},
                              {"upload_limit_bytes", options_.upload_limit_bytes},
                              {"triangle_limit", triangle_limit}}
                             .dump());
  if (path == "/api/catalog" && reads) return text_response(head, http::status::ok, catalog_json().dump());
  if (path.starts_with("/api/blobs/"))
    return reads ? answer_blob(head, path.substr(11))
                 : error_response(head, http::status::method_not_allowed, "invalid_input", "",
                                  "A file is read, or sent under its SHA-256.");
  if (path == "/api/jobs" && reads) {
    std::size_t limit = 50;
    if (query.starts_with("limit=")) limit = static_cast<std::size_t>(std::clamp(std::atoi(query.c_str() + 6), 1, 500));
    Json list = Json::array();
    for (const StoredJob* job : store_.newest_first())
      if (list.size() < limit) list.push_back(job_summary(*job));
    return text_response(head, http::status::ok, list.dump());
  }
  if (path == "/api/jobs" || path.starts_with("/api/jobs/")) return answer_jobs(head, path.substr(9), body);
  return error_response(head, http::status::not_found, "invalid_input", "", "There is nothing at this address.");
}

Response HttpServer::answer_jobs(const Head& head, const std::string& path, const std::string& body) {
  const bool reads = head.method() == http::verb::get || head.method() == http::verb::head;
  if (path.empty()) {
    if (head.method() != http::verb::post)
      return error_response(head, http::status::method_not_allowed, "invalid_input", "",
                            "Use GET to list jobs and POST to send one.");
    const Json message = parse_json_text(body);
    if (message.is_discarded())
      return error_response(head, http::status::bad_request, "invalid_input", "", "The job is not JSON.");
    if (const auto error = check_job(message))
      return text_response(head, http::status::unprocessable_entity, error_json(*error).dump());
    const Json inputs = message.value("inputs", Json::object());
    for (const auto& [name, input] : inputs.items()) {
      if (!input.contains("sha256")) continue;
      // A model that is worked on is never the one that was unused longest.
      if (!store_.touch_blob(input["sha256"].get<std::string>()))
        return error_response(head, http::status::unprocessable_entity, "invalid_input", name,
                              "The file for the input " + name + " has not arrived: send it again.");
    }
    if (queue_.waiting() >= max_queued)
      return error_response(head, http::status::too_many_requests, "invalid_input", "",
                            "Too many jobs are waiting: let some finish.");
    std::string id;
    try {
      id = store_.add(message).id;
    } catch (const StorageError& error) {
      return error_response(head, http::status::insufficient_storage, "internal", "",
                            std::string("The job was not accepted: ") + error.what());
    }
    store_.tidy(max_kept_jobs, max_blob_mb);  // now that the new job's blobs count as needed
    queue_.enqueue(id);
    return text_response(head, http::status::accepted, Json{{"id", id}}.dump());
  }
  const std::string id = path.substr(1, std::min(path.find('/', 1), path.size()) - 1);
  const std::string rest = path.substr(std::min(1 + id.size(), path.size()));
  StoredJob* job = is_hex_name(id, 32) ? store_.find(id) : nullptr;
  if (!job) return error_response(head, http::status::not_found, "invalid_input", "", "There is no such job.");
  if (rest.empty() && reads) return text_response(head, http::status::ok, job_detail(*job).dump());
  if (rest.empty() && head.method() == http::verb::delete_) {
    if (!job->finished())
      return error_response(head, http::status::conflict, "invalid_input", "",
                            "The job is not finished: cancel it first.");
    if (!store_.remove(id))
      return error_response(head, http::status::insufficient_storage, "internal", "",
                            "The job could not be removed from the disk: try again.");
    return text_response(head, http::status::no_content, "");
  }
  if (rest == "/cancel" && head.method() == http::verb::post) {
    queue_.cancel(id);
    return text_response(head, http::status::accepted, Json{{"id", id}}.dump());
  }
  constexpr std::string_view outputs = "/outputs/";
  if (rest.starts_with(outputs) && reads) {
    // Only names that the result lists: what the client says never becomes a path by itself.
    const std::string name = rest.substr(outputs.size());
    if (job->state == JobState::done && job->result["outputs"].contains(name))
      return file_response(head, store_.outputs_folder(id) / name,
                           job->result["outputs"][name]["media_type"].get<std::string>());
  }
  return error_response(head, http::status::not_found, "invalid_input", "", "There is nothing at this address.");
}

Response HttpServer::answer_blob(const Head& head, const std::string& sha256) {
  if (!is_hex_name(sha256, 64))
    return error_response(head, http::status::not_found, "invalid_input", "",
                          "The name of a file here is its SHA-256.");
  store_.touch_blob(sha256);
  return file_response(head, store_.blob_path(sha256), "application/octet-stream");
}

Response HttpServer::accept_upload(const Head& head, const std::string& sha256, const std::filesystem::path& received,
                                   const std::string& found_hash) {
  if (found_hash != sha256)
    return error_response(head, http::status::unprocessable_entity, "invalid_input", "sha256",
                          "The bytes do not have the SHA-256 they were sent under: send them again.");
  const bool known = std::filesystem::exists(store_.blob_path(sha256));
  try {
    store_.keep_blob(received, sha256);
  } catch (const StorageError& error) {
    return error_response(head, http::status::insufficient_storage, "internal", "", error.what());
  }
  return text_response(head, known ? http::status::ok : http::status::created, Json{{"sha256", sha256}}.dump());
}

Response HttpServer::page_file(const Head& head, const std::string& path) {
  if (options_.web.empty() || !std::filesystem::exists(options_.web / "index.html"))
    return error_response(head, http::status::not_found, "invalid_input", "",
                          "The page is not built here: run make web, or name its folder with --web.");
  // Only plain names, so that nothing outside the folder can be named.
  const bool plain = path.starts_with('/') && path.find("..") == std::string::npos &&
                     path.find("//") == std::string::npos &&
                     path.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-/@") ==
                         std::string::npos;
  if (!plain)
    return error_response(head, http::status::not_found, "invalid_input", "", "There is nothing at this address.");
  std::filesystem::path file = options_.web / path.substr(1);
  if (path == "/" || std::filesystem::is_directory(file)) file /= "index.html";
  std::error_code status;
  const auto real = std::filesystem::canonical(file, status);
  if (status || !real.string().starts_with((std::filesystem::canonical(options_.web, status) / "").string()))
    return error_response(head, http::status::not_found, "invalid_input", "", "There is nothing at this address.");
  Response response = file_response(head, real, media_type_of(real));
  // Names with a hash in them never change; the rest is asked for again.
  const std::string cache = path.starts_with("/assets/") ? "public, max-age=31536000, immutable" : "no-cache";
  std::visit([&](auto& r) { r.set(http::field::cache_control, cache); }, response);
  return response;
}

}  // namespace formwright
