// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/ipp_connection.h"

#include <algorithm>

#include "base/error.h"

namespace formwright {
namespace {

constexpr int connect_patience_ms = 10'000;
constexpr double answer_patience_s = 30, look_up_s = 0.5;  // how long it may be silent; how often a cancel is looked for

/// libcups asks on the terminal unless told not to: a worker has nobody to ask.
const char* no_password(const char*, http_t*, const char*, const char*, void*) { return nullptr; }

void check(const std::atomic<bool>& cancelled) {
  if (cancelled) throw Error(ErrorCode::cancelled, "", "Cancelled.");
}

}  // namespace

void IppConnection::fail(const std::string& what) const {
  check(cancelled_);
  throw Error(ErrorCode::could_not_solve, "machine", what);
}

int IppConnection::still_wanted(http_t*, void* self) {
  auto& connection = *static_cast<IppConnection*>(self);
  connection.silent_s_ += look_up_s;
  return !connection.cancelled_ && connection.silent_s_ < answer_patience_s ? 1 : 0;
}

IppConnection::IppConnection(const PrinterAddress& address, const std::atomic<bool>& cancelled) : name_(address.name), uri_(address.uri), cancelled_(cancelled) {
  check(cancelled_);
  cupsSetPasswordCB2(no_password, nullptr);
  if (address.destination) {
    char resource[1024] = "";
    // A destination with a queue is reached through the print service; one found on the network is spoken to itself.
    const bool queued = cupsGetOption("printer-uri-supported", address.destination->num_options, address.destination->options) != nullptr;
    http_ = cupsConnectDest(address.destination.get(), queued ? CUPS_DEST_FLAGS_NONE : CUPS_DEST_FLAGS_DEVICE, connect_patience_ms, nullptr, resource, sizeof resource, nullptr, nullptr);
    if (!http_) fail(name_ + " cannot be reached: see whether it is switched on and on the network, and try again.");
    resource_ = resource;
    char host[256] = "", uri[1024] = "";
    httpGetHostname(http_, host, sizeof host);
    const char* own = queued ? cupsGetOption("printer-uri-supported", address.destination->num_options, address.destination->options) : nullptr;
    if (!own && httpAssembleURI(HTTP_URI_CODING_ALL, uri, sizeof uri, httpIsEncrypted(http_) ? "ipps" : "ipp", nullptr, host, httpAddrPort(httpGetAddress(http_)), resource) != HTTP_URI_STATUS_OK)
      fail("The address of " + name_ + " cannot be read: register it with formwright machine add --url.");
    uri_ = own ? own : uri;
  } else {
    char scheme[32] = "", user[256] = "", host[256] = "", resource[1024] = "";
    int port = 0;
    if (httpSeparateURI(HTTP_URI_CODING_ALL, uri_.c_str(), scheme, sizeof scheme, user, sizeof user, host, sizeof host, &port, resource, sizeof resource) != HTTP_URI_STATUS_OK)
      fail("The address " + uri_ + " of " + name_ + " is not one: register it anew, such as ipp://192.168.1.20/ipp/print.");
    resource_ = resource;
    const http_encryption_t encryption = std::string(scheme) == "ipps" ? HTTP_ENCRYPTION_ALWAYS : HTTP_ENCRYPTION_IF_REQUESTED;
    http_ = httpConnect2(host, port, nullptr, AF_UNSPEC, encryption, 1, connect_patience_ms, nullptr);
    if (!http_) {
      const std::string reason = cupsLastErrorString();
      fail(name_ + " does not answer at " + uri_ + (reason.empty() ? "" : " (" + reason + ")") + ": see whether it is switched on and its address is right.");
    }
  }
  httpSetTimeout(http_, look_up_s, still_wanted, this);
}

IppConnection::~IppConnection() {
  if (http_) httpClose(http_);
}

IppMessage IppConnection::request(ipp_op_t operation) const {
  IppMessage message(ippNewRequest(operation), ippDelete);
  ippAddString(message.get(), IPP_TAG_OPERATION, IPP_TAG_URI, "printer-uri", nullptr, uri_.c_str());
  ippAddString(message.get(), IPP_TAG_OPERATION, IPP_TAG_NAME, "requesting-user-name", nullptr, cupsUser());
  return message;
}

IppConnection::Answer IppConnection::ask(IppMessage message, ByteView document) {
  check(cancelled_);
  silent_s_ = 0;
  const std::size_t length = ippLength(message.get()) + document.size();
  http_status_t sent = cupsSendRequest(http_, message.get(), resource_.c_str(), length);
  for (std::size_t at = 0; at < document.size() && sent == HTTP_STATUS_CONTINUE;) {
    check(cancelled_);
    silent_s_ = 0;
    const std::size_t part = std::min<std::size_t>(document.size() - at, 65536);
    sent = cupsWriteRequestData(http_, reinterpret_cast<const char*>(document.data() + at), part);
    at += part;
  }
  silent_s_ = 0;
  Answer answer;
  // A refusal in the middle of the document is in the response all the same.
  answer.message.reset(cupsGetResponse(http_, resource_.c_str()));
  check(cancelled_);
  if (!answer.message) {
    const http_status_t status = httpGetStatus(http_);
    if (status == HTTP_STATUS_UNAUTHORIZED || sent == HTTP_STATUS_UNAUTHORIZED || status == HTTP_STATUS_CUPS_AUTHORIZATION_CANCELED || status == HTTP_STATUS_FORBIDDEN)
      fail(name_ + " asks for a password: let it print without one, or add it to the system's printers and choose it there.");
    if (status == HTTP_STATUS_SERVICE_UNAVAILABLE) {
      answer.status = IPP_STATUS_ERROR_BUSY;
      answer.message.reset(ippNew());
      return answer;
    }
    if (status == HTTP_STATUS_NOT_FOUND) fail("There is no printer at " + uri_ + ": most have theirs at /ipp/print; register it anew.");
    if (silent_s_ >= answer_patience_s) fail(name_ + " was asked and stayed silent for 30 s: switch it off and on, and try again.");
    fail("The connection to " + name_ + " broke off (" + std::string(cupsLastErrorString()) + "): try again.");
  }
  answer.status = ippGetStatusCode(answer.message.get());
  if (ipp_attribute_t* text = ippFindAttribute(answer.message.get(), "status-message", IPP_TAG_ZERO))
    if (const char* words = ippGetString(text, 0, nullptr)) answer.text = words;
  if (answer.status == IPP_STATUS_ERROR_NOT_AUTHENTICATED || answer.status == IPP_STATUS_ERROR_NOT_AUTHORIZED || answer.status == IPP_STATUS_ERROR_FORBIDDEN)
    fail(name_ + " does not let us print" + (answer.text.empty() ? "" : " (\"" + answer.text + "\")") + ": allow it at the printer, or add it to the system's printers.");
  return answer;
}

}  // namespace formwright
