// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>

#include "formats/shared/colour.h"
#include "formats/obj/obj.h"
#include "formats/shared/text_scan.h"

namespace formwright {
namespace {

/// File name of a map statement: what is left after its options, spaces and all.
std::string map_name(TextScan scan) {
  constexpr std::array<std::string_view, 8> one_word{"-blendu", "-blendv", "-cc",     "-clamp",
                                                     "-bm",     "-boost",  "-texres", "-imfchan"};
  while (true) {
    scan.skip_blanks();
    TextScan ahead = scan;
    const std::string_view option = ahead.word();
    int words = 0;
    if (std::ranges::find(one_word, option) != one_word.end()) words = 1;
    else if (option == "-mm") words = 2;
    else if (option == "-o" || option == "-s" || option == "-t") {
      // One to three numbers.
      for (TextScan number = ahead; words < 3; ++words) {
        number.skip_blanks();
        double value = 0;
        if (!number.number(value) || !(number.done() || is_blank(*number.at))) break;
      }
    } else {
      return clean_text(trimmed(scan.rest()), 1000);
    }
    while (words-- > 0) ahead.word();
    scan = ahead;
  }
}

}  // namespace

std::vector<MtlMaterial> read_mtl(const MeshSource& source) {
  const std::string_view text = source.text();
  if (text.substr(0, 4096).find('\0') != std::string_view::npos)
    source.refuse("it is not a text file, as a material library must be.");
  std::vector<MtlMaterial> materials;
  bool has_colour = false;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t start = at;
    const std::size_t stop = std::min(text.find_first_of("\r\n", at), text.size());
    at = stop + 1;
    TextScan scan(trimmed(text.substr(start, stop - start)));
    const std::string_view keyword = scan.word();
    if (keyword == "newmtl") {
      materials.emplace_back().material.name = clean_text(trimmed(scan.rest()));
      has_colour = false;
    } else if (materials.empty()) {
      continue;
    } else if (keyword == "Kd") {
      Vec3 colour = Vec3::Zero();
      int count = 0;
      for (; count < 3; ++count) {
        scan.skip_blanks();
        if (scan.done() || !scan.number(colour[count])) break;
        if (!std::isfinite(colour[count]))
          source.refuse_line(start, "a colour is not a finite number; correct the line.");
      }
      if (count == 0) {
        const std::string_view kind = scan.word();
        if (kind == "spectral" || kind == "xyz") continue;  // not colours one could show without a light's spectrum
        source.refuse_line(start, "Kd needs three numbers: red, green and blue; correct the line.");
      }
      for (; count < 3; ++count) colour[count] = colour[count - 1];  // "Kd 0.5" is grey
      materials.back().material.diffuse = colour.unaryExpr(&linear_of_srgb);
      has_colour = true;
    } else if (equal_ignoring_case(keyword, "map_Kd")) {
      materials.back().texture = map_name(scan);
      // A texture is multiplied with the colour: without one it counts as it is.
      if (!has_colour) materials.back().material.diffuse = Vec3::Ones();
    }
  }
  return materials;
}

}  // namespace formwright
