#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_files/number_type.h"

namespace argil::mesh_files {

/// How the arrays of a .vtu file lie in its bytes.
struct ArrayEncoding {
  std::endian order = std::endian::little;
  NumberType header = NumberType::uint32;  ///< type of the lengths before the numbers
  bool is_packed = false;                  ///< blocks packed by zlib
};

/// Number type of a name such as "Float64".
std::optional<NumberType> find_number_type(std::string_view name);

/// Bytes of base64 text, group by group, so that padding within the text ends one run and begins the next.
/// Stops at the first character that is neither base64 nor blank.
std::string decode_base64(std::string_view text);

/// Numbers of a block that begins with its lengths. On failure says why in `problem`.
std::vector<double> decode_block(std::string_view bytes, NumberType type, const ArrayEncoding& encoding,
                                 std::string& problem);

}  // namespace argil::mesh_files
