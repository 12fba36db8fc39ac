#pragma once

#include "base/types.h"
#include "hdf5/file.h"

namespace argil::output {

inline hdf5::Shape field_shape(const Field& field) {
  return {static_cast<std::uint64_t>(field.size())};
}

/// Arrays hold one entity a column, column after column; the same bytes are one entity a row on disk.
template <class Array>
hdf5::Shape entity_shape(const Array& array) {
  return {static_cast<std::uint64_t>(array.cols()), static_cast<std::uint64_t>(array.rows())};
}

}  // namespace argil::output
