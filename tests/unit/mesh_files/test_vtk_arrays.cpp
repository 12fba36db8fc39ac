// Encodings of .vtu arrays: base64 against the vectors of RFC 4648 §10, zlib blocks against zlib's own
// packer.
#include "mesh_files/vtk_arrays.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include "sample_files.h"

namespace argil::mesh_files {
namespace {

TEST(Base64, GivesTheVectorsOfTheRfc) {
  EXPECT_EQ(decode_base64(""), "");
  EXPECT_EQ(decode_base64("Zg=="), "f");
  EXPECT_EQ(decode_base64("Zm8="), "fo");
  EXPECT_EQ(decode_base64("Zm9v"), "foo");
  EXPECT_EQ(decode_base64("Zm9vYg=="), "foob");
  EXPECT_EQ(decode_base64("Zm9vYmE="), "fooba");
  EXPECT_EQ(decode_base64("Zm9vYmFy"), "foobar");
}

TEST(Base64, RunsWithTheirOwnPaddingFollowEachOther) {
  EXPECT_EQ(decode_base64(" Zg==\n\tZm8=Zm9v "), "ffofoo");
  EXPECT_EQ(decode_base64("Zm9v<Zm9v"), "foo");
}

std::string pack_blocks(const std::vector<double>& values, std::size_t block_bytes) {
  std::string bytes;
  for (const double value : values) test::append_bytes(bytes, value);
  std::string head;
  std::string body;
  std::uint32_t blocks = 0;
  for (std::size_t at = 0; at < bytes.size(); at += block_bytes, ++blocks) {
    const std::string block = bytes.substr(at, block_bytes);
    uLongf size = compressBound(block.size());
    std::string packed(size, '\0');
    EXPECT_EQ(compress(reinterpret_cast<Bytef*>(packed.data()), &size,
                       reinterpret_cast<const Bytef*>(block.data()), block.size()),
              Z_OK);
    test::append_bytes(head, static_cast<std::uint32_t>(size));
    body += packed.substr(0, size);
  }
  std::string lengths;
  test::append_bytes(lengths, blocks);
  test::append_bytes(lengths, static_cast<std::uint32_t>(block_bytes));
  test::append_bytes(lengths, static_cast<std::uint32_t>(bytes.size() % block_bytes));
  return lengths + head + body;
}

TEST(ZlibBlocks, FullAndPartBlocksUnpackInOrder) {
  ArrayEncoding encoding;
  encoding.is_packed = true;
  for (const std::size_t count : {1U, 5U, 8U, 12U, 16U, 17U}) {  // blocks of 8 values, the last full or not
    std::vector<double> values(count);
    for (std::size_t i = 0; i < count; ++i) values[i] = 0.1 * static_cast<double>(i);
    std::string problem;
    EXPECT_EQ(decode_block(pack_blocks(values, 64), NumberType::float64, encoding, problem), values) << count;
    EXPECT_EQ(problem, "");
  }
}

TEST(ZlibBlocks, ALengthThatZlibCannotReachIsRefusedBeforeMemoryIsTaken) {
  ArrayEncoding encoding;
  encoding.is_packed = true;
  std::string bytes;
  for (const std::uint32_t length : {1U, 0xfffffff0U, 0U, 8U}) test::append_bytes(bytes, length);
  std::string problem;
  EXPECT_TRUE(decode_block(bytes + "12345678", NumberType::float64, encoding, problem).empty());
  EXPECT_EQ(problem, "its lengths do not fit the file");
}

TEST(PlainBlocks, APartOfAValueIsRefused) {
  std::string bytes;
  test::append_bytes(bytes, std::uint32_t{7});
  std::string problem;
  EXPECT_TRUE(decode_block(bytes + "1234567", NumberType::float64, ArrayEncoding{}, problem).empty());
  EXPECT_EQ(problem, "its length is not a whole number of values");
}

}  // namespace
}  // namespace argil::mesh_files
