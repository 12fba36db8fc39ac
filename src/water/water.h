#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "base/ordered_loops.h"
#include "water/stencil.h"

namespace argil::water {

/// Sum that carries its rounding error along [Neumaier1974].
struct CompensatedSum {
  double sum = 0.0;
  double error = 0.0;
  void add(double x);
  double value() const { return sum + error; }
};

/// Kilograms in and out since the start.
struct WaterLedger {
  double initial = 0.0;  ///< [kg] in the body at the start
  double added = 0.0;    ///< [kg] given by the tool
  double removed = 0.0;  ///< [kg] taken by the tool
};

/// All that a run must keep of the water to go on with the same bits.
struct WaterState {
  Field saturation;  ///< S per tet [–]
  Field carry;  ///< what rounding kept out of S so far [–]: half a unit in the last place of S, or what an
                ///< implicit solve missed the bounds 0 and 1 by
  double initial = 0.0;
  CompensatedSum added, removed;  ///< [kg]
};

/// What a tool touches for a step.
struct Touch {
  std::span<const int> tet;      ///< behind the touched triangles, each as often as it is touched
  std::span<const double> area;  ///< [m²] of each of these triangles, what the tool touches of it
  int sign = 0;                  ///< > 0: the tool gives water, < 0: it takes it
};

struct ImplicitSystem;

/// Water in the pores of every tet. Saturation S in [0, 1]; mass of a tet = ρ_w n V_rest S. Bits depend on
/// the calls alone, not on `threads`.
class PoreWater {
 public:
  /// `initial_saturation`: one value per tet, in [0, 1]. Ranges are checked with the scenario and asserted
  /// here.
  PoreWater(const mesh::TetMesh& mesh, const mesh::Topology& topology, const WaterParams& params,
            const Field& initial_saturation, int threads = 1);
  ~PoreWater();
  PoreWater(PoreWater&&) noexcept;
  PoreWater& operator=(PoreWater&&) noexcept;

  /// Uptake from the tool, or to it, and diffusion for `step_s`; the rest of the boundary is sealed. No tet
  /// holds more than it can or less than nothing; what a tet does not take stays with the tool. Every gram is
  /// booked. Conservative to round-off. Without a touch S stays between the smallest and the largest S
  /// around: in explicit substeps bit for bit, in an implicit step to the solver's rounding. Explicit: only
  /// tets with water, or next to one that holds more than a trace (1e-12), are visited. Returns the number of
  /// explicit substeps or of implicit solves.
  int move(const Touch& touch, double step_s);
  int diffuse(double step_s) { return move({}, step_s); }

  /// Explicit substeps that `diffuse(step_s)` takes with the present water.
  double num_substeps(double step_s) const;

  /// Tets that may hold water, in increasing order. Saturation changes in these and in dried() alone.
  std::span<const int> active() const { return m_active; }
  /// Tets that the last move to a drying tool left dry; they are no longer active.
  std::span<const int> dried() const { return m_dried; }

  const Field& saturation() const { return m_state.saturation; }
  double capacity(int tet) const { return m_capacity(tet); }  ///< mass at S = 1 [kg]
  double mass() const;                                        ///< Σ capacity·S [kg], compensated sum
  WaterLedger ledger() const;
  double ledger_error() const;  ///< (mass − initial − added + removed) / Σ capacity [–]

  /// Longest substep [s] that keeps the maximum principle where D = D₀.
  double monotone_step() const { return m_stencil.monotone_step; }
  int num_active() const { return static_cast<int>(m_active.size()); }

  const WaterState& state() const { return m_state; }
  /// Goes on from `state`, made by a PoreWater of the same mesh and parameters.
  void restore(const WaterState& state);
  /// What has moved since the last commit stays so; or is where it was.
  void commit();
  void roll_back() { restore(m_committed); }

 private:
  /// A tet behind the tool's wall, which is full of water or dry.
  struct WallTet {
    int tet = 0;
    double area = 0.0;    // touched [m²]
    double uptake = 0.0;  // change of S times volume in a (sub)step [m³]
    // Implicit steps only.
    double conductance = 0.0;  // [m³/s]
    bool is_limited = false;   // by the tool's flux
  };

  // water.cpp
  void activate(int tet);
  void activate_around(int tet);
  void activate_all_wet();
  void sort_active();
  void leave_dry();
  bool add(int tet, double change);
  void set_potential(int tet, double saturation);

  // uptake.cpp
  void transfer(const Touch& touch, double step_s);
  void give(int tet, double mass);
  void book(double mass);
  void open_wall(const Touch& touch);
  double compute_wall_diffusivity(int tet) const;
  double compute_wall_conductance(const WallTet& wall, double step_s) const;
  double find_free_before(int tet) const;
  void find_uptake(double step_s);
  void book_uptake(double step_s);

  // diffusion.cpp
  int diffuse_in_substeps(double step_s);
  void diffuse_explicitly(double step_s);
  bool passes(int a, int b) const;
  double find_steepest() const;
  void set_flow(int tet, double step_s);
  void set_gradient(int tet);
  Vec3 mean_gradient(int tet, int other) const;
  void set_correction(int tet, double step_s);
  std::pair<double, double> find_range(int tet) const;
  void limit_correction(int tet);
  double compute_let_through(int tet) const;
  OrderedItems active_tets() const;

  // implicit.cpp
  int diffuse_implicitly(double step_s);
  void make_system();
  void factorise(double step_s);
  void set_implicit_correction(double step_s, const Field& S);
  void solve_two_point(Field& x);
  void solve_with_wall(double step_s);
  Field solve_wall_system(double step_s);
  int solve_corrected(double step_s);
  void relax_limits();
  void set_implicit_flow(double step_s);

  WaterParams m_params;
  int m_threads;
  Stencil m_stencil;
  Field m_capacity;  // [kg]
  WaterState m_state, m_committed;
  std::vector<char> m_is_active;
  std::vector<int> m_active;         // sorted between calls
  std::vector<int> m_dried;          // that the last drying took from these
  std::vector<int> m_merged;         // scratch of sort_active
  std::size_t m_num_sorted = 0;      // how many of m_active are in order
  std::vector<int> m_once;           // scratch of transfer
  std::vector<WallTet> m_wall;       // of this call of move, by tet
  double m_wall_saturation = 0.0;    // 1 or 0
  double m_wall_flux = 0.0;          // the tool's [m/s]: volume of water over n and area
  Field m_potential;                 // u(S) of D(S): expm1(βS)/β, S itself where β = 0
  Field m_change;                    // change of S in a substep
  Field m_wall_area;                 // of each tet, zero but in open_wall [m²]
  std::vector<char> m_is_newly_wet;  // in a substep
  Points m_gradient;              // ∇u of each active tet [1/m]; this and the next two: corrected flux only
  Eigen::Matrix4Xd m_correction;  // unlimited change of S times volume by the correction across each face
  Eigen::Matrix2Xd m_share;  // of the correction that raises (0) or lowers (1) S, how much is let through
  std::unique_ptr<ImplicitSystem> m_system;  // implicit_euler only
};

}  // namespace argil::water
