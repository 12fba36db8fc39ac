#pragma once

#include <cstdint>

namespace argil::output {

/// How much frames keep of fields and of the skin. Positions of the cage are always whole.
enum class FramePrecision : std::uint8_t {
  single,  ///< arrays that are stored compressed: 24 bits of their largest value
  whole,   ///< every bit
};

}  // namespace argil::output
