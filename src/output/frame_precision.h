#pragma once

#include <cstdint>

namespace argil::output {

/// How much the frames keep of arrays that are stored compressed, in bits of their largest value.
enum class FramePrecision : std::uint8_t {
  picture,  ///< what a picture or a plot shows: 22 of the cage's positions, 16 of the skin's, 12 of fields
  single,   ///< 24 of fields and the skin's positions; the cage's positions are whole
  whole,    ///< every bit
};

}  // namespace argil::output
