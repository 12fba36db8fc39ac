#include "mesh_files/readers.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

#include "base/error.h"
#include "base/lower_case.h"
#include "mesh/topology.h"
#include "mesh_files/surface_file.h"
#include "mesh_files/tet_file.h"

namespace argil::mesh_files {
namespace {

// `elements`: vertex numbers of tets or triangles.
template <class Elements>
void leave_out_unused(Points& vertices, Elements& elements, FileVertices* told) {
  std::vector<int> number(static_cast<std::size_t>(vertices.cols()), -1);
  for (const int v : elements.reshaped()) number[static_cast<std::size_t>(v)] = 0;
  FileVertices made{static_cast<int>(vertices.cols()), {}};
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<int>(made.kept.size());
    made.kept.push_back(static_cast<int>(v));
  }
  if (made.num_left_out() == 0) {
    made.kept.clear();
  } else {
    for (std::size_t i = 0; i < made.kept.size(); ++i)  // forwards: none is overwritten before it moved
      vertices.col(static_cast<Eigen::Index>(i)) = vertices.col(made.kept[i]).eval();
    vertices.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(made.kept.size()));
    for (int& v : elements.reshaped()) v = number[static_cast<std::size_t>(v)];
  }
  if (told != nullptr) *told = std::move(made);
}

// Numbers every tet the other way round where all have a negative volume.
bool turn_mirrored(mesh::TetMesh& mesh) {
  const Field volumes = mesh::compute_volumes(mesh.vertices, mesh.tets);
  if (!(volumes.maxCoeff() <= 0.0 && volumes.minCoeff() < 0.0)) return false;
  mesh.tets.row(2).swap(mesh.tets.row(3));
  return true;
}

// Ending of the name in small letters, with its dot.
std::string find_ending(const std::string& file) {
  return to_lower_case(std::filesystem::path(file).extension().string());
}

mesh::TetMesh read_all_tets(const std::string& file, double scale) {
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

using SurfaceReader = mesh::TriangleMesh (*)(const std::string& file, double scale);

// By its ending; null where it is no surface's.
SurfaceReader find_surface_reader(const std::string& ending) {
  constexpr std::array<std::pair<std::string_view, SurfaceReader>, 4> kReaders = {
      {{".obj", read_obj}, {".off", read_off}, {".ply", read_ply}, {".stl", read_stl}}};
  for (const auto& [known, reader] : kReaders)
    if (ending == known) return reader;
  return nullptr;
}

mesh::TriangleMesh read_all_triangles(const std::string& file, double scale) {
  const std::string ending = find_ending(file);
  if (const SurfaceReader read = find_surface_reader(ending)) return read(file, scale);
  throw InputError(file, "", "ending \"" + ending + "\" is no known surface format",
                   "use .obj, .off, .ply or .stl");
}

}  // namespace

int FileVertices::find(int place) const {
  if (kept.empty()) return place;
  const auto at = std::lower_bound(kept.begin(), kept.end(), place);
  return at != kept.end() && *at == place ? static_cast<int>(at - kept.begin()) : -1;
}

std::string FileVertices::describe(const std::string& file, const std::string& element) const {
  std::string turned;
  if (is_mirrored)
    turned = file + ": every " + element +
             " is numbered the other way round, with a negative volume; two of its corners are swapped";
  if (num_left_out() == 0) return turned;
  int first = 0;
  while (find(first) >= 0) ++first;
  return file + ": " + std::to_string(num_left_out()) + " of " + std::to_string(num_in_file) +
         " vertices belong to no " + element + " and are left out, number " + std::to_string(first) +
         " (from 0) the first" + (turned.empty() ? "" : "; " + turned);
}

bool is_surface(const std::string& file) {
  return find_surface_reader(find_ending(file)) != nullptr;
}

mesh::TetMesh read_tet_mesh(const std::string& file, double scale, FileVertices* vertices) {
  mesh::TetMesh mesh = read_all_tets(file, scale);
  leave_out_unused(mesh.vertices, mesh.tets, vertices);
  const bool is_mirrored = turn_mirrored(mesh);
  if (vertices != nullptr) vertices->is_mirrored = is_mirrored;
  return mesh;
}

mesh::TriangleMesh read_triangle_mesh(const std::string& file, double scale, FileVertices* vertices) {
  mesh::TriangleMesh mesh = read_all_triangles(file, scale);
  leave_out_unused(mesh.vertices, mesh.triangles, vertices);
  return mesh;
}

}  // namespace argil::mesh_files
