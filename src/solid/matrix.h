#pragma once

#include <span>

#include "solid/part.h"
#include "solid/step_loads.h"
#include "solid/system.h"

namespace argil::solid {

struct Body;

/// Does the matrix need ∂P/∂F? The one-step linear and corotational models keep their rotation instead.
bool needs_tangents(const Body& body);

/// Of the present step.
MatrixShares compute_shares(const Body& body);

/// τ² of the contacts' stiffness, and τ of their fall, are so many times the step's. Newmark's rule for
/// clay takes the mean force of both ends, and contacts by that rule gain energy wherever they come and go;
/// so theirs is the force at the end [Kane1999].
double find_contact_share(const Body& body);
/// How often the contacts' stiffness enters the matrix: that many times τ².
double find_contact_scale(const Body& body);

/// Frame of the stiffness whose rotation is kept: the present one, or that of the step's start.
Mat3 kept_rotation(const Body& body, int point);

/// A of the present iterate with the contacts that act, in the rows of `part` and those next to them.
void assemble_matrix(Body& body, const Part& part, std::span<const PointStiffness> contacts);

}  // namespace argil::solid
