// SPDX-License-Identifier: GPL-3.0-or-later
// formwright: the same jobs as in the page, from a shell; and the worker the page can use.
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <optional>

#include "base/sha256.h"
#include "command_line/command_line.h"
#include "command_line/flags.h"
#include "system/files.h"
#include "system/host.h"
#include "job/catalog.h"
#include "job/run.h"
#include "machines/machine_commands.h"
#include "command_line/manual_page.h"
#include "command_line/output_folder.h"
#include "system/private_data.h"
#include "system/work_places.h"
#include "jobs/job_runner.h"
#include "server/serve.h"
#include "slurm/slurm_engine.h"
#include "jobs/simulation_task.h"
#include "command_line/shell_completions.h"

namespace formwright {
namespace {

std::atomic<bool> interrupted{false};

int exit_code(ErrorCode code) {
  switch (code) {
    case ErrorCode::invalid_input: return 2;
    case ErrorCode::cancelled: return 130;
    default: return 3;
  }
}

class ProgressLine {
 public:
  explicit ProgressLine(bool quiet) : quiet_(quiet), terminal_(::isatty(STDERR_FILENO) == 1) {}
  void show(const Progress& progress) {
    if (quiet_) return;
    if (!terminal_) {
      if (progress.stage != stage_)
        std::fprintf(stderr, "%3.0f %%  %s\n", 100 * progress.fraction, progress.stage.c_str());
      stage_ = progress.stage;
      return;
    }
    constexpr int width = 28;
    const int filled = static_cast<int>(progress.fraction * width);
    std::string bar;
    for (int i = 0; i < width; ++i) bar += i < filled ? "█" : "░";
    std::fprintf(stderr, "\r\033[K%s %3.0f %%  %s", bar.c_str(), 100 * progress.fraction, progress.stage.c_str());
    if (progress.seconds_left && *progress.seconds_left > 1)
      std::fprintf(stderr, ", about %.0f s left", *progress.seconds_left);
    if (const std::string places = places_text(progress.places); !places.empty())
      std::fprintf(stderr, " (%s)", places.c_str());
    shown_ = true;
  }
  void clear() {
    if (shown_) std::fprintf(stderr, "\r\033[K");
    shown_ = false;
  }

 private:
  bool quiet_, terminal_, shown_ = false;
  std::string stage_;
};

/// Commands that write jobs for machines: after a run of theirs that failed no earlier job may be left to be sent.
bool makes_jobs(const Operation& operation) {
  return std::any_of(operation.outputs.begin(), operation.outputs.end(),
                     [](const OutputInfo& output) { return output.media_type == "text/x-gcode"; });
}

/// Where a run's simulations were made.
void show_places(const WorkPlaces& places, int left_by_slurm) {
  if (const std::string text = places_text(places.now()); !text.empty())
    std::fprintf(stderr, "Simulations: %s.\n", text.c_str());
  if (left_by_slurm > 0)
    std::fprintf(stderr, "Slurm did not make %d of them: this computer did. squeue and the nodes' logs say why.\n",
                 left_by_slurm);
}

/// A job that does not fit is not written: that is an error, or whoever sends what stands in the folder next would
/// send something else.
void require_fit(const Operation& operation, const Json& report) {
  if (report.value("fits", true)) return;
  const Json& misfits = report["misfits"];
  std::string sentences;
  for (const Json& misfit : misfits) sentences += (sentences.empty() ? "" : " ") + misfit.get<std::string>();
  throw Error(ErrorCode::invalid_input, operation.inputs.empty() ? "" : operation.inputs.front().name, sentences);
}

JobResult run_to_result(const Operation& operation, ParsedCommand& command, const OutputFolder& out) {
  std::map<std::string, std::shared_ptr<const Bytes>> blobs;
  for (const auto& [name, path] : command.files) {
    const auto folder = command.folders.find(name);
    auto bytes = folder == command.folders.end()
                     ? read_file(path, name)
                     : pack_folder(path, folder->second.needed, folder->second.optional, name);
    const std::string hash = sha256_hex(*bytes);
    command.message["inputs"][name] = {
        {"sha256", hash}, {"file_name", (path.has_filename() ? path : path.parent_path()).filename().string()}};
    blobs[hash] = std::move(bytes);
  }
  if (const auto error = check_job(command.message)) throw Error(error->code, error->where, error->message);
  out.make();
  ProgressLine line(command.quiet);
  Session session;
  Host host{[&](const Progress& progress) { line.show(progress); }, [] { return interrupted.load(); }, peak_memory_mb};
  const std::filesystem::path results = command.results.empty() ? command.out / "simulations" : command.results;
  std::shared_ptr<WorkPlaces> places;
  std::optional<SlurmEngine> slurm;
  if (operation.keeps_results) places = share_results(ResultFolder(results), host);
  if (command.slurm) slurm.emplace(command.slurm_options, results).lend_to(host, places);
  JobResult result = run_job(
      command.message, [&](const std::string& hash) { return blobs[hash]; }, session, host);
  line.clear();
  if (places && !command.quiet) show_places(*places, slurm ? slurm->left_by_slurm() : 0);
  if (result.error) throw Error(result.error->code, result.error->where, result.error->message);
  require_fit(operation, result.report);
  return result;
}

int run_operation(const Operation& operation, const std::vector<std::string>& words) {
  ParsedCommand command = parse_command(operation, words);
  if (command.help) {
    std::cout << operation_help(operation);
    return 0;
  }
  std::vector<std::string> names;
  for (const OutputInfo& output : operation.outputs) names.push_back(output.name);
  names.emplace_back("report.json");
  OutputFolder out(command.out, operation.name, names);
  try {
    const JobResult result = run_to_result(operation, command, out);
    std::vector<std::pair<std::string, std::size_t>> written;
    const auto put = [&](const std::string& name, ByteView bytes) {
      out.put(name, bytes);
      written.emplace_back(name, bytes.size());
    };
    for (const OutputBlob& output : result.outputs) put(output.name, *output.bytes);
    put("report.json", as_bytes(json_text(result.report, 2) + "\n"));
    out.replace();
    for (const auto& [name, bytes] : written)
      std::printf("%s  %.2f MB\n", (command.out / name).string().c_str(), static_cast<double>(bytes) * 1e-6);
  } catch (const std::exception&) {
    if (makes_jobs(operation)) out.clear();
    throw;
  }
  return 0;
}

/// What `formwright list` prints, for programs: the order is the catalog's.
Json operation_list() {
  Json list = Json::array();
  for (const Operation& operation : operations())
    list.push_back({{"name", operation.name}, {"title", operation.title}, {"summary", operation.summary}});
  return list;
}

int run(const std::vector<std::string>& words) {
  if (words.empty() || words[0] == "--help" || words[0] == "-h" || words[0] == "help") {
    std::cout << overview_text();
    return words.empty() ? 2 : 0;
  }
  const std::vector<std::string> rest(words.begin() + 1, words.end());
  if (words[0] == "--version") {
    std::cout << "formwright " << version() << "\n";
    return 0;
  }
  if (words[0] == "list") {
    const FlagValues flags = read_flags(rest, {{"--json", FlagRule::Value::none}}, [](const std::string& word) {
      return "There is no flag " + word + " of list: it has --json.";
    });
    if (flags.contains("--json")) {
      std::cout << operation_list().dump(2) << "\n";
      return 0;
    }
    for (const Operation& operation : operations()) std::cout << operation.name << "\t" << operation.summary << "\n";
    return 0;
  }
  if (words[0] == "describe") {
    if (words.size() == 1) {
      std::cout << catalog_json().dump(2) << "\n";
      return 0;
    }
    if (const Operation* operation = find_operation(words[1])) {
      std::cout << operation_json(*operation).dump(2) << "\n";
      return 0;
    }
    throw Error(ErrorCode::invalid_input, words[1],
                "There is no operation called " + words[1] + ": see formwright list.");
  }
  if (words[0] == "completions") {
    std::cout << shell_completions(words.size() > 1 ? words[1] : "");
    return 0;
  }
  if (words[0] == "manual") {
    std::cout << manual_page();
    return 0;
  }
  // What these write goes to DATA; outputs of operations are the person's own, with the rights that they chose.
  if (words[0] == "serve" || words[0] == "machine" || words[0] == "run-jobs") make_new_files_private();
  if (words[0] == "serve") return serve(rest);
  if (words[0] == "machine") return machine_command(rest, interrupted);
  if (words[0] == "run-jobs") return run_jobs_for_server(rest);
  if (words[0] == "run-simulations") return run_simulations(rest, interrupted);
  if (const Operation* operation = find_operation(words[0])) return run_operation(*operation, rest);
  throw Error(ErrorCode::invalid_input, words[0], "There is no command " + words[0] + ": see formwright --help.");
}

}  // namespace
}  // namespace formwright

int main(int argc, char** argv) {
  std::signal(SIGINT, [](int) { formwright::interrupted = true; });
  std::signal(SIGTERM, [](int) { formwright::interrupted = true; });
  // The terminal was closed, or the line to it dropped.
  if (!formwright::hangup_is_ignored()) std::signal(SIGHUP, [](int) { formwright::interrupted = true; });
  try {
    return formwright::run({argv + 1, argv + argc});
  } catch (const formwright::Error& error) {
    std::fprintf(stderr, "formwright: %s\n", error.what());
    return formwright::exit_code(error.code());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "formwright: internal error: %s\n", error.what());
    return 3;
  }
}
