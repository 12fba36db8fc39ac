#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/archive.h"
#include "base/ordered_runs.h"
#include "material/moisture.h"
#include "sim/clock.h"
#include "sim/compliance.h"
#include "sim/contact_surface.h"
#include "sim/params.h"
#include "sim/record.h"
#include "sim/stage.h"
#include "sim/state.h"

namespace argil::sim {

/// One body, one tool, one loop. Feed it a device sample a tick; read records and frames between ticks.
/// Same parameters and samples give the same bits on any number of threads.
class Simulation {
 public:
  /// `tool`: closed surface in the tool frame; `start`: pose and mode before the first tick.
  Simulation(Body body, const mesh::TriangleMesh& tool, const Params& params,
             const device::DeviceSample& start);

  /// One haptic tick: the tool goes to `sample`, the paper's loop runs, the hand gets its force.
  StepStatus tick(const device::DeviceSample& sample);

  /// Takes the body to its elastic equilibrium under its loads, without the tool. Kinematics, records and
  /// frames are those of the equilibrium then.
  StepStatus settle();

  /// True when the tool touches or lies in the body now; a run must not start so.
  bool tool_overlaps_body() const;

  const State& state() const { return m_state; }
  const Body& body() const { return m_body; }
  const Clock& clock() const { return m_clock; }
  const water::PoreWater& pore_water() const { return m_water; }
  const solid::Solid& solid() const { return m_solid; }
  const contact::Contacts& contacts() const { return m_contacts; }
  const Params& params() const { return m_params; }
  bool physics_due_last_tick() const {
    return m_clock.tick > 0 && m_clock.tick % m_params.rates.physics_period_ticks == 0;
  }
  bool frame_due_last_tick() const { return m_clock.tick % m_params.rates.frame_period_ticks == 0; }

  HapticRecord haptic_record() const;    ///< of the last tick
  PhysicsRecord physics_record() const;  ///< of the last physics step
  Frame make_frame() const;              ///< the body as it is now
  std::string state_hash() const;        ///< SHA-256 of everything a tick changes

  /// All that a tick takes from earlier ones: bits after a return are those without. Only after a physics
  /// step, or before the first tick.
  Snapshot take_snapshot();
  /// Goes on from `snapshot`, taken from a simulation of the same body, tool and parameters. `origin` is what
  /// messages call it. Throws IoError when it does not fit.
  void restore(const Snapshot& snapshot, const std::string& origin);

  void observe_stages(StageObserver* observer) { m_observer = observer; }

 private:
  // Stages of a tick, defined in step.cpp in the order in which they run.
  void contact_step(int ticks);
  StepStatus yielding_contact_step();
  StepStatus water_step();
  StepStatus physics_step();
  double clay_factor(Eigen::Index node, double step_s) const;
  void apply_clay_kernel(double step_s);
  StepStatus check_energy();
  Vec6 compute_flow(int point, double step_s) const;
  void apply_plastic_flow(double step_s);
  double flow_at_points(std::ptrdiff_t begin, std::ptrdiff_t end, double step_s);
  double flow_at_point(int point, double step_s);

  // Between contacts, body and hand: hand.cpp.
  void move_hand(const device::DeviceSample& sample);
  void find_contacts(const Points& x, int ticks);
  void act_on_body(const contact::Contact& c, const Vec3& force, double share);
  void spread_contact_force(int ticks);
  void add_contact_stiffness(const contact::Contact& c, const Vec3& force, bool pushes, double share);
  void add_contact_stiffness(const contact::Contact& c, const Vec3& direction, double stiffness,
                             double force_at_rest);
  std::size_t find_group(const contact::Contact& c, std::size_t first, std::size_t pieces);
  void apply_contact_yield();
  bool is_yielding() const;
  BodyAtFrame body_at_frame();
  void follow_with_springs();
  void make_springs();
  void render_force();

  // Checkpoints: snapshot.cpp.
  void exchange_state(Archive& archive);
  void exchange_contact_state(Archive& archive);
  void exchange_water_state(Archive& archive);
  void exchange_springs(Archive& archive);

  void exchange_water(int sign, double step_s);
  TensorField mean_plastic_strain() const;
  StepStatus refresh_materials(double tolerance);
  void refresh_material(int tet, double S);
  void fall_asleep();
  bool rests();

  Params m_params;
  Body m_body;
  Clock m_clock;
  State m_state;
  material::MoistureTable m_moisture;
  solid::Solid m_solid;
  water::PoreWater m_water;
  ContactSurface m_surface;
  contact::ContactDetector m_detector;
  contact::Contacts m_contacts;
  LocalCompliance m_compliance;
  std::vector<ContactSpring> m_springs;       // of the last detection, with their forces
  std::vector<std::size_t> m_spring_contact;  // and their places in m_contacts
  Points m_yielded_x;                         // 3×n, nodes as they have yielded between physics steps
  double m_pressed_weight = 0.0;              // Σ|force| of the last detection
  device::OutputGate m_gate;
  device::GatedForce m_gated;
  std::vector<solid::PointStiffness>
      m_contact_stiffness;  // since the last physics step, by their share of it
  struct Yield {
    Vec3 point;                  // where the force acts [m]
    double force_at_rest = 0.0;  // what the solve was told besides, for damping [N]
  };
  std::vector<Yield> m_yields;  // of each of these
  struct ContactGroup {
    std::array<int, 3> vertex;  // of the surface
    std::size_t first;          // entry of m_contact_stiffness
    std::size_t pieces;         // and how many stand for a contact
  };
  std::vector<ContactGroup> m_contact_groups;
  std::size_t m_last_detection = 0;  // where in it the last detection's contacts begin
  std::vector<int> m_touched_tet;    // tets under the tool, and how much of their surface
  std::vector<double> m_touched_area;
  std::vector<int> m_changed_tets;
  Points m_surface_x;   // 3×vertices of the surface, as it is now
  Points m_load_force;  // 3×n, constant
  Points m_external_force;
  Points m_x_before, m_v_before;
  std::vector<double> m_shape_stiffness;  // 2μ* per tet [Pa]; empty: isotropic stiffness
  bool m_is_flow_driven = false;          // plastic flow follows the stress, not the strain
  Field m_yield;                          // of each point: elastic strain norm [–]
  std::vector<char> m_is_flowing;         // of each run of kLanes points, in the last step
  OrderedRuns m_runs;
  bool m_is_moved = false;                                  // some support moves
  double m_rest_energy = 0.0, m_rest_plastic_strain = 0.0;  // of the body while it is at rest
  StageObserver* m_observer = nullptr;
};

}  // namespace argil::sim
