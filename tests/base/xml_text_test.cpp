// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/data/xml_text.h"

#include <catch2/catch_test_macros.hpp>

namespace formwright {

TEST_CASE("XmlText.MarkupBecomesText") {
  CHECK(xml_text("a < b && c > \"d\"") == "a &lt; b &amp;&amp; c &gt; \"d\"");
  CHECK(xml_attribute("\"&lt;\"") == "&quot;&amp;lt;&quot;");
  CHECK(xml_text("Möbel, 5 mm").compare("Möbel, 5 mm") == 0);
  CHECK(xml_attribute("").empty());
}

}  // namespace formwright
