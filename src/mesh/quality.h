#pragma once

#include <array>
#include <string>
#include <vector>

#include "mesh/tet_mesh.h"

namespace argil::mesh {

/// Sizes of bodies and tools [m], from molecules to orbits: no scene lies beyond, and their cubes and
/// quotients stay far from what a double cannot hold.
inline constexpr double kSmallestSize = 1e-9;
inline constexpr double kLargestSize = 1e9;

/// Throws InputError when what `file` holds is smaller or larger across, or lies farther off the origin.
void require_size(const Points& vertices, const std::string& file);

/// Between the faces of a tet, inside it: 0 and 180 where a face has no area.
struct DihedralAngles {
  double smallest_degrees = 0.0;
  double largest_degrees = 0.0;
};
DihedralAngles compute_dihedral_angles(const std::array<Vec3, 4>& corners);

/// Mean ratio η = 12 (3V)^⅔ / Σ l² of a tet's volume and edges: 1 where it is regular, 0 where it is flat or
/// inverted [Liu1994].
double compute_shape(const std::array<Vec3, 4>& corners);

/// What a reviewer asks of a tet mesh. Lists hold element or vertex numbers from 0, increasing.
struct QualityReport {
  int num_vertices = 0;
  int num_tets = 0;
  double volume = 0.0;                ///< [m³]
  double min_dihedral_degrees = 0.0;  ///< between faces, inside the tet; 0 when a face has no area
  double max_dihedral_degrees = 0.0;  ///< 180 when a face has no area
  std::vector<int> inverted;          ///< tets with volume < 0, beyond round-off
  std::vector<int> flat;              ///< tets whose volume is below round-off of their size, or 1e-45 m³
  std::vector<int> orphan_vertices;   ///< used by no tet
  std::vector<int> overfull_faces;    ///< tets with a face that three or more share, or two on the same side
  std::vector<int> non_manifold_vertices;  ///< boundary vertices whose boundary triangles form no single fan
  int num_non_manifold_edges = 0;          ///< boundary edges with other than two boundary triangles
  int num_components = 0;                  ///< parts not connected by faces
};

/// Vertex numbers must be in range. Nothing else is asked of the mesh.
QualityReport compute_quality(const TetMesh& mesh);

/// Throws InputError naming the elements when `report` has what a simulation cannot run with: inverted or
/// flat tets, orphan vertices, overfull faces. A non-manifold boundary is returned as a warning line, else
/// empty.
std::string require_usable(const QualityReport& report, const std::string& file);

}  // namespace argil::mesh
