#pragma once

#include <vector>

#include "base/archive.h"
#include "base/change_marks.h"
#include "base/ordered_loops.h"
#include "solid/elements.h"
#include "solid/law.h"

namespace argil::solid {

/// How the points of a body have been strained and turned: F, R, ε and det F of each at the positions of the
/// last update. The matrix sees its tets in frames Q that may lag behind R; of a law whose stiffness changes
/// with the strain, behind F.
class Kinematics {
 public:
  /// `has_lag`: frames may lag, so that what they were at the last commit is known. `has_deformed_frames`:
  /// they are F, not R.
  Kinematics(const Elements& elements, StrainModel model, bool has_lag, bool has_deformed_frames);

  /// Which tets an update looks at, and what it does with their frames.
  struct Update {
    const OrderedRuns& batches;    ///< runs of kLanes tets that may have moved
    bool keeps_frames = false;     ///< Q ∇N stays as it is
    double frame_tolerance = 0.0;  ///< on ‖R − Q‖ or ‖F − Q‖, beyond which Q becomes R or F
    std::vector<char>& is_turned;  ///< set to 1 for tets whose Q changed
    std::vector<char>& is_moved;   ///< set to 1 for runs of kLanes tets that were looked at
  };
  /// Of the same elements at each call. gradient: ∇λ [1/m] of the shape at rest; x: 3×n nodes [m].
  void update(const Elements& elements, const Eigen::Matrix3Xd& gradient, const Points& x, const Update& how);
  /// A tet's frame is made anew at the next update.
  void drop_frame(int tet);
  /// A frame that is F becomes that of the last update.
  void renew_frame(int tet);

  PointMotion at(int point) const;
  const Eigen::Matrix3Xd& rotation() const { return m_rotation; }  ///< R, 3 columns a point
  const TensorField& strain() const { return m_strain; }           ///< ε (Mandel) of each point
  const Eigen::Matrix3Xd& frame() const { return m_frame; }        ///< Q, 3 columns a point
  /// Q ∇λ, four columns a point; not where Q is F.
  const Eigen::Matrix3Xd& turned_gradient() const { return m_turned_gradient; }
  /// Least det F; NaN where one is not finite.
  double min_volume_ratio() const { return m_min_volume_ratio; }
  double volume_ratio(int point) const { return m_volume_ratio(point); }
  int find_worst_point() const;  ///< whose det F is not finite, or the least

  /// What frames remember of earlier rotations.
  void serialize_frames(Archive& archive);
  /// Frames stay as they are from now on; or are again what they were then, of the same shape at rest.
  void commit() { m_changed_frames.clear(); }
  void roll_back(const Eigen::Matrix3Xd& gradient);

 private:
  bool has_lag() const { return m_committed_frame.size() > 0; }
  bool keeps_deformation() const { return m_deformation.size() > 0; }
  void keep_committed_frame(int point);
  double find_least_of_groups(const std::vector<int>* batches);

  StrainModel m_model;
  int m_points_per_tet;
  bool m_has_deformed_frames;
  Eigen::Matrix3Xd m_deformation;  // F, 3 columns a point, where strain does not say all of it
  Eigen::Matrix3Xd m_rotation;
  TensorField m_strain;
  Field m_volume_ratio;        // det F
  Field m_batch_volume_ratio;  // least of each run of kLanes tets
  Field m_group_volume_ratio;  // and of each group of these runs
  double m_min_volume_ratio = 1.0;
  Eigen::Matrix3Xd m_turned_gradient;
  Eigen::Matrix3Xd m_frame;            // Q
  Eigen::Matrix3Xd m_committed_frame;  // of those that have changed since the last commit; empty without lag
  ChangeMarks m_changed_frames;
};

}  // namespace argil::solid
