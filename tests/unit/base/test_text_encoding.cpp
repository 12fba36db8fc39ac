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

}  // namespace
}  // namespace argil
