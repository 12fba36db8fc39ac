// Texts with a byte order mark become UTF-8 without one; anything else stays as it is.
#include "base/text_encoding.h"

#include <gtest/gtest.h>

#include <string>

namespace argil {
namespace {

using std::string_literals::operator""s;

// RFC 2781, section 5, and RFC 3629, section 7.
TEST(TextEncoding, Utf16BecomesUtf8) {
  EXPECT_EQ(to_utf8("\xFE\xFF\xD8\x08\xDF\x45\x00\x3D\x00\x52\x00\x61"s), "\xF0\x92\x8D\x85=Ra");
  EXPECT_EQ(to_utf8("\xFF\xFE\x08\xD8\x45\xDF\x3D\x00\x52\x00\x61\x00"s), "\xF0\x92\x8D\x85=Ra");
  EXPECT_EQ(to_utf8("\xFE\xFF\x00\x41\x22\x62\x03\x91\x00\x2E"s), "A\xE2\x89\xA2\xCE\x91.");
  EXPECT_EQ(to_utf8("\xFE\xFF"s), "");
  EXPECT_EQ(to_utf8("\xFF\xFE\xFF\xDB\xFF\xDF\xFF\xFF"s),
            "\xF4\x8F\xBF\xBF\xEF\xBF\xBF");  // the last of each length
}

TEST(TextEncoding, AMarkOfUtf8IsLeftOut) {
  EXPECT_EQ(to_utf8("\xEF\xBB\xBFv 0"s), "v 0");
  EXPECT_EQ(to_utf8("v \xEF\xBB\xBF"s), "v \xEF\xBB\xBF");
}

TEST(TextEncoding, WhatIsNoTextStays) {
  for (const std::string& bytes :
       {"\xFF\xFE\x00\x00"s, "\xFF\xFE\x41"s, "\xFE\xFF\xDC\x00"s, "\xFE\xFF\xD8\x00"s,
        "\xFE\xFF\xD8\x00\x00\x41"s, "\xEF\xBB\xBF\x00"s, "\xFF"s, ""s, "\0"s})
    EXPECT_EQ(to_utf8(bytes), bytes);
}

TEST(TextEncoding, Utf16WithoutAMarkIsKnownByItsZeros) {
  EXPECT_TRUE(looks_like_utf16("v\0 \0001\0"s));
  EXPECT_TRUE(looks_like_utf16("\0v\0 \0001\0"s));      // cut
  EXPECT_TRUE(looks_like_utf16("\xFF\xFEv\0 \0001"s));  // a mark, but cut
  std::string wide;
  for (int i = 0; i < 32; ++i) wide += "a\0"s;
  EXPECT_TRUE(looks_like_utf16(wide + "\xB1\x03"s));  // behind the head any letter may stand
  EXPECT_FALSE(looks_like_utf16(wide + "\0\0"s));
  for (const std::string& bytes :
       {""s, "v\0"s, "v 0 0 0\n"s, "\0\0\0\0"s, "ab\0\0"s, "a\0b\0\0\0"s, "solid\0"s})
    EXPECT_FALSE(looks_like_utf16(bytes));
}

TEST(TextEncoding, CarriageReturnsAloneBecomeLineFeeds) {
  EXPECT_EQ(to_line_feeds("a\rb\r\r"), "a\nb\n\n");
  for (const std::string& bytes : {"a\r\nb\r\n"s, "a\rb\n"s, "a\r\0"s, ""s})
    EXPECT_EQ(to_line_feeds(bytes), bytes);
}

// RFC 3629, sections 3 and 4.
TEST(TextEncoding, WhatAMessageShowsIsTextWithoutControls) {
  EXPECT_EQ(to_printable("A\xE2\x89\xA2\xCE\x91. \xF4\x8F\xBF\xBF\xC2\xA0"),
            "A\xE2\x89\xA2\xCE\x91. \xF4\x8F\xBF\xBF\xC2\xA0");
  EXPECT_EQ(to_printable("\x1b[0m\t\x7f\0\n"s), "?[0m????");
  EXPECT_EQ(to_printable("\xC2\x9B\xC0\x80\x80\xFF\xE2\x89"), "????????");
}

}  // namespace
}  // namespace argil
