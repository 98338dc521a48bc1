// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/print/printer.h"

#include <algorithm>
#include <array>

namespace formwright {
namespace {

std::vector<std::string> strings_of(ipp_t* message, const char* name) {
  std::vector<std::string> result;
  ipp_attribute_t* list = ippFindAttribute(message, name, IPP_TAG_ZERO);
  for (int i = 0; list && i < ippGetCount(list); ++i)
    if (const char* text = ippGetString(list, i, nullptr)) result.emplace_back(text);
  return result;
}

std::string string_of(ipp_t* message, const char* name) {
  const auto all = strings_of(message, name);
  return all.empty() ? "" : all.front();
}

}  // namespace

std::string printer_reason_sentence(const std::string& reason) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 20> known{{
      {"media-needed", "it waits for its paper to be put in"},
      {"media-empty", "it is out of paper"},
      {"media-low", "its paper runs out"},
      {"media-jam", "paper is stuck in it"},
      {"cover-open", "its cover is open"},
      {"door-open", "a door is open"},
      {"input-tray-missing", "a paper tray is missing"},
      {"output-area-full", "its output tray is full"},
      {"output-tray-missing", "its output tray is missing"},
      {"marker-supply-empty", "its ink is empty"},
      {"marker-supply-low", "its ink runs out"},
      {"toner-empty", "its toner is empty"},
      {"toner-low", "its toner runs out"},
      {"paused", "it was paused"},
      {"shutdown", "it is switched off"},
      {"offline", "it is off the network"},
      {"connecting-to-device", "it is being connected to"},
      {"spool-area-full", "its memory is full"},
      {"document-format-error", "it could not read the document"},
      {"document-unprintable-error", "it could not print the document"},
  }};
  // A reason may end in how grave it is.
  std::string plain = reason;
  for (const std::string_view ending : {"-report", "-warning", "-error"})
    if (plain.ends_with(ending) && !plain.starts_with("document-")) plain.resize(plain.size() - ending.size());
  for (const auto& [name, sentence] : known)
    if (name == plain) return std::string(sentence);
  return "it says \"" + reason + "\"";
}

PrinterDescription read_printer_description(ipp_t* message) {
  PrinterDescription result;
  result.model = string_of(message, "printer-make-and-model");
  ipp_attribute_t* state = ippFindAttribute(message, "printer-state", IPP_TAG_ENUM);
  result.state = !state                                             ? "unknown"
                 : ippGetInteger(state, 0) == IPP_PSTATE_STOPPED    ? "stopped"
                 : ippGetInteger(state, 0) == IPP_PSTATE_PROCESSING ? "printing"
                                                                    : "idle";
  result.reasons = strings_of(message, "printer-state-reasons");
  std::erase(result.reasons, "none");
  result.state_message = string_of(message, "printer-state-message");
  if (ipp_attribute_t* accepting = ippFindAttribute(message, "printer-is-accepting-jobs", IPP_TAG_BOOLEAN))
    result.accepting = ippGetBoolean(accepting, 0) != 0;
  result.media = read_print_media(message);
  result.formats = strings_of(message, "document-format-supported");
  ipp_attribute_t* quality = ippFindAttribute(message, "print-quality-supported", IPP_TAG_ENUM);
  for (const auto& [value, name] :
       {std::pair{IPP_QUALITY_DRAFT, "draft"}, {IPP_QUALITY_NORMAL, "normal"}, {IPP_QUALITY_HIGH, "high"}})
    if (quality && ippContainsInteger(quality, value)) result.qualities.emplace_back(name);
  int upper = 1;
  if (ipp_attribute_t* copies = ippFindAttribute(message, "copies-supported", IPP_TAG_RANGE))
    ippGetRange(copies, 0, &upper);
  result.max_copies = std::clamp(upper, 1, 9999);
  if (ipp_attribute_t* colour = ippFindAttribute(message, "color-supported", IPP_TAG_BOOLEAN))
    result.colour = ippGetBoolean(colour, 0) != 0;
  const auto scaling = strings_of(message, "print-scaling-supported");
  result.scaling_can_be_off = std::find(scaling.begin(), scaling.end(), "none") != scaling.end();
  return result;
}

Json printer_json(const PrinterDescription& d) {
  Json media = Json::array(), reasons = Json::array();
  for (const PrintMedia& m : d.media) media.push_back(print_media_json(m));
  for (const std::string& reason : d.reasons) reasons.push_back(printer_reason_sentence(reason));
  return {{"model", d.model},
          {"state", d.state},
          {"state_message", d.state_message},
          {"reasons", reasons},
          {"accepting", d.accepting},
          {"formats", d.formats},
          {"qualities", d.qualities},
          {"max_copies", d.max_copies},
          {"colour", d.colour},
          {"scaling_can_be_off", d.scaling_can_be_off},
          {"media", media}};
}

}  // namespace formwright
