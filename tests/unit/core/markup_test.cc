#include "core/markup.h"

#include <gtest/gtest.h>

namespace innermap {
namespace {

TEST(Markup, IsEscapedAndValid) {
  EXPECT_EQ(markupText("a<b> & \"c\""), "a&lt;b&gt; &amp; &quot;c&quot;");
  EXPECT_EQ(markupText("K\xc3\xbche\n"), "K\xc3\xbche ");
  EXPECT_EQ(markupText("\xff\xc3"), "??");       // no UTF-8
  EXPECT_EQ(markupText("\xed\xa0\x80"), "???");  // a surrogate
  EXPECT_EQ(markupText("\xc0\xaf"), "??");       // too long
  EXPECT_EQ(markupText("\xef\xbf\xbf"), "???");  // no character of XML
}

}  // namespace
}  // namespace innermap
