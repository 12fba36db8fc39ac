#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "contact/ccd.h"

namespace argil::contact {

/// Continuous collision queries of one kind, as public test sets give them.
struct QueryFile {
  std::vector<PairPath> paths;
  std::vector<bool> truth;  ///< does each pair meet; empty: the file does not say
};

/// Reads a table of eight rows a query: the four points at t = 0, then at t = 1 (v f0 f1 f2, or a0 a1 b0 b1).
/// A row has numerator and denominator of x, y and z as integers of at most 10 000 digits, separated by
/// commas, and perhaps the truth (0 or 1). Each quotient is rounded correctly to double. Throws InputError
/// with file and line, IoError when the file cannot be read.
QueryFile read_queries(const std::filesystem::path& file);

/// The double nearest to numerator/denominator (ties to even) for decimal integers of at most 10 000 digits.
/// Throws std::invalid_argument saying what is wrong: not an integer, too long a one, a denominator that is
/// not positive, or a quotient beyond the range of double.
double compute_quotient(std::string_view numerator, std::string_view denominator);

}  // namespace argil::contact
