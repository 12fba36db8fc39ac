#pragma once

#include <bit>
#include <cstddef>

namespace argil::mesh_files {

/// Number types of a file's arrays.
enum class NumberType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

std::size_t size_of(NumberType type);
/// One number from its bytes. Integers beyond 2⁵³ lose their last digits.
double load_number(const char* bytes, NumberType type, std::endian order);

}  // namespace argil::mesh_files
