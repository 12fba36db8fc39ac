// Between the contacts, the body and the hand: who gets which force.

#include "sim/hand_side.h"

#include <numbers>

#include "sim/body_side.h"

namespace argil::sim {

using device::ToolMode;

HandState::HandState(const Params& params)
    : clock{0, params.rates.haptic_period},
      chatter(params.chatter_limit, params.rates.haptic_period),
      gate(params.device, params.rates.haptic_period) {}

HandSide::HandSide(const mesh::TriangleMesh& tool, const Params& params, const ContactSurface& surface,
                   BodySide& body, const device::DeviceSample& start)
    : m_tool(tool),
      m_params(params),
      m_surface(surface),
      m_body(body),
      m_state(params),
      m_committed(params),
      m_touched(surface),
      m_detector(surface.triangles(), surface.num_vertices(), tool, params.contact),
      m_grip(params.contact.grip_strength),
      m_collector(params, surface, body.solid().model.elements),
      m_compliance(surface, body.solid().model.elements.num_nodes()) {
  m_detector.share(params.threads);
  if (params.contact.law == contact::ContactLaw::pressure)
    m_pressure.emplace(surface.triangles(), surface.num_vertices(),
                       contact::make_tool_solid(params.contact.round_tool, tool),
                       body.find_surface_stiffness(), params.solid.solves_contact(), params.contact.penalty);
  m_stiffness_before.reserve(static_cast<std::size_t>(surface.triangles().cols()));
  if (m_pressure && params.contact.friction > 0.0)
    m_friction.emplace(params.contact.friction, surface.num_vertices());
  if (params.carries_force_on()) m_between.emplace(params.rates, params.solid.solves_contact() ? 0.0 : 0.5);
  m_unpressed.with_touched = false;
  const Field& moduli = body.body().youngs_modulus;
  const double modulus = moduli.size() > 0 ? moduli.maxCoeff() : params.elastic.youngs_modulus;
  m_most_force = modulus * std::numbers::pi * tool.vertices.colwise().squaredNorm().maxCoeff();
  begin_at(start);
}

void HandSide::begin_at(const device::DeviceSample& start) {
  m_state.tool = {start.position, start.orientation};
  m_state.mode = start.mode;
  m_state.contact_tool = m_state.tool;
  if (m_between) m_between->begin_at(m_state.tool);
  if (m_touched.x_t0().size() > 0) prepare_detection(m_touched.x_t0());
  commit();
}

/// A first look at contacts, in which nothing moves.
void HandSide::prepare_alone() {
  m_detector.share(1);
  if (m_pressure)
    m_pressure->find_contacts(m_touched.x_t0(), m_state.tool, m_state.tool, m_state.yielding, m_contacts);
  else
    m_detector.find_contacts(m_touched.x_t0(), m_touched.x_t0(), m_state.tool, m_state.tool, m_contacts, 0.0);
  commit();
}

void HandSide::place_surface(const Points& x) {
  m_touched.place(x);
  prepare_detection(x);
}

void HandSide::go_on_from(const HandSide& before, const Points& x) {
  m_state = before.m_state;
  m_pressure->go_on_from(*before.m_pressure);
  m_grip.go_on_from(before.m_grip, before.m_touched.x_t1(), x, m_state.contact_tool);
  if (m_friction)
    m_friction->go_on_from(*before.m_friction, before.m_touched.x_t0(), before.m_touched.x_t1(), x);
  if (m_between) m_between->go_on_from(*before.m_between, before.m_touched.x_t1(), x);
  m_pressure->stiffness() = m_body.find_surface_stiffness();
  place_surface(x);
  commit();
}

std::vector<PressedPoint> HandSide::find_pressed() {
  if (!is_pressing() || m_grip.holds()) return {};
  contact::Contacts contacts;
  m_pressure->prepare(m_touched.x_t1());
  m_pressure->find_contacts(m_touched.x_t1(), m_state.contact_tool, m_state.contact_tool, m_state.yielding,
                            contacts);
  m_pressure->forget();
  return list_pressed(contacts, m_surface.triangles(), m_touched.x_t1(), m_pressure->stiffness().per_area);
}

Points HandSide::put_under_tool(const std::vector<PressedPoint>& before, const Points& x) {
  contact::ToolSolid tool = contact::make_tool_solid(m_params.contact.round_tool, m_tool);
  return keep_pressure(before, {tool, m_state.contact_tool, m_state.hand_force.norm()}, m_surface.triangles(),
                       x, *m_pressure);
}

void HandSide::find_still_contacts() {
  const contact::Pose& tool = m_state.contact_tool;
  if (m_grip.holds())
    m_grip.find_contacts(m_touched.x_t1(), tool, tool, m_contacts);
  else
    m_pressure->find_contacts(m_touched.x_t1(), tool, tool, m_state.yielding, m_contacts);
}

void HandSide::hand_over_still(ContactLoad& load) {
  const contact::Pose& tool = m_state.contact_tool;
  find_still_contacts();
  if (m_friction && !m_grip.holds())
    m_friction->stretch(m_touched.x_t0(), m_touched.x_t1(), tool, tool, m_contacts);
  m_collector.begin_detection(0.0, {});
  m_state.hand_force = m_contacts.force_on_tool + m_contacts.resistance_on_tool;
  m_state.hand_torque = m_contacts.torque_on_tool + m_contacts.resistance_torque_on_tool;
  gather_contact_forces();
  m_collector.hand_over(pose(), m_state.mode, m_params.rates.physics_period_ticks, m_contacts, load);
}

void HandSide::feel_settled(const StepResult& result, const Points& x) {
  m_state.hand_force = result.felt.force;
  m_state.hand_torque = result.felt.torque;
  m_state.last_answer = result.felt.force;
  if (m_between) m_between->change_answer(result.felt, result.friction);
  place_surface(x);
  commit();
}

Points HandSide::find_contact_force() {
  NodalForce force(m_body.solid().model.elements.num_nodes());
  if (!is_pressing()) return force.at;
  find_still_contacts();
  const double found = m_contacts.force_on_tool.norm();
  const double share = found > 0.0 ? m_state.hand_force.norm() / found : 0.0;
  for (const contact::Contact& c : m_contacts.contacts)
    m_surface.add_force({c.vertex, c.weight, share * c.force}, force);
  return force.at;
}

/// Of the contact law: a surface at x.
void HandSide::prepare_detection(const Points& x) {
  if (m_pressure)
    m_pressure->prepare(x);
  else
    m_detector.prepare(x, m_state.tool);
}

/// No tool is pressed back with more than the clay's modulus over all that it shows.
void HandSide::limit_force(device::Wrench& felt) const {
  if (!felt.force.allFinite() || !felt.torque.allFinite()) felt = {};
  if (felt.force.norm() <= m_most_force) return;
  const double share = m_most_force / felt.force.norm();
  felt.force *= share;
  felt.torque *= share;
}

void HandSide::receive(StepResult& result) {
  if (result.is_limited) limit_force(result.felt);
  note_answer(result);
  if (!m_state.has_felt_anew && !result.is_held) {
    m_state.hand_force = result.felt.force;
    m_state.hand_torque = result.felt.torque;
  }
  m_touched.receive(result);
  m_has_met_surface = false;
  if (m_pressure) {
    m_pressure->exchange(result.stiffness);
    m_stiffness_before.swap(result.stiffness);
  }
  if (m_between && !result.is_held) m_between->receive(result.felt, result.friction, result.pressed);
}

/// Keeps by how much the answer is off what the hand has felt until now, less the way that the tool has gone
/// in this tick where the force follows it.
void HandSide::note_answer(const StepResult& result) {
  m_state.error = result.error;
  const Vec3& answer = result.felt.force;
  const double jump = (answer - m_state.hand_force).norm();
  const double change = (answer - m_state.last_answer).norm();
  const bool follows = m_params.rates.between_frames != BetweenFrames::hold;
  m_state.force_jump = std::max(0.0, follows ? jump - change / m_params.rates.physics_period_ticks : jump);
  if (!result.is_held) m_state.last_answer = answer;
}

/// A force that is held, or carried on, is off by a share of the last jump that grows from tick to tick.
ForceErrorParts HandSide::find_error() const {
  ForceErrorParts parts;
  const double force = m_state.hand_force.norm();
  if (!m_params.estimates_error || !(force > 0.0)) return parts;
  const double age = static_cast<double>(m_state.ticks_since_step) / m_params.rates.physics_period_ticks;
  parts.mesh = m_state.error.mesh * force;
  parts.step = m_state.error.step * force + age * m_state.force_jump;
  parts.contact = -m_state.error.contact * force;
  parts.solver = m_state.error.solver;
  parts.left_out = m_state.error.left_out;
  return parts;
}

/// The device holds its last force on the way to where the hand is at the end of the tick, so that the work
/// done on the hand is force times path, exactly; a turn is taken about one axis.
void HandSide::advance(const device::DeviceSample& sample) {
  const Eigen::AngleAxisd turn(sample.orientation * m_state.tool.orientation.conjugate());  // the shorter way
  m_state.motion = {sample.position - m_state.tool.position, turn.angle() * turn.axis()};
  m_state.port_energy += device::compute_work({m_state.gated.force, m_state.gated.torque}, m_state.motion);
  m_state.passivity_energy += device::compute_work(m_state.withheld, m_state.motion);
  m_state.tool = {sample.position, sample.orientation};
  m_state.mode = sample.mode;
  ++m_state.ticks_since_step;
}

bool HandSide::is_wetting() const {
  return m_state.mode == ToolMode::wet || m_state.mode == ToolMode::dry;
}

/// Does the surface deflect between physics steps? Tools that do not deform the body meet it as it is, and so
/// does a pulling one, whose negative stiffness has no balance with the body where it is the stiffer.
bool HandSide::is_compliant() const {
  return m_params.deflects_between_steps() && m_state.mode != ToolMode::pull && !keeps_shape();
}

StepStatus HandSide::find_contact_force(bool begins_step) {
  const StageScope scope(m_observer, Stage::contact);
  const bool moves_water = begins_step && m_params.rates.moves_water(m_state.steps_begun + 1);
  m_contacts.with_touched = moves_water && is_wetting();
  ++m_state.force_age;
  choose_yielding();
  if (is_compliant()) return find_compliant_force();
  if (m_pressure && !keeps_shape())
    find_pressure_force(begins_step);
  else if (m_params.rates.between_frames != BetweenFrames::hold)
    find_penalty_force(1);
  else if (begins_step)
    find_penalty_force(m_state.ticks_since_step);
  return StepStatus::ok();
}

/// fidelity: contacts of a tool and a surface that both stand still are what they were. The first such
/// detection may still change which pairs are in touch, and the second what it takes from that.
bool HandSide::finds_same_contacts() {
  constexpr int kSettled = 2;
  const bool is_still = !m_touched.has_moved() && m_state.tool.position == m_state.contact_tool.position &&
                        m_state.tool.orientation.coeffs() == m_state.contact_tool.orientation.coeffs();
  m_still_detections = is_still ? m_still_detections + 1 : 0;
  return m_params.fidelity.mode != FidelityMode::full && m_still_detections > kSettled &&
         !m_contacts.with_touched;
}

/// Detection over `ticks` ticks while the surface goes to where the body has moved it; both paths start where
/// the last one ended, so none has a gap.
void HandSide::find_contacts(int ticks) {
  const bool is_new = !finds_same_contacts();
  if (is_new && m_pressure)
    find_pressure();
  else if (is_new)
    m_detector.find_contacts(m_touched.x_t0(), m_touched.x_t1(), m_state.contact_tool, m_state.tool,
                             m_contacts, m_touched.find_motion(), m_state.clock.seconds(ticks));
  m_state.num_contacts = static_cast<int>(m_contacts.contacts.size());
  m_touched.advance();
  m_collector.begin_detection(is_new && m_pressure ? find_way_over_patch() : 0.0, find_resolution());
  m_state.contact_tool = m_state.tool;
  m_state.force_age = 0;
  m_state.has_felt_anew = true;
}

/// Eqs. 7 and 8 on the body, reversed in pull. Wet and dry tools feel the body but do not deform it.
void HandSide::gather_contact_forces() {
  m_collector.begin_felt();
  if (keeps_shape()) return;
  if (m_pressure) return gather_pressure();
  const bool pushes = !reverses();
  for (const contact::Contact& c : m_contacts.contacts) {
    const Vec3 force = (pushes ? c.force : Vec3(-c.force)) + c.resistance;
    m_collector.add_force(c, force);
    m_collector.add_stiffness(c, m_collector.share() * force, pushes, m_touched.x_t0());
  }
}

void HandSide::hand_over(ContactLoad& load) {
  if (m_between) {
    const contact::Patch patch = m_grip.holds() ? contact::Patch{} : m_pressure->find_patch();
    m_between->tell(keeps_shape() ? contact::Contacts{} : m_contacts, patch, m_told_tool, m_state.tool);
    const bool has_left = keeps_shape() || (m_contacts.contacts.empty() && m_contacts.near.empty());
    m_between->repay(has_left, m_collector);
  }
  HandPose hand = pose();
  ++hand.ticks;  // this one ends
  m_collector.hand_over(hand, m_state.mode, m_state.ticks_since_step, m_contacts, load);
  m_state.ticks_since_step = 0;
  ++m_state.steps_begun;
  m_state.has_felt_anew = false;
  if (!m_pressure || keeps_shape()) return;
  m_state.hand_force = m_felt.force;  // until the body answers
  m_state.hand_torque = m_felt.torque;
}

/// The last force, old or new, less what would generate energy, through the device's limits. A hand that
/// chatters is let go until it does not.
void HandSide::render(device::HandFeed feed) {
  if (m_between) feel_between_steps();
  m_state.chatter.add(m_state.hand_force);
  const device::Wrench felt{m_state.hand_force, m_state.hand_torque};
  device::Wrench sent = felt;
  if (m_params.passivity == device::Passivity::time_domain)
    sent = device::damp_generated_energy(felt, m_state.motion, -m_state.port_energy);
  m_state.withheld = {felt.force - sent.force, felt.torque - sent.torque};
  if (!m_params.is_strict && m_state.chatter.is_chattering() && feed == device::HandFeed::fresh)
    feed = device::HandFeed::stale;
  m_state.gated = m_state.gate.apply(sent.force, sent.torque, feed);
  m_state.clock.advance();
}

StepStatus HandSide::status() const {
  if (!m_params.is_strict || !m_state.chatter.is_chattering()) return StepStatus::ok();
  return StepStatus::failed({m_state.clock.tick + 1, "hand", -1,
                             "share of the force that trembles above 50 Hz for 0.3 s",
                             m_state.chatter.share(), m_params.chatter_limit});
}

void HandSide::commit() {
  m_committed = m_state;
  m_touched.commit();
  m_detector.commit();
  m_stiffness_before.clear();
  if (m_pressure) m_pressure->commit();
  m_grip.commit();
  if (m_friction) m_friction->commit();
  if (m_between) m_between->commit();
  m_collector.commit();
  if (!m_params.deflects_between_steps()) return;
  m_compliance.commit();
  m_committed_springs = m_springs;
}

void HandSide::roll_back(ContactLoad* load) {
  const bool is_compliant = m_params.deflects_between_steps();
  const bool has_handed_over = m_state.steps_begun != m_committed.steps_begun;
  if (load && has_handed_over) m_collector.take_back(*load);
  m_state = m_committed;
  m_touched.roll_back(is_compliant ? &m_body.state().solid.x : nullptr);
  m_detector.roll_back();
  if (m_pressure) {
    m_pressure->exchange(m_stiffness_before);
    m_pressure->roll_back();
  }
  m_stiffness_before.clear();
  m_grip.roll_back();
  if (m_friction) m_friction->roll_back();
  if (m_between) m_between->roll_back();
  m_has_met_surface = false;
  m_collector.roll_back();
  m_still_detections = 0;
  if (!is_compliant) return;
  m_compliance.roll_back(m_surface);
  m_springs = m_committed_springs;
}

HapticRecord HandSide::make_record() const {
  HapticRecord record;
  record.tick = m_state.clock.tick;
  record.time = static_cast<double>(m_state.clock.tick) * m_state.clock.period;
  record.tool_position = m_state.tool.position;
  record.tool_orientation = m_state.tool.orientation;
  record.force = m_state.hand_force;
  record.torque = m_state.hand_torque;
  record.device_force = m_state.gated.force;
  record.mode = m_state.mode;
  record.force_age = m_state.force_age;
  record.num_contacts = m_state.num_contacts;
  record.gate_events = m_state.gated.events;
  record.port_energy = m_state.port_energy;
  record.passivity_energy = m_state.passivity_energy;
  record.error = find_error();
  return record;
}

}  // namespace argil::sim
