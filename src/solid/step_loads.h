#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "solid/elements.h"

namespace argil::solid {

/// Stiffness that a penalty contact adds between its nodes: k·wᵢwⱼ n⊗n. Entries of one group press on
/// the body with Σ n·f − k n·(x' − x) of those that count, or are let go all together where that would draw.
/// One that is alone is all of its group: its force is max(0, n·f − k n·(x' − x)), whatever came before.
struct PointStiffness {
  /// −1 beyond the last; all of one tet.
  std::array<int, 10> vertex = {-1, -1, -1, -1, -1, -1, -1, -1, -1, -1};
  std::array<double, 10> weight = {};
  Vec3 normal = Vec3::Zero();
  double stiffness = 0.0;     ///< k [N/m]
  Vec3 force = Vec3::Zero();  ///< f [N]: how much of the loads is this contact's at x
  int group = -1;             ///< number of the group's first entry; −1: acts whatever its force
  bool counts = false;        ///< it is along this normal that its group must not draw
  bool is_alone = false;
  double begin_force =
      0.0;               ///< [N] where the step begins: what presses there is the first guess of what acts
  bool is_near = false;  ///< n·f ≤ 0: it presses only where the body comes to it; f is no part of the loads
  /// > 0: this is the friction of the contact `partner`, with Coulomb's coefficient μ: a spring of
  /// `stiffness` in all directions across that one's normal, whose `force` without the body's motion is f; it
  /// carries no more than μ times what its partner presses with, which is alone. It has no group.
  double friction = 0.0;
  int partner = -1;
  std::size_t count() const {
    return static_cast<std::size_t>(std::find(vertex.begin(), vertex.end(), -1) - vertex.begin());
  }
};

/// What acts on the body during a step.
struct StepLoads {
  const Points& force;                            ///< 3×n external forces [N] without gravity
  std::span<const PointStiffness> contacts = {};  ///< and how those of contacts grow as the body moves on
  /// Of an active region: share of a node's speed that the step will leave it; empty: all of it.
  std::function<double(Eigen::Index)> mobility = {};
  /// Forces [N] without balance, Euclidean norm over all nodes, that a step's solve may leave; 0: the
  /// tolerance of the parameters decides.
  double slack = 0.0;
  /// And what it leaves at most where there is slack, whatever the tolerance.
  double limit = std::numeric_limits<double>::infinity();
  /// Of an active region: by how much the hand's force may be off [N] for what is left as it is; 0: as for
  /// slack.
  double region_slack = 0.0;
  /// Of an active region: nodes whose force may be another than in the last step; null: any.
  const std::vector<int>* changed = nullptr;
  /// A step with one linearisation is solved once more about where it came to: what turns and stretches on
  /// the way is a part of its forces then.
  bool follows_turns = false;
};

}  // namespace argil::solid
