// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Printing at true size over IPP: what the printer takes is read first, the job is validated, sent with
// print-scaling=none and the exact sheet, and followed to its end. Blocks: never on the server's thread.
#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "base/data/json.h"
#include "machines/print/ipp_connection.h"
#include "machines/print/print_media.h"

namespace formwright {

struct PrinterDescription {
  std::string model, state;          // state: idle, printing or stopped
  std::vector<std::string> reasons;  // printer-state-reasons, without "none"
  std::string state_message;
  bool accepting = true;
  std::vector<PrintMedia> media;
  std::vector<std::string> formats, qualities;  // media types; of draft, normal, high
  int max_copies = 1;
  bool colour = false, scaling_can_be_off = false;
};

/// What the answer to Get-Printer-Attributes says; what it leaves out is as in the struct.
PrinterDescription read_printer_description(ipp_t* attributes);

/// Throws as IppConnection does, and Error{could_not_solve, "machine"} for what is no printer.
PrinterDescription describe_printer(const PrinterAddress& address, const std::atomic<bool>& cancelled);

Json printer_json(const PrinterDescription& description);

struct PrintOrder {
  ByteView document;
  std::string title = "Formwright";
  std::string media;  // of the printer's own, "A4" or "iso_a4_210x297mm"; empty: the one that the first page fits
  int copies = 1;
  std::string quality = "normal";  // draft, normal or high
  bool mirrored = false;           // PDF only
};

/// `state`: waiting (the printer is busy), sending or printing; `sentence`: for a person.
using PrintProgress = std::function<void(const std::string& state, const std::string& sentence)>;

struct PrintResult {
  int job_id = 0, sheets = 0;
  std::vector<std::string> notes;  // sentences a person should read: fed by hand, scaling not promised
};

/// Returns when the printer says it is done. Refuses before anything is sent: Error{invalid_input} with where media,
/// copies, quality, mirrored or sha256. Error{could_not_solve, "machine"}: the printer refused, stopped or vanished.
/// Error{cancelled}: the job was taken back at the printer as well. Once the document is out, that needs the printer's
/// answer, for which a cancel waits up to 30 s; where none comes, the sentence says that sheets may come out. `taken`:
/// the printer has the document, and what number it gave it.
PrintResult print_document(const PrinterAddress& address, const PrintOrder& order, const std::atomic<bool>& cancelled,
                           const PrintProgress& progress, const std::function<void(const PrintResult&)>& taken = {});

/// The rest of it, of a job that a printer has: the sheets that came out. Throws alike.
int follow_print(const PrinterAddress& address, int job_id, const std::atomic<bool>& cancelled,
                 const PrintProgress& progress);

/// The sentence of one printer-state-reason or job-state-reason (RFC 8011, 5.4.12; PWG 5100.9): "media-empty" -> "it is
/// out of paper".
std::string printer_reason_sentence(const std::string& reason);

}  // namespace formwright
