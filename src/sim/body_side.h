#pragma once

#include <string>
#include <vector>

#include "base/archive.h"
#include "base/ordered_items.h"
#include "material/moisture.h"
#include "sim/compliance.h"
#include "sim/contact_surface.h"
#include "sim/exchange.h"
#include "sim/params.h"
#include "sim/record.h"
#include "sim/stage.h"
#include "sim/state.h"

namespace argil::sim {

/// The body's side of the loop: water and solid, step by step. A step has always the same length; where the
/// hand does not wait, steps that come late make the body slow.
class BodySide {
 public:
  /// `params` is kept by reference.
  BodySide(Body body, const Params& params);
  BodySide(const BodySide&) = delete;
  BodySide& operator=(const BodySide&) = delete;

  /// One physics step under `load`, after the water's when that is due. Clears `load`. Also a step that fails
  /// answers.
  StepStatus step(ContactLoad& load, BodyAnswer& answer);
  /// To the elastic equilibrium under the loads, without the tool.
  StepStatus settle();

  const BodyState& state() const { return m_state; }
  const Body& body() const { return m_body; }
  const ContactSurface& surface() const { return m_surface; }
  const solid::Solid& solid() const { return m_solid; }
  const water::PoreWater& pore_water() const { return m_water; }
  const HandPose& hand() const { return m_hand; }               ///< of the last step
  const Points& x_before() const { return m_solid.x_start(); }  ///< nodes before the last move
  BodyAtFrame at_frame(Tick tick);
  PhysicsRecord make_record() const;                  ///< of the last step
  Frame make_frame(const HandPose& hand) const;       ///< the body as it is now, with the hand there
  std::string make_hash(const HandPose& hand) const;  ///< SHA-256 of all that a step changes, and the hand

  void exchange_state(Archive& archive);
  void observe_stages(StageObserver* observer) { m_observer = observer; }

 private:
  // Stages of a step: step.cpp.
  StepStatus water_step(const ContactLoad& load);
  StepStatus physics_step(ContactLoad& load, BodyAnswer& answer);

  // body_side.cpp
  void exchange_water(Archive& archive);
  double step_seconds() const { return m_params.rates.haptic_period * m_params.rates.physics_period_ticks; }
  /// At the end of the present step, and the tick in which it began.
  double time_at_end() const {
    return static_cast<double>(m_state.steps * m_params.rates.physics_period_ticks) *
           m_params.rates.haptic_period;
  }
  Tick tick() const { return m_hand.ticks - 1; }
  void begin_step(ContactLoad& load, BodyAnswer& answer);
  void set_external_force(const ContactLoad& load);
  void apply_contact_yield(ContactLoad& load, device::Wrench& felt);
  double clay_factor(Eigen::Index node, const ContactLoad& load, double step_s) const;
  void apply_clay_kernel(const ContactLoad& load, double step_s);
  StepStatus check_energy(const ContactLoad& contacts);
  void take_back(double energy_given);
  Vec6 compute_flow(int point, double step_s) const;
  void apply_plastic_flow(double step_s);
  double flow_at_points(std::ptrdiff_t begin, std::ptrdiff_t end, double step_s);
  double flow_at_point(int point, double step_s);
  TensorField mean_plastic_strain() const;
  StepStatus refresh_materials(double tolerance);
  void refresh_material(int tet, double S);
  void fall_asleep();
  bool rests(const ContactLoad& load);
  bool sleeps_on(const ContactLoad& load);
  void find_reach(const OrderedItems& nodes);
  void watch_strain();
  bool falls_asleep(const ContactLoad& load, const solid::StepLoads& loads);

  const Params& m_params;
  Body m_body;
  BodyState m_state;
  HandPose m_hand;
  material::MoistureTable m_moisture;
  solid::Solid m_solid;
  water::PoreWater m_water;
  ContactSurface m_surface;
  std::vector<int> m_changed_tets;
  Points m_load_force;  // 3×n, constant
  Points m_external_force;
  std::vector<int> m_forced_nodes;        // by contacts, in the last step
  std::vector<int> m_changed_nodes;       // whose external force may be another than in that before
  std::vector<double> m_shape_stiffness;  // 2μ* per tet [Pa]; empty: isotropic stiffness
  bool m_is_flow_driven = false;          // plastic flow follows the stress, not the strain
  Field m_yield;                          // of each point: elastic strain norm [–]
  bool m_flows = false;                   // anywhere
  std::vector<char> m_is_flowing;         // of each run of kLanes points, in the last step
  bool m_is_moved = false;                // some support moves
  Fidelity m_fidelity;
  double m_held_back_squares = 0.0;
  Points m_held_back;  // 3×n [N] of a body that sleeps: loads less internal forces, where nodes are free
  solid::StrainSummary m_rest_strain;  // of the body while it is at rest
  StageObserver* m_observer = nullptr;
};

}  // namespace argil::sim
