// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How large the pages of a document are, so that a print that would be scaled or cut is refused before paper is spent.
#include <string>
#include <vector>

#include "base/bytes.h"

namespace formwright {

struct PageSize {
  double width_mm = 0, height_mm = 0;
};

struct DocumentPages {
  std::string media_type;       // application/pdf, image/png or image/pwg-raster, as the first bytes say
  std::vector<PageSize> pages;  // at least one; a PNG is one page as large as its pixel density says
};

/// Reads PDF (the size of each page as it is shown: its crop box, turned as it says), PNG (pHYs) and PWG raster (page
/// header). Throws Error{invalid_input, "sha256"} for anything else, a broken or locked PDF, and a PNG that does not
/// say its pixels per metre.
DocumentPages read_document_pages(ByteView document);

/// The same PDF with every page's picture mirrored left to right within its crop box: for transfer prints seen from
/// behind. Throws Error{invalid_input, "mirrored"} when the PDF cannot be read.
Bytes mirrored_pdf(ByteView document);

}  // namespace formwright
