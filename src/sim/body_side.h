#pragma once

#include <string>
#include <vector>

#include "base/archive.h"
#include "base/status.h"
#include "contact/pressure.h"
#include "sim/body_materials.h"
#include "sim/compliance.h"
#include "sim/contact_surface.h"
#include "sim/economy.h"
#include "sim/external_force.h"
#include "sim/force_error.h"
#include "sim/params.h"
#include "sim/plastic_flow.h"
#include "sim/record.h"
#include "sim/remap.h"
#include "sim/stage.h"
#include "sim/state.h"
#include "sim/step_result.h"
#include "sim/surface_moduli.h"
#include "solid/limit_motion.h"

namespace argil::sim {

/// The body's side of the loop: water and solid, step by step. A step has always the same length; where the
/// hand does not wait, steps that come late make the body slow.
class BodySide {
 public:
  /// `params` is kept by reference.
  BodySide(Body body, const Params& params);
  BodySide(const BodySide&) = delete;
  BodySide& operator=(const BodySide&) = delete;

  /// One physics step under `load`, after the water's when that is due. Called by Simulation::start_step and
  /// live::StepMailbox::make, which then commit it, or roll it back where it failed. Also a step that fails
  /// has a result. One that is not strict does not fail, but may be limited
  /// (PhysicsRecord::limited_tets).
  StepStatus step(const ContactLoad& load, StepResult& result);
  void commit();
  /// Materials go back before the solid, which needs their moduli, sizes and masses; the rest in any order.
  void roll_back();
  /// To the elastic equilibrium under the loads, without the tool.
  StepStatus find_equilibrium();

  /// Goes on from where another with other cells in the same shape has come to; `clay`: remapped from there.
  void go_on_from(const BodySide& before, const RemappedState& clay);

  /// Changes the clay's stress, in the shape that it has, until it is in balance with the loads and these
  /// forces of contacts, 3×n [N], and within its strength; by about as little as that takes. Nothing changes
  /// where supports alone do not hold the body. Returns by what share of the strength the last stress in
  /// balance was beyond it; infinite where there is no equilibrium.
  double balance(const Points& contact_force);

  /// A step in which no time passes and nothing is booked: the body comes to rest against a tool that stands
  /// still, and then has the speed that it had. To be committed, or rolled back where it failed.
  StepStatus settle(const ContactLoad& load, StepResult& result);

  /// Plastic strain of each tet since the run began, also in earlier cells (6×tets), Mandel: for pictures.
  TensorField find_flow() const;
  /// It is that now.
  void set_flow(const TensorField& flow);
  /// mesh::compute_shape of the worst of the tets that the last step has moved; 1 where there is none.
  double find_worst_shape() const;
  const BodyState& state() const { return m_state; }
  const Body& body() const { return m_body; }
  const ContactSurface& surface() const { return m_surface; }
  const solid::Body& solid() const { return m_solid; }
  const water::PoreWater& pore_water() const { return m_water; }
  const HandPose& hand() const { return m_state.hand; }  ///< when it handed over the load of the last step
  const Points& x_before() const { return m_solid.committed.x; }  ///< nodes before the last move
  BodyBetweenSteps between_steps(Tick tick);
  /// Of each triangle of the touched surface, as the body is now.
  contact::SurfaceStiffness find_surface_stiffness() const { return m_surface_moduli.find_all(); }
  PhysicsRecord make_record();                   ///< of the last step
  Frame make_frame(const HandPose& hand) const;  ///< the body as it is now, with the hand there
  /// The same with the hand of the last step, and the hash of the body's side alone: where the hand goes on
  /// meanwhile.
  Frame make_frame_of_step();

  void serialize(Archive& archive);
  void observe_stages(StageObserver* observer) { m_observer = observer; }

 private:
  // step.cpp
  StepStatus move_water(const ContactLoad& load, StepResult& result);
  StepStatus find_velocity(const ContactLoad& load);
  StepStatus move_solid(const ContactLoad& load, StepResult& result);

  // Stages of these: body_stages.cpp.
  void transfer_and_diffuse(const ContactLoad& load, double step_s);
  StepStatus refresh_materials(StepResult& result);
  StepStatus predict(const ContactLoad& load);
  bool assemble_or_stop();
  StepStatus solve(bool& is_solved);
  void apply_deflection(const ContactLoad& load, StepResult& result);
  void add_pressed(const ContactLoad& load, std::size_t i, const Vec3& change, PressedMoments& pressed) const;
  void find_pressed(const ContactLoad& load, StepResult& result);
  void find_compliance(const ContactLoad& load, PressedPatch& pressed);
  bool share_force(const ContactLoad& load, const PressedPatch& pressed);
  void find_drift();
  void scale_velocity(const ContactPatch& patch);
  StepStatus update_kinematics();
  void flow();
  void find_surface(StepResult& result);
  StepStatus check_energy();
  double clay_factor(Eigen::Index node, const ContactPatch& patch) const;

  // body_side.cpp
  void begin_strained(const TensorField& elastic);
  double limit_to_strength(TensorField& elastic) const;
  StepStatus make_step(const ContactLoad& load, StepResult& result);
  StepStatus step_solid(const ContactLoad& load, StepResult& result);
  void hold_still(const ContactLoad& load, const Failure& failure, StepResult& result);
  void begin_step(const ContactLoad& load, StepResult& result);
  /// At the end of the present step [s].
  double time_at_end() const {
    return static_cast<double>(m_state.steps * m_params.rates.physics_period_ticks) *
           m_params.rates.haptic_period;
  }
  /// Number of the tick at whose end the present step began.
  Tick tick() const { return m_state.hand.ticks; }
  // snapshot.cpp, as serialize()
  void serialize_water(Archive& archive);
  // body_records.cpp
  TensorField mean_plastic_strain() const;

  const Params& m_params;
  Body m_body;
  BodyState m_state;
  BodyProgress m_committed;
  solid::Body m_solid;
  solid::ActiveRegion m_region;
  water::PoreWater m_water;
  ContactSurface m_surface;
  SurfaceModuli m_surface_moduli;
  ExternalForce m_force;
  solid::StepLoads m_loads;  // of the present step
  BodyMaterials m_materials;
  PlasticFlow m_flow;
  Economy m_economy;
  ForceErrorEstimate m_error;
  TensorField m_earlier_flow;  // what find_flow adds; empty: nothing
  solid::MotionLimiter m_limiter;
  solid::MotionLimit m_limit;   // of the last step; all tets: of the whole body, or the step was not made
  Eigen::RowVectorXd m_shares;  // of each node, of find_compliance
  Points m_push, m_response, m_drift;  // 3×nodes, likewise
  bool m_has_moved_water = false;      // since the last commit, as is the next
  bool m_has_begun_solid = false;
  StageObserver* m_observer = nullptr;
};

}  // namespace argil::sim
