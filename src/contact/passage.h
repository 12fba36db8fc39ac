#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "base/archive.h"
#include "contact/bounding_tree.h"
#include "contact/contact.h"
#include "contact/tool_solid.h"

namespace argil::contact {

/// A triangle surface at rest and its tree of boxes.
struct TreeSurface {
  const Points& x;  ///< [m]
  const Triangles& triangles;
  BoundingTree& tree;
};

/// How a tool has come through the surface of a body, when its middle is about to pass the surface or is
/// behind it: then the nearest way out of the tool need not lead back to where it came from. The tool is
/// taken as a few balls that lie in it. They are looked at along straight ways. The direction in which they
/// went in is kept until they are out again, on this side or on the other.
class Passage {
 public:
  /// Of one interval.
  struct Interval {
    Vec3 inward = Vec3::Zero();  ///< unit, into the body: the mean normal of the faces that were passed
    double length = 0.0;         ///< so far back along −inward the tool is outside [m]
    double retreat = 0.0;        ///< no point of the tool goes farther back along −inward [m]
    Vec3 shift = Vec3::Zero();   ///< of the tool's last place, back to where it came in [m]
    bool has_left = false;       ///< at the end the tool and the body are apart, on the other side
  };

  /// Room for a tool of so many balls and a body of so many faces.
  Passage(std::size_t num_balls, Eigen::Index num_faces) {
    m_segments.reserve(num_balls);
    m_near.reserve(static_cast<std::size_t>(num_faces));
  }

  /// The tool goes from pose_t0 to pose_t1. None: nothing is passed. Successive calls join.
  std::optional<Interval> find(const std::vector<InnerBall>& balls, const Pose& pose_t0, const Pose& pose_t1,
                               const TreeSurface& body);

  void commit() { m_committed = m_way; }
  void roll_back() { m_way = m_committed; }
  void serialize(Archive& archive);

 private:
  /// A straight way of a ball's centre.
  struct Segment {
    Vec3 from, to;
    double radius = 0.0;  // of the ball [m]
    double ahead = 0.0;   // the way goes on so many times its length
  };

  void list_segments(const std::vector<InnerBall>& balls, const Pose& pose_t0, const Pose& pose_t1);
  void move_starts(const Vec3& way);
  void find_near(const TreeSurface& body, bool with_balls);
  std::optional<Interval> find_entry(const TreeSurface& body);
  bool enters(const TreeSurface& body) const;
  bool overlaps(const TreeSurface& body) const;

  Vec3 m_way = Vec3::Zero();  // back along it the tool is outside again [m]; zero: it has passed nothing
  Vec3 m_committed = Vec3::Zero();
  std::vector<Segment> m_segments;  // working arrays
  std::vector<int> m_near;
};

}  // namespace argil::contact
