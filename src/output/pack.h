#pragma once

#include <string>

namespace argil::output {

/// Writes a complete result anew: without the room of what was removed from it, and with what neighbouring
/// frames have in common stored once. Large arrays of frames become views of rows in /packed; every value
/// that is read is the same. The file is replaced as a whole at the end. Throws IoError, and the file is as
/// before.
void pack(const std::string& result_file);

/// The same, but a file for whose copy there is no room on the disk stays as it is.
void try_to_pack(const std::string& result_file) noexcept;

}  // namespace argil::output
