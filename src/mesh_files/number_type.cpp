#include "mesh_files/number_type.h"

#include <cstdint>

#include "mesh_files/file_cursor.h"

namespace argil::mesh_files {

std::size_t size_of(NumberType type) {
  switch (type) {
    case NumberType::int8:
    case NumberType::uint8:
      return 1;
    case NumberType::int16:
    case NumberType::uint16:
      return 2;
    case NumberType::int32:
    case NumberType::uint32:
    case NumberType::float32:
      return 4;
    default:
      return 8;
  }
}

double load_number(const char* bytes, NumberType type, std::endian order) {
  switch (type) {
    case NumberType::int8:
      return load_bytes<std::int8_t>(bytes, order);
    case NumberType::uint8:
      return load_bytes<std::uint8_t>(bytes, order);
    case NumberType::int16:
      return load_bytes<std::int16_t>(bytes, order);
    case NumberType::uint16:
      return load_bytes<std::uint16_t>(bytes, order);
    case NumberType::int32:
      return load_bytes<std::int32_t>(bytes, order);
    case NumberType::uint32:
      return load_bytes<std::uint32_t>(bytes, order);
    case NumberType::int64:
      return static_cast<double>(load_bytes<std::int64_t>(bytes, order));
    case NumberType::uint64:
      return static_cast<double>(load_bytes<std::uint64_t>(bytes, order));
    case NumberType::float32:
      return static_cast<double>(load_bytes<float>(bytes, order));
    case NumberType::float64:
      break;
  }
  return load_bytes<double>(bytes, order);
}

}  // namespace argil::mesh_files
