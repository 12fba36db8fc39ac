#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "base/archive.h"
#include "base/ordered_items.h"
#include "base/status.h"
#include "solid/active_set.h"
#include "solid/kinematics.h"
#include "solid/nodal_product.h"
#include "solid/step_loads.h"
#include "solid/supports.h"
#include "solid/tet_lanes.h"

namespace argil::solid {

/// Motion and history of the body; what a checkpoint must hold.
struct SolidState {
  Points x;                    ///< 3×n positions of the nodes [m]
  Points v;                    ///< 3×n velocities [m/s]
  TensorField plastic_strain;  ///< 6×p ε_p at each point in its turned frame, Mandel
  Points x_before, v_before;   ///< a step earlier, bdf2 only; empty before the first step
};

/// Stiffness and strength of one tet as the water left them.
struct TetMaterial {
  double lambda = 0.0;  ///< [Pa]
  double mu = 0.0;      ///< [Pa]
  double yield = 0.0;   ///< elastic strain norm [–]
};

/// What the last step took; statics: with all its shares of the load, those that failed included.
struct StepCounters {
  int newton_iterations = 0;
  int linear_iterations = 0;
  bool has_solved = false;  ///< by iterations or a factor; not where the first guess would do
  double residual = 0.0;    ///< relative, of the last linear solve
  double imbalance = 0.0;   ///< [N] that a solve left, with a slack also frames that lag: norm over all nodes
  int assembled_rows = 0;   ///< rows of the matrix that were gathered anew; the others stayed as they were
};

/// Of the body as a whole.
struct StrainSummary {
  double elastic_energy = 0.0;          ///< [J]
  double largest_plastic_strain = 0.0;  ///< ‖ε_p‖
};

/// Finite elements in time. A step in the order in which sim/step.cpp calls its stages: begin_step, then
/// assemble and solve until solved, finish_step, move, update_kinematics. Every implicit integrator is
///   x' = x̂ + τ v',  M (v' − v̂) = τ (f_ext − f_int(x') − D v')
/// with its own x̂, v̂ and τ. Bits do not depend on `threads`.
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
  template <class Body>
  double sum_moving_points(Body body) {
    const std::ptrdiff_t count = m_elements.num_points();
    const std::vector<int>* batches = m_region ? &m_region->batches() : nullptr;
    const auto num_batches = static_cast<std::size_t>((count + kLanes - 1) / kLanes);
    m_point_sums.resize(batches ? batches->size() : num_batches);
    double* sums = m_point_sums.data();
    parallel_for(static_cast<std::ptrdiff_t>(m_point_sums.size()), m_threads, [=, &body](std::ptrdiff_t i) {
      const std::ptrdiff_t batch = batches ? (*batches)[static_cast<std::size_t>(i)] : i;
      sums[i] = body(batch * kLanes, std::min((batch + 1) * kLanes, count));
    });
    double total = 0.0;
    for (const double sum : m_point_sums) total += sum;
    return total;
  }
  /// By what the last step left as it is: how much of that force the hand may feel [N].
  double held_back() const { return m_held_back; }
  /// Nodes that the last step solved for.
  int num_active() const { return m_region ? m_region->num_awake_rows() : num_free(); }

  /// How the force of contact i, of which a step was told, changed while the body moved: what to add [N] for
  /// the force that acted.
  Vec3 compute_contact_change(std::span<const PointStiffness> contacts, std::size_t i) const;

  /// Did contacts of this group act in the last step?
  bool acts(int group) const { return group < 0 || m_contact_acts[static_cast<std::size_t>(group)] != 0; }

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

  const Elements& elements() const { return m_elements; }
  const Constraints& constraints() const { return m_constraints; }
  const TensorField& strain() const {
    return m_kinematics.strain();
  }                                             ///< ε (Mandel) of each point, last kinematics
  const Field& mass() const { return m_mass; }  ///< lumped, per node [kg]
  const TetMaterial& material(int tet) const { return m_material[static_cast<std::size_t>(tet)]; }
  const StepCounters& counters() const { return m_counters; }
  const linear::SolverCost& solver_cost() const { return m_solver->cost(); }
  /// Does a tet hold elastic strain beyond what rounding leaves in a body at rest?
  bool is_strained(int tet, const TensorField& plastic_strain) const;
  double min_volume_ratio() const { return m_kinematics.min_volume_ratio(); }
  int num_free() const { return static_cast<int>(m_node_of_row.size()); }
  /// Of tets that moved in the last step: all others are where they were.
  const OrderedItems& moving_nodes() const { return m_nodes; }
  const Points& x_start() const { return m_x_start; }  ///< where the last step began
  const Points& v_start() const { return m_v_start; }
  const Points& internal_force() const { return m_internal_force; }  ///< of the last assembly [N]

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
  class Product;  // A x of the present matrix, stored or not

  /// How often M, the stiffness with kept rotations and the tangent ∂P/∂F enter the matrix.
  struct MatrixShares {
    double mass = 0.0;
    double kept = 0.0;
    double exact = 0.0;
    bool operator==(const MatrixShares&) const = default;
  };

  // solid.cpp
  void number_rows();
  template <class Body>
  void each_batch(Body body) const {
    if (m_region)
      for_batches(m_region->batches(), m_elements.num_tets(), m_threads, body);
    else
      for_batches(m_elements.num_tets(), m_threads, body);
  }
  template <class Body>
  void each_node(Body body) const {
    m_nodes.each(m_elements.num_nodes(), body);
  }
  bool is_placed(int support) const;
  void take_up(const SolidState& state);
  void wake_region(const StepLoads& loads);
  void grow_region(const StepLoads& loads);
  void grow_region_by_speed(const StepLoads& loads);
  bool grow_region_by_force(const StepLoads& loads);
  void take_in_region(const StepLoads& loads);
  struct LargestWay {
    double size = 0.0;          // [m]
    Vec3 place = Vec3::Zero();  // at rest, of the node that has gone so far
  };
  Vec3 find_way(Eigen::Index row) const;
  double find_reach(std::size_t row, const LargestWay& largest) const;
  double find_felt_pull(int run, const LargestWay& largest, const StepLoads& loads) const;
  void make_region();
  void drop_region();
  void leave_region(const StepLoads& loads);
  void visit_region();
  double frame_tolerance() const;
  bool has_lagging_frames() const;
  bool may_lag_further() const;
  Elasticity elasticity(int tet) const;
  void compute_volume_changes(const TensorField& plastic_strain, Field& change) const;
  void update_volume_change(const TensorField& plastic_strain);
  StepStatus update_motion(const Points& x, Tick tick, bool keeps_frames);

  // assembly.cpp
  void assemble_internal_force();
  bool has_isotropic_tets() const;
  bool has_plain_tets() const;
  ForceArrays make_force_arrays(const TensorField& plastic_strain, double* corner_force) const;
  void set_tet_forces();
  template <int N>
  void set_corner_forces();
  template <int N>
  void set_corner_products(const Points& u, double kept, double exact);
  void compute_stiffness_product(const Points& u, double kept, double exact, Points& force);
  void compute_present_product(const Points& u, Points& force);
  Mat3 volume_gradient(int tet) const;
  Mat3 kept_rotation(int point) const;
  void gather(const Eigen::Matrix3Xd& corner_force, Points& force) const;
  void clear_held(Points& u) const;

  // contacts.cpp
  void start_contacts(std::size_t count);
  bool exchange_contacts(std::span<const PointStiffness> contacts);
  Vec3 compute_contact_fall(std::span<const PointStiffness> contacts, std::size_t i) const;
  double compute_contact_potential(std::span<const PointStiffness> contacts, std::size_t i) const;
  void add_contact_product(const Points& u, std::span<const PointStiffness> contacts, double scale,
                           Points& force) const;
  static void spread(const PointStiffness& contact, const Vec3& f, Points& force);
  static Vec3 compute_mean_way(const PointStiffness& contact, const Points& to, const Points& from);

  // matrix.cpp
  bool needs_tangents() const;
  MatrixShares shares() const;
  void assemble_tangents();
  void assemble_matrix(std::span<const PointStiffness> contacts);
  void assemble_rows();
  void mark_rows(bool all);
  template <int N>
  void gather_row(int row, const MatrixShares& share);
  void make_pattern();
  bool keeps_nodal_factors() const;
  void store_nodal_stiffness();
  void update_nodal_stiffness();
  void add_nodal_stiffness(const Eigen::Matrix3Xd& gradient, double scale);
  void add_contacts(std::span<const PointStiffness> contacts);
  void mask_rows();
  bool has_only_diagonal() const { return m_params.solver.kind == linear::SolverKind::pcg_matrix_free; }

  // step.cpp
  void keep_damping_frame();
  double find_tau(const SolidState& state, double step_s) const;
  void predict(const SolidState& state, const StepLoads& loads, double step_s);
  bool place_supports(double time, double share);
  void compute_residual(const StepLoads& loads);
  void set_rhs(const StepLoads& loads);
  void set_rounding();
  double compute_excess() const;
  StepStatus check_resolution(const SolidState& state) const;
  Vec3 applied_force(const StepLoads& loads, Eigen::Index node) const;
  void set_residual_scale(const StepLoads& loads);
  double compute_potential(const StepLoads& loads);
  static linear::SolverParams make_exact(linear::SolverParams solver);
  double find_left(Product& product);
  double estimate_left(Product& product, double share);
  bool correct_solution(const StepLoads& loads);
  linear::SolveReport solve_system(const StepLoads& loads, bool is_first);
  StepStatus search_line(const StepLoads& loads, Tick tick);
  void set_iterate(double share);
  double gravity_mass(Eigen::Index node) const;
  bool is_newton() const { return m_is_static || m_params.iteration == Iteration::newton; }
  bool is_explicit() const { return !m_is_static && m_params.integrator == Integrator::symplectic_euler; }
  StepStatus iterate_static(const SolidState& state, const StepLoads& loads);

  SolidParams m_params;
  int m_threads;
  Elements m_elements;
  std::vector<Support> m_supports;
  Constraints m_constraints;
  Field m_mass;
  Field m_static_mass;  // carries gravity in statics
  Field m_water_mass;   // of each tet; empty without
  Elements m_dry;       // gradient and weight of tets that have not swollen; empty without swelling
  std::vector<TetMaterial> m_material;
  std::vector<Mat6> m_stiffness;        // empty while every tet is isotropic
  Field m_lambda, m_mu, m_excess_bulk;  // of each tet as elasticity() has them

  Kinematics m_kinematics;
  mutable std::vector<char> m_is_batch_new;  // p1: have its tets moved since they were summarised?
  mutable Field m_batch_energy, m_batch_plastic_strain;
  mutable Field m_group_energy, m_group_plastic_strain;  // of each group of these runs
  Field m_tet_volume_change;                             // p1_nodal: θ of each tet
  Field m_volume_change;                                 // p1_nodal: θ of each tet's nodes, their mean
  Field m_nodal_pressure;                                // and the stress that it is [Pa]

  Eigen::Matrix3Xd m_kept_rotation;                     // damping's R where it is not the present one
  Eigen::Matrix<double, 81, Eigen::Dynamic> m_tangent;  // ∂P/∂F of each point, where it is wanted
  bool m_is_projected = true;                           // with its negative modes set to zero
  Eigen::Matrix3Xd m_corner_force;                      // N columns a tet, and one more
  Points m_internal_force;

  std::vector<int> m_row_of_node;  // −1: held in all directions
  std::vector<int> m_nodes_along_curve;
  std::vector<int> m_node_of_row;
  std::vector<std::array<int, 2>> m_placed_components;  // node and direction of what is_placed
  std::vector<int> m_held_rows;                         // rows with a held component
  std::vector<int> m_block_of_corner_pair;  // N² a tet: place of block (i, j), −1 where there is none
  linear::BlockMatrix m_matrix;
  MatrixShares m_stored_shares;         // of the matrix that is stored
  std::vector<char> m_is_tet_changed;   // its stiffness or frame, since then
  std::vector<char> m_is_row_stale;     // holds something that the next matrix may not
  OrderedRuns m_rows;                   // that are solved for
  OrderedRuns m_near_rows;              // and those that awake tets pull at
  OrderedItems m_nodes;                 // of tets that move
  std::unique_ptr<ActiveSet> m_region;  // Extent::local
  bool m_has_old_forces = true;         // of tets that do not move: not found yet
  bool m_has_old_nodes = true;          // what a step takes of nodes that do not move: not taken up yet
  double m_fastest = 0.0;               // speed of the last step [m/s]
  double m_frame_slack = 0.0;           // by how much frames may lag where the force at the hand allows it
  struct {
    double left = 0.0;          // by frames that lag, in terms of the right-hand side
    double way = 0.0;           // their lag times the body's speed
    int steps = 0;              // for so many more it is not found anew
  } m_frame_error;              // as it was last found
  double m_region_slack = 0.0;  // of the present step [N]
  double m_held_back = 0.0;
  std::vector<std::pair<double, int>> m_pulls;  // on runs that sleep [N], and their numbers
  Points m_last_load;                           // forces of the last step
  std::vector<double> m_point_sums;             // of each run of points
  std::vector<double> m_run_speed;              // of the fastest node of each run that is awake
  std::unique_ptr<linear::Solver> m_solver;
  std::unique_ptr<linear::Solver> m_static_solver;    // made at first use, as is the next:
  std::unique_ptr<linear::Solver> m_response_solver;  // each keeps a factor of its own
  std::unique_ptr<NodalVolume> m_nodal;               // p1_nodal
  std::unique_ptr<NodalProduct> m_nodal_product;      // its stiffness where the matrix does not hold it

  // Of the present step.
  bool m_is_static = false;
  double m_load_share = 1.0;  // statics: part of the loads that is applied
  double m_tau = 0.0;
  Points m_x_hat, m_v_hat;                        // 3×n
  Points m_x_start;                               // where the step began and contacts were found
  Points m_held_x;                                // where prescribed components are at the step's end
  Points m_x, m_v, m_v_base;                      // iterate, and where its line search began
  Points m_v_start;                               // v at the step's start: first guess of the solve
  const TensorField* m_plastic_strain = nullptr;  // the state's, during a step
  Points m_product, m_direction, m_zero;          // working arrays, 3×n; the last one stays zero
  Points m_rhs, m_delta;                          // a column a row
  Points m_left, m_correction;                    // likewise: what δ leaves of the step, and what to add
  struct {
    TensorField strain;
    Eigen::Matrix3Xd corner_force;
    Field volume, pressure;
  } m_change;  // of 4-node tets by a small displacement, the present rotations kept
  mutable struct {
    Field change, mean_kept, mean_exact;  // of volume, of each tet
    Eigen::Matrix3Xd gradient;
  } m_of_nodal;                   // working arrays of p1_nodal
  double m_first_residual = 0.0;  // of the first guess of its first solve
  double m_residual_scale = 0.0;
  double m_corner_scale = 0.0;      // Σ‖corner force‖²
  Field m_rounding;                 // what rounding alone leaves of the internal force at each node [N]
  bool m_is_shifted = false;        // some support is not where it was at rest
  bool m_is_driven = false;         // something acts in this step: a body left alone is not stirred
  bool m_is_moved_by_load = false;  // statics: some solve was made
  double m_potential = 0.0, m_potential_scale = 0.0, m_potential_rounding = 0.0;
  StepCounters m_counters;
  int m_iterations = 0;                 // Newton's, of the present step or share of the load
  std::vector<char> m_contact_acts;     // at the number of each group's first entry
  std::vector<double> m_contact_force;  // likewise: Σ n·f − k n·(x − x₀)
  int m_contact_exchanges = 0;
};

}  // namespace argil::solid
