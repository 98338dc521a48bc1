// SPDX-License-Identifier: GPL-3.0-or-later
#include "imaging/flow/page_flow.h"

#include <sstream>

namespace formwright {
namespace {

// Heights of capitals and what follows below a line, in mm.
constexpr double heading_mm = 4.2, text_mm = 2.6, line_gap_mm = 2.2, paragraph_gap_mm = 1.6, before_heading_mm = 5;

}  // namespace

PageFlow::PageFlow(PdfDocument& pdf, const Vec2& paper_mm, double margin_mm)
    : pdf_(pdf), paper_mm_(paper_mm), margin_mm_(margin_mm), y_mm_(paper_mm.y() - margin_mm) {}

void PageFlow::heading(const std::string& words) {
  // Never alone at the foot of a page.
  constexpr double with_company_mm = before_heading_mm + heading_mm + 30;
  if (y_mm_ - with_company_mm < margin_mm_ + foot_mm) end_page(), ++pages_;
  if (y_mm_ < paper_mm_.y() - margin_mm_) y_mm_ -= before_heading_mm;
  line(words, heading_mm, 0);
  y_mm_ -= paragraph_gap_mm;
}

void PageFlow::paragraph(const std::string& words, double indent_mm) {
  std::istringstream list(words);
  std::string text, word;
  while (list >> word) {
    const std::string longer = text.empty() ? word : text + " " + word;
    if (!text.empty() && pdf_.text_width_mm(longer, text_mm) > width_mm() - indent_mm) {
      line(text, text_mm, indent_mm);
      text = word;
    } else {
      text = longer;
    }
  }
  if (!text.empty()) line(text, text_mm, indent_mm);
  y_mm_ -= paragraph_gap_mm;
}

Vec2 PageFlow::room(double height_mm) {
  if (y_mm_ - height_mm < margin_mm_ + foot_mm && y_mm_ < paper_mm_.y() - margin_mm_) end_page(), ++pages_;
  y_mm_ -= height_mm;
  return {margin_mm_, y_mm_};
}

int PageFlow::finish() {
  end_page();
  return pages_;
}

void PageFlow::line(const std::string& words, double height_mm, double indent_mm) {
  const Vec2 corner = room(height_mm + line_gap_mm);
  drawing_.label(corner + Vec2(indent_mm + pdf_.text_width_mm(words, height_mm) / 2, line_gap_mm + height_mm / 2),
                 height_mm, words);
}

void PageFlow::end_page() {
  drawing_.label(Vec2(paper_mm_.x() / 2, margin_mm_ + text_mm / 2), text_mm, std::to_string(pages_));
  pdf_.add_page(paper_mm_.x(), paper_mm_.y());
  pdf_.draw(drawing_, {}, Vec2::Zero(), paper_mm_);
  drawing_ = {};
  y_mm_ = paper_mm_.y() - margin_mm_;
}

}  // namespace formwright
