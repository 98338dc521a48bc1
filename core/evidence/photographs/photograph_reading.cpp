// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/photographs/photograph_reading.h"

#include <algorithm>
#include <set>

#include "base/error.h"
#include "base/index.h"
#include "base/sha256.h"
#include "imaging/picture/picture_reader.h"

namespace formwright {
namespace {

struct MarkOwner {
  int strip = -1;  // -1: the sheet
  int mark = 0;
};

std::map<int, MarkOwner> owners_of(const MarkSheet& sheet) {
  std::map<int, MarkOwner> owners;
  for (std::size_t i = 0; i < sheet.marks.size(); ++i) owners[sheet.marks[i].number] = {-1, static_cast<int>(i)};
  for (std::size_t k = 0; k < 4; ++k)
    for (std::size_t i = 0; i < sheet.strips[k].marks.size(); ++i)
      owners[sheet.strips[k].marks[i].number] = {static_cast<int>(k), static_cast<int>(i)};
  return owners;
}

ReadPhotograph read_one(const Photograph& photograph, const std::map<int, MarkOwner>& owners, const Context& context) {
  ReadPhotograph read;
  read.input = photograph.input;
  read.file_name = photograph.file_name;
  SeenMarks seen;
  {
    LightPicture light;
    {
      const Image image = read_picture(photograph.bytes, photograph.file_name, photograph.input);
      context.check_cancelled();
      light = light_picture(image, context);
    }
    read.width = light.width;
    read.height = light.height;
    seen = find_coded_marks(light, context);
  }
  read.cut_short = seen.cut_short;
  for (const SeenMark& mark : seen.marks) {
    const auto owner = owners.find(mark.number);
    if (owner == owners.end()) ++read.foreign;
    else if (owner->second.strip < 0) read.sheet.push_back({owner->second.mark, mark.corners});
    else read.board.push_back({owner->second.strip, owner->second.mark, mark.corners});
  }
  for (const int number : seen.mirrored)
    if (const auto owner = owners.find(number); owner != owners.end())
      ++(owner->second.strip < 0 ? read.mirrored_sheet : read.mirrored_board);
  for (const int number : seen.blurred)
    if (const auto owner = owners.find(number); owner != owners.end() && owner->second.strip < 0)
      read.unclear.push_back(owner->second.mark);
  return read;
}

[[noreturn]] void refuse_photographs(const std::string& where, const std::string& message) {
  throw Error(ErrorCode::invalid_input, where, message);
}

void check_marks(const std::vector<ReadPhotograph>& read) {
  std::size_t sheet = 0, board = 0;
  int foreign = 0, mirrored_sheet = 0, mirrored_board = 0;
  for (const ReadPhotograph& r : read) {
    sheet += r.sheet.size();
    board += r.board.size();
    foreign += r.foreign;
    mirrored_sheet += r.mirrored_sheet;
    mirrored_board += r.mirrored_board;
  }
  const std::string names = read.size() == 1 ? read[0].file_name : read[0].file_name + " and the others";
  if (static_cast<std::size_t>(mirrored_board) > board)
    refuse_photographs("photograph",
                       "The marks in " + names +
                           " are mirrored, left and right exchanged: give the photographs as the camera took them.");
  if (static_cast<std::size_t>(mirrored_sheet) > sheet)
    refuse_photographs(
        "photograph",
        "The marks on the sheet are mirrored, left and right exchanged, in " + names +
            ": print the pattern with “mirror” switched the other way, or mirror the print before it goes onto the sheet.");
  if (static_cast<std::size_t>(foreign) > sheet + board)
    refuse_photographs(
        "pattern",
        "Most marks in " + names +
            " do not belong to this pattern.json: give the one that was written with the print on this sheet.");
  if (sheet + board == 0)
    refuse_photographs(
        "photograph",
        "No coded marks were found in " + names +
            ": photograph the printed sheet with its strips, sharp, in even light, and fill the picture with it.");
}

}  // namespace

std::vector<ReadPhotograph> read_photographs(std::span<const Photograph> photographs, const MarkSheet& sheet,
                                             std::vector<std::string>& notes, Context& context) {
  if (photographs.size() < 2)
    refuse_photographs("photograph", "One photograph shows no depth: give two or more, taken from different sides.");
  const std::map<int, MarkOwner> owners = owners_of(sheet);
  std::vector<ReadPhotograph> read;
  std::set<std::string> known;
  for (std::size_t i = 0; i < photographs.size(); ++i) {
    const Photograph& photograph = photographs[i];
    context.progress(static_cast<double>(i) / static_cast<double>(photographs.size()),
                     "Finding marks in photograph " + std::to_string(i + 1));
    if (!known.insert(sha256_hex(photograph.bytes)).second) {
      notes.push_back(photograph.file_name + " was given twice and counts once.");
      continue;
    }
    read.push_back(read_one(photograph, owners, context));
    if (read.back().cut_short)
      notes.push_back(
          photograph.file_name +
          " has a busy background, of which not every outline was looked at: fill the picture with the sheet.");
  }
  if (read.size() < 2)
    refuse_photographs("photograph",
                       "The same photograph was given several times: give two or more, taken from different sides.");
  check_marks(read);
  return read;
}

}  // namespace formwright
