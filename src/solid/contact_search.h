#pragma once

#include <span>

#include "solid/part.h"
#include "solid/step_loads.h"

namespace argil::solid {

struct Body;
struct ContactActivity;
struct StepContacts;

/// Of a step of this length [s] whose contacts are alone, of a body that goes at v (3×n) [m/s]: those that
/// press act, with friction within the limit of what they press with at the start. Which of them slide, and
/// where to, is taken from where they would be if the body went on.
void start_alone(std::span<const PointStiffness> contacts, const Points& v, double step_s,
                 ContactActivity& activity);

/// Contacts that are alone act as they would at x, with friction within the limits that it has.
void choose_alone(const StepContacts& contacts, const Points& x, ContactActivity& activity);

/// Its limits become those of what presses at x. False where all friction carries what they say to a
/// thousandth: then it stays as it is.
bool update_friction(const StepContacts& contacts, const Points& x, ContactActivity& activity);

/// Of contact i, which is alone and would exert `trial` [N] without a limit [J].
double compute_potential_alone(const PointStiffness& contact, const Vec3& trial,
                               const ContactActivity& activity, std::size_t i);

/// After a solve of a step with one linearisation: true where its contacts act as they do at its end, else it
/// is to be solved again with others.
///
/// The forces of contacts that are alone, with friction of given limits, are the slope of a convex potential:
/// ½ Σ max(0, n·f − k n·(x − x₀))²/k, and Huber's for friction [Huber1964]. Newton's method on it is to solve
/// again with what acts where the search stands; on the way to each solution it goes to the least potential,
/// so that no set comes back. A point that would slide back at a solution is a secant in the next. As soon as
/// little is off by the limits that there are, they follow what presses, until friction carries what
/// Coulomb's law says to a thousandth. After very many rounds the step ends at the least that was found.
/// `tolerance`: share of what presses that may draw or be missing. Of other contacts see
/// update_active_contacts().
bool settle_contacts(Body& body, const Part& part, std::span<const PointStiffness> list, double tolerance);

}  // namespace argil::solid
