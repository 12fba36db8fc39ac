#include "mesh_files/vtk_arrays.h"

#include <zlib.h>

#include <cstdint>

#include "mesh_files/file_cursor.h"

namespace argil::mesh_files {
namespace {

// zlib cannot pack better than this (zlib.net, "Maximum Compression Factor"); more is a damaged length.
constexpr std::uint64_t kMostPacking = 1032;

int base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

// Lengths before the numbers: one after the other, of the type the file announced.
class Lengths {
 public:
  Lengths(std::string_view bytes, const ArrayEncoding& encoding) : m_bytes(bytes), m_encoding(encoding) {}
  bool next(std::uint64_t& length) {
    const std::size_t size = size_of(m_encoding.header);
    if (m_bytes.size() < size) return false;
    length = size == 8 ? load_bytes<std::uint64_t>(m_bytes.data(), m_encoding.order)
                       : load_bytes<std::uint32_t>(m_bytes.data(), m_encoding.order);
    m_bytes.remove_prefix(size);
    return true;
  }
  std::string_view rest() const { return m_bytes; }

 private:
  std::string_view m_bytes;
  const ArrayEncoding& m_encoding;
};

// [number of blocks][length of a block][length of the last, 0 if full][packed length of each block] blocks
std::string unpack(std::string_view bytes, const ArrayEncoding& encoding, std::string& problem) {
  Lengths lengths(bytes, encoding);
  std::uint64_t count = 0;
  std::uint64_t block = 0;
  std::uint64_t last = 0;
  std::string values;
  problem = "its lengths do not fit the file";
  if (!lengths.next(count) || count > bytes.size()) return {};
  if (count == 0) {
    problem.clear();
    return {};
  }
  if (!lengths.next(block) || !lengths.next(last)) return {};
  std::vector<std::uint64_t> packed(count);
  for (std::uint64_t& length : packed)
    if (!lengths.next(length)) return {};
  std::string_view rest = lengths.rest();
  for (std::size_t i = 0; i < packed.size(); ++i) {
    const std::uint64_t size = i + 1 == packed.size() && last != 0 ? last : block;
    if (packed[i] > rest.size() || size / kMostPacking > packed[i]) return {};
    const std::size_t used = values.size();
    values.resize(used + size);
    uLongf unpacked = size;
    const int status = uncompress(reinterpret_cast<Bytef*>(values.data() + used), &unpacked,
                                  reinterpret_cast<const Bytef*>(rest.data()), packed[i]);
    if (status != Z_OK || unpacked != size) {
      problem = "zlib cannot unpack it";
      return {};
    }
    rest.remove_prefix(packed[i]);
  }
  problem.clear();
  return values;
}

}  // namespace

std::optional<NumberType> find_number_type(std::string_view name) {
  constexpr std::pair<std::string_view, NumberType> kTypes[] = {
      {"Int8", NumberType::int8},      {"UInt8", NumberType::uint8},   {"Int16", NumberType::int16},
      {"UInt16", NumberType::uint16},  {"Int32", NumberType::int32},   {"UInt32", NumberType::uint32},
      {"Int64", NumberType::int64},    {"UInt64", NumberType::uint64}, {"Float32", NumberType::float32},
      {"Float64", NumberType::float64}};
  for (const auto& [known, type] : kTypes)
    if (known == name) return type;
  return std::nullopt;
}

std::string decode_base64(std::string_view text) {
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  std::uint32_t group = 0;
  int digits = 0;
  int padding = 0;
  for (const char c : text) {
    if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
    const int digit = base64_digit(c);
    if (digit < 0 && c != '=') break;
    if (c == '=') ++padding;
    group = (group << 6) | static_cast<std::uint32_t>(digit < 0 ? 0 : digit);
    if (++digits < 4) continue;
    for (int i = 0; i < 3 - padding; ++i) bytes += static_cast<char>((group >> (16 - 8 * i)) & 0xffU);
    group = 0;
    digits = padding = 0;
  }
  return bytes;
}

std::vector<double> decode_block(std::string_view bytes, NumberType type, const ArrayEncoding& encoding,
                                 std::string& problem) {
  std::string unpacked;
  std::string_view values;
  if (encoding.is_packed) {
    unpacked = unpack(bytes, encoding, problem);
    values = unpacked;
  } else {
    Lengths lengths(bytes, encoding);
    std::uint64_t size = 0;
    if (!lengths.next(size) || size > lengths.rest().size()) problem = "its length does not fit the file";
    values = lengths.rest().substr(0, problem.empty() ? size : 0);
  }
  if (problem.empty() && values.size() % size_of(type) != 0)
    problem = "its length is not a whole number of values";
  std::vector<double> numbers;
  if (!problem.empty()) return numbers;
  numbers.reserve(values.size() / size_of(type));
  for (std::size_t at = 0; at < values.size(); at += size_of(type))
    numbers.push_back(load_number(values.data() + at, type, encoding.order));
  return numbers;
}

}  // namespace argil::mesh_files
