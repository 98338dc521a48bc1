// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/context.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <vector>

#include "base/error.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinULP;

TEST_CASE("Context.NestedSpansMapToTheWholeAndNeverFall") {
  std::vector<Progress> messages;
  Context context(Host{[&](const Progress& p) { messages.push_back(p); }, {}, {}});
  context.progress(0, "A");
  {
    const auto outer = context.span(0.5, 1.0, "B");
    {
      const auto inner = context.span(0.0, 0.5, "C");
      context.progress(1.0, "D");  // 0.5 + 0.5 * 0.5
    }
    context.progress(0.1, "E");  // 0.55, but 0.75 was said already
  }
  context.progress(1.0, "F");
  REQUIRE(messages.size() >= 5u);
  double last = 0;
  for (const Progress& message : messages) {
    CHECK(message.fraction >= last);
    last = message.fraction;
    if (message.stage == "D" || message.stage == "E") {
      CHECK_THAT(message.fraction, WithinULP(0.75, 4));
    }
  }
  CHECK_THAT(last, WithinULP(1.0, 4));
}

TEST_CASE("Context.ThrottlesWithinAStage") {
  int messages = 0;
  Context context(Host{[&](const Progress&) { ++messages; }, {}, {}});
  for (int i = 0; i <= 10000; ++i) context.progress(i / 10000.0, "Counting");
  CHECK(messages < 100);
}

TEST_CASE("Context.CancelThrowsFromProgressAndCheck") {
  bool cancel = false;
  Context context(Host{{}, [&] { return cancel; }, {}});
  CHECK_NOTHROW(context.check_cancelled());
  cancel = true;
  try {
    context.progress(0.5, "Late");
    FAIL("cancel went unnoticed");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::cancelled);
  }
}

}  // namespace
}  // namespace formwright
