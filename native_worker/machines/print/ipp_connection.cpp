// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/print/ipp_connection.h"

#include <algorithm>
#include <utility>

#include "base/error.h"

namespace formwright {
namespace {

constexpr int printer_connect_patience_ms = 10'000;
constexpr double answer_patience_s = 30,
                 look_up_s = 0.5;  // how long it may be silent; how often a cancel is looked for

/// libcups asks on the terminal unless this forbids it: a worker has nobody to ask.
const char* no_password(const char*, http_t*, const char*, const char*, void*) { return nullptr; }

/// libcups has no words for some mishaps, and says so with a null.
std::string last_words() {
  const char* words = cupsLastErrorString();
  return words ? words : "no answer";
}

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
  const bool wanted = connection.may_have_job_ || !connection.cancelled_;
  return wanted && connection.silent_s_ < answer_patience_s ? 1 : 0;
}

IppConnection::IppConnection(const PrinterAddress& address, const std::atomic<bool>& cancelled)
    : name_(address.name), uri_(address.uri), cancelled_(cancelled) {
  check(cancelled_);
  cupsSetPasswordCB2(no_password, nullptr);
  if (address.destination) connect_to_destination(*address.destination);
  const bool found_encrypted = address.destination && uri_.starts_with("ipps:");
  try {
    if (!http_) connect_to_uri();
  } catch (const Error&) {
    if (!found_encrypted || cancelled_) throw;
    // Printers that announce encryption and cannot do it are common; nobody vouches for the certificates of the others
    // either.
    uri_.erase(3, 1);
    connect_to_uri();
  }
  httpSetTimeout(http_, look_up_s, still_wanted, this);
}

void IppConnection::connect_to_destination(const cups_dest_t& destination) {
  // A copy: connecting writes into it, and others may be connecting as well.
  cups_dest_t* copy = nullptr;
  if (cupsCopyDest(const_cast<cups_dest_t*>(&destination), 0, &copy) != 1)
    fail("There is not enough memory to connect to " + name_ + ": close another program.");
  const std::unique_ptr<cups_dest_t, void (*)(cups_dest_t*)> owned(copy, [](cups_dest_t* d) { cupsFreeDests(1, d); });
  const auto option = [&](const char* name) {
    const char* value = cupsGetOption(name, copy->num_options, copy->options);
    return std::string(value ? value : "");
  };
  char resource[1024] = "";
  // A destination with a queue is reached through the print service; one found on the network is spoken to itself.
  const std::string queue = option("printer-uri-supported");
  http_ = cupsConnectDest(copy, queue.empty() ? CUPS_DEST_FLAGS_DEVICE : CUPS_DEST_FLAGS_NONE,
                          printer_connect_patience_ms, nullptr, resource, sizeof resource, nullptr, nullptr);
  if (!http_) fail(name_ + " cannot be reached: see whether it is switched on and on the network, and try again.");
  resource_ = resource;
  uri_ = queue;
  if (!queue.empty()) return;
  // Connecting has found out its address, which is then as good as a registered one.
  uri_ = option("device-uri");
  if (!uri_.starts_with("ipp"))
    fail(name_ + " does not support IPP, as its network entry says: add it to the system's printers.");
  httpClose(std::exchange(http_, nullptr));
}

void IppConnection::connect_to_uri() {
  char scheme[32] = "", user[256] = "", host[256] = "", resource[1024] = "";
  int port = 0;
  if (httpSeparateURI(HTTP_URI_CODING_ALL, uri_.c_str(), scheme, sizeof scheme, user, sizeof user, host, sizeof host,
                      &port, resource, sizeof resource) < HTTP_URI_STATUS_OK)
    fail("The address " + uri_ + " of " + name_ +
         " is not one: register it anew, such as ipp://192.168.1.20/ipp/print.");
  resource_ = resource;
  const http_encryption_t encryption =
      std::string(scheme) == "ipps" ? HTTP_ENCRYPTION_ALWAYS : HTTP_ENCRYPTION_IF_REQUESTED;
  http_ = httpConnect2(host, port, nullptr, AF_UNSPEC, encryption, 1, printer_connect_patience_ms, nullptr);
  if (http_) return;
  const std::string reason = last_words();
  fail(name_ + " does not answer at " + uri_ + (reason.empty() ? "" : " (" + reason + ")") +
       ": see whether it is switched on and its address is right.");
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

http_status_t IppConnection::send(ipp_t* message, ByteView document) {
  may_have_job_ = false;
  check(cancelled_);
  silent_s_ = 0;
  const std::size_t length = ippLength(message) + document.size();
  http_status_t sent = cupsSendRequest(http_, message, resource_.c_str(), length);
  for (std::size_t at = 0; at < document.size() && sent == HTTP_STATUS_CONTINUE;) {
    check(cancelled_);
    silent_s_ = 0;
    const std::size_t part = std::min<std::size_t>(document.size() - at, 65536);
    sent = cupsWriteRequestData(http_, reinterpret_cast<const char*>(document.data() + at), part);
    at += part;
  }
  return sent;
}

void IppConnection::fail_unanswered(http_status_t sent, http_status_t status) const {
  if (cancelled_ && may_have_job_ && status < HTTP_STATUS_BAD_REQUEST)
    throw Error(ErrorCode::cancelled, "",
                "Cancelled, but " + name_ +
                    " has received the whole document and does not confirm: check whether its sheets come out.");
  if (status == HTTP_STATUS_UNAUTHORIZED || sent == HTTP_STATUS_UNAUTHORIZED ||
      status == HTTP_STATUS_CUPS_AUTHORIZATION_CANCELED || status == HTTP_STATUS_FORBIDDEN)
    fail(name_ +
         " asks for a password: let it print without one, or add it to the system's printers and choose it there.");
  if (status == HTTP_STATUS_NOT_FOUND)
    fail("There is no printer at " + uri_ + ": most have theirs at /ipp/print; register it anew.");
  if (silent_s_ >= answer_patience_s) fail(name_ + " did not answer for 30 s: switch it off and on, and try again.");
  fail("The connection to " + name_ + " broke off (" + last_words() + "): try again.");
}

IppConnection::Answer IppConnection::ask(IppMessage message, ByteView document) {
  const http_status_t sent = send(message.get(), document);
  silent_s_ = 0;
  // OK: the printer was so quick that the end of the document met its answer.
  may_have_job_ = !document.empty() && (sent == HTTP_STATUS_CONTINUE || sent == HTTP_STATUS_OK);
  Answer answer;
  // A refusal in the middle of the document is in the response all the same.
  answer.message.reset(cupsGetResponse(http_, resource_.c_str()));
  if (!may_have_job_) check(cancelled_);
  if (!answer.message) {
    const http_status_t status = httpGetStatus(http_);
    if (status != HTTP_STATUS_SERVICE_UNAVAILABLE) fail_unanswered(sent, status);
    check(cancelled_);
    answer.status = IPP_STATUS_ERROR_BUSY;
    answer.message.reset(ippNew());
    return answer;
  }
  answer.status = ippGetStatusCode(answer.message.get());
  if (!answer.ok()) check(cancelled_);  // it refused, and made no job
  if (ipp_attribute_t* text = ippFindAttribute(answer.message.get(), "status-message", IPP_TAG_ZERO))
    if (const char* words = ippGetString(text, 0, nullptr)) answer.text = words;
  if (answer.status == IPP_STATUS_ERROR_NOT_AUTHENTICATED || answer.status == IPP_STATUS_ERROR_NOT_AUTHORIZED ||
      answer.status == IPP_STATUS_ERROR_FORBIDDEN)
    fail(name_ + " does not allow printing" + (answer.text.empty() ? "" : " (\"" + answer.text + "\")") +
         ": allow it at the printer, or add it to the system's printers.");
  return answer;
}

}  // namespace formwright
