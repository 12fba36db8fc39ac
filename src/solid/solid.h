#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "base/status.h"
#include "linear/pcg.h"
#include "mesh/topology.h"
#include "solid/element.h"
#include "solid/parameters.h"

namespace argil::solid {

/// Motion and history of the body; what a checkpoint must hold.
struct SolidState {
  Points x;                    ///< 3×n positions [m]
  Points v;                    ///< 3×n velocities [m/s]
  TensorField plastic_strain;  ///< 6×m ε_p in each tet's turned frame, Mandel
};

/// Stiffness that a penalty contact adds between its vertices: k·wᵢwⱼ n⊗n.
struct PointStiffness {
  std::array<int, 3> vertex = {-1, -1, -1};  ///< −1 beyond the last; all on one boundary triangle
  std::array<double, 3> weight = {};
  Vec3 normal = Vec3::Zero();
  double stiffness = 0.0;  ///< k [N/m]
};

/// Stiffness and strength of one tet as the water left them.
struct TetMaterial {
  double lambda = 0.0;  ///< [Pa]
  double mu = 0.0;      ///< [Pa]
  double yield = 0.0;   ///< elastic strain norm [–]
};

/// The linear solves of a run so far.
struct SolverCounters {
  int iterations = 0;      ///< of the last solve
  int factorisations = 0;  ///< since the start
  double residual = 0.0;   ///< relative, of the last solve
};

/// Regions → fixed vertices, increasing, without repeats.
std::vector<int> find_vertices(const Points& rest, std::span<const Region> regions);

/// Corotational finite elements on 4-node tets with lumped mass and one linearised backward Euler step
/// [Baraff & Witkin 1998; Müller & Gross 2004]: stages in the order in which sim/step.cpp calls them. Bits do
/// not depend on `threads`; no allocation after the first step unless the solver factorises.
class Solid {
 public:
  Solid(const mesh::TetMesh& mesh, const mesh::Topology& topology, std::vector<int> fixed,
        const SolidParams& params, int threads);

  /// Stiffness and yield of one tet; `C` (Mandel) only for anisotropic laws.
  void set_material(int tet, const TetMaterial& material);
  void set_anisotropic_stiffness(int tet, const Mat6& C);

  /// F → R → ε at positions x. Fails when det F is not above the bound of the parameters.
  StepStatus update_kinematics(const Points& x, Tick tick);

  /// A = (1 + ha)M + (h² + hb)K + h²K_contact and b = M v + h(f_ext − f_int), eq. 2 by backward Euler.
  void assemble(const SolidState& state, const Points& external_force,
                std::span<const PointStiffness> contacts, double step_s);

  /// Solves A v = b on the free vertices; fixed ones get v = 0.
  StepStatus solve(SolidState& state, Tick tick);

  /// Turns the force that was given to assemble() into the one that acted: backward Euler takes a contact's
  /// force at the end of the step, f − h k (n·v) n. `velocity`: as solved.
  void apply_contact_stiffness(const Points& velocity, std::span<const PointStiffness> contacts,
                               double step_s, Points& force) const;

  const TensorField& strain() const { return m_strain; }  ///< ε (Mandel) of the last kinematics
  const Field& volume() const { return m_volume; }        ///< rest volumes [m³]
  const Field& mass() const { return m_mass; }            ///< lumped, per vertex [kg]
  const TetMaterial& material(int tet) const { return m_material[static_cast<std::size_t>(tet)]; }
  const SolverCounters& counters() const { return m_counters; }
  double min_volume_ratio() const { return m_min_volume_ratio; }
  int num_free() const { return static_cast<int>(m_vertex_of_row.size()); }
  const Points& internal_force() const { return m_internal_force; }  ///< of the last assembly [N]

  /// ½ V ε_e:C:ε_e of one tet for the given plastic strain [J].
  double compute_elastic_energy(int tet, const Vec6& plastic_strain) const;
  double compute_elastic_energy(const SolidState& state) const;
  double compute_kinetic_energy(const SolidState& state) const;

 private:
  void assemble_tets(const SolidState& state);
  void assemble_rows(const SolidState& state, const Points& external_force, double step_s);
  void add_contacts(std::span<const PointStiffness> contacts, double step_s);
  bool factorise();
  Vec6 compute_stress(std::size_t tet, const Vec6& elastic_strain) const;

  SolidParams m_params;
  int m_threads;
  Tets m_tets;
  std::vector<int> m_vertex_begin, m_vertex_corners;  // topology's vertex → corners

  Field m_volume, m_mass;
  Eigen::Matrix3Xd m_gradient;  // ∇N, 4 columns a tet
  std::vector<TetMaterial> m_material;
  std::vector<Mat6> m_stiffness;  // empty while every tet is isotropic

  Eigen::Matrix3Xd m_rotation;  // R, 3 columns a tet
  TensorField m_strain;
  Field m_volume_ratio;  // det F
  double m_min_volume_ratio = 1.0;

  Eigen::Matrix3Xd m_turned_gradient;  // R ∇N, 4 columns a tet
  Eigen::Matrix3Xd m_corner_force;     // internal force on each corner
  Points m_internal_force;

  std::vector<int> m_row_of_vertex;  // −1: fixed
  std::vector<int> m_vertex_of_row;
  std::vector<int> m_block_of_corner_pair;  // 16 a tet: place of block (i, j), −1 where either is fixed
  linear::BlockMatrix m_matrix;
  Points m_rhs, m_velocity;
  linear::ConjugateGradients m_cg;
  linear::BlockJacobi m_jacobi;
  std::unique_ptr<linear::CholeskyFactor> m_factor;
  bool m_factor_valid = false;
  SolverCounters m_counters;
};

}  // namespace argil::solid
