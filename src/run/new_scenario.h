#pragma once

#include <string>
#include <vector>

namespace argil::run {

/// What `argil new` is given.
struct NewOptions {
  std::string mesh;
  std::string trace;
  std::string output;           ///< scenario; empty: the mesh's name with .json in the working folder
  std::string mesh_unit;        ///< m, cm, mm, um, or metres per unit; empty: by the body's size
  std::string trace_unit;       ///< /trace/length_unit; empty: as the file says, or by the motion's size
  std::string up = "z";         ///< x, y or z: the body stands on its lowest part
  double youngs_modulus = 1e5;  ///< [Pa]
  double poissons_ratio = 0.3;  ///< [–]
  double strength = 1500;       ///< [Pa]
  double tool_radius = 0.0;     ///< [m]; 0: chosen by the body
  std::vector<std::string> settings;  ///< --set texts: further keys
  bool overwrites = false;
};

/// Writes a short scenario that runs as it is: body, what holds it, a soft clay, a ball and the motion, with
/// the schema beside it. A unit that nobody gave and that makes a size out of all reason is said and written
/// as millimetres or what else is likely. A motion that does not touch the body, or begins in it, is moved as
/// `argil place` does. Throws InputError where that is no scenario yet, IoError.
int write_new_scenario(const NewOptions& options);

}  // namespace argil::run
