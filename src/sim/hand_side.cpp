// Between the contacts, the body and the hand: who gets which force.

#include "sim/hand_side.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace argil::sim {

using device::ToolMode;

ContactLoad::ContactLoad(Eigen::Index num_nodes) : force(num_nodes) {
  constexpr std::size_t kContacts = 16384;  // more than a late step gathers
  stiffness.reserve(kContacts);
  yields.reserve(kContacts);
  groups.reserve(kContacts);
}

void ContactLoad::clear() {
  force.clear();
  is_touched = false;
  is_pressed = false;
  centre.setZero();
  stiffness.clear();
  yields.clear();
  groups.clear();
  last_detection = 0;
  touched_tet.clear();
  touched_area.clear();
}

HandSide::HandSide(const mesh::TriangleMesh& tool, const Params& params, const ContactSurface& surface,
                   const solid::Elements& elements, const device::DeviceSample& start)
    : m_params(params),
      m_surface(surface),
      m_elements(elements),
      m_share(params.rates.between_frames == BetweenFrames::hold ? 1.0
                                                                 : 1.0 / params.rates.physics_period_ticks),
      m_detector(surface.triangles(), surface.num_vertices(), tool, params.contact),
      m_compliance(surface, elements.num_nodes()),
      m_load(elements.num_nodes()),
      m_chatter(params.chatter_limit, params.rates.haptic_period),
      m_gate(params.device, params.rates.haptic_period) {
  m_clock.period = params.rates.haptic_period;
  m_detector.share(params.threads);
  m_moved.reserve(static_cast<std::size_t>(surface.num_vertices()));
  begin_at(start);
}

void HandSide::begin_at(const device::DeviceSample& start) {
  m_state.tool = {start.position, start.orientation};
  m_state.mode = start.mode;
  m_state.contact_tool = m_state.tool;
  if (m_state.contact_x.size() > 0) m_detector.prepare(m_state.contact_x, m_state.tool);
}

/// A first look at contacts, which sees nothing move.
void HandSide::prepare_alone() {
  m_detector.share(1);
  m_detector.find_contacts(m_state.contact_x, m_state.contact_x, m_state.tool, m_state.tool, m_contacts, 0.0);
}

void HandSide::see(BodyAnswer& answer) {
  if (!m_has_felt_anew) {
    m_state.hand_force = answer.felt.force;
    m_state.hand_torque = answer.felt.torque;
  }
  if (!answer.has_moved) return;
  if (answer.is_whole) {
    m_state.surface_x.swap(answer.surface_x);
    m_has_all_moved = true;
  } else {
    if (!m_is_surface_known && !m_state.has_moved) m_state.surface_x = m_state.contact_x;
    m_is_surface_known = true;
    for (std::size_t i = 0; i < answer.moved.size(); ++i)
      m_state.surface_x.col(answer.moved[i]) = answer.surface_x.col(static_cast<Eigen::Index>(i));
    m_moved.insert(m_moved.end(), answer.moved.begin(), answer.moved.end());
  }
  m_state.has_moved = true;
}

/// How far the surface has moved since the last detection, at most; nothing where that takes a look at all of
/// it.
std::optional<double> HandSide::find_surface_motion() const {
  if (!m_state.has_moved) return 0.0;
  if (m_has_all_moved) return {};
  double motion = 0.0;
  for (const int v : m_moved)
    motion = std::max(motion, (m_state.surface_x.col(v) - m_state.contact_x.col(v)).cwiseAbs().maxCoeff());
  return motion;
}

/// The last detection has seen the surface where it is.
void HandSide::take_up_surface() {
  if (m_has_all_moved) {
    m_state.contact_x.swap(m_state.surface_x);
    m_is_surface_known = false;
  } else {
    for (const int v : m_moved) m_state.contact_x.col(v) = m_state.surface_x.col(v);
  }
  forget_motion();
}

void HandSide::forget_motion() {
  m_has_all_moved = false;
  m_moved.clear();
  m_state.has_moved = false;
}

void HandSide::place_surface(const Points& x) {
  m_state.contact_x = x;
  m_state.surface_x = x;
  m_is_surface_known = true;
  forget_motion();
  m_detector.prepare(x, m_state.tool);
}

void HandSide::move_surface(const Points& x) {
  m_surface.find_positions(x, m_state.surface_x);
  m_has_all_moved = true;
  m_state.has_moved = true;
}

/// The device holds its last force on the way to where the hand is at the end of the tick, so that the work
/// done on the hand is force times path, exactly; a turn is taken about one axis.
void HandSide::move(const device::DeviceSample& sample) {
  const Eigen::AngleAxisd turn(sample.orientation * m_state.tool.orientation.conjugate());  // the shorter way
  m_state.motion = {sample.position - m_state.tool.position, turn.angle() * turn.axis()};
  m_state.port_energy += device::compute_work({m_gated.force, m_gated.torque}, m_state.motion);
  m_state.passivity_energy += device::compute_work(m_state.withheld, m_state.motion);
  m_state.tool = {sample.position, sample.orientation};
  m_state.mode = sample.mode;
  ++m_ticks_since_step;
}

bool HandSide::is_wetting() const {
  return m_state.mode == ToolMode::wet || m_state.mode == ToolMode::dry;
}

/// Does the surface yield between physics steps? Tools that do not deform the body meet it as it is, and so
/// does a pulling one, whose negative stiffness has no balance with the body where it is the stiffer.
bool HandSide::is_yielding() const {
  return m_params.rates.between_frames == BetweenFrames::compliant && m_state.mode == ToolMode::push;
}

/// fidelity: contacts of a tool and a surface that both stand still are what they were. The first such
/// detection may still change which pairs are in touch, and the second what it takes from that.
bool HandSide::finds_same_contacts() {
  constexpr int kSettled = 2;
  const bool is_still = !m_state.has_moved && m_state.tool.position == m_state.contact_tool.position &&
                        m_state.tool.orientation.coeffs() == m_state.contact_tool.orientation.coeffs();
  m_still_detections = is_still ? m_still_detections + 1 : 0;
  return m_params.fidelity.mode != FidelityMode::full && m_still_detections > kSettled &&
         !m_contacts.with_touched;
}

/// Detection over `ticks` ticks while the surface goes to where the body has moved it; both paths start where
/// the last one ended, so none has a gap.
void HandSide::find_contacts(int ticks) {
  const bool has_moved = m_state.has_moved;
  if (!finds_same_contacts())
    m_detector.find_contacts(m_state.contact_x, has_moved ? m_state.surface_x : m_state.contact_x,
                             m_state.contact_tool, m_state.tool, m_contacts, find_surface_motion(),
                             m_clock.seconds(ticks));
  m_state.num_contacts = static_cast<int>(m_contacts.contacts.size());
  take_up_surface();
  m_state.contact_tool = m_state.tool;
  m_state.force_age = 0;
  m_has_felt_anew = true;
  m_load.is_pressed = false;
  m_load.centre.setZero();
  m_pressed_weight = 0.0;
}

/// Adds a contact's force on the body, by its share of the step.
void HandSide::act_on_body(const contact::Contact& c, const Vec3& force) {
  m_load.is_touched = true;
  m_surface.add_force(c, m_share * force, m_load.force);
  // The centre of pressure so far.
  const double weight = force.norm();
  m_pressed_weight += weight;
  m_load.is_pressed = m_pressed_weight > 0.0;
  if (weight > 0.0) m_load.centre += weight / m_pressed_weight * (c.point - m_load.centre);
}

/// Eqs. 7 and 8 on the body, reversed in pull. Wet and dry tools feel the body but do not deform it.
void HandSide::spread_contact_force() {
  m_load.last_detection = m_load.stiffness.size();
  if (is_wetting()) return;
  const bool pushes = m_state.mode == ToolMode::push;
  for (const contact::Contact& c : m_contacts.contacts) {
    const Vec3 force = (pushes ? c.force : Vec3(-c.force)) + c.resistance;
    act_on_body(c, force);
    add_contact_stiffness(c, m_share * force, pushes);
  }
}

/// How a contact's force changes as the body moves on: falls by its stiffness, by damping with the speed, and
/// along the surface while it sticks, or across its way where it slides. One that pushes lets go before it
/// would draw. A pulling contact has negative stiffness; left out, so that the system stays positive
/// definite.
void HandSide::add_contact_stiffness(const contact::Contact& c, const Vec3& force, bool pushes) {
  // The damping force counted with the body's last speed; the solve finds the next, from a force without it.
  const double per_speed = c.damping / m_clock.seconds(m_params.rates.physics_period_ticks);
  const double at_rest = c.damping * c.body_speed;
  const std::size_t first = m_load.stiffness.size();
  add_contact_stiffness(c, c.normal, m_share * ((pushes ? c.stiffness : 0.0) + per_speed), m_share * at_rest);
  const std::size_t pieces = m_load.stiffness.size() - first;
  const std::size_t leader = pushes && pieces > 0 ? find_group(c, first, pieces) : 0;
  for (std::size_t i = 0; pushes && i < pieces; ++i) {
    solid::PointStiffness& piece = m_load.stiffness[first + i];
    piece.force =
        (pieces == 1 ? 1.0 : c.weight[i]) * force + m_load.yields[first + i].force_at_rest * c.normal;
    piece.group = static_cast<int>(leader + i);
    piece.counts = true;
  }
  if (c.sticking == 0.0) return;
  const bool slides = c.sticking < 0.0;
  const Vec3 dragged = c.resistance - c.normal.dot(c.resistance) * c.normal;
  const Vec3 along = slides ? dragged.normalized() : c.normal.unitOrthogonal();
  const std::array<Vec3, 2> directions = {c.normal.cross(along), along};
  for (std::size_t d = 0; d < (slides ? 1 : 2); ++d) {
    const std::size_t begin = m_load.stiffness.size();
    add_contact_stiffness(c, directions[d], m_share * std::abs(c.sticking), 0.0);
    for (std::size_t i = 0; pushes && i < pieces; ++i)
      m_load.stiffness[begin + i].group = static_cast<int>(leader + i);
  }
}

/// What presses on the same vertices in several ticks of a step is one contact to the body, which gets the
/// mean. Number of the first piece of the first of them, or `first` when there was none yet.
std::size_t HandSide::find_group(const contact::Contact& c, std::size_t first, std::size_t pieces) {
  for (const ContactGroup& group : m_load.groups)
    if (group.vertex == c.vertex && group.pieces == pieces) return group.first;
  m_load.groups.push_back({c.vertex, first, pieces});
  return first;
}

void HandSide::add_contact_stiffness(const contact::Contact& c, const Vec3& direction, double stiffness,
                                     double force_at_rest) {
  if (!(stiffness > 0.0)) return;
  m_surface.add_stiffness(c, direction, stiffness, m_elements, m_load.stiffness);
  const bool is_implicit =
      m_params.solid.implicit_contact && m_params.solid.integrator != solid::Integrator::symplectic_euler;
  if (!is_implicit) force_at_rest = 0.0;
  if (force_at_rest != 0.0) m_surface.add_force(c, force_at_rest * direction, m_load.force);
  // One entry stands for the contact as a whole, more of them for one of its vertices each.
  const std::size_t added = m_load.stiffness.size() - m_load.yields.size();
  for (std::size_t i = 0; i < added; ++i)
    m_load.yields.push_back(
        added == 1 ? ContactYield{c.point, force_at_rest}
                   : ContactYield{m_state.contact_x.col(c.vertex[i]), c.weight[i] * force_at_rest});
}

/// In `hold` there is one detection a step; otherwise each tick's contacts count with the share that they
/// have in a step of the planned length, which is set right here where it was shorter or longer.
void HandSide::give(ContactLoad& empty) {
  const int planned = m_params.rates.physics_period_ticks;
  const bool holds = m_params.rates.between_frames == BetweenFrames::hold;
  m_load.hand = pose();
  ++m_load.hand.ticks;  // this one ends
  m_load.num_ticks = m_ticks_since_step;
  m_load.scale =
      holds || m_ticks_since_step == planned ? 1.0 : static_cast<double>(planned) / m_ticks_since_step;
  m_load.detections = holds ? 1 : m_ticks_since_step;
  m_load.mode = m_state.mode;
  if (m_contacts.with_touched)
    m_surface.find_touched_tets(m_contacts, m_load.touched_tet, m_load.touched_area);
  std::swap(m_load, empty);
  m_ticks_since_step = 0;
  ++m_steps_begun;
  m_has_felt_anew = false;
}

StepStatus HandSide::begin_frame(const BodyAtFrame& body, const Points& x_before) {
  if (m_params.rates.between_frames != BetweenFrames::compliant) return StepStatus::ok();
  return m_compliance.begin_frame(body, x_before);
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

/// The last force, old or new, less what would generate energy, through the device's limits.
void HandSide::render(device::HandFeed feed) {
  m_chatter.see(m_state.hand_force);
  const device::Wrench felt{m_state.hand_force, m_state.hand_torque};
  device::Wrench sent = felt;
  if (m_params.passivity == device::Passivity::time_domain)
    sent = device::damp_generated_energy(felt, m_state.motion, -m_state.port_energy);
  m_state.withheld = {felt.force - sent.force, felt.torque - sent.torque};
  m_gated = m_gate.apply(sent.force, sent.torque, feed);
  m_clock.advance();
}

StepStatus HandSide::status() const {
  if (!m_chatter.is_chattering()) return StepStatus::ok();
  return StepStatus::failed({m_clock.tick + 1, "hand", -1,
                             "share of the force that trembles above 50 Hz for 0.3 s", m_chatter.share(),
                             m_params.chatter_limit});
}

HapticRecord HandSide::make_record() const {
  HapticRecord record;
  record.tick = m_clock.tick;
  record.time = static_cast<double>(m_clock.tick) * m_clock.period;
  record.tool_position = m_state.tool.position;
  record.tool_orientation = m_state.tool.orientation;
  record.force = m_state.hand_force;
  record.torque = m_state.hand_torque;
  record.device_force = m_gated.force;
  record.mode = m_state.mode;
  record.force_age = m_state.force_age;
  record.num_contacts = m_state.num_contacts;
  record.gate_events = m_gated.events;
  record.port_energy = m_state.port_energy;
  record.passivity_energy = m_state.passivity_energy;
  return record;
}

}  // namespace argil::sim
