#pragma once

#include <string>
#include <vector>

#include "mesh/tet_mesh.h"

namespace argil::embed {

/// Where each embedded point lies in the cage.
struct Embedding {
  std::vector<int> tet;  ///< containing cage tet of each point
  Eigen::Matrix4Xd
      weights;  ///< barycentric weights in it, sum 1; of a point inside in [0, 1] up to round-off
  int num_points() const { return static_cast<int>(tet.size()); }
};

/// Finds the containing tet of every point (on a shared face: the lowest tet). Throws InputError naming
/// `file`, the first outside points and their distance when the cage does not enclose all of them. Those that
/// are nearer to the boundary than `most_beyond` longest edges of the tet below it are carried by that tet.
Embedding make_embedding(const mesh::TetMesh& cage, const Points& points, const std::string& file,
                         double most_beyond = 0.0);
/// Would make_embedding take all of the points?
bool can_embed(const mesh::TetMesh& cage, const Points& points, double most_beyond);
/// Of a body that is fitted to the points' surface.
inline constexpr double kMostBeyondFitted = 2.0;
inline constexpr double kAnyBeyond = 1e30;

/// Positions of the embedded points for cage nodes `x`: Σ Nᵢ(w) xᵢ. `nodes`: 4×m (N = w) or 10×m (quadratic)
/// node numbers of the cage's tets. `out` is resized once.
void interpolate_positions(const Embedding& embedding, const Eigen::MatrixXi& nodes, const Points& x,
                           Points& out);

/// A per-tet field (saturation) seen at the embedded points: the value of the containing tet (the paper).
void interpolate_tet_field(const Embedding& embedding, const Field& per_tet, Field& out);

/// Region of influence: 1 at the tool's point falling by the kernel to the radius R_D, 0 beyond:
/// out(i) = 1 − |xᵢ − centre|/radius clipped to [0, 1].
void compute_region_of_influence(const Points& x, const Vec3& centre, double radius, Field& out);

}  // namespace argil::embed
