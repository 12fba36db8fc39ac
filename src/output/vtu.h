#pragma once

#include <cstddef>
#include <string>

namespace argil::output {

/// Writes a result as VTK's unstructured grids: FOLDER/cage_000000.vtu … with saturation and plastic strain
/// of each tet and the displacement since the first frame, skin_000000.vtu … where there is a skin, and
/// FILE.pvd that lists them with their times; FOLDER is FILE without its suffix. Cage and skin are parts 0
/// and 1. Returns the number of frames. Throws IoError or InputError.
std::size_t write_vtu_series(const std::string& result_file, const std::string& pvd_file);

}  // namespace argil::output
