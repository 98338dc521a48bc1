// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers as squares, the sheet and the board that carry them, and pattern.json.
#include <bit>
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>
#include <set>

#include "base/context.h"
#include "base/error.h"
#include "evidence/photographs/mark_sheet.h"

namespace formwright {
namespace {

TEST_CASE("MarkCode.NumbersDifferFromEachOtherHoweverTheyAreTurned") {
  for (int a = 0; a < mark_numbers; ++a) {
    std::uint64_t turned = mark_bits(a);
    for (int k = 0; k < 4; ++k) {
      for (int b = k == 0 ? a + 1 : a; b < mark_numbers; ++b)
        if (std::popcount(turned ^ mark_bits(b)) < mark_distance) FAIL(a << " and " << b << " turned " << k);
      turned = turned_bits(turned);
    }
    REQUIRE(turned == mark_bits(a));
  }
}

TEST_CASE("MarkCode.ANumberIsReadTurnedAndWithThreeWrongCells") {
  for (const int number : {0, 17, 421, mark_numbers - 1}) {
    std::uint64_t bits = mark_bits(number);
    for (int k = 0; k < 4; ++k) {
      const auto read = read_code(bits ^ 0x100000011ull);
      REQUIRE(read);
      CHECK(read->number == number);
      CHECK(read->quarter_turns == k);
      CHECK(read->wrong_cells == 3);
      bits = turned_bits(bits);
    }
    CHECK_FALSE(read_code(mirrored_bits(mark_bits(number))));
    CHECK(mirrored_bits(mirrored_bits(bits)) == bits);
  }
}

TEST_CASE("MarkSheet.IsTheSameAfterItsFile") {
  const MarkSheet sheet = make_mark_sheet({});
  const MarkSheet again = read_mark_sheet(to_bytes(mark_sheet_json(sheet).dump()));
  CHECK(mark_sheet_json(again) == mark_sheet_json(sheet));
  std::set<int> numbers;
  for (const PlacedMark& m : sheet.marks) numbers.insert(m.number);
  for (const BoardStrip& s : sheet.strips)
    for (const PlacedMark& m : s.marks) {
      numbers.insert(m.number);
      // Strips lie around the opening, not in it.
      CHECK((s.machine_mm(m.centre_mm).cwiseAbs() - 0.5 * sheet.opening_mm).maxCoeff() > 0);
    }
  std::size_t all = sheet.marks.size();
  for (const BoardStrip& s : sheet.strips) all += s.marks.size();
  CHECK(numbers.size() == all);
  MarkSheetPlan other;
  other.seed = 2;
  CHECK(make_mark_sheet(other).marks[0].number != sheet.marks[0].number);
  CHECK(write_board_pdf(sheet, 150, Context()).size() > 5000);
}

TEST_CASE("MarkSheet.WrongPlansAndFilesAreRefusedWithAFix") {
  using Catch::Matchers::ContainsSubstring;
  MarkSheetPlan plan;
  plan.mark_pitch_mm = 10;
  CHECK_THROWS_WITH(make_mark_sheet(plan), ContainsSubstring("1.25 times"));
  plan = {};
  plan.mark_mm = 3;
  plan.mark_pitch_mm = 4;
  CHECK_THROWS_WITH(make_mark_sheet(plan), ContainsSubstring("1000 different marks"));
  plan = {};
  plan.margin_mm = 100;
  CHECK_THROWS_WITH(make_mark_sheet(plan), ContainsSubstring("no room"));
  const auto refused = [](const Json& json) { read_mark_sheet(to_bytes(json.dump())); };
  CHECK_THROWS_WITH(refused({{"a", 1}}), ContainsSubstring("not a pattern.json"));
  CHECK_THROWS_WITH(refused({{"format", "formwright calibration pattern 1"}}), ContainsSubstring("no coded marks"));
  Json json = mark_sheet_json(make_mark_sheet({}));
  for (const char* key : {"marks", "strips", "sheet_mm", "mark_mm", "board_check_mm"}) {
    Json without = json;
    without.erase(key);
    CHECK_THROWS_AS(refused(without), Error);
  }
  json["marks"][1][0] = json["marks"][0][0];
  CHECK_THROWS_WITH(refused(json), ContainsSubstring("same number"));
}

}  // namespace
}  // namespace formwright
