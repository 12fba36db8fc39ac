#pragma once

#include <memory>
#include <span>
#include <vector>

#include "base/archive.h"
#include "base/ordered_items.h"
#include "base/ordered_runs.h"
#include "base/status.h"
#include "solid/elements.h"
#include "solid/energy.h"
#include "solid/materials.h"
#include "solid/solver_history.h"
#include "solid/state.h"
#include "solid/step_loads.h"
#include "solid/supports.h"

namespace argil::solid {

struct Body;
class ActiveRegion;

/// A body and its region, and the stages of a step by one name each: begin_step, then assemble and solve
/// until solved, finish_step, move, update_kinematics. Bits do not depend on `threads`.
class Solid {
 public:
  Solid(const mesh::TetMesh& mesh, const mesh::Topology& topology, std::vector<Support> supports,
        const SolidParams& params, int threads);
  ~Solid();
  Solid(Solid&&) noexcept;

  SolidState make_rest_state() const;

  /// Stiffness and yield of one tet; `C` (Mandel) only for anisotropic laws.
  void set_material(int tet, const TetMaterial& material);
  void set_anisotropic_stiffness(int tet, const Mat6& C);

  /// Rest volume of a tet over what it was made with (> 0): its shape at rest grows alike in all directions.
  /// F, forces and energy are those of the grown shape from the next update_kinematics on. Mass stays.
  void set_swelling(int tet, double volume_ratio);
  /// Mass [kg] of water in a tet, shared among its nodes like that of the clay.
  void set_water_mass(int tet, double mass);

  /// F → R → ε at positions x. Fails when det F is not above the bound of the parameters.
  StepStatus update_kinematics(const Points& x, Tick tick);

  /// x̂, v̂ and τ of a step of h seconds that ends at `time`; prescribed nodes go to where they are then.
  /// Kinematics must be those of state.x.
  StepStatus begin_step(const SolidState& state, const StepLoads& loads, double step_s, double time,
                        Tick tick);
  /// Residual and matrix at the present iterate. True when Newton's residual is small enough.
  bool assemble(const StepLoads& loads);
  Vec3 find_free_part(const Vec3& force, Eigen::Index node) const;  ///< without what a support takes
  /// After the first assembly of a step: the force [N] that would act on a node if the body were stopped
  /// where it is; and the norm over all awake nodes of these and the forces that stop it within the step.
  Vec3 find_imbalance(const StepLoads& loads, Eigen::Index node) const;
  double compute_imbalance(const StepLoads& loads) const;
  /// One linear solve and, for Newton's method, its line search. Sets `solved` when no other is wanted.
  StepStatus solve(const StepLoads& loads, Tick tick, bool& solved);
  void finish_step(SolidState& state) const;  ///< v ← v'
  void move(SolidState& state) const;         ///< x ← x̂ + τ v; prescribed components go where they must
  void keep_start(SolidState& state) const;   ///< of a step that is made, what bdf2 must remember

  /// Extent::local, after a step's kinematics and flow: runs that have been slow for some steps, and whose
  /// tets do not flow, fall asleep and lose their speed. `is_flowing`: of each run of kLanes tets.
  void settle_region(SolidState& state, const std::vector<char>& is_flowing);
  void wake_all();   ///< the whole body moves again
  void sleep_all();  ///< none of it until something acts; it has no speed
  /// Does ahead of the first step what is done once: memory, and the forces of tets that do not move.
  /// `force`: 3×n [N] that act already, of which no node needs to be told.
  void make_ready(const SolidState& state, const Points& force);
  bool is_awake(Eigen::Index node) const;
  /// Is it set for any run of kLanes tets that may move?
  bool has_any_moving(const std::vector<char>& of_batch) const;
  /// Σ body(begin, end) over the runs of kLanes points that may move, in their order.
  template <class Term>
  double sum_moving_points(Term term) const {
    return moving_batches().sum(elements().num_points(), term);
  }
  /// By what the last step left as it is: how much of that force the hand may feel [N].
  double held_back() const;
  /// Nodes that the last step solved for.
  int num_active() const;

  /// How the force of contact i, of which a step was told, changed while the body moved: what to add [N] for
  /// the force that acted.
  Vec3 compute_contact_change(std::span<const PointStiffness> contacts, std::size_t i) const;

  /// Did contacts of this group act in the last step?
  bool acts(int group) const;

  /// Turns the contact forces that were given to the step into those that acted: an implicit step takes them
  /// at its end, f − k n n·(x' − x), or 0 where it let them go; newmark takes the mean of both ends.
  void apply_contact_stiffness(std::span<const PointStiffness> contacts, Points& force) const;

  /// Static equilibrium under `loads` from state.x on, by Newton's method. Loads and prescribed displacements
  /// are applied in shares where they do not converge at once; state.x then holds the last share that did.
  StepStatus find_equilibrium(SolidState& state, const StepLoads& loads);

  /// Makes the matrix of a step of `step_s` seconds from the present kinematics, without contacts. It serves
  /// find_response and compute_local_response until the next step begins.
  void prepare_response(const SolidState& state, double step_s);
  /// How far forces (3×n) move every node by the end of such a step: τ² A⁻¹ f [m].
  StepStatus find_response(const Points& force, Tick tick, Points& displacement);
  /// The same of one node by a force on it while all others stay: τ² Aᵢᵢ⁻¹ [m/N], a lower bound.
  Mat3 compute_local_response(int node) const;

  /// What a step takes from the last ones besides the state, its moduli and its kinematics: what the solvers
  /// keep, and the counters.
  void exchange_state(Archive& archive);
  /// What the matrix remembers of earlier rotations, and which part of the body sleeps; restored once the
  /// tets have their moduli and size at rest.
  void exchange_frames(Archive& archive);
  /// After that: kinematics as those of the saved x were, with frames that lag as far as they did.
  StepStatus restore_kinematics(const Points& x, Tick tick);

  const Elements& elements() const;
  const Constraints& constraints() const;
  const TensorField& strain() const;  ///< ε (Mandel) of each point, last kinematics
  const Field& mass() const;          ///< lumped, per node [kg]
  const Field& weight() const;        ///< volume of each point [m³], as it has swollen
  TetMaterial material(int tet) const;
  const StepCounters& counters() const;
  const linear::SolverCost& solver_cost() const;
  /// Does a tet hold elastic strain beyond what rounding leaves in a body at rest?
  bool is_strained(int tet, const TensorField& plastic_strain) const;
  double min_volume_ratio() const;
  int num_free() const;
  /// Of tets that moved in the last step: all others are where they were.
  const OrderedItems& moving_nodes() const;
  const OrderedRuns& moving_batches() const;  ///< of kLanes tets, likewise
  const Points& x_start() const;              ///< where the last step began
  const Points& v_start() const;
  const Points& internal_force() const;  ///< of the last assembly [N]

  /// Elastic energy of one point for the given plastic strain [J], without what nodes share (p1_nodal).
  double compute_elastic_energy(int point, const Vec6& plastic_strain) const;
  /// See solid/law.h; at one point.
  Vec6 compute_flow_drive(int point, const Vec6& plastic_strain, double shape_stiffness) const;
  /// Of the body at the present kinematics [J].
  double compute_elastic_energy(const TensorField& plastic_strain) const;
  /// The same and the largest ‖ε_p‖. Tets that have not moved since the last call are not looked at.
  StrainSummary summarise(const TensorField& plastic_strain) const;
  double compute_kinetic_energy(const SolidState& state) const;

 private:
  void take_up(const SolidState& state);

  std::unique_ptr<Body> m_body;
  std::unique_ptr<ActiveRegion> m_region;
};

}  // namespace argil::solid
