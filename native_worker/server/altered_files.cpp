// SPDX-License-Identifier: GPL-3.0-or-later
// Before a blob or an output is sent, its bytes are compared with the SHA-256 it is known by: once, and again when the
// file was written to since.
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "server/http_server.h"

namespace formwright {
namespace {

struct KeptFile {
  std::filesystem::path path;
  std::string sha256;
  bool is_output = false;
};

/// What a request reads of that which was kept.
std::optional<KeptFile> file_of(const Head& head, JobStore& store) {
  if (head.method() != http::verb::get && head.method() != http::verb::head) return std::nullopt;
  constexpr std::string_view blobs = "/api/blobs/", jobs = "/api/jobs/", outputs = "/outputs/";
  constexpr std::size_t id_digits = 32, hash_digits = 64;
  const std::string target = text_of(head.target()), path = target.substr(0, target.find('?'));
  if (path.starts_with(blobs)) {
    const std::string hash = path.substr(blobs.size());
    if (!is_hex_name(hash, hash_digits)) return std::nullopt;
    return KeptFile{store.blob_path(hash), hash};
  }
  if (!path.starts_with(jobs) || path.size() <= jobs.size() + id_digits + outputs.size()) return std::nullopt;
  const std::string id = path.substr(jobs.size(), id_digits), rest = path.substr(jobs.size() + id_digits);
  if (!is_hex_name(id, id_digits) || !rest.starts_with(outputs)) return std::nullopt;
  const StoredJob* job = store.find(id);
  const std::string name = rest.substr(outputs.size());
  if (!job || job->state != JobState::done || !job->result["outputs"].contains(name)) return std::nullopt;
  const std::string hash = job->result["outputs"][name].value("sha256", "");
  if (hash.empty()) return std::nullopt;
  return KeptFile{store.outputs_folder(id) / name, hash, true};
}

}  // namespace

boost::asio::awaitable<std::optional<TextResponse>> HttpServer::refuse_altered(const Head& head) {
  const std::function<std::optional<KeptFile>()> find = [this, &head]() -> std::optional<KeptFile> {
    auto found = file_of(head, store_);
    return found && !store_.checked().known(found->path, found->sha256) ? found : std::nullopt;
  };
  const std::optional<KeptFile> file = co_await on_jobs_thread(find);
  if (!file) co_return std::nullopt;
  const auto stamp = stamp_of(file->path);
  if (!stamp) co_return std::nullopt;  // there is no such file, which others say
  // On a third thread: a large file takes seconds, and jobs end meanwhile.
  const bool intact = co_await boost::asio::co_spawn(
      hashing_,
      [](std::filesystem::path path, std::string sha256) -> boost::asio::awaitable<bool> {
        co_return has_sha256(path, sha256);
      }(file->path, file->sha256),
      boost::asio::use_awaitable);
  const std::function<bool()> note = [this, &file, &stamp, intact] {
    if (intact) store_.checked().note(file->path, file->sha256, *stamp);
    // So that it is sent again; unless it was meanwhile.
    else if (!file->is_output && stamp_of(file->path) == stamp) store_.remove_blob(file->sha256);
    return intact;
  };
  if (co_await on_jobs_thread(note)) co_return std::nullopt;
  if (file->is_output)
    co_return error_response(
        head, http::status::gone, "internal", "",
        "The result " + file->path.filename().string() + " was altered on the disk: run the job again.");
  co_return error_response(head, http::status::not_found, "invalid_input", "",
                           "The file was altered on the disk: send it again.");
}

}  // namespace formwright
