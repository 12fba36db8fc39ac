#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shapes/implicit.h"

namespace argil::shapes {

/// Place of a lattice node in half cube edges: all even is a cube's corner, all odd its centre.
using LatticePlace = std::array<int, 3>;

/// Body-centred cubic lattice over a box. A node has 6 long edges (one cube edge h, to its own kind) and 8
/// short ones (√3/2 h, to the other kind). Nodes are numbered corners first, x fastest.
class BccLattice {
 public:
  /// Covers `surface`'s box with at least one free cube all round; the box centre is a cube corner.
  BccLattice(const ImplicitSurface& surface, double cell_size);

  double cell_size() const { return m_cell_size; }
  int num_nodes() const { return m_num_corners + m_cells[0] * m_cells[1] * m_cells[2]; }
  /// Number of cubes along each axis.
  const std::array<int, 3>& num_cells() const { return m_cells; }
  int node(const LatticePlace& place) const;
  LatticePlace place(int node) const;
  Vec3 position(const LatticePlace& place) const;
  bool contains(const LatticePlace& place) const;

 private:
  double m_cell_size;
  Vec3 m_origin;
  std::array<int, 3> m_cells;
  int m_num_corners;
};

/// The 14 edges of a node: direction i < 7 leads to a later node, i + 7 is its opposite. 0–2 are long.
inline constexpr std::array<LatticePlace, 14> kLatticeEdges = {{{2, 0, 0},
                                                                {0, 2, 0},
                                                                {0, 0, 2},
                                                                {1, 1, 1},
                                                                {1, -1, 1},
                                                                {1, 1, -1},
                                                                {1, -1, -1},
                                                                {-2, 0, 0},
                                                                {0, -2, 0},
                                                                {0, 0, -2},
                                                                {-1, -1, -1},
                                                                {-1, 1, -1},
                                                                {-1, -1, 1},
                                                                {-1, 1, 1}}};
inline constexpr int kForwardEdges = 7;
inline bool is_long_edge(int direction) {
  return direction % kForwardEdges < 3;
}

/// A lattice whose nodes know their side of the surface, and the points where the surface cuts its edges,
/// after nodes too close to a cut have moved onto it.
class CutLattice {
 public:
  enum class Side : std::int8_t { inside = -1, surface = 0, outside = 1 };

  /// Calls surface.value once per node and some ten times per cut edge.
  CutLattice(const ImplicitSurface& surface, double cell_size);

  /// Takes these nodes back to their lattice places for good. Cuts too close to them move away from them
  /// instead, which keeps the angles' bounds and gives way by at most a quarter of a cube edge.
  void keep_in_place(const std::vector<int>& nodes);

  const BccLattice& lattice() const { return m_lattice; }
  Side side(int node) const { return m_side[static_cast<std::size_t>(node)]; }
  Vec3 position(int node) const;
  /// Index of the cut on the edge that leaves `node` in `direction`, or −1.
  int find_cut(int node, int direction) const;
  int num_cuts() const { return static_cast<int>(m_cuts.size()); }
  const Vec3& cut_position(int cut) const { return m_cuts[static_cast<std::size_t>(cut)].position; }

 private:
  struct Cut {
    int direction;    // forward, from the earlier node
    double fraction;  // of the edge, from the earlier node
    Vec3 position;
  };

  void classify_nodes(const ImplicitSurface& surface, Field& value);
  void find_cuts(const ImplicitSurface& surface, const Field& value);
  void snap_nodes();
  int find_nearest_cut(int node) const;
  int neighbour(int node, int direction) const;

  BccLattice m_lattice;
  std::vector<Side> m_side;       // per node, after snapping
  std::vector<bool> m_is_inside;  // per node, before snapping
  std::vector<bool> m_is_kept;    // per node: never snapped
  std::vector<int> m_cut_begin;   // per node: where its forward cuts begin in m_cuts
  std::vector<Cut> m_cuts;
  std::vector<int> m_cut_nodes;     // nodes at the end of a cut edge, increasing
  std::vector<int> m_snapped_node;  // increasing
  std::vector<int> m_snapped_cut;   // the cut onto which the node moved
};

}  // namespace argil::shapes
