// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/serve.h"

#include <unistd.h>

#include <boost/asio/signal_set.hpp>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <optional>

#include "base/error.h"
#include "command_line/flags.h"
#include "system/files.h"
#include "system/host.h"
#include "server/http_server.h"

namespace formwright {
namespace {

/// Beside the program when installed, or in the checkout it was built in.
std::filesystem::path default_web_folder() {
  std::error_code status;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", status).parent_path();
  for (const auto& folder :
       {program / "web", program.parent_path() / "web/dist", program.parent_path() / "share/formwright/web"})
    if (std::filesystem::exists(folder / "index.html", status)) return folder;
  return {};
}

long whole_number(const std::string& flag, const std::string& text, long minimum, long maximum) {
  char* end = nullptr;
  const long number = std::strtol(text.c_str(), &end, 10);
  if (text.empty() || *end != '\0' || number < minimum || number > maximum)
    throw Error(
        ErrorCode::invalid_input, flag,
        flag + " must be a whole number from " + std::to_string(minimum) + " to " + std::to_string(maximum) + ".");
  return number;
}

ServerOptions read_options(const std::vector<std::string>& words) {
  std::vector<FlagRule> rules = solver_flag_rules();
  rules.insert(rules.end(), {{"--port"}, {"--web"}, {"--data"}, {"--upload-limit-mb"}});
  const FlagValues flags = read_flags(words, rules, [](const std::string& word) {
    return "There is no flag " + word +
           ": serve has --port N, --web DIR, --data DIR, --upload-limit-mb N, --solver-memory-mb N, "
           "--max-job-minutes N and --no-solver-sandbox.";
  });
  const auto value = [&](const char* flag) {
    const auto given = flags.find(flag);
    return given == flags.end() ? std::optional<std::string>() : given->second.back();
  };
  ServerOptions options;
  options.data = value("--data").value_or(default_data_folder().string());
  options.web = value("--web").value_or(default_web_folder().string());
  if (const auto port = value("--port"))
    options.port = static_cast<unsigned short>(whole_number("--port", *port, 0, 65535));
  if (const auto limit = value("--upload-limit-mb"))
    options.upload_limit_bytes = static_cast<std::uint64_t>(whole_number("--upload-limit-mb", *limit, 1, 65536)) << 20;
  set_solver_flags(flags, options.solver);
  options.solver.data = options.data;
  return options;
}

}  // namespace

int serve(const std::vector<std::string>& words) {
  for (const std::string& word : words)
    if (word == "--help" || word == "-h") {
      std::cout
          << "Serves the page and the native worker on this machine only.\n\n"
             "  formwright serve [--port 8731] [--web DIR] [--data DIR] [--upload-limit-mb 1024]\n"
             "                   [--solver-memory-mb N] [--max-job-minutes 1440] [--no-solver-sandbox]\n\n"
             "Prints the address to open. --port 0 takes any free port. Jobs and results are kept in --data.\n"
             "Jobs run in a process of their own, which may take three quarters of the computer's memory unless\n"
             "--solver-memory-mb says otherwise, 24 h a job, and which the kernel keeps (Landlock, seccomp) from\n"
             "other files, the network and other programs.\n";
      return 0;
    }
  std::signal(SIGPIPE, SIG_IGN);
  const ServerOptions options = read_options(words);
  boost::asio::io_context io(1);
  HttpServer server(io, options);
  server.start();
  boost::asio::signal_set signals(io, SIGINT, SIGTERM);
  if (!hangup_is_ignored()) signals.add(SIGHUP);  // its terminal was closed: machines are to be stopped then, too
  signals.async_wait([&](const boost::system::error_code&, int) { io.stop(); });
  if (::geteuid() == 0)
    std::cerr << "formwright: the worker runs as root, and could harm the whole computer if anything went wrong: start "
                 "it as an ordinary user, who is in the group dialout for serial ports.\n";
  std::cerr << describe_solver_limits(options.solver) << std::endl;
  if (options.web.empty()) std::cout << "The page is not built (make web); the worker answers all the same.\n";
  std::cout << "http://127.0.0.1:" << server.port() << "/#token=" << server.token() << std::endl;
  run_handlers(io);
  server.stop();
  // Uploads that are being hashed and pages that listen are not waited for; left-overs go at the next start.
  std::_Exit(0);
}

}  // namespace formwright
