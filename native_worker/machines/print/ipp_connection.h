// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// One conversation with an IPP printer (RFC 8010, 8011) over libcups. Everything here blocks: never on the server's
// thread.
#include <cups/cups.h>

#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include "base/bytes.h"

namespace formwright {

/// Where a printer is: the address a person registered, or a destination the system's print service knows or found on
/// the network.
struct PrinterAddress {
  std::string name;  // for sentences
  std::string uri;   // ipp://... or ipps://...; empty for a destination
  std::shared_ptr<cups_dest_t> destination;
};

using IppMessage = std::unique_ptr<ipp_t, void (*)(ipp_t*)>;

class IppConnection {
 public:
  /// `cancelled` must outlive it. Throws Error{could_not_solve, "machine"} with a sentence when nobody answers within
  /// 10 s, and Error{cancelled}.
  IppConnection(const PrinterAddress& address, const std::atomic<bool>& cancelled);
  IppConnection(const IppConnection&) = delete;
  IppConnection& operator=(const IppConnection&) = delete;
  ~IppConnection();

  /// A request that names this printer; add attributes to it, then send it.
  IppMessage request(ipp_op_t operation) const;

  struct Answer {
    IppMessage message{nullptr, ippDelete};
    ipp_status_t status = IPP_STATUS_OK;
    std::string text;  // the printer's own words, may be empty
    bool ok() const { return status < IPP_STATUS_REDIRECTION_OTHER_SITE; }
    bool busy() const {
      return status == IPP_STATUS_ERROR_BUSY || status == IPP_STATUS_ERROR_TEMPORARY ||
             status == IPP_STATUS_ERROR_SERVICE_UNAVAILABLE;
    }
  };
  /// Sends it with the document behind it and waits up to 30 s for each step. Throws Error{could_not_solve, "machine"}
  /// when the connection breaks, the printer asks for a password or stays silent, and Error{cancelled}. What the
  /// printer refuses is an Answer. A cancel is heard at once until the document is out. From then on the printer may
  /// have made a job of it, which only its answer can name: that is waited for as if nobody had cancelled, and given
  /// back when it took the document, for the caller to take back the job.
  Answer ask(IppMessage request, ByteView document = {});

 private:
  void connect_to_destination(const cups_dest_t& destination);
  void connect_to_uri();
  http_status_t send(ipp_t* message, ByteView document);
  [[noreturn]] void fail(const std::string& what) const;
  [[noreturn]] void fail_unanswered(http_status_t sent, http_status_t status) const;
  static int still_wanted(http_t* http, void* self);

  std::string name_, uri_, resource_;
  const std::atomic<bool>& cancelled_;
  http_t* http_ = nullptr;
  double silent_s_ = 0;
  bool may_have_job_ = false;  // the document is out
};

}  // namespace formwright
