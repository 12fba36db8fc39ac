#pragma once

#include <span>
#include <vector>

#include "solid/step_loads.h"

namespace argil::solid {

struct Body;

/// What a step takes friction at a point for.
enum class Slip {
  none,     ///< a spring
  tangent,  ///< `force` − c e e·(x − x₀) with e across its way: it turns with the motion
  secant,  ///< `force` − c (x − x₀) in all directions: less the less far it goes, and never against its way
};

/// Friction at a point: a spring that carries no more than `limit`. Where it slides, c is the spring's
/// stiffness in the ratio of the limit to what the spring alone would carry: the farther, the softer.
struct Friction {
  double limit = 0.0;  ///< [N]
  Slip slip = Slip::none;
  Vec3 force = Vec3::Zero();   ///< [N]
  Vec3 across = Vec3::Zero();  ///< e, unit
  double stiffness = 0.0;      ///< c [N/m]
};

/// Where the search for the contacts that act stands, within a step.
struct ContactSearch {
  Points delta;               ///< δ there, a column a row [m/s]
  std::vector<Vec3> trial;    ///< of each contact there: what it would exert without a limit [N]
  int num_rounds = 0;         ///< since it began
  bool has_given_up = false;  ///< stands at the best that it has found
};

/// Which contacts act in the present step, and how.
struct ContactActivity {
  std::vector<char> acts;          ///< at the number of each group's first entry
  std::vector<double> force;       ///< likewise: Σ n·f − k n·(x − x₀) [N]
  std::vector<Friction> friction;  ///< of each contact; empty where none has any
  std::vector<Vec3> trial;         ///< of each contact at the last solution, where they are alone
  int num_updates = 0;             ///< of the step
  bool are_alone = false;          ///< all groups are of one entry
  ContactSearch search;            ///< then, after some updates

  /// Of a step of this length [s] with these contacts, of a body that goes at v (3×n) [m/s]. What is alone
  /// acts where it has pressed, or, if none has, where it is not near; all others act.
  void start(std::span<const PointStiffness> contacts, const Points& v, double step_s);
  /// They act as they do; the search for others begins anew.
  void go_on() {
    num_updates = search.num_rounds = 0;
    search.has_given_up = false;
  }
  bool is_acting(int group) const { return group < 0 || acts[static_cast<std::size_t>(group)] != 0; }
};

/// Σ wᵢ uᵢ over the nodes that a contact presses; u: 3×n.
Vec3 find_mean(const PointStiffness& contact, const Points& u);

/// What a contact would exert once its point has moved by u [m], if it could draw, and its friction had no
/// limit [N].
Vec3 compute_trial(const PointStiffness& contact, const Vec3& u);

/// Contacts of a step that began at x_start (3×n) [m].
struct StepContacts {
  std::span<const PointStiffness> list;
  const Points& x_start;

  /// Mean displacement since then of the nodes that contact i presses [m].
  Vec3 displacement(std::size_t i, const Points& x) const;
  /// What contact i would exert at x if it could draw, and its friction had no limit [N].
  Vec3 compute_trial(std::size_t i, const Points& x) const;
  /// How much less than f contact i exerts at x [N].
  Vec3 compute_fall(std::size_t i, const Points& x, const ContactActivity& activity) const;
  /// How the force of contact i falls with the displacement of its point [N/m], symmetric.
  Mat3 stiffness(std::size_t i, const ContactActivity& activity) const;
  /// Potential of what compute_fall is the force of [J].
  double compute_potential(std::size_t i, const Points& x, const ContactActivity& activity) const;
};

/// Lets go what would draw at x and takes back what would press again. After some updates contacts are only
/// let go, so that this ends. False when all is as it was.
bool update_active_contacts(const StepContacts& contacts, const Points& x, ContactActivity& activity);

/// force += scale · Σ k n n·u of the contacts that act.
void add_contact_product(const StepContacts& contacts, const ContactActivity& activity, const Points& u,
                         double scale, Points& force);

/// force += f, shared among the nodes that the contact presses.
void spread(const PointStiffness& contact, const Vec3& f, Points& force);

/// How the force of contact i, of which a step was told, changed while the body moved: what to add [N] for
/// the force that acted. An implicit step takes it at its end, f − k n n·(x' − x), or 0 where it let it go.
Vec3 compute_contact_change(const Body& body, std::span<const PointStiffness> contacts, std::size_t i);

/// Euclidean norm over all nodes of the forces that act on them by the contacts of a step at its iterate [N];
/// where it is larger, that of the internal forces at the same nodes, which held the contacts before.
double find_contact_norm(Body& body, std::span<const PointStiffness> contacts);

/// Turns the contact forces that were given to a step into those that acted.
void apply_contact_stiffness(const Body& body, std::span<const PointStiffness> contacts, Points& force);

}  // namespace argil::solid
