// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/print/print_media.h"

#include <cups/pwg.h>
#include <strings.h>

#include <algorithm>
#include <cmath>

#include "base/format.h"

namespace formwright {
namespace {

int integer_of(ipp_t* collection, const char* name) {
  ipp_attribute_t* attribute = ippFindAttribute(collection, name, IPP_TAG_INTEGER);
  return attribute ? std::clamp(ippGetInteger(attribute, 0), 0, 10'000'000) : 0;
}

std::string keyword_of(ipp_t* collection, const char* name) {
  ipp_attribute_t* attribute = ippFindAttribute(collection, name, IPP_TAG_ZERO);
  const char* text = attribute ? ippGetString(attribute, 0, nullptr) : nullptr;
  return text ? text : "";
}

void name_media(PrintMedia& media) {
  char name[128];
  if (const pwg_media_t* known = pwgMediaForSize(media.width_hmm, media.height_hmm)) {
    if (known->pwg) media.name = known->pwg;
    if (known->ppd) media.label = known->ppd;
  }
  if (media.name.empty() &&
      pwgFormatSizeName(name, sizeof name, "custom", nullptr, media.width_hmm, media.height_hmm, "mm") == 1)
    media.name = name;
  if (media.label.empty() || media.label.starts_with("Custom")) {
    media.label = with_digits(media.width_mm(), 6) + " x " + with_digits(media.height_mm(), 6) + " mm";
  }
}

/// One media-col, or width 0 for a range or nothing.
PrintMedia read_media_col(ipp_t* collection) {
  PrintMedia media;
  ipp_attribute_t* size = ippFindAttribute(collection, "media-size", IPP_TAG_BEGIN_COLLECTION);
  ipp_t* dimensions = size ? ippGetCollection(size, 0) : collection;
  media.width_hmm = integer_of(dimensions, "x-dimension");
  media.height_hmm = integer_of(dimensions, "y-dimension");
  media.left_hmm = integer_of(collection, "media-left-margin");
  media.right_hmm = integer_of(collection, "media-right-margin");
  media.top_hmm = integer_of(collection, "media-top-margin");
  media.bottom_hmm = integer_of(collection, "media-bottom-margin");
  const std::string source = keyword_of(collection, "media-source");
  media.by_hand = source == "manual" || source == "by-pass-tray";
  return media;
}

std::vector<PrintMedia> read_media_cols(ipp_t* attributes, const char* name) {
  std::vector<PrintMedia> result;
  ipp_attribute_t* list = ippFindAttribute(attributes, name, IPP_TAG_BEGIN_COLLECTION);
  const int count = list ? std::min(ippGetCount(list), 2000) : 0;
  for (int i = 0; i < count; ++i) {
    PrintMedia media = read_media_col(ippGetCollection(list, i));
    if (media.width_hmm <= 0 || media.height_hmm <= 0) continue;
    name_media(media);
    result.push_back(std::move(media));
  }
  return result;
}

int largest_of(ipp_t* attributes, const char* name) {
  ipp_attribute_t* list = ippFindAttribute(attributes, name, IPP_TAG_INTEGER);
  int largest = 0;
  for (int i = 0; list && i < ippGetCount(list); ++i) largest = std::max(largest, ippGetInteger(list, i));
  return largest;
}

bool same_size(const PrintMedia& a, const PrintMedia& b) {
  return std::abs(a.width_hmm - b.width_hmm) <= 50 && std::abs(a.height_hmm - b.height_hmm) <= 50;
}

bool same_margins(const PrintMedia& a, const PrintMedia& b) {
  return a.left_hmm == b.left_hmm && a.right_hmm == b.right_hmm && a.top_hmm == b.top_hmm &&
         a.bottom_hmm == b.bottom_hmm;
}

bool has_keyword(ipp_t* attributes, const char* name, const char* value) {
  ipp_attribute_t* list = ippFindAttribute(attributes, name, IPP_TAG_ZERO);
  return list && ippContainsString(list, value) == 1;
}

int margin_sum(const PrintMedia& m) { return m.left_hmm + m.right_hmm + m.top_hmm + m.bottom_hmm; }

}  // namespace

std::vector<PrintMedia> read_print_media(ipp_t* attributes) {
  std::vector<PrintMedia> all = read_media_cols(attributes, "media-col-database");
  const std::vector<PrintMedia> ready = read_media_cols(attributes, "media-col-ready");
  if (all.empty()) all = read_media_cols(attributes, "media-size-supported");
  if (all.empty()) {  // printers older than PWG 5100.3
    ipp_attribute_t* names = ippFindAttribute(attributes, "media-supported", IPP_TAG_ZERO);
    for (int i = 0; names && i < std::min(ippGetCount(names), 2000); ++i) {
      const char* name = ippGetString(names, i, nullptr);
      const pwg_media_t* known = name ? pwgMediaForPWG(name) : nullptr;
      if (!known || known->width <= 0 || known->length <= 0) continue;
      PrintMedia media;
      media.width_hmm = known->width;
      media.height_hmm = known->length;
      name_media(media);
      all.push_back(std::move(media));
    }
  }
  for (const PrintMedia& r : ready)
    if (std::none_of(all.begin(), all.end(),
                     [&](const PrintMedia& m) { return same_size(m, r) && same_margins(m, r); }))
      all.push_back(r);
  const bool knows_ready = !ready.empty();
  const bool feeds_by_hand = has_keyword(attributes, "media-source-supported", "manual") ||
                             has_keyword(attributes, "media-source-supported", "by-pass-tray");
  PrintMedia widest;
  widest.left_hmm = largest_of(attributes, "media-left-margin-supported");
  widest.right_hmm = largest_of(attributes, "media-right-margin-supported");
  widest.top_hmm = largest_of(attributes, "media-top-margin-supported");
  widest.bottom_hmm = largest_of(attributes, "media-bottom-margin-supported");
  const bool says_margins = ippFindAttribute(attributes, "media-col-database", IPP_TAG_BEGIN_COLLECTION) != nullptr;
  std::vector<PrintMedia> result;
  for (PrintMedia& m : all) {
    if (!says_margins && margin_sum(m) == 0) {
      m.left_hmm = widest.left_hmm, m.right_hmm = widest.right_hmm;
      m.top_hmm = widest.top_hmm, m.bottom_hmm = widest.bottom_hmm;
    }
    m.loaded =
        !knows_ready || std::any_of(ready.begin(), ready.end(), [&](const PrintMedia& r) { return same_size(r, m); });
    m.by_hand = m.by_hand || feeds_by_hand;
    const auto known = std::find_if(result.begin(), result.end(),
                                    [&](const PrintMedia& r) { return same_size(r, m) && same_margins(r, m); });
    if (known == result.end()) result.push_back(m);
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const PrintMedia& a, const PrintMedia& b) { return a.loaded > b.loaded; });
  return result;
}

const PrintMedia* find_print_media(const std::vector<PrintMedia>& media, const std::string& name) {
  const PrintMedia* best = nullptr;
  for (const PrintMedia& m : media) {
    if (::strcasecmp(m.name.c_str(), name.c_str()) != 0 && ::strcasecmp(m.label.c_str(), name.c_str()) != 0) continue;
    if (!best || (m.loaded && !best->loaded) || (m.loaded == best->loaded && margin_sum(m) > margin_sum(*best)))
      best = &m;
  }
  return best;
}

Json print_media_json(const PrintMedia& m) {
  return {{"name", m.name},
          {"label", m.label},
          {"width_mm", m.width_mm()},
          {"height_mm", m.height_mm()},
          {"margins_mm",
           {{"left", m.left_hmm / 100.0},
            {"right", m.right_hmm / 100.0},
            {"top", m.top_hmm / 100.0},
            {"bottom", m.bottom_hmm / 100.0}}},
          {"loaded", m.loaded},
          {"by_hand", m.by_hand}};
}

bool page_matches(const PrintMedia& media, const PageSize& page) {
  constexpr double tolerance_mm = 1;
  const auto near = [](double a, double b) { return std::abs(a - b) <= tolerance_mm; };
  return (near(page.width_mm, media.width_mm()) && near(page.height_mm, media.height_mm())) ||
         (near(page.width_mm, media.height_mm()) && near(page.height_mm, media.width_mm()));
}

}  // namespace formwright
