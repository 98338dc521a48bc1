// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/print/document_pages.h"

#include <cups/raster.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <qpdf/Buffer.hh>
#include <qpdf/Pl_Flate.hh>
#include <qpdf/QPDF.hh>
#include <qpdf/QPDFPageDocumentHelper.hh>
#include <qpdf/QPDFPageObjectHelper.hh>
#include <qpdf/QPDFWriter.hh>

#include "base/error.h"
#include "base/read_budget.h"

namespace formwright {
namespace {

constexpr double mm_per_point = 25.4 / 72;
constexpr std::size_t max_pages = 500;
constexpr double max_mm = 20'000;

[[noreturn]] void refuse_document(const std::string& sentence) {
  throw Error(ErrorCode::invalid_input, "sha256", sentence);
}

PageSize checked(PageSize size) {
  if (!(size.width_mm >= 1 && size.width_mm <= max_mm && size.height_mm >= 1 && size.height_mm <= max_mm))
    refuse_document(
        "A page of the document is smaller than 1 mm or larger than 20 m: export it again with its size in millimetres.");
  return size;
}

std::uint32_t big_endian(ByteView bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | std::to_integer<std::uint32_t>(bytes[at + i]);
  return value;
}

/// PNG (ISO 15948): width and height in IHDR, pixels per metre in pHYs, which stands before the first IDAT.
DocumentPages read_png(ByteView png) {
  std::uint32_t width = 0, height = 0;
  for (std::size_t at = 8; at + 12 <= png.size();) {
    const std::size_t length = big_endian(png, at);
    const std::string_view name = as_text(png.subspan(at + 4, 4));
    if (length > png.size() - at - 12) break;
    if (name == "IHDR" && length >= 8) {
      width = big_endian(png, at + 8);
      height = big_endian(png, at + 12);
    } else if (name == "pHYs" && length >= 9 && width > 0 && png[at + 16] == std::byte{1}) {
      const double x_per_m = big_endian(png, at + 8), y_per_m = big_endian(png, at + 12);
      if (x_per_m > 0 && y_per_m > 0)
        return {"image/png", {checked({1000 * width / x_per_m, 1000 * height / y_per_m})}};
    } else if (name == "IDAT") {
      break;
    }
    at += length + 12;
  }
  refuse_document(
      "The PNG does not say how many pixels there are to a metre, so its true size is unknown: save it with a density, "
      "or print a PDF.");
}

/// The first page's header (PWG 5102.4, 4.3) only: the pages behind it would have to be unpacked to find them, and
/// printers take one size per job. Not by libcups, which first sets aside as many bytes as the header claims a line to
/// have, up to 4 GB.
DocumentPages read_pwg_raster(ByteView raster) {
  if (raster.size() < 4 + sizeof(cups_page_header2_t))
    refuse_document("The PWG raster cannot be read: export it again.");
  const bool low_end_first = as_text(raster).starts_with("2SaR");
  const auto number = [&](std::size_t offset) {
    const std::uint32_t value = big_endian(raster, 4 + offset);
    return low_end_first ? __builtin_bswap32(value) : value;
  };
  const std::size_t resolution = offsetof(cups_page_header2_t, HWResolution);
  const double across = number(resolution), down = number(resolution + 4);
  if (across == 0 || down == 0) refuse_document("The PWG raster cannot be read: export it again.");
  return {"image/pwg-raster",
          {checked({25.4 * number(offsetof(cups_page_header2_t, cupsWidth)) / across,
                    25.4 * number(offsetof(cups_page_header2_t, cupsHeight)) / down})}};
}

struct Box {
  double x0, y0, x1, y1;
};

Box crop_box(QPDFPageObjectHelper& page) {
  QPDFObjectHandle box = page.getCropBox();
  if (!box.isRectangle()) refuse_document("A page of the PDF does not state its size: export the PDF again.");
  const auto r = box.getArrayAsRectangle();
  const Box found{std::min(r.llx, r.urx), std::min(r.lly, r.ury), std::max(r.llx, r.urx), std::max(r.lly, r.ury)};
  if (!std::isfinite(found.x0 + found.y0 + found.x1 + found.y1))
    refuse_document("A page of the PDF does not state its size: export the PDF again.");
  return found;
}

/// Takes what is unpacked and keeps nothing of it.
class CountingPipeline final : public Pipeline {
 public:
  explicit CountingPipeline(ReadBudget& budget) : Pipeline("count", nullptr), budget_(budget) {}
  void write(const unsigned char*, std::size_t size) override {
    if (!budget_.take(size))
      refuse_document("The PDF is far larger when unpacked than a file of its size should be: export it again.");
  }
  void finish() override {}

 private:
  ReadBudget& budget_;
};

/// A dictionary with its #41 written as A (ISO 32000-1, 7.3.5).
std::string plain_names(std::string_view dictionary) {
  std::string plain;
  for (std::size_t i = 0; i < dictionary.size(); ++i) {
    unsigned code = 0;
    const char* const digits = dictionary.data() + i + 1;
    if (dictionary[i] == '#' && i + 2 < dictionary.size() &&
        std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2) {
      plain += static_cast<char>(code);
      i += 2;
    } else {
      plain += dictionary[i];
    }
  }
  return plain;
}

/// qpdf unpacks object streams and cross-reference streams (ISO 32000-1, 7.5.7 and 7.5.8) whole, without a limit; all
/// other streams stay packed here. So what these unpack to is counted before. Streams of
/// an encrypted PDF cannot be unpacked here and are not counted.
void check_unpacked_size(ByteView document) {
  const std::string_view text = as_text(document);
  ReadBudget budget(document.size());
  std::size_t dictionary_at = 0;
  constexpr std::string_view keyword = "stream";
  for (std::size_t at = text.find(keyword); at != std::string_view::npos; at = text.find(keyword, at)) {
    const std::string_view before = text.substr(dictionary_at, at - dictionary_at);
    dictionary_at = at += keyword.size();
    if (before.ends_with("end")) continue;
    const std::size_t object = before.rfind("obj");
    const std::string dictionary = plain_names(before.substr(object == std::string_view::npos ? 0 : object));
    const auto has = [&](std::string_view name) { return dictionary.find(name) != std::string::npos; };
    if ((!has("/ObjStm") && !has("/XRef")) || !has("/Filter")) continue;
    const std::size_t flate = dictionary.find("/Fl");
    if (flate == std::string::npos || dictionary.find("/Fl", flate + 1) != std::string::npos || has("/LZW") ||
        has("/RunLength"))
      refuse_document("The PDF is compressed in an unusual way: export it again.");
    if (text.substr(at).starts_with("\r\n")) at += 2;
    else if (text.substr(at).starts_with('\n')) ++at;
    CountingPipeline count(budget);
    Pl_Flate inflate("inflate", &count, Pl_Flate::a_inflate);
    try {
      inflate.write(reinterpret_cast<const unsigned char*>(text.data()) + at, text.size() - at);
    } catch (const Error&) {
      throw;
    } catch (const std::exception&) {
      // Damaged from here on, as qpdf will find, or no stream at all.
    }
  }
}

void open_pdf(QPDF& pdf, ByteView document) {
  check_unpacked_size(document);
  pdf.setSuppressWarnings(true);
  pdf.setAttemptRecovery(true);
  pdf.processMemoryFile("document", reinterpret_cast<const char*>(document.data()), document.size());
}

double number_or(QPDFObjectHandle value, double otherwise) {
  return value.isNumber() ? value.getNumericValue() : otherwise;
}

DocumentPages read_pdf(ByteView document) {
  DocumentPages result{"application/pdf", {}};
  try {
    QPDF pdf;
    open_pdf(pdf, document);
    for (QPDFPageObjectHelper page : QPDFPageDocumentHelper(pdf).getAllPages()) {
      if (result.pages.size() >= max_pages) refuse_document("The PDF has more than 500 pages: print it in parts.");
      const Box box = crop_box(page);
      const double unit = number_or(page.getAttribute("/UserUnit", false), 1);
      PageSize size{(box.x1 - box.x0) * unit * mm_per_point, (box.y1 - box.y0) * unit * mm_per_point};
      if (std::fmod(std::abs(number_or(page.getAttribute("/Rotate", false), 0)), 180) == 90)
        std::swap(size.width_mm, size.height_mm);
      result.pages.push_back(checked(size));
    }
  } catch (const Error&) {
    throw;
  } catch (const std::exception&) {
    refuse_document("The PDF cannot be read, or is locked by a password: export it again without one.");
  }
  if (result.pages.empty()) refuse_document("The PDF has no pages: export it again.");
  return result;
}

}  // namespace

DocumentPages read_document_pages(ByteView document) {
  const std::string_view text = as_text(document);
  if (text.starts_with("%PDF-")) return read_pdf(document);
  if (text.starts_with("\x89PNG\r\n\x1a\n")) return read_png(document);
  if (text.starts_with("RaS2") || text.starts_with("2SaR")) return read_pwg_raster(document);
  refuse_document("Only PDF, PNG and PWG raster can be printed: export the plan as PDF.");
}

Bytes mirrored_pdf(ByteView document) {
  try {
    QPDF pdf;
    open_pdf(pdf, document);
    for (QPDFPageObjectHelper page : QPDFPageDocumentHelper(pdf).getAllPages()) {
      const Box box = crop_box(page);
      // The crop box's own axis in the page's unturned frame: a page that is shown on its side is mirrored left to
      // right as it is shown.
      const bool on_its_side = std::fmod(std::abs(number_or(page.getAttribute("/Rotate", false), 0)), 180) == 90;
      char matrix[160];
      if (on_its_side) std::snprintf(matrix, sizeof matrix, "q 1 0 0 -1 0 %.6f cm\n", box.y0 + box.y1);
      else std::snprintf(matrix, sizeof matrix, "q -1 0 0 1 %.6f 0 cm\n", box.x0 + box.x1);
      page.addPageContents(pdf.newStream(std::string(matrix)), true);
      page.addPageContents(pdf.newStream("\nQ\n"), false);
    }
    QPDFWriter writer(pdf);
    writer.setOutputMemory();
    writer.setDeterministicID(true);
    writer.write();
    const auto buffer = writer.getBufferSharedPointer();
    const auto* begin = reinterpret_cast<const std::byte*>(buffer->getBuffer());
    return {begin, begin + buffer->getSize()};
  } catch (const Error&) {
    throw;
  } catch (const std::exception&) {
    throw Error(ErrorCode::invalid_input, "mirrored",
                "The PDF cannot be read, so it cannot be mirrored: export it again.");
  }
}

}  // namespace formwright
