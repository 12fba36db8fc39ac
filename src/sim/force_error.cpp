#include "sim/force_error.h"

#include <algorithm>
#include <cmath>

#include "base/mandel.h"
#include "sim/usual_error.h"
#include "solid/unloading.h"

namespace argil::sim {
namespace {

constexpr double kOfBound = 1.0 / 3.0;  // what a solve's residual does, over the most that it could
constexpr int kSteps = 8;  // from one look at the whole body to the next; fewer just after the touch

}  // namespace

ForceErrorEstimate::ForceErrorEstimate(const Params& params, solid::Body& solid,
                                       const solid::ActiveRegion& region)
    : m_params(params), m_solid(solid), m_region(region) {
  if (params.estimates_error) m_recovered.emplace(solid.model, params.plasticity.enabled);
}

void ForceErrorEstimate::begin_step(const ContactLoad& load) {
  if (!is_on()) return;
  const bool is_touched = load.patch.is_touched;
  if (is_touched && !m_state.is_touched) {
    m_recovered->set_reference(m_solid.kinematics);
    const Vec3 tool = m_state.tool;
    m_state = {};
    m_state.tool = tool;
  }
  m_state.is_touched = is_touched;
}

void ForceErrorEstimate::finish_step(const ContactLoad& load, const BodyState& state) {
  if (!is_on()) return;
  m_state.tool = load.hand.tool.position;
  if (!m_state.is_touched) return;
  const bool is_due = this->is_due();
  ++m_state.steps;
  if (!is_due) return;
  m_state.next = m_state.steps + std::min(kSteps, m_state.steps) - 1;
  m_state.found = m_recovered->find(m_solid.strained(state.solid.plastic_strain));
  find_reach(state.solid.x);
  const double stress = m_state.found.stress + m_state.kept.stress;
  const double work = m_state.found.work + m_state.kept.work;
  if (!(stress > 0.0) || !(work > 0.0)) return;
  // The stiffness against going deeper is F' = n F/d, and the work F d/(n + 1), if F grows as dⁿ: 0.6 of F²
  // over the work for a ball on elastic clay, from a half to two thirds for a punch to a cone.
  constexpr double kStiffness = 0.6;
  m_state.rates.mesh = std::min(1.0, (m_state.found.error + m_state.kept.error) / stress);
  m_state.rates.mesh = std::max(m_state.rates.mesh, find_unresolved(load.resolution.cells));
  const Pressing pressing = find_pressing(load);
  m_state.rates.contact =
      std::min(1.0, kStiffness * pressing.force / work * (pressing.depth + load.resolution.sag));
}

/// What four-node tets cannot show is no part of the strain that they recover: on fewer than two cells along
/// the radius of contact the share by which the force is usually off, from one and a half on by degrees. The
/// usual one is of blocks with a node under the tool; where the patch lies askew over the cells it is 0.7 of
/// that.
double ForceErrorEstimate::find_unresolved(double cells) const {
  constexpr double kFull = 1.5, kNone = 2.0;
  if (!(cells > 0.0) || m_solid.model.elements.nodes_per_tet != 4) return 0.0;
  constexpr double kAskew = 0.8;
  const double usual = kAskew * find_usual_error(m_params.solid.element, cells);
  return std::clamp((kNone - cells) / (kNone - kFull), 0.0, 1.0) * usual / (1.0 + usual);
}

/// Of one linearisation: the internal forces f + τ K v that a step's equation had, which follow neither what
/// turns and stretches on the way nor all of what flows. Where the body has come they are others.
void ForceErrorEstimate::keep_solution(const ContactLoad& load, const NodalForce& contacts, const Points& v) {
  const bool is_linearised = !m_solid.is_newton() && !m_solid.is_explicit() && !m_solid.materials.nodal();
  if (!is_on() || !m_state.is_touched || !is_linearised) return;
  if (!is_due()) return;
  m_state.is_kept = true;
  Vec3 force = Vec3::Zero();
  for (const int n : contacts.nodes()) force += contacts.at.col(n);
  const double of_tool = (load.hand.tool.position - m_state.tool).norm() / m_params.rates.step_seconds();
  const double fastest = std::sqrt(
      m_region.part().nodes.find_largest(v.cols(), [&](std::ptrdiff_t n) { return v.col(n).squaredNorm(); }));
  m_state.hand_power = force.norm() * std::max(of_tool, fastest);
  m_state.solved_power = m_region.part().nodes.sum(
      v.cols(), [&](std::ptrdiff_t n) { return v.col(n).dot(m_solid.forces.internal.col(n)); });
  m_state.solved_power += m_solid.prediction.tau * find_stiffness_power(v);
}

/// v·K (v − v₀) [W/s], v₀ where the step's last solve began, K of its matrix: elastic, but for tets at their
/// yield that flow on as they did.
double ForceErrorEstimate::find_stiffness_power(const Points& v) const {
  const solid::Elements& elements = m_solid.model.elements;
  const auto find_rate = [&](const Points& speed, int p) {
    const Mat3 H = elements.nodes_per_tet == 4
                       ? solid::find_gradient<4>(elements, m_solid.materials.gradient(), speed, p)
                       : solid::find_gradient<10>(elements, m_solid.materials.gradient(), speed, p);
    const Mat3 turned = m_solid.kinematics.rotation().middleCols<3>(3 * p).transpose() * H;
    return to_mandel(0.5 * (turned + turned.transpose()));
  };
  const auto of_point = [&](int p) {
    const int tet = elements.tet_of_point(p);
    const Vec6 rate = find_rate(v, p);
    const Vec6 change = m_solid.newton.is_follow_up ? Vec6(rate - find_rate(m_solid.system.v_base, p)) : rate;
    const solid::Elasticity e = m_solid.materials.elasticity(tet);
    double power = rate.dot(solid::compute_stress(e, change));
    if (m_solid.model.params.flows_in_solve && m_solid.system.unloads[static_cast<std::size_t>(p)] == 0) {
      const Vec6 n = solid::find_flow_direction(m_solid, p);
      power -= 2.0 * e.mu * n.dot(rate) * n.dot(change);
    }
    return m_solid.materials.weight()(p) * power;
  };
  const std::ptrdiff_t Q = elements.points_per_tet;
  return m_region.part().batches.sum(elements.num_tets(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    double sum = 0.0;
    for (std::ptrdiff_t p = Q * begin; p < Q * end; ++p) sum += of_point(static_cast<int>(p));
    return sum;
  });
}

void ForceErrorEstimate::check_last_step() {
  if (!m_state.is_kept) return;
  m_state.is_kept = false;
  const Points& v = m_solid.committed.v;
  const double power = m_region.part().nodes.sum(
      v.cols(), [&](std::ptrdiff_t n) { return v.col(n).dot(m_solid.forces.internal.col(n)); });
  const double off = std::abs(m_state.solved_power - power);
  m_state.rates.step = m_state.hand_power > 0.0 ? std::min(1.0, off / m_state.hand_power) : 0.0;
}

ForceErrorEstimate::Pressing ForceErrorEstimate::find_pressing(const ContactLoad& load) const {
  Vec3 all = Vec3::Zero();
  double sum = 0.0, total = 0.0;
  for (std::size_t i = 0; i < load.stiffness.size(); ++i) {
    const solid::PointStiffness& c = load.stiffness[i];
    const Vec3 given = c.is_near ? Vec3(Vec3::Zero()) : c.force;
    const Vec3 force = given + solid::compute_contact_change(m_solid, load.stiffness, i);
    all += force;
    if (c.friction > 0.0 || !(c.stiffness > 0.0)) continue;
    const double normal = std::abs(c.normal.dot(force));
    sum += normal * normal / c.stiffness;
    total += normal;
  }
  return {all.norm(), total > 0.0 ? sum / total : 0.0};
}

void ForceErrorEstimate::find_reach(const Points& x) {
  const Points& rest = m_solid.model.elements.rest;
  const OrderedItems& nodes = m_region.part().nodes;
  const auto squares = [&](std::ptrdiff_t n) { return (x.col(n) - rest.col(n)).squaredNorm(); };
  const double largest = nodes.find_largest(x.cols(), squares);
  m_state.reach = largest > 0.0 ? std::sqrt(nodes.sum(x.cols(), squares) / largest) : 0.0;
}

ForceErrorRates ForceErrorEstimate::rates(const Economy& economy) const {
  if (!is_on() || !m_state.is_touched) return {};
  ForceErrorRates rates = m_state.rates;
  const bool sleeps = !economy.is_full() && economy.record().rung == Rung::asleep;
  rates.solver = sleeps ? 0.0 : kOfBound * m_state.reach * m_solid.history.counters.imbalance;
  rates.left_out = sleeps ? economy.record().estimate : m_region.held_back();
  return rates;
}

void ForceErrorEstimate::go_on_from(const ForceErrorEstimate& before) {
  if (!is_on()) return;
  m_state = before.m_state;
  m_state.kept.error += m_state.found.error;
  m_state.kept.stress += m_state.found.stress;
  m_state.kept.work += m_state.found.work;
  m_state.found = {};
  m_recovered->set_reference(m_solid.kinematics);
  commit();
}

void serialize_rates(Archive& archive, const std::string& prefix, ForceErrorRates& rates) {
  archive.number(prefix + "mesh", rates.mesh);
  archive.number(prefix + "step", rates.step);
  archive.number(prefix + "contact", rates.contact);
  archive.number(prefix + "solver", rates.solver);
  archive.number(prefix + "left_out", rates.left_out);
}

void ForceErrorEstimate::serialize(Archive& archive) {
  if (!is_on()) return;
  archive.array("force_error/reference", m_recovered->reference());
  archive.number("force_error/is_touched", m_state.is_touched);
  archive.number("force_error/steps", m_state.steps);
  archive.number("force_error/next", m_state.next);
  archive.number("force_error/reach", m_state.reach);
  archive.number("force_error/is_kept", m_state.is_kept);
  archive.number("force_error/solved_power", m_state.solved_power);
  archive.number("force_error/hand_power", m_state.hand_power);
  archive.array("force_error/tool", m_state.tool);
  serialize_rates(archive, "force_error/", m_state.rates);
  const auto work = [&archive](const std::string& name, solid::MeshError& sums) {
    archive.number(name + "_error", sums.error);
    archive.number(name + "_stress", sums.stress);
    archive.number(name + "_work", sums.work);
  };
  work("force_error/found", m_state.found);
  work("force_error/kept", m_state.kept);
  if (archive.is_restoring()) commit();
}

}  // namespace argil::sim
