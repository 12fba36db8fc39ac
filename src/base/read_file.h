#pragma once

#include <string>

namespace argil {

/// All bytes of a file. Throws IoError with the system's reason.
std::string read_file(const std::string& file);

}  // namespace argil
