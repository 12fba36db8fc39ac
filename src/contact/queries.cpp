#include "contact/queries.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>

#include "base/error.h"

namespace argil::contact {
namespace {

// The cost of a quotient grows with the square of its digits; a double's exact value has at most 767 and 308.
constexpr std::size_t kMostDigits = 10000;
constexpr std::size_t kQuotedLength = 40;  // longer words are cut in messages

/// Unsigned integer of any length, lowest limb first, no zero limb on top.
class BigUint {
 public:
  static BigUint from_decimal(std::string_view digits) {
    BigUint value;
    for (const char c : digits) value.multiply_add(10, static_cast<std::uint32_t>(c - '0'));
    return value;
  }
  bool is_zero() const { return m_limbs.empty(); }
  int num_bits() const {
    if (m_limbs.empty()) return 0;
    int bits = 32 * (static_cast<int>(m_limbs.size()) - 1);
    for (std::uint32_t top = m_limbs.back(); top != 0; top >>= 1) ++bits;
    return bits;
  }
  BigUint shifted_left(int bits) const {
    BigUint out;
    if (is_zero()) return out;
    out.m_limbs.assign(static_cast<std::size_t>(bits / 32), 0);
    std::uint64_t carry = 0;
    for (const std::uint32_t limb : m_limbs) {
      carry |= static_cast<std::uint64_t>(limb) << (bits % 32);
      out.m_limbs.push_back(static_cast<std::uint32_t>(carry));
      carry >>= 32;
    }
    if (carry != 0) out.m_limbs.push_back(static_cast<std::uint32_t>(carry));
    return out;
  }
  void halve() {
    for (std::size_t i = 0; i < m_limbs.size(); ++i) {
      const std::uint32_t from_above = i + 1 < m_limbs.size() ? m_limbs[i + 1] << 31 : 0;
      m_limbs[i] = m_limbs[i] >> 1 | from_above;
    }
    trim();
  }
  /// Subtracts `other` when that leaves no negative number; says whether it did.
  bool subtract_if_not_less(const BigUint& other) {
    if (is_less_than(other)) return false;
    std::uint64_t borrow = 0;
    for (std::size_t i = 0; i < m_limbs.size(); ++i) {
      const std::uint64_t take = borrow + (i < other.m_limbs.size() ? other.m_limbs[i] : 0);
      borrow = m_limbs[i] < take ? 1 : 0;
      m_limbs[i] = static_cast<std::uint32_t>(m_limbs[i] + (borrow << 32) - take);
    }
    trim();
    return true;
  }
  bool is_less_than(const BigUint& other) const {
    if (m_limbs.size() != other.m_limbs.size()) return m_limbs.size() < other.m_limbs.size();
    return std::lexicographical_compare(m_limbs.rbegin(), m_limbs.rend(), other.m_limbs.rbegin(),
                                        other.m_limbs.rend());
  }

 private:
  void multiply_add(std::uint32_t factor, std::uint32_t summand) {
    std::uint64_t carry = summand;
    for (std::uint32_t& limb : m_limbs) {
      carry += static_cast<std::uint64_t>(limb) * factor;
      limb = static_cast<std::uint32_t>(carry);
      carry >>= 32;
    }
    if (carry != 0) m_limbs.push_back(static_cast<std::uint32_t>(carry));
  }
  void trim() {
    while (!m_limbs.empty() && m_limbs.back() == 0) m_limbs.pop_back();
  }
  std::vector<std::uint32_t> m_limbs;
};

std::string_view require_digits(std::string_view text, std::string_view whole) {
  const bool ok =
      !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
  if (!ok)
    throw std::invalid_argument("\"" + std::string(whole.substr(0, kQuotedLength)) + "\" is not an integer");
  if (text.size() > kMostDigits)
    throw std::invalid_argument("an integer has " + std::to_string(text.size()) + " digits, more than " +
                                std::to_string(kMostDigits));
  return text;
}

/// Nearest double to n/d, n and d positive.
double divide(BigUint n, BigUint d) {
  using Limits = std::numeric_limits<double>;
  // n/d lies in [2^E, 2^(E+1)).
  int E = n.num_bits() - d.num_bits();
  if (E >= 0 ? n.is_less_than(d.shifted_left(E)) : n.shifted_left(-E).is_less_than(d)) --E;
  if (E >= Limits::max_exponent) throw std::invalid_argument("the quotient is beyond the range of double");
  // Numbers below the smallest normal one have fewer bits.
  const int bits = Limits::digits - std::max(0, Limits::min_exponent - 1 - E);
  if (bits < 0) return 0.0;
  // Scale so that the integer part of the quotient has just these bits, then divide by hand.
  const int scale = bits - 1 - E;
  if (scale >= 0)
    n = n.shifted_left(scale);
  else
    d = d.shifted_left(-scale);
  BigUint shifted = d.shifted_left(bits);
  std::uint64_t quotient = 0;
  for (int i = 0; i <= bits; ++i) {
    quotient = quotient << 1 | (n.subtract_if_not_less(shifted) ? 1U : 0U);
    shifted.halve();
  }
  // What is left is n < d; compare it with d/2.
  const BigUint twice = n.shifted_left(1);
  const bool is_above_half = d.is_less_than(twice);
  const bool is_half = !is_above_half && !twice.is_less_than(d);
  if (is_above_half || (is_half && quotient % 2 == 1)) ++quotient;
  const double value = std::ldexp(static_cast<double>(quotient), -scale);
  if (!std::isfinite(value)) throw std::invalid_argument("the quotient is beyond the range of double");
  return value;
}

struct Row {
  Vec3 point;
  int truth = -1;
};

Row parse_row(std::string_view line, const std::string& file, const std::string& place) {
  std::vector<std::string_view> columns;
  while (true) {
    const std::size_t comma = line.find(',');
    std::string_view column = line.substr(0, comma);
    while (!column.empty() && (column.front() == ' ' || column.front() == '\t')) column.remove_prefix(1);
    while (!column.empty() && (column.back() == ' ' || column.back() == '\t')) column.remove_suffix(1);
    columns.push_back(column);
    if (comma == std::string_view::npos) break;
    line.remove_prefix(comma + 1);
  }
  if (columns.size() != 6 && columns.size() != 7)
    throw InputError(file, place, "has " + std::to_string(columns.size()) + " columns",
                     "give numerator and denominator of x, y and z, and perhaps the truth: 6 or 7 columns");
  Row row;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(2 * i);
    try {
      row.point(i) = compute_quotient(columns[k], columns[k + 1]);
    } catch (const std::invalid_argument& problem) {
      throw InputError(file, place + ", column " + std::to_string(k + 1), problem.what(),
                       "write each coordinate as an integer and a positive integer to divide it by");
    }
  }
  if (columns.size() == 7) {
    if (columns[6] != "0" && columns[6] != "1")
      throw InputError(file, place + ", column 7", "truth is \"" + std::string(columns[6]) + "\"",
                       "write 1 for a pair that meets and 0 for one that does not");
    row.truth = columns[6] == "1" ? 1 : 0;
  }
  return row;
}

}  // namespace

double compute_quotient(std::string_view numerator, std::string_view denominator) {
  const bool is_negative = !numerator.empty() && numerator.front() == '-';
  const std::string_view digits = require_digits(is_negative ? numerator.substr(1) : numerator, numerator);
  const BigUint d = BigUint::from_decimal(require_digits(denominator, denominator));
  if (d.is_zero()) throw std::invalid_argument("the denominator is 0");
  const BigUint n = BigUint::from_decimal(digits);
  const double quotient = n.is_zero() ? 0.0 : divide(n, d);
  return is_negative ? -quotient : quotient;
}

QueryFile read_queries(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw IoError(file.string(), "cannot be opened for reading");
  QueryFile out;
  std::string line;
  int number = 0;
  std::size_t in_query = 0;
  int truth = -1;
  while (std::getline(stream, line)) {
    ++number;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.find_first_not_of(" \t") == std::string::npos) continue;
    const std::string place = "line " + std::to_string(number);
    const Row row = parse_row(line, file.string(), place);
    const bool is_first = in_query == 0;
    if (is_first) {
      const bool has_truth = row.truth >= 0;
      if (!out.paths.empty() && has_truth == out.truth.empty())
        throw InputError(file.string(), place, "some queries have a truth column and some have not",
                         "give it on all rows or on none");
      out.paths.emplace_back();
      truth = row.truth;
      if (has_truth) out.truth.push_back(truth == 1);
    } else if (row.truth != truth) {
      throw InputError(file.string(), place, "the truth differs from the first row of its query",
                       "repeat the same truth on all eight rows of a query");
    }
    PairPath& path = out.paths.back();
    (in_query < 4 ? path.t0[in_query] : path.t1[in_query - 4]) = row.point;
    in_query = (in_query + 1) % 8;
  }
  if (stream.bad()) throw IoError(file.string(), "reading stopped in the middle");
  if (in_query != 0)
    throw InputError(file.string(), "line " + std::to_string(number),
                     "the last query has " + std::to_string(in_query) + " of its 8 rows",
                     "give four points at t = 0, then four at t = 1, one a row");
  return out;
}

}  // namespace argil::contact
