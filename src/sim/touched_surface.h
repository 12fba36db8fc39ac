#pragma once

#include <optional>
#include <vector>

#include "base/archive.h"
#include "sim/contact_surface.h"
#include "sim/step_result.h"

namespace argil::sim {

/// The touched surface as the hand knows it: where it was at the last detection, and where the body has moved
/// it since. A detection goes from the one to the other, so that the paths of successive ones join.
class TouchedSurface {
 public:
  explicit TouchedSurface(const ContactSurface& surface);

  const Points& x_t0() const { return m_x_t0; }  ///< at the last detection [m]
  /// Where it is now [m].
  const Points& x_t1() const { return m_has_moved ? m_x_t1 : m_x_t0; }
  bool has_moved() const { return m_has_moved; }  ///< since the last detection

  /// The surface stands at x (3×vertices), as if it always had.
  void place(const Points& x);
  /// A step of the body has moved it. Takes the result's array and leaves one of its size.
  void receive(StepResult& result);
  /// It goes with nodes at `x` (3×n).
  void move_to(const Points& x);
  /// How far any vertex has moved since the last detection along an axis, at most [m]; nothing where finding
  /// out takes a look at all of them.
  std::optional<double> find_motion() const;
  /// A detection has found it where it is. At most once between two commits.
  void advance();

  /// The surface and its motion are again as at the last commit.
  /// `x`: nodes of a body whose surface has deflected since, null where it has not.
  void roll_back(const Points* x);
  void commit();
  void serialize(Archive& archive);

 private:
  void forget_motion();

  const ContactSurface& m_surface;
  Points m_x_t0, m_x_t1;  // 3×vertices
  bool m_has_moved = false;
  bool m_has_all_moved = false;  // any vertex may have moved
  std::vector<int> m_moved;      // else these have
  bool m_is_t1_known = false;    // m_x_t1 holds all vertices, also where they have not moved
  struct {
    bool has_moved = false;
    bool has_all_moved = false;
    bool is_t1_known = false;
    // Of an advance() since.
    bool has_advanced = false;
    bool is_swapped = false;
    std::vector<int> moved;
    std::vector<Vec3> x_t0;  // of these
  } m_before;                // at the last commit
};

}  // namespace argil::sim
