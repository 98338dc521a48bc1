// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The sheets a printer says it takes: IPP media-col-database (PWG 5100.3 and 5100.7, hundredths of a millimetre).
#include <cups/cups.h>

#include <string>
#include <vector>

#include "base/data/json.h"
#include "machines/print/document_pages.h"

namespace formwright {

struct PrintMedia {
  std::string name;                                              // PWG 5101.1: iso_a4_210x297mm
  std::string label;                                             // for a person: A4
  int width_hmm = 0, height_hmm = 0;                             // hundredths of a millimetre, as IPP counts
  int left_hmm = 0, right_hmm = 0, top_hmm = 0, bottom_hmm = 0;  // where it cannot print
  bool loaded = false;                                           // in a tray now, by what the printer says
  bool by_hand = false;                                          // may be fed by hand
  double width_mm() const { return width_hmm / 100.0; }
  double height_mm() const { return height_hmm / 100.0; }
};

/// What the answer to Get-Printer-Attributes says: media-col-database, else media-size-supported, else media-supported.
/// One entry a size and margins, loaded ones first. Sizes that are ranges (a roll) are left out.
std::vector<PrintMedia> read_print_media(ipp_t* attributes);

/// The entry called `name` ("A4" or "iso_a4_210x297mm", upper or lower case), preferring the loaded and, among those,
/// the widest margins, which every tray keeps. nullptr when there is none.
const PrintMedia* find_print_media(const std::vector<PrintMedia>& media, const std::string& name);

Json print_media_json(const PrintMedia& media);

/// True when a page lies on the sheet as it is, upright or turned, to within 1 mm (points are whole numbers in many
/// PDFs).
bool page_matches(const PrintMedia& media, const PageSize& page);

}  // namespace formwright
