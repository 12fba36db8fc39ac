// NumPy's array files [numpy.lib.format]: magic, version, length of a header, a Python dictionary in it, then
// bytes.

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "device/trace_columns.h"
#include "device/trace_raw.h"

namespace argil::device::internal {
namespace {

static_assert(std::endian::native == std::endian::little);

struct Array {
  bool is_double = true;
  bool is_swapped = false;  // big-endian
  bool is_fortran = false;  // columns lie one after the other
  std::vector<std::uint64_t> shape;
  std::string_view bytes;
};

[[noreturn]] void refuse_damaged(const std::string& file) {
  throw InputError(file, "", "is cut or damaged: no header of an array of NumPy's",
                   "write it again by numpy.save");
}

/// The text behind "'key':" of the dictionary.
std::string_view find_value(const std::string& file, std::string_view header, std::string_view key) {
  const std::size_t at = header.find(key);
  if (at == std::string_view::npos) refuse_damaged(file);
  std::string_view rest = header.substr(at + key.size());
  const std::size_t begin = rest.find_first_not_of("'\": ");
  if (begin == std::string_view::npos) refuse_damaged(file);
  return rest.substr(begin);
}

std::vector<std::uint64_t> read_shape(const std::string& file, std::string_view text) {
  const std::size_t end = text.find(')');
  if (!text.starts_with('(') || end == std::string_view::npos) refuse_damaged(file);
  std::vector<std::uint64_t> shape;
  for (std::size_t at = 1; at < end;) {
    at = text.find_first_not_of(", ", at);
    if (at >= end) break;
    std::uint64_t length = 0;
    const auto [stop, error] = std::from_chars(text.data() + at, text.data() + end, length);
    if (error != std::errc() || shape.size() > 32) refuse_damaged(file);
    shape.push_back(length);
    at = static_cast<std::size_t>(stop - text.data());
  }
  return shape;
}

Array read_header(const std::string& file, std::string_view bytes) {
  constexpr std::size_t kMagic = 6;  // bytes
  if (bytes.size() < kMagic + 6) refuse_damaged(file);
  const bool is_first = bytes[kMagic] == 1;  // whose length has two bytes, later ones' four
  const std::size_t num_bytes = is_first ? 2 : 4;
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + kMagic + 2, num_bytes);
  const std::size_t begin = kMagic + 2 + num_bytes;
  if (length > bytes.size() - begin) refuse_damaged(file);
  const std::string_view header = bytes.substr(begin, length);
  Array array;
  array.bytes = bytes.substr(begin + length);
  const std::string_view type = find_value(file, header, "descr").substr(0, 3);
  array.is_swapped = type.starts_with('>');
  array.is_double = type.ends_with("f8");
  if ((type[0] != '<' && type[0] != '>') || (!type.ends_with("f8") && !type.ends_with("f4")))
    throw InputError(file, "", "is an array of '" + std::string(type) + "', not of float32 or float64",
                     "save numpy.asarray(a, float)");
  array.is_fortran = find_value(file, header, "fortran_order").starts_with("True");
  array.shape = read_shape(file, find_value(file, header, "shape"));
  return array;
}

std::string print_shape(const std::vector<std::uint64_t>& shape) {
  std::string text;
  for (const std::uint64_t length : shape) text += (text.empty() ? "" : " × ") + std::to_string(length);
  return text.empty() ? "a single number" : text;
}

/// Refuses what is no table of so many bytes.
void check_shape(const std::string& file, const Array& array) {
  const std::vector<std::uint64_t>& shape = array.shape;
  if (shape.size() != 2)
    throw InputError(file, "", "is " + print_shape(shape) + ", not a table of rows and columns",
                     shape.size() == 3 ? "save one motion of it, as numpy.save(file, a[0])"
                                       : "save a row a sample and a column a quantity");
  const std::uint64_t size = array.is_double ? 8 : 4;
  const std::uint64_t most = array.bytes.size() / size;
  if (shape[0] == 0 || shape[1] == 0 || shape[1] > most || shape[0] > most / shape[1] ||
      shape[0] * shape[1] * size != array.bytes.size())
    throw InputError(file, "",
                     "holds " + std::to_string(array.bytes.size()) + " bytes of numbers, not those of " +
                         print_shape(shape),
                     "write it again by numpy.save");
}

template <class Word>
Word swapped(Word word) {
  Word other = 0;
  for (std::size_t i = 0; i < sizeof(Word); ++i)
    other = static_cast<Word>(other << 8 | ((word >> 8 * i) & 0xFF));
  return other;
}

template <class Real, class Word>
double read_as(const Array& array, std::uint64_t i) {
  Word word = 0;
  std::memcpy(&word, array.bytes.data() + i * sizeof(Word), sizeof(Word));
  return static_cast<double>(std::bit_cast<Real>(array.is_swapped ? swapped(word) : word));
}

double read_number(const Array& array, std::uint64_t row, std::uint64_t column) {
  const std::uint64_t i = array.is_fortran ? column * array.shape[0] + row : row * array.shape[1] + column;
  return array.is_double ? read_as<double, std::uint64_t>(array, i) : read_as<float, std::uint32_t>(array, i);
}

/// A table whose columns are the samples: few rows, and as many named columns or fewer.
void refuse_lying(const std::string& file, const Array& array, const TraceOptions& options) {
  constexpr std::uint64_t kMostQuantities = 32;  // that a device writes
  constexpr std::uint64_t kManySamples = 50;
  const std::uint64_t rows = array.shape[0];
  const std::uint64_t columns = array.shape[1];
  const std::uint64_t named = options.columns.size();
  const bool is_likely = named == 0 ? columns >= kManySamples : named <= rows && named < columns;
  if (!(rows >= 3 && rows <= kMostQuantities && rows < columns && is_likely)) return;
  throw InputError(file, "",
                   "is " + print_shape(array.shape) +
                       ", fewer rows than columns, but a row is a sample and a column a quantity",
                   "save it the other way round, numpy.save(file, a.T); or, if it is as meant, name all " +
                       std::to_string(columns) + R"( columns by /trace/columns, "-" leaves one out)");
}

void require_columns(const std::string& file, const Array& array, const TraceOptions& options) {
  refuse_lying(file, array, options);
  if (options.columns.empty())
    throw InputError(
        file, "", print_shape(array.shape) + " numbers without names of the columns",
        R"(name them from the left by /trace/columns, for instance ["t", "x", "y", "z"]; "-" leaves one out)");
  if (options.columns.size() > array.shape[1])
    throw InputError(file, "",
                     std::to_string(options.columns.size()) +
                         " columns are named by /trace/columns, but there are " +
                         std::to_string(array.shape[1]),
                     "name no more than there are");
}

/// The named columns as the text that a table of them is; numbers come back from it to the bit.
std::string print_table(const std::string& file, const Array& array, const TraceOptions& options) {
  const std::array<int, kNumRoles> places = find_columns(options.columns);
  const auto is_place = [&](std::uint64_t column) {
    return std::find(places.begin() + kX, places.begin() + kZ + 1, static_cast<int>(column)) !=
           places.begin() + kZ + 1;
  };
  std::string text;
  for (std::uint64_t row = 0; row < array.shape[0]; ++row) {
    for (std::uint64_t column = 0; column < array.shape[1]; ++column) {
      const bool is_named = column < options.columns.size() && options.columns[column] != "-" &&
                            !options.columns[column].empty();
      const double value = is_named ? read_number(array, row, column) : 0.0;
      const bool is_lost = std::isnan(value) && is_place(column);
      if (!std::isfinite(value) && !is_lost)
        throw InputError(file, "row " + std::to_string(row) + ", column " + std::to_string(column),
                         "is " + std::to_string(value), "give finite numbers");
      char digits[32];
      const char* end = std::to_chars(digits, digits + sizeof digits, value).ptr;
      text.append(digits, static_cast<std::size_t>(end - digits));
      text.push_back(column + 1 < array.shape[1] ? ',' : '\n');
    }
  }
  return text;
}

}  // namespace

RawTrace parse_npy(const std::string& file, const std::string& bytes, const TraceOptions& options) {
  const Array array = read_header(file, bytes);
  check_shape(file, array);
  require_columns(file, array, options);
  return parse_csv(file, print_table(file, array, options), options, true);
}

}  // namespace argil::device::internal
