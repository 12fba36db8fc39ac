#pragma once

#include <optional>

#include "contact/tool_solid.h"

namespace argil::contact {

/// What the force is a force of.
enum class ContactLaw {
  pairs,     ///< eqs. 7 and 8: a stiffness for each pair of features in touch (the paper)
  pressure,  ///< κ times the depth, over the area in touch
};

/// κ h/E* [–] of a pressure whose κ is chosen: doubling it changes the force by less than a hundredth where
/// the patch's radius has two cells or more.
inline constexpr double kChosenStiffness = 80.0;

/// How deep a pair counts.
enum class PenaltyKind {
  continuous,  ///< eqs. 7 and 8: mean over the interval
  discrete,    ///< what the paper sets itself against: the depth at the end of the interval
};

struct ContactParams {
  double vertex_face_stiffness = 0.0;  ///< k_vf [N/m], eq. 7
  double edge_edge_stiffness = 0.0;    ///< k_ee [N/m], eq. 8
  PenaltyKind penalty = PenaltyKind::continuous;
  /// Faces that are farther from a vertex than its nearest one by less than this share of the distance take
  /// part in the direction of its force, so that the force does not jerk when the vertex passes from one face
  /// to the next [–], ≥ 0. 0: the nearest face alone, eq. 7 to the letter. For the continuous penalty.
  double face_blend = 0.25;
  /// λ [s/m], ≥ 0: the normal force is k d (1 + λ ḋ) instead of k d, never below 0 [Hunt1975].
  double damping = 0.0;
  /// μ [–], ≥ 0: Coulomb's coefficient. A pair sticks by a spring as stiff as its normal one, and slides when
  /// that would carry more than μ times the normal force.
  double friction = 0.0;
  /// [m], ≥ 0: vertices and edges that come this near count as met by detection. The force stays that of
  /// penetration.
  double minimum_separation = 0.0;
  ContactLaw law = ContactLaw::pairs;
  /// pressure: κ [Pa/m], > 0; 0: as the body's stiffness asks for.
  double pressure_stiffness = 0.0;
  /// pressure: mean traction [Pa] that a pulling tool's grip bears, > 0.
  double grip_strength = 0.0;
  /// pressure: the tool's exact shape; none: the one that its triangles enclose.
  std::optional<RoundTool> round_tool = {};
};

}  // namespace argil::contact
