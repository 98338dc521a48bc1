// SPDX-License-Identifier: GPL-3.0-or-later
// One print: checked, validated, sent, followed to its end.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "base/error.h"
#include "base/format.h"
#include "machines/print/document_pages.h"
#include "machines/print/printer.h"
#include "system/machine_errors.h"

namespace formwright {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::minutes busy_patience{5}, print_patience{120};
constexpr std::chrono::milliseconds retry_pause{1500}, look_pause{700};
constexpr int max_failures = 8;

void pause_for(std::chrono::milliseconds time, const std::atomic<bool>& cancelled) {
  const auto end = Clock::now() + time;
  while (!cancelled && Clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  if (cancelled) throw Error(ErrorCode::cancelled, "", "Cancelled.");
}

std::string millimetres(const PageSize& size) {
  return with_decimals(size.width_mm, 1) + " x " + with_decimals(size.height_mm, 1) + " mm";
}

struct CheckedOrder {
  PrintMedia media;
  std::string media_type;
  int quality = IPP_QUALITY_NORMAL;
  bool feeds_by_hand = false, turned = false;
  Bytes mirrored;  // empty unless the order says so
  std::vector<std::string> notes;
};

const PrintMedia& chosen_media(const PrinterDescription& printer, const std::string& name,
                               const std::string& printer_name) {
  if (const PrintMedia* media = find_print_media(printer.media, name)) return *media;
  std::string list;
  for (const PrintMedia& m : printer.media)
    if (list.find(m.label) == std::string::npos && list.size() < 160) list += (list.empty() ? "" : ", ") + m.label;
  refuse("media", printer_name + " does not take " + name + ": choose one of " +
                      (list.empty() ? "those it is set to" : list) + ".");
}

/// The sheet that the pages were laid out for.
const PrintMedia& media_for(const PrinterDescription& printer, const PageSize& page, const std::string& printer_name) {
  for (const PrintMedia& m : printer.media)  // loaded ones first
    if (page_matches(m, page)) return *find_print_media(printer.media, m.name);
  refuse("media", printer_name + " has no sheet of " + millimetres(page) + ": lay the pages out for one that it has.");
}

/// What can be known before anything is sent.
CheckedOrder check_order(const PrinterDescription& printer, const PrintOrder& order, const std::string& name) {
  CheckedOrder checked;
  if (order.copies < 1 || order.copies > printer.max_copies)
    refuse("copies",
           name + " prints 1 to " + std::to_string(printer.max_copies) + " copies: choose a number of these.");
  if (order.quality == "draft") checked.quality = IPP_QUALITY_DRAFT;
  else if (order.quality == "high") checked.quality = IPP_QUALITY_HIGH;
  else if (order.quality != "normal") refuse("quality", "The quality must be draft, normal or high.");
  if (!printer.qualities.empty() &&
      std::find(printer.qualities.begin(), printer.qualities.end(), order.quality) == printer.qualities.end())
    refuse("quality", name + " has no quality called " + order.quality + ": choose " + printer.qualities.front() + ".");
  const DocumentPages document = read_document_pages(order.document);
  checked.media =
      order.media.empty() ? media_for(printer, document.pages.front(), name) : chosen_media(printer, order.media, name);
  checked.media_type = document.media_type;
  if (std::find(printer.formats.begin(), printer.formats.end(), document.media_type) == printer.formats.end())
    refuse("sha256", name + " does not take " + document.media_type +
                         ": add it to the system's printers, which convert, or send " +
                         (printer.formats.empty() ? "something else" : printer.formats.back()) + ".");
  for (const PageSize& page : document.pages) {
    const bool picture = document.media_type == "image/png";
    // A picture smaller than the sheet stays its own size; a page says which sheet it is meant for.
    const PageSize sheet{checked.media.width_mm(), checked.media.height_mm()};
    const bool fits = picture &&
                      std::min(page.width_mm, page.height_mm) <= std::min(sheet.width_mm, sheet.height_mm) + 1 &&
                      std::max(page.width_mm, page.height_mm) <= std::max(sheet.width_mm, sheet.height_mm) + 1;
    if (!fits && !page_matches(checked.media, page))
      refuse("media", "The document's page is " + millimetres(page) + ", the sheet " + checked.media.label + " is " +
                          millimetres(sheet) + ", and nothing is scaled: choose that sheet, or lay the pages out for " +
                          checked.media.label + ".");
  }
  const PageSize& first = document.pages.front();
  checked.turned = (first.width_mm > first.height_mm) != (checked.media.width_mm() > checked.media.height_mm()) &&
                   std::abs(first.width_mm - first.height_mm) > 1;
  if (!checked.media.loaded) {
    if (!checked.media.by_hand) {
      std::string loaded;
      for (const PrintMedia& m : printer.media)
        if (m.loaded && loaded.find(m.label) == std::string::npos) loaded += (loaded.empty() ? "" : ", ") + m.label;
      refuse("media", checked.media.label + " is not loaded in " + name +
                          (loaded.empty() ? "" : ", which has " + loaded) +
                          ": load it and tell the printer, or lay the pages out for what it has.");
    }
    checked.feeds_by_hand = true;
    checked.notes.push_back(checked.media.label + " is in no tray of " + name + ": put it into the manual feed.");
  }
  if (order.mirrored) {
    if (document.media_type != "application/pdf")
      refuse(
          "mirrored",
          "Only PDF files can be mirrored while printing: export the picture as PDF, or export it already mirrored.");
    checked.mirrored = mirrored_pdf(order.document);
  }
  if (!printer.scaling_can_be_off)
    checked.notes.push_back(name + " does not guarantee to print at true size: measure the first page.");
  return checked;
}

void add_job_attributes(ipp_t* request, const CheckedOrder& checked, const PrintOrder& order) {
  ippAddString(request, IPP_TAG_OPERATION, IPP_TAG_NAME, "job-name", nullptr, order.title.c_str());
  ippAddString(request, IPP_TAG_OPERATION, IPP_TAG_MIMETYPE, "document-format", nullptr, checked.media_type.c_str());
  ippAddInteger(request, IPP_TAG_JOB, IPP_TAG_INTEGER, "copies", order.copies);
  ipp_t* size = ippNew();
  ippAddInteger(size, IPP_TAG_ZERO, IPP_TAG_INTEGER, "x-dimension", checked.media.width_hmm);
  ippAddInteger(size, IPP_TAG_ZERO, IPP_TAG_INTEGER, "y-dimension", checked.media.height_hmm);
  ipp_t* media = ippNew();
  ippAddCollection(media, IPP_TAG_ZERO, "media-size", size);
  ippDelete(size);
  ippAddInteger(media, IPP_TAG_ZERO, IPP_TAG_INTEGER, "media-left-margin", checked.media.left_hmm);
  ippAddInteger(media, IPP_TAG_ZERO, IPP_TAG_INTEGER, "media-right-margin", checked.media.right_hmm);
  ippAddInteger(media, IPP_TAG_ZERO, IPP_TAG_INTEGER, "media-top-margin", checked.media.top_hmm);
  ippAddInteger(media, IPP_TAG_ZERO, IPP_TAG_INTEGER, "media-bottom-margin", checked.media.bottom_hmm);
  if (checked.feeds_by_hand) ippAddString(media, IPP_TAG_ZERO, IPP_TAG_KEYWORD, "media-source", nullptr, "manual");
  ippAddCollection(request, IPP_TAG_JOB, "media-col", media);
  ippDelete(media);
  if (checked.turned) ippAddInteger(request, IPP_TAG_JOB, IPP_TAG_ENUM, "orientation-requested", IPP_ORIENT_LANDSCAPE);
  ippAddInteger(request, IPP_TAG_JOB, IPP_TAG_ENUM, "print-quality", checked.quality);
  ippAddString(request, IPP_TAG_JOB, IPP_TAG_KEYWORD, "print-scaling", nullptr, "none");
}

[[noreturn]] void fail_refused(const IppConnection::Answer& answer, const std::string& name, const PrintMedia& media) {
  const std::string words = answer.text.empty() ? ippErrorString(answer.status) : answer.text;
  if (answer.status == IPP_STATUS_ERROR_DOCUMENT_FORMAT_NOT_SUPPORTED)
    fail_at_machine(name + " does not take this kind of document (\"" + words +
                    "\"): add it to the system's printers, which convert.");
  if (answer.status == IPP_STATUS_ERROR_NOT_ACCEPTING_JOBS)
    fail_at_machine(name + " takes no jobs now (\"" + words +
                    "\"): switch it on, or resume it in the system's printers.");
  if (answer.status == IPP_STATUS_ERROR_ATTRIBUTES_OR_VALUES)
    fail_at_machine(name + " refuses " + media.label + " or one of the other settings (\"" + words +
                    "\"): choose another sheet, quality or number of copies.");
  fail_at_machine(name + " refused the job: \"" + words + "\". Fix this at the printer, and print again.");
}

/// A printer that would take another sheet instead says so in the group of unsupported attributes.
void check_media_kept(const IppConnection::Answer& answer, const std::string& name, const PrintMedia& media) {
  for (ipp_attribute_t* a = ippFirstAttribute(answer.message.get()); a; a = ippNextAttribute(answer.message.get()))
    if (ippGetGroupTag(a) == IPP_TAG_UNSUPPORTED_GROUP && ippGetName(a) &&
        std::string(ippGetName(a)).starts_with("media"))
      fail_at_machine(name + " would take another sheet than " + media.label + ": choose one that it has, or load " +
                      media.label + ".");
}

/// Asks until the printer is no longer busy.
template <class MakeRequest>
IppConnection::Answer ask_patiently(const PrinterAddress& address, const MakeRequest& make, ByteView document,
                                    const std::atomic<bool>& cancelled, const PrintProgress& progress) {
  const auto end = Clock::now() + busy_patience;
  for (;;) {
    {
      IppConnection connection(address, cancelled);
      auto answer = connection.ask(make(connection), document);
      if (!answer.busy()) return answer;
    }
    if (Clock::now() > end)
      fail_at_machine(address.name + " has been busy for 5 minutes: try again when its other jobs are done.");
    progress("waiting", address.name + " is busy; asking again.");
    pause_for(retry_pause, cancelled);
  }
}

void take_back(const PrinterAddress& address, int job_id) {
  const std::atomic<bool> go_on{false};
  try {
    IppConnection connection(address, go_on);
    IppMessage request = connection.request(IPP_OP_CANCEL_JOB);
    ippAddInteger(request.get(), IPP_TAG_OPERATION, IPP_TAG_INTEGER, "job-id", job_id);
    connection.ask(std::move(request));
  } catch (const Error&) {
    // The printer is gone, and the job with it or not: the sentence of the cancel stands.
  }
}

std::string reasons_of(ipp_t* message) {
  std::string sentence;
  ipp_attribute_t* list = ippFindAttribute(message, "job-state-reasons", IPP_TAG_ZERO);
  for (int i = 0; list && i < ippGetCount(list); ++i) {
    const std::string reason = ippGetString(list, i, nullptr) ? ippGetString(list, i, nullptr) : "none";
    if (reason == "none" || reason.starts_with("job-printing") || reason.starts_with("job-completed") ||
        reason == "processing-to-stop-point")
      continue;
    sentence += (sentence.empty() ? "" : ", ") + printer_reason_sentence(reason);
  }
  return sentence;
}

int sheets_of(ipp_t* message) {
  for (const char* name : {"job-impressions-completed", "job-media-sheets-completed"})
    if (ipp_attribute_t* count = ippFindAttribute(message, name, IPP_TAG_INTEGER))
      return std::max(0, ippGetInteger(count, 0));
  return 0;
}

int follow(const PrinterAddress& address, int job_id, const std::atomic<bool>& cancelled,
           const PrintProgress& progress) {
  const auto end = Clock::now() + print_patience;
  int failures = 0, sheets = 0;
  for (;;) {
    pause_for(look_pause, cancelled);
    if (Clock::now() > end)
      fail_at_machine(
          address.name +
          " has had the job for two hours and is not done: look at the printer; the job is not followed any longer.");
    IppConnection::Answer answer;
    try {
      IppConnection connection(address, cancelled);
      IppMessage request = connection.request(IPP_OP_GET_JOB_ATTRIBUTES);
      ippAddInteger(request.get(), IPP_TAG_OPERATION, IPP_TAG_INTEGER, "job-id", job_id);
      answer = connection.ask(std::move(request));
    } catch (const Error& error) {
      // Small printers drop a question now and then: only a silence that lasts is an error.
      if (error.code() == ErrorCode::cancelled || ++failures >= max_failures) throw;
      continue;
    }
    if (answer.busy()) continue;
    if (answer.status == IPP_STATUS_ERROR_NOT_FOUND || answer.status == IPP_STATUS_ERROR_GONE)
      fail_at_machine(address.name +
                      " no longer knows the job: see whether its sheets came out before printing again.");
    ipp_attribute_t* state = answer.ok() ? ippFindAttribute(answer.message.get(), "job-state", IPP_TAG_ENUM) : nullptr;
    if (!state) {
      if (++failures >= max_failures)
        fail_at_machine(address.name + " does not report the progress of the job: check whether it prints.");
      continue;
    }
    failures = 0;
    sheets = std::max(sheets, sheets_of(answer.message.get()));
    const std::string reasons = reasons_of(answer.message.get());
    switch (ippGetInteger(state, 0)) {
      case IPP_JSTATE_COMPLETED: return sheets;
      case IPP_JSTATE_CANCELED:
        fail_at_machine("The job was cancelled at " + address.name + (reasons.empty() ? "" : ": " + reasons) +
                        ". Print again when it is ready.");
      case IPP_JSTATE_ABORTED:
        fail_at_machine(address.name + " cancelled the job" + (reasons.empty() ? "" : ": " + reasons) +
                        ". Fix this at the printer, and print again.");
      case IPP_JSTATE_STOPPED:
      case IPP_JSTATE_HELD:
        progress("waiting", address.name + " stopped" + (reasons.empty() ? "" : ": " + reasons) +
                                ". It continues when that is fixed.");
        break;
      default:
        progress("printing", "Printing" + (sheets > 0 ? ", sheet " + std::to_string(sheets) : "") +
                                 (reasons.empty() ? "" : "; " + reasons) + ".");
    }
  }
}

}  // namespace

int follow_print(const PrinterAddress& address, int job_id, const std::atomic<bool>& cancelled,
                 const PrintProgress& progress) {
  try {
    return follow(address, job_id, cancelled, progress);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) take_back(address, job_id);
    throw;
  }
}

PrintResult print_document(const PrinterAddress& address, const PrintOrder& order, const std::atomic<bool>& cancelled,
                           const PrintProgress& progress, const std::function<void(const PrintResult&)>& taken) {
  progress("waiting", "Asking " + address.name + " what it can print.");
  const PrinterDescription printer = describe_printer(address, cancelled);
  const CheckedOrder checked = check_order(printer, order, address.name);
  if (!printer.accepting)
    fail_at_machine(address.name + " takes no jobs now: switch it on, or resume it in the system's printers.");
  const ByteView document = checked.mirrored.empty() ? order.document : ByteView(checked.mirrored);
  const auto make = [&](ipp_op_t operation) {
    return [&, operation](const IppConnection& connection) {
      IppMessage request = connection.request(operation);
      add_job_attributes(request.get(), checked, order);
      return request;
    };
  };
  auto answer = ask_patiently(address, make(IPP_OP_VALIDATE_JOB), {}, cancelled, progress);
  if (!answer.ok() && answer.status != IPP_STATUS_ERROR_OPERATION_NOT_SUPPORTED)
    fail_refused(answer, address.name, checked.media);
  check_media_kept(answer, address.name, checked.media);
  progress("sending", "Sending the document to " + address.name + ".");
  answer = ask_patiently(address, make(IPP_OP_PRINT_JOB), document, cancelled, progress);
  if (!answer.ok()) fail_refused(answer, address.name, checked.media);
  ipp_attribute_t* id = ippFindAttribute(answer.message.get(), "job-id", IPP_TAG_INTEGER);
  if (!id) fail_at_machine(address.name + " received the document but did not confirm it: check whether it prints.");
  PrintResult result{ippGetInteger(id, 0), 0, checked.notes};
  progress("printing", checked.notes.empty() ? "Printing." : checked.notes.front());
  if (taken) taken(result);
  result.sheets = follow_print(address, result.job_id, cancelled, progress);
  return result;
}

}  // namespace formwright
