// SPDX-License-Identifier: GPL-3.0-or-later
#include "imaging/drawing/pdf.h"

#include <hpdf.h>

#include <array>
#include <vector>

#include "base/error.h"

namespace formwright {
namespace {

constexpr double points_per_mm = 72 / 25.4;
constexpr double capital_height = 0.718;  // of Helvetica, in its size

HPDF_REAL points(double mm) { return static_cast<HPDF_REAL>(mm * points_per_mm); }

/// libharu is C: it hands its errors to this and goes on; finish() looks at the first.
void remember(HPDF_STATUS error, HPDF_STATUS, void* first) {
  auto& kept = *static_cast<HPDF_STATUS*>(first);
  if (kept == 0) kept = error;
}

}  // namespace

struct PdfDocument::Implementation {
  HPDF_STATUS first_error = 0;
  HPDF_Doc document = nullptr;
  HPDF_Page page = nullptr;
  HPDF_Font font = nullptr;
  std::vector<HPDF_Image> pictures;
  std::vector<std::array<int, 2>> sizes;

  Implementation() : document(HPDF_New(remember, &first_error)) {
    if (document == nullptr) throw std::bad_alloc();
  }
  ~Implementation() { HPDF_Free(document); }
  Implementation(const Implementation&) = delete;

  void clip(const Vec2& lower, const Vec2& upper) const {
    HPDF_Page_Rectangle(page, points(lower.x()), points(lower.y()), points(upper.x() - lower.x()),
                        points(upper.y() - lower.y()));
    HPDF_Page_Clip(page);
    HPDF_Page_EndPath(page);
  }
};

PdfDocument::PdfDocument(const std::string& title) : implementation_(std::make_unique<Implementation>()) {
  HPDF_SetCompressionMode(implementation_->document, HPDF_COMP_ALL);
  HPDF_SetInfoAttr(implementation_->document, HPDF_INFO_TITLE, title.c_str());
  HPDF_SetInfoAttr(implementation_->document, HPDF_INFO_CREATOR, "Formwright");
  // Readers must not fit true-size pages to the paper.
  HPDF_SetViewerPreference(implementation_->document, HPDF_PRINT_SCALING_NONE);
  implementation_->font = HPDF_GetFont(implementation_->document, "Helvetica", nullptr);
}
PdfDocument::~PdfDocument() = default;
PdfDocument::PdfDocument(PdfDocument&&) noexcept = default;
PdfDocument& PdfDocument::operator=(PdfDocument&&) noexcept = default;

int PdfDocument::add_picture(const Image& image) {
  std::vector<HPDF_BYTE> rgb(3 * image.pixels.size());
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) rgb[3 * i + k] = image.pixels[i][k];
  implementation_->pictures.push_back(
      HPDF_LoadRawImageFromMem(implementation_->document, rgb.data(), static_cast<HPDF_UINT>(image.width),
                               static_cast<HPDF_UINT>(image.height), HPDF_CS_DEVICE_RGB, 8));
  implementation_->sizes.push_back({image.width, image.height});
  return static_cast<int>(implementation_->pictures.size()) - 1;
}

void PdfDocument::add_page(double width_mm, double height_mm) {
  implementation_->page = HPDF_AddPage(implementation_->document);
  HPDF_Page_SetWidth(implementation_->page, points(width_mm));
  HPDF_Page_SetHeight(implementation_->page, points(height_mm));
}

void PdfDocument::add_page(const Vec2& size_mm, const Vec2& scale, const Vec2& middle_mm) {
  add_page(size_mm.x(), size_mm.y());
  const Vec2 shift = size_mm / 2 - scale.cwiseProduct(middle_mm);
  HPDF_Page_Concat(implementation_->page, static_cast<HPDF_REAL>(scale.x()), 0, 0, static_cast<HPDF_REAL>(scale.y()),
                   points(shift.x()), points(shift.y()));
}

void PdfDocument::show_picture(int picture, double pixel_mm, const PagePlacement& placement, const Vec2& clip_lower_mm,
                               const Vec2& clip_upper_mm) {
  const auto i = static_cast<std::size_t>(picture);
  const HPDF_Image image = implementation_->pictures.at(i);
  const HPDF_Page page = implementation_->page;
  if (image == nullptr || page == nullptr) return;  // first_error has the reason
  const double width_mm = implementation_->sizes[i][0] * pixel_mm, height_mm = implementation_->sizes[i][1] * pixel_mm;
  const Vec2 corner = placement(Vec2(-width_mm / 2, -height_mm / 2));
  HPDF_Page_GSave(page);
  implementation_->clip(clip_lower_mm, clip_upper_mm);
  HPDF_Page_Concat(page, placement.mirrored ? -points(width_mm) : points(width_mm), 0, 0, points(height_mm),
                   points(corner.x()), points(corner.y()));
  HPDF_Page_ExecuteXObject(page, image);
  HPDF_Page_GRestore(page);
}

void PdfDocument::draw(const Drawing& drawing, const PagePlacement& placement, const Vec2& clip_lower_mm,
                       const Vec2& clip_upper_mm) {
  const HPDF_Page page = implementation_->page;
  if (page == nullptr) return;
  HPDF_Page_GSave(page);
  implementation_->clip(clip_lower_mm, clip_upper_mm);
  const HPDF_UINT16 dash[] = {static_cast<HPDF_UINT16>(points(dash_mm))};
  for (const Stroke& stroke : drawing.strokes) {
    const Vec2 from = placement(stroke.from), to = placement(stroke.to);
    HPDF_Page_SetLineWidth(page, points(stroke.width_mm));
    HPDF_Page_SetDash(page, stroke.dashed ? dash : nullptr, stroke.dashed ? 1 : 0, 0);
    HPDF_Page_MoveTo(page, points(from.x()), points(from.y()));
    HPDF_Page_LineTo(page, points(to.x()), points(to.y()));
    HPDF_Page_Stroke(page);
  }
  if (!drawing.labels.empty() && implementation_->font != nullptr) {
    HPDF_Page_BeginText(page);
    for (const Label& label : drawing.labels) {
      const double size = label.height_mm / capital_height * points_per_mm;
      HPDF_Page_SetFontAndSize(page, implementation_->font, static_cast<HPDF_REAL>(size));
      const double width_mm = static_cast<double>(HPDF_Page_TextWidth(page, label.text.c_str())) / points_per_mm;
      const Vec2 at = placement(label.centre - Vec2(width_mm / 2, label.height_mm / 2));
      HPDF_Page_SetTextMatrix(page, placement.mirrored ? -1 : 1, 0, 0, 1, points(at.x()), points(at.y()));
      HPDF_Page_ShowText(page, label.text.c_str());
    }
    HPDF_Page_EndText(page);
  }
  HPDF_Page_GRestore(page);
}

double PdfDocument::text_width_mm(const std::string& words, double height_mm) const {
  if (implementation_->font == nullptr) return 0;
  // In thousandths of the font's size.
  const HPDF_TextWidth width = HPDF_Font_TextWidth(
      implementation_->font, reinterpret_cast<const HPDF_BYTE*>(words.c_str()), static_cast<HPDF_UINT>(words.size()));
  return static_cast<double>(width.width) / 1000 * height_mm / capital_height;
}

Bytes PdfDocument::finish() {
  Implementation& pdf = *implementation_;
  HPDF_SaveToStream(pdf.document);
  if (pdf.first_error == 0) {
    HPDF_UINT32 size = HPDF_GetStreamSize(pdf.document);
    Bytes bytes(size);
    HPDF_ResetStream(pdf.document);
    HPDF_ReadFromStream(pdf.document, reinterpret_cast<HPDF_BYTE*>(bytes.data()), &size);
    if (pdf.first_error == 0 && size == bytes.size()) return bytes;
  }
  throw Error(ErrorCode::could_not_solve, "print.pdf",
              "The pages could not be written (libharu says " + std::to_string(pdf.first_error) +
                  "): choose fewer dots per inch or a smaller paper.");
}

}  // namespace formwright
