#include "contact/passage.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/nearest.h"

namespace argil::contact {
namespace {

/// A tool counts as passing from where the middle of one of its balls would be behind the surface after so
/// much of the ball's radius.
constexpr double kAhead = 0.25;

struct Face {
  std::array<Vec3, 3> x;
  Vec3 normal = Vec3::Zero();  // not of unit length
};

Face get_face(const TreeSurface& body, int number) {
  Face face;
  for (Eigen::Index k = 0; k < 3; ++k)
    face.x[static_cast<std::size_t>(k)] = body.x.col(body.triangles(k, number));
  face.normal = (face.x[1] - face.x[0]).cross(face.x[2] - face.x[0]);
  return face;
}

/// Where the line from a along d passes a face: on the left of each of its edges or on the right of each. One
/// edge has one answer for both of its faces, so that no line slips through between two of them and none
/// meets both.
bool is_met(const Vec3& a, const Vec3& d, const Face& face, const Eigen::Vector3i& vertex) {
  int left = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    const double side = d.dot((face.x[k] - a).cross(face.x[next] - a));
    const bool goes_up =
        vertex(static_cast<Eigen::Index>(k)) < vertex(static_cast<Eigen::Index>(next));  // on the edge itself
    left += (side != 0.0 ? side > 0.0 : goes_up) ? 1 : 0;
  }
  return left == 0 || left == 3;
}

/// Where a segment crosses a face.
struct Crossing {
  int sign = 0;       ///< 1: into the body, −1: out of it, 0: not at all
  double time = 0.0;  ///< on the segment, 0 to 1
};

Crossing find_crossing(const TreeSurface& body, int number, const Vec3& from, const Vec3& to) {
  const Face face = get_face(body, number);
  const double begin = face.normal.dot(from - face.x[0]);
  const double end = face.normal.dot(to - face.x[0]);
  if ((begin > 0.0) == (end > 0.0)) return {};
  if (!is_met(from, to - from, face, body.triangles.col(number))) return {};
  return {begin > 0.0 ? 1 : -1, begin / (begin - end)};
}

Vec3 place(const Pose& pose, const Vec3& p) {
  return pose.position + pose.orientation * p;
}

}  // namespace

void Passage::list_segments(const std::vector<InnerBall>& balls, const Pose& pose_t0, const Pose& pose_t1) {
  m_segments.clear();
  for (const InnerBall& ball : balls) {
    Segment segment{place(pose_t0, ball.centre), place(pose_t1, ball.centre), ball.radius};
    const double length = (segment.to - segment.from).norm();
    segment.ahead = length > 0.0 ? kAhead * ball.radius / length : 0.0;
    m_segments.push_back(segment);
  }
}

/// Straight to the same ends by another way.
void Passage::move_starts(const Vec3& way) {
  for (Segment& segment : m_segments) {
    segment.from = segment.to - way;
    segment.ahead = kAhead * segment.radius / way.norm();
  }
}

/// Faces near the segments, or also near the balls at their ends.
void Passage::find_near(const TreeSurface& body, bool with_balls) {
  mesh::Box box;
  for (const Segment& segment : m_segments) {
    box.include(segment.from);
    box.include(segment.to + segment.ahead * (segment.to - segment.from));
    if (with_balls) box.include(mesh::Box{segment.to, segment.to}.grown(segment.radius));
  }
  m_near.clear();
  body.tree.find_overlaps(box, body.x, body.x, m_near);
  std::sort(m_near.begin(), m_near.end());
}

/// Where the balls' middles first come into the body on their way.
std::optional<Passage::Interval> Passage::find_entry(const TreeSurface& body) {
  Vec3 sum = Vec3::Zero();
  Vec3 first_normal = Vec3::Zero();
  double first_time = std::numeric_limits<double>::infinity();
  const Segment* first = nullptr;
  for (const Segment& segment : m_segments) {
    const Vec3 end = segment.to + segment.ahead * (segment.to - segment.from);
    int face = -1;
    double time = std::numeric_limits<double>::infinity();
    for (const int number : m_near) {
      const Crossing crossing = find_crossing(body, number, segment.from, end);
      if (crossing.sign <= 0 || !(crossing.time < time)) continue;
      time = crossing.time;
      face = number;
    }
    if (face < 0) continue;
    const Vec3 normal = get_face(body, face).normal.normalized();
    sum += normal;
    time *= 1.0 + segment.ahead;
    if (!(time < first_time)) continue;
    first_time = time;
    first_normal = normal;
    first = &segment;
  }
  if (!first) return {};
  Interval interval;
  const Vec3 path = first->to - first->from;
  interval.inward = -sum.normalized();
  if (!(interval.inward.dot(path) > 0.0)) interval.inward = -first_normal;
  const Vec3 beyond = std::max(0.0, 1.0 - first_time) * path;
  interval.shift = beyond.dot(interval.inward) * interval.inward - beyond;
  interval.length = path.dot(interval.inward) + first->radius;
  return interval;
}

/// Does any ball's middle come into the body on its way?
bool Passage::enters(const TreeSurface& body) const {
  for (const Segment& segment : m_segments)
    for (const int number : m_near)
      if (find_crossing(body, number, segment.from, segment.to + segment.ahead * (segment.to - segment.from))
              .sign > 0)
        return true;
  return false;
}

/// Is any ball in the body at the end of its way, or in touch with its surface?
bool Passage::overlaps(const TreeSurface& body) const {
  for (const Segment& segment : m_segments) {
    int inside = 0;
    for (const int number : m_near) {
      const Face face = get_face(body, number);
      if (compute_nearest_on_triangle(segment.to, face.x[0], face.x[1], face.x[2]).squared_distance <
          segment.radius * segment.radius)
        return true;
      inside += find_crossing(body, number, segment.from, segment.to).sign;
    }
    if (inside > 0) return true;
  }
  return false;
}

std::optional<Passage::Interval> Passage::find(const std::vector<InnerBall>& balls, const Pose& pose_t0,
                                               const Pose& pose_t1, const TreeSurface& body) {
  list_segments(balls, pose_t0, pose_t1);
  if (m_way.isZero(0.0)) {
    find_near(body, false);
    std::optional<Interval> interval = m_near.empty() ? std::nullopt : find_entry(body);
    if (!interval) return {};
    find_near(body, true);
    interval->has_left = !overlaps(body);
    if (!interval->has_left) m_way = interval->length * interval->inward;
    return interval;
  }
  Interval interval;
  interval.inward = m_way.normalized();
  double ahead = -std::numeric_limits<double>::infinity();
  for (const Segment& segment : m_segments) {
    const double step = (segment.to - segment.from).dot(interval.inward);
    ahead = std::max(ahead, step);
    interval.retreat = std::max(interval.retreat, -step);
  }
  // At least a way along which the balls can be looked at.
  interval.length = std::max(m_way.norm() + ahead, kAhead * m_segments.front().radius);
  m_way = interval.length * interval.inward;
  move_starts(m_way);
  find_near(body, true);
  if (!enters(body)) {
    m_way.setZero();  // it has come back
  } else if (!overlaps(body)) {
    m_way.setZero();
    interval.has_left = true;
  }
  return interval;
}

void Passage::serialize(Archive& archive) {
  archive.array("contact/passage", m_way);
  if (archive.is_restoring()) commit();
}

}  // namespace argil::contact
