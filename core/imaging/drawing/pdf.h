// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Pages of exact size, with pictures, lines and words at exact places: PDF written by libharu.
#include <memory>
#include <string>

#include "base/bytes.h"
#include "imaging/drawing/drawing.h"
#include "imaging/picture/image.h"

namespace formwright {

/// Where the origin of a drawing lies on the page, in mm from its lower left corner; mirrored: x runs to the left.
struct PagePlacement {
  Vec2 origin_mm{0, 0};
  bool mirrored = false;

  Vec2 operator()(const Vec2& p) const { return origin_mm + Vec2(mirrored ? -p.x() : p.x(), p.y()); }
};

inline constexpr double longest_pdf_page_mm = 5080;  // 14400 points

/// Numbers in the file have 5 decimals of a point (1/72 inch), and pages are at most 5.08 m long.
class PdfDocument {
 public:
  explicit PdfDocument(const std::string& title);
  ~PdfDocument();
  PdfDocument(PdfDocument&&) noexcept;
  PdfDocument& operator=(PdfDocument&&) noexcept;

  /// Stored once, however often it is shown; loss-free, sRGB; transparency is dropped. Returns its number.
  int add_picture(const Image& image);

  /// Everything that follows goes onto this page.
  void add_page(double width_mm, double height_mm);
  /// The same, drawn `scale` times as large along x and y: what is drawn at `middle_mm` lies in the middle of the page.
  void add_page(const Vec2& size_mm, const Vec2& scale, const Vec2& middle_mm);

  /// The whole picture with its middle at the placement's origin and pixels of `pixel_mm`, cut to the page's rectangle
  /// from `clip_lower_mm` to `clip_upper_mm`.
  void show_picture(int picture, double pixel_mm, const PagePlacement& placement, const Vec2& clip_lower_mm,
                    const Vec2& clip_upper_mm);

  /// The drawing in black, words in Helvetica, cut to the same kind of rectangle.
  void draw(const Drawing& drawing, const PagePlacement& placement, const Vec2& clip_lower_mm,
            const Vec2& clip_upper_mm);

  /// How wide a line of words is that is drawn with capitals of this height.
  double text_width_mm(const std::string& words, double height_mm) const;

  /// The file. Throws Error{could_not_solve} when libharu has refused any of the above: a page longer than 5.08 m, no
  /// memory.
  Bytes finish();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace formwright
