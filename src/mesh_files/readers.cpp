#include "mesh_files/readers.h"

#include <filesystem>

#include "base/error.h"
#include "base/lower_case.h"
#include "mesh_files/surface_file.h"
#include "mesh_files/tet_file.h"

namespace argil::mesh_files {
namespace {

// Ending of the name in small letters, with its dot.
std::string find_ending(const std::string& file) {
  return to_lower_case(std::filesystem::path(file).extension().string());
}

}  // namespace

mesh::TetMesh read_tet_mesh(const std::string& file, double scale) {
  const std::string ending = find_ending(file);
  if (ending == ".msh") return read_gmsh(file, scale);
  if (ending == ".mesh") return read_medit(file, scale);
  if (ending == ".node" || ending == ".ele") return read_tetgen(file, scale);
  if (ending == ".vtk") return read_vtk(file, scale);
  if (ending == ".vtu") return read_vtu(file, scale);
  if (ending == ".veg") return read_vega(file, scale);
  throw InputError(file, "", "ending \"" + ending + "\" is no known tetrahedral format",
                   "use .msh, .mesh, .node/.ele, .vtk, .vtu or .veg");
}

mesh::TriangleMesh read_triangle_mesh(const std::string& file, double scale) {
  const std::string ending = find_ending(file);
  if (ending == ".obj") return read_obj(file, scale);
  if (ending == ".stl") return read_stl(file, scale);
  if (ending == ".ply") return read_ply(file, scale);
  throw InputError(file, "", "ending \"" + ending + "\" is no known surface format",
                   "use .obj, .stl or .ply");
}

}  // namespace argil::mesh_files
