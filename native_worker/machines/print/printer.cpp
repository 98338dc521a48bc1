// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/print/printer.h"

#include <array>

#include "base/error.h"

namespace formwright {

PrinterDescription describe_printer(const PrinterAddress& address, const std::atomic<bool>& cancelled) {
  IppConnection connection(address, cancelled);
  IppMessage request = connection.request(IPP_OP_GET_PRINTER_ATTRIBUTES);
  // media-col-database is not among "all" (PWG 5100.7): it has to be asked for by its name.
  static constexpr std::array<const char*, 2> wanted{"all", "media-col-database"};
  ippAddStrings(request.get(), IPP_TAG_OPERATION, IPP_TAG_KEYWORD, "requested-attributes",
                static_cast<int>(wanted.size()), nullptr, wanted.data());
  const auto answer = connection.ask(std::move(request));
  if (!answer.ok())
    throw Error(ErrorCode::could_not_solve, "machine",
                address.name + " does not say what it can do (" + std::string(ippErrorString(answer.status)) +
                    "): see whether its address is that of a printer.");
  return read_printer_description(answer.message.get());
}

}  // namespace formwright
