#pragma once

#include <array>
#include <vector>

#include "base/archive.h"
#include "base/status.h"
#include "sim/contact_surface.h"
#include "sim/nodal_force.h"

namespace argil::sim {

/// A contact as a penalty spring on the vertices of the touched surface.
struct ContactSpring {
  std::array<int, 3> vertex = {-1, -1, -1};  ///< −1 beyond the last
  std::array<double, 3> weight = {};
  Vec3 normal = Vec3::Zero();  ///< in which a push moves the body, unit
  double stiffness = 0.0;      ///< k [N/m]
  double force = 0.0;          ///< along the normal, never drawing [N]
  Vec3 point = Vec3::Zero();   ///< where it acts [m]
};

/// Every number of a spring, for an archive.
inline constexpr auto list_spring_fields = [](ContactSpring& s, auto field) {
  for (int& vertex : s.vertex) field(vertex);
  for (double& weight : s.weight) field(weight);
  for (double& value : s.normal) field(value);
  field(s.stiffness), field(s.force);
  for (double& value : s.point) field(value);
};

/// The body as the last physics step left it.
struct BodyBetweenSteps {
  solid::Body& solid;
  const solid::Part& part;  ///< of it, that moves
  const ContactSurface& surface;
  const solid::SolidState& state;
  double step_s = 0.0;
  Tick tick = 0;  ///< number of the tick under way
};

/// How the surface yields between two physics steps: u = C (F − G), with F the present forces on its
/// vertices, G those that acted in the last step, and C the nodes' displacement by a unit force on a touched
/// vertex at the end of a step, τ² A⁻¹ Wᵀ, from the body's own matrix without contacts. A vertex that is
/// touched anew has guessed columns until the next physics step, so that a tick solves nothing: what its
/// nodes yield while all others stay, times how much more the vertex solved for last yields than that. A step
/// solves for no more than four vertices: those with guesses, most pressed first, then known ones by turns.
class LocalCompliance {
 public:
  LocalCompliance(const ContactSurface& surface, int num_nodes);

  /// A share of the step in which `spring` acts on the body: its force with the body where the step begins.
  /// `group` of the solid's contacts that it belongs to.
  void hold(const ContactSpring& spring, double share, int group) {
    m_acting.push_back({spring, share, group});
  }

  /// After a physics step from x_before (3×n) on, under what was held: forgets the vertices that nothing
  /// presses.
  StepStatus begin_frame(const BodyBetweenSteps& body, const Points& x_before);

  /// Lets the surface yield under `springs`. In: the force of each if the surface stayed as it is. Out: the
  /// forces f ≥ 0 in balance with the surface as it then is, f = f_in − k n·Δu, 0 where that were below. Of
  /// Δu, what guessed and solved vertices do to each other is left to the next tick's detection. The balance
  /// is unique and continuous in what it is given.
  StepStatus press(const BodyBetweenSteps& body, std::vector<ContactSpring>& springs);

  /// Nothing presses any more; the surface comes back.
  void release();

  /// x + u at the nodes that carry the surface; the others as in x. 3×n both.
  void displace(const Points& x, Points& displaced) const;
  /// n·u where a spring acts [m].
  double compute_deflection(const ContactSurface& surface, const ContactSpring& spring) const;
  void commit();
  void roll_back(const ContactSurface& surface);
  /// All that press takes from earlier ticks.
  void serialize(Archive& archive, const ContactSurface& surface);
  int num_known() const { return static_cast<int>(m_state.known.size()); }

 private:
  struct Acting {
    ContactSpring spring;
    double share = 0.0;
    int group = -1;
  };
  /// What ticks and steps change, but for the columns.
  struct State {
    std::vector<int> known;         // vertices whose columns are known
    std::vector<char> is_guess;     // of each
    std::vector<Vec3> force, held;  // F and G of each
    double guess_factor = 1.0;      // deflection of the vertex solved for last over that of its nodes alone
    std::size_t next_renewed = 0;
  };
  void learn(const BodyBetweenSteps& body, int vertex);
  void guess_columns(const BodyBetweenSteps& body, std::size_t place);
  StepStatus solve_columns(const BodyBetweenSteps& body, std::size_t place);
  StepStatus solve_due_columns(const BodyBetweenSteps& body);
  int find_most_pressed_guess() const;
  void update_between(const ContactSurface& surface, std::size_t place);
  void forget(std::size_t place);
  void find_places(const ContactSurface& surface);
  void update_displacement();
  Vec3 compute_mean(const ContactSurface& surface, const ContactSpring& spring,
                    const Eigen::VectorXd& displacement) const;
  void assemble_balance(const std::vector<ContactSpring>& springs);
  bool solve_balance(std::size_t num_springs);
  auto between(std::size_t i, std::size_t j) const {
    return m_between.block<3, 3>(3 * static_cast<Eigen::Index>(i), 3 * static_cast<Eigen::Index>(j));
  }
  std::size_t place_of(int vertex) const {
    return static_cast<std::size_t>(m_known_of_vertex[static_cast<std::size_t>(vertex)]);
  }

  std::vector<int> m_nodes;        // that carry the surface, increasing
  std::vector<int> m_row_of_node;  // first of three; −1: within the body
  State m_state, m_committed;
  std::size_t m_committed_acting = 0;
  std::vector<int> m_known_of_vertex;  // −1: not known
  Eigen::MatrixXd m_columns;           // C: 3 rows a carrying node, 3 columns a known vertex
  Eigen::MatrixXd m_between;           // 3×3 blocks of the balance: vertex i by a force on vertex j
  std::vector<Acting> m_acting;        // since the last physics step
  bool m_has_begun_frame = false;      // since the last commit
  Eigen::MatrixXd m_columns_before;    // and the columns before that
  Eigen::VectorXd m_displacement;      // u, 3 rows a carrying node
  bool m_is_prepared = false;          // the body's matrix is that of find_columns
  Points m_load, m_response;           // 3×n
  // Working arrays of press.
  Eigen::VectorXd m_own;  // displacement by one spring
  std::vector<double> m_balance, m_factor, m_right, m_trial;
  std::vector<int> m_pressed;  // springs with a force
};

}  // namespace argil::sim
