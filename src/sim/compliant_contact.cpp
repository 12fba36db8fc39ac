// Contact against a surface that deflects between two steps of the body (`compliant`).

#include "sim/body_side.h"
#include "sim/hand_side.h"

namespace argil::sim {

/// Detection over the last tick against a surface that deflects: it first follows the tool as far as the
/// springs of the last contacts let it, then comes to balance with those that are found. The hand feels the
/// force of the place where it is; pairs that came and went within the tick add their mean.
StepStatus HandSide::find_compliant_force() {
  const BodyBetweenSteps body = m_body.between_steps(m_state.clock.tick + 1);
  follow_with_springs();
  const bool has_deflected = m_compliance.num_known() > 0;
  ARGIL_TRY(m_compliance.press(body, m_springs));
  m_compliance.displace(body.state.x, m_deflected_x);
  if (m_touched.has_moved() || has_deflected) m_touched.move_to(m_deflected_x);
  find_contacts(1);
  make_springs();
  ARGIL_TRY(m_compliance.press(body, m_springs));

  m_state.hand_force.setZero();
  m_state.hand_torque.setZero();
  for (std::size_t i = 0; i < m_springs.size(); ++i) {
    ContactSpring spring = m_springs[i];
    if (!(spring.force > 0.0)) continue;
    const Vec3 on_hand = spring.force * spring.normal;
    spring.force += spring.stiffness * m_compliance.compute_deflection(m_surface, spring);
    press(m_contacts.contacts[m_spring_contact[i]], on_hand, spring);
  }
  for (const contact::Contact& c : m_contacts.contacts)
    if (c.passes) press(c, c.force, {c.vertex, c.weight, c.normal, 0.0, c.force.norm(), c.point});
  m_collector.begin_felt();  // the hand has felt the deflection already
  return StepStatus::ok();
}

/// A contact on the hand, with the force `on_hand`, and on the body. `spring`: the contact as it acts where
/// the step begins, before the surface deflects.
void HandSide::press(const contact::Contact& contact, const Vec3& on_hand, const ContactSpring& spring) {
  contact::Contact c = contact;
  m_state.hand_force -= on_hand + c.resistance;
  m_state.hand_torque -= (c.point - m_state.tool.position).cross(on_hand + c.resistance);
  const Vec3 force = spring.force * spring.normal + c.resistance;
  m_collector.add_force(c, force);
  c.stiffness = spring.stiffness;
  const int group = m_collector.add_stiffness(c, m_collector.share() * force, true, m_touched.x_t0());
  m_compliance.hold(spring, m_collector.share(), group);
}

/// A tool that meets the surface as it is takes all deflection from it.
void HandSide::release_springs() {
  if (m_compliance.num_known() == 0) return;
  m_springs.clear();
  m_compliance.release();
  m_touched.move_to(m_body.state().solid.x);
}

StepStatus HandSide::update_compliance() {
  if (!m_params.deflects_between_steps()) return StepStatus::ok();
  return m_compliance.begin_frame(m_body.between_steps(m_state.clock.tick + 1), m_body.x_before());
}

/// The springs of the last detection go with the tool.
void HandSide::follow_with_springs() {
  const contact::Pose& from = m_state.contact_tool;
  for (ContactSpring& spring : m_springs) {
    const Vec3 in_tool = from.orientation.conjugate() * (spring.point - from.position);
    const Vec3 point = m_state.tool.position + m_state.tool.orientation * in_tool;
    spring.force += spring.stiffness * spring.normal.dot(point - spring.point);
  }
}

/// Springs of the pairs that are in penetration at the end of the tick.
void HandSide::make_springs() {
  m_springs.clear();
  m_spring_contact.clear();
  for (std::size_t i = 0; i < m_contacts.contacts.size(); ++i) {
    const contact::Contact& c = m_contacts.contacts[i];
    if (!(c.end_stiffness > 0.0)) continue;
    m_springs.push_back({c.vertex, c.weight, c.normal, c.end_stiffness, c.end_force, c.point});
    m_spring_contact.push_back(i);
  }
}

}  // namespace argil::sim
