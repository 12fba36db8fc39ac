#pragma once

#include <array>
#include <utility>
#include <vector>

#include "base/archive.h"
#include "contact/contact.h"
#include "device/gate.h"
#include "sim/contact_surface.h"
#include "sim/params.h"

namespace argil::sim {

/// How an entry of ContactLoad::stiffness acts on the hand.
struct ContactLever {
  Vec3 point = Vec3::Zero();   ///< where [m]
  double force_at_rest = 0.0;  ///< what the solve was told besides, for damping [N]
};

/// Contacts of several ticks that press on the same vertices and count as one.
struct ContactGroup {
  std::array<int, 3> vertex = {-1, -1, -1};  ///< of the surface
  std::size_t first = 0;                     ///< entry of ContactLoad::stiffness
  std::size_t pieces = 0;                    ///< and how many stand for a contact
};

/// Where a tool exerts force on the body.
struct ContactPatch {
  Vec3 centre = Vec3::Zero();  ///< of pressure of the last detection [m], valid while is_pressed
  double weight = 0.0;         ///< Σ|force| of the last detection [N]
  bool is_pressed = false;     ///< a push or pull tool exerts a force on the body
  bool is_touched = false;     ///< some detection of the step found a force on the body
};

/// How finely the body is made where a tool presses on it.
struct PatchResolution {
  double cells = 0.0;  ///< along the radius of what it touches; 0: not known
  double sag = 0.0;    ///< PressureContact::find_sag [m]
};

/// What the hand hands to the body for one step: the contacts of its ticks since the last one, each by its
/// share of the step. Ticks only append to it, so that a tick that fails is cut off again.
struct ContactLoad {
  // When it is handed over.
  HandPose hand;                ///< at the end of the tick in which it is
  int num_ticks = 0;            ///< since the last one
  int detections = 1;           ///< whose mean the body gets
  double way_over_patch = 0.0;  ///< the tool's in the last detection, over the radius of what it presses on
  PatchResolution resolution;   ///< of what it presses on, where the error is estimated
  Vec3 inward = Vec3::Zero();   ///< find_inward of the last detection
  double scale = 1.0;           ///< by which the sum of `forces` has yet to be multiplied for that
  device::ToolMode mode = device::ToolMode::push;
  std::vector<int> touched_tet;      ///< by a tool that wets or dries in the tick that hands over
  std::vector<double> touched_area;  ///< [m²] of each, for the whole water period
  // Tick by tick.
  ContactPatch patch;
  std::vector<SurfaceForce> forces;  ///< on the body
  std::vector<solid::PointStiffness> stiffness;
  std::vector<ContactLever> levers;  ///< of each of these
  std::vector<ContactGroup> groups;
  std::size_t last_detection = 0;  ///< entry of `stiffness` where the last detection's contacts begin

  ContactLoad();
  /// Ready for the ticks of another step; keeps its storage.
  void clear();

  /// How far the ticks have filled it.
  struct Mark {
    ContactPatch patch;
    std::size_t forces = 0, stiffness = 0, groups = 0;
    std::size_t last_detection = 0;
  };
  Mark mark() const { return {patch, forces.size(), stiffness.size(), groups.size(), last_detection}; }
  void cut_to(const Mark& mark);
  /// What the ticks have filled in.
  void serialize(Archive& archive);
};

/// The contacts; where nothing reaches into the surface, points that the tool has left by little, which may
/// press in the step.
inline const std::vector<contact::Contact>& list_touching(const contact::Contacts& contacts) {
  return contacts.contacts.empty() ? contacts.near : contacts.contacts;
}
/// Unit: from the tool into the clay, mean of those by their springs; zero where there are none.
Vec3 find_inward(const contact::Contacts& contacts);

/// Makes the load of a step from the contacts of its ticks.
class LoadCollector {
 public:
  /// All are kept by reference.
  LoadCollector(const Params& params, const ContactSurface& surface, const solid::Elements& elements);

  /// Part of the step in which a detection's contacts act, when the step has as many ticks as planned.
  double share() const { return m_share; }
  const ContactLoad& load() const { return m_load; }

  /// Contacts of another detection follow. `way_over_patch`: of the tool in it.
  void begin_detection(double way_over_patch, const PatchResolution& resolution);
  /// Adds a contact's force on the body, by its share of the step.
  void add_force(const contact::Contact& contact, const Vec3& force);
  /// How a contact's force changes as the body moves on. `force`: on the body, by its share of the step; `x`:
  /// the touched surface's vertices [m]. Returns the group of contacts with which it is let go; −1: none.
  int add_stiffness(const contact::Contact& contact, const Vec3& force, bool pushes, const Points& x);
  /// The same of a pressure, each of whose entries falls to zero by itself, and of its friction, which is
  /// solved for with the step. `is_near`: it does not press yet.
  void add_pressure(const contact::Contact& contact, bool is_near, const Points& x);
  /// How a bond's force changes as the body moves on: alike in all directions, whether it pushes or draws.
  void add_bond(const contact::Contact& bond, const Points& x);
  /// A force on the body that no contact of the present has: for a whole step.
  void add_reaction(const SurfaceForce& force);
  /// Contacts from here on change the force that the hand feels; those before have been felt as they are.
  void begin_felt() { m_load.last_detection = m_load.stiffness.size(); }

  /// Swaps the load, which ends with this tick of the hand, for an empty one. `num_ticks`: since the last.
  void hand_over(const HandPose& hand, device::ToolMode mode, int num_ticks,
                 const contact::Contacts& contacts, ContactLoad& load);
  /// Undoes that.
  void take_back(ContactLoad& load) { std::swap(m_load, load); }

  void commit() { m_mark = m_load.mark(); }
  void roll_back() { m_load.cut_to(m_mark); }
  void serialize(Archive& archive);

 private:
  void add_stiffness_along(const contact::Contact& contact, const Vec3& direction, double stiffness,
                           double force_at_rest, const Points& x);
  std::size_t find_group(const contact::Contact& contact, std::size_t first, std::size_t pieces);

  const Params& m_params;
  const ContactSurface& m_surface;
  const solid::Elements& m_elements;
  double m_share;
  ContactLoad m_load;
  ContactLoad::Mark m_mark;
};

}  // namespace argil::sim
