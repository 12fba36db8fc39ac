#pragma once

#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>

#include "mesh/tet_mesh.h"

namespace argil::test {

/// Writes `text` to `file` and returns the file's name.
inline std::string write_text(const std::string& file, const std::string& text) {
  std::ofstream(file) << text;
  return file;
}

/// Writes `mesh` with its cell data to a legacy .vtk `file` and returns the file's name.
inline std::string write_vtk(const std::string& file, const mesh::TetMesh& mesh) {
  std::ofstream out(file);
  out.precision(17);
  out << "# vtk DataFile Version 3.0\nblock\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " << mesh.num_vertices()
      << " double\n"
      << mesh.vertices.transpose() << "\nCELLS " << mesh.num_tets() << ' ' << 5 * mesh.num_tets() << '\n';
  for (int t = 0; t < mesh.num_tets(); ++t) out << "4 " << mesh.tets.col(t).transpose() << '\n';
  out << "CELL_TYPES " << mesh.num_tets() << '\n';
  for (int t = 0; t < mesh.num_tets(); ++t) out << "10\n";
  out << "CELL_DATA " << mesh.num_tets() << '\n';
  for (const auto& [name, values] : mesh.cell_fields)
    out << "SCALARS " << name << " double 1\nLOOKUP_TABLE default\n" << values << '\n';
  return file;
}

/// A motion along z over the origin: from `top` down to `bottom` and up again within `seconds`, at 1 kHz.
inline std::string write_press_trace(const std::string& file, double top, double bottom, double seconds,
                                     const std::string& mode) {
  std::ofstream out(file);
  out << "t,x,y,z,qx,qy,qz,qw,mode\n";
  const int count = static_cast<int>(seconds * 1000.0);
  for (int k = 0; k <= count; ++k) {
    const double share = 0.5 - 0.5 * std::cos(2.0 * 3.14159265358979 * k / count);
    char line[160];
    std::snprintf(line, sizeof line, "%.3f,0.001,0.0007,%.9f,0,0,0,1,%s\n", 0.001 * k,
                  top + share * (bottom - top), mode.c_str());
    out << line;
  }
  return file;
}

/// A small sphere of clay on the floor, pressed from above by the motion in `trace`. Extra keys of `body`, if
/// any, begin with a comma.
inline std::string make_ball_scenario(const std::string& trace, const std::string& more_body = "") {
  return R"({"about": "a ball of clay pressed from above",
  "body": {"shape": {"kind": "sphere", "size_m": 0.04, "target_tets": 600, "skin_triangles": 0},
           "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": 0.006}])" +
         more_body + R"(},
  "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3,
    "moisture": {"yield_law": "log_linear", "saturated_yield_ratio": 0.1},
    "plasticity": {"yield": 0.02, "creep_per_s": 20, "max": 0.5},
    "clay_kernel": {"k1_per_m": 2, "k2_per_m": 60, "radius_m": 0.03}},
  "water": {"diffusivity_m2_per_s": 1e-5, "wetting_flux_kg_per_m2_s": 50, "drying_flux_kg_per_m2_s": 50},
  "tool": {"shape": {"kind": "sphere", "radius_m": 0.006, "subdivisions": 2}},
  "contact": {"law": "pairs", "vertex_face_stiffness_N_per_m": 400, "edge_edge_stiffness_N_per_m": 400},
  "dynamics": {"rayleigh_stiffness_s": 0.001},
  "haptics": {"frame_period_ticks": 20},
  "trace": {"file": ")" +
         trace + "\"}}";
}

}  // namespace argil::test
