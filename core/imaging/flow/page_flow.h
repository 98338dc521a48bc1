// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Instructions on paper: headings, wrapped words and room for pictures, one below the other, over as many pages as it
// takes.
#include <string>

#include "imaging/drawing/pdf.h"

namespace formwright {

/// Upright pages of one size with a margin all around, numbered at the foot. Words are plain ASCII. All sizes in mm.
class PageFlow {
 public:
  /// `pdf` must outlive this; pages are added to it.
  PageFlow(PdfDocument& pdf, const Vec2& paper_mm, double margin_mm);

  void heading(const std::string& words);

  /// Broken where a line is full; a word that is longer than a line stands out of it.
  void paragraph(const std::string& words, double indent_mm = 0);

  /// Free room over the pages' whole width, on a new page where this one has not enough; at most a page high. Returns
  /// its lower left corner on the page, to draw there.
  Vec2 room(double height_mm);

  double width_mm() const { return paper_mm_.x() - 2 * margin_mm_; }
  double height_mm() const { return paper_mm_.y() - 2 * margin_mm_ - foot_mm; }

  /// What is added to it is drawn on the page where room was last given.
  Drawing& drawing() { return drawing_; }

  /// Ends the last page; nothing may follow. Returns how many there are.
  int finish();

 private:
  static constexpr double foot_mm = 8;

  void line(const std::string& words, double height_mm, double indent_mm);
  void end_page();

  PdfDocument& pdf_;
  Vec2 paper_mm_;
  double margin_mm_;
  double y_mm_;  // down to which the page is full
  Drawing drawing_;
  int pages_ = 1;
};

}  // namespace formwright
