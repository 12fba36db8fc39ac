#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/types.h"

namespace argil::solid {

struct Elements;

/// Part of space whose nodes at rest are meant.
struct Region {
  enum class Kind { box, sphere, half_space, plane, nodes } kind = Kind::box;
  Vec3 lower = Vec3::Zero();    ///< box [m]
  Vec3 upper = Vec3::Zero();    ///< box [m]
  Vec3 centre = Vec3::Zero();   ///< sphere [m]
  double radius = 0.0;          ///< sphere [m]
  Vec3 normal = Vec3::UnitZ();  ///< of any length, n its direction: half_space: n·x ≤ offset;
                                ///< plane: |n·x − offset| ≤ thickness
  double offset = 0.0;          ///< half_space, plane [m]
  double thickness = 1e-9;      ///< plane: half of it [m]
  std::vector<int> nodes;       ///< nodes
};

/// Nodes whose motion is prescribed, in all or some directions.
struct Support {
  Region region;
  std::array<bool, 3> fixes = {true, true, true};  ///< x, y, z
  Vec3 displacement = Vec3::Zero();  ///< [m] reached at the end of the ramp, from rest at its start
  double ramp_start = 0.0;           ///< [s]
  double ramp_end = 0.0;             ///< [s]; not after ramp_start: at once
};

/// Regions → nodes, increasing, without repeats.
std::vector<int> find_nodes(const Points& rest, std::span<const Region> regions);

/// Which components of which node are prescribed, and by which support; later supports win.
struct Constraints {
  Eigen::Matrix3Xi support;  ///< 3×n: number of the support that holds this component, −1: free

  bool is_free(int node) const { return (support.col(node).array() < 0).all(); }
  bool is_held(int node) const { return (support.col(node).array() >= 0).all(); }
};

/// A node in the middle of an edge is held where both ends of the edge are meant, by place or by number.
Constraints find_constraints(const Elements& elements, std::span<const Support> supports);

/// Displacement that a support prescribes at a time.
Vec3 compute_displacement(const Support& support, double time);

}  // namespace argil::solid
