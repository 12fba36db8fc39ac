// SHA-256 against the examples of FIPS 180-4 (published by NIST).
#include "base/hash.h"

#include <gtest/gtest.h>

namespace argil {
namespace {

TEST(Sha256, MatchesThePublishedDigestOfAbc) {
  EXPECT_EQ(Sha256().add(std::string("abc")).hex_digest(),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Sha256, MatchesThePublishedDigestOfTwoBlocks) {
  EXPECT_EQ(
      Sha256().add(std::string("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq")).hex_digest(),
      "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

TEST(Sha256, MatchesThePublishedDigestOfAMillionLettersAddedInUnevenPieces) {
  Sha256 hash;
  std::size_t left = 1000000;
  for (std::size_t piece = 1; left > 0; piece = piece % 97 + 1) {
    const std::size_t take = std::min(piece, left);
    hash.add(std::string(take, 'a'));
    left -= take;
  }
  EXPECT_EQ(hash.hex_digest(), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, ProcessorsInstructionsGiveThePortableDigestForAnyLengthAndAnySplit) {
  std::string text;
  for (int i = 0; i < 500; ++i) text += static_cast<char>(37 * i % 251);
  for (std::size_t length = 0; length < text.size(); length += 7) {
    Sha256 portable(Sha256::Code::portable);
    const std::string whole = portable.add(text.substr(0, length)).hex_digest();
    const std::size_t split = length / 3;
    Sha256 fastest;
    fastest.add(text.substr(0, split)).add(text.substr(split, length - split));
    EXPECT_EQ(fastest.hex_digest(), whole) << length;
  }
}

}  // namespace
}  // namespace argil
