// How deep a point of the body is below the tool, over the tool's way.

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/pressure.h"

namespace argil::contact {
namespace {

/// ∫ of min(max(s, 0), most) from 0 to s.
double integrate_limited(double s, double most) {
  if (!(s > 0.0)) return 0.0;
  return s < most ? 0.5 * s * s : 0.5 * most * most + most * (s - most);
}

}  // namespace

/// Places of the tool along its way, in pieces that are no longer than it is thick: their ends, or for a body
/// that keeps its shape, where nothing hangs on the end, their middles.
void PressureContact::place_tool(const Pose& pose_t0, const Pose& pose_t1) {
  const Vec3 path = pose_t1.position - pose_t0.position;
  const double angle = pose_t0.orientation.angularDistance(pose_t1.orientation);
  m_way = path.norm() + angle * m_tool.reach();
  const double wanted = std::ceil(m_way / m_tool.thickness());
  const int pieces = static_cast<int>(std::min(wanted, static_cast<double>(kMostPlaces - 1)));
  const double first = m_yielding == Yielding::yes ? 0.0 : 0.5;
  m_places.clear();
  if (m_passage) {
    m_step = path;
    m_turn = (pose_t0.orientation * pose_t1.orientation.conjugate()).toRotationMatrix();
    m_places.push_back(
        {pose_t1.position + m_passage->shift, pose_t1.orientation.conjugate().toRotationMatrix()});
    return;
  }
  for (int i = 0; i < pieces; ++i) {
    const double t = (first + i) / pieces;
    const Quat orientation = pose_t0.orientation.slerp(t, pose_t1.orientation);
    m_places.push_back({pose_t0.position + t * path, orientation.conjugate().toRotationMatrix()});
  }
  if (m_yielding == Yielding::yes || pieces == 0)
    m_places.push_back({pose_t1.position, pose_t1.orientation.conjugate().toRotationMatrix()});
}

/// Of a point that is farther than `far`, only how far it is at least, if that is found sooner.
ToolDistance PressureContact::find_distance(const Vec3& p, const Place& place, double far) {
  if (m_tool.is_ball()) return m_tool.find_from_ball(p - place.position);
  const Vec3 in_tool = place.turn * (p - place.position);
  if (far < kAnywhere)
    if (const double least = m_tool.find_least_distance(in_tool); least > far) return {least, Vec3::Zero()};
  ToolDistance found = m_tool.find_distance(in_tool, m_guess);
  found.outward = place.turn.transpose() * found.outward;
  return found;
}

/// Of a point from the tool along its way; anything beyond `reach` where it is farther. Places that are too
/// far along the way to be nearer are left out.
PressureContact::LeastDistance PressureContact::find_least_distance(const Vec3& p, double reach) {
  if (m_passage) return find_passage_distance(p, reach);
  if (m_tool.is_ball()) {
    const Nearness nearest = find_ball_nearness(p, reach);
    return {m_tool.find_from_ball(p - nearest.place->position), nearest.place};
  }
  const Place* first = find_near_place(p);
  LeastDistance least{find_distance(p, *first, m_way + reach), first};
  if (m_places.size() == 1 || least.distance - m_way >= reach) return least;
  const int last = static_cast<int>(m_places.size()) - 1;
  for (int i = 0; i <= last;) {
    const Place& place = m_places[static_cast<std::size_t>(i)];
    const ToolDistance found = &place == first ? least : find_distance(p, place, least.distance);
    if (found.distance < least.distance) least = {found, &place};
    i += count_steps(found.distance - least.distance);
  }
  return least;
}

PressureContact::Nearness PressureContact::find_nearness(const Vec3& p, double reach) {
  if (m_tool.is_ball() && !m_passage) return find_ball_nearness(p, reach);
  const LeastDistance found = find_least_distance(p, reach);
  return {found.distance, found.place};
}

PressureContact::Nearness PressureContact::find_ball_nearness(const Vec3& p, double reach) const {
  const double at_end = find_ball_distance(p, m_places.back());
  Nearness nearest{at_end, &m_places.back()};
  const int last = static_cast<int>(m_places.size()) - 1;
  if (last == 0 || at_end - m_way >= reach) return nearest;
  if (last == 1) {
    const double at_begin = find_ball_distance(p, m_places.front());
    return at_begin < at_end ? Nearness{at_begin, &m_places.front()} : nearest;
  }
  for (int i = 0; i <= last;) {
    const Place& place = m_places[static_cast<std::size_t>(i)];
    const double distance = i == last ? at_end : find_ball_distance(p, place);
    if (distance < nearest.distance) nearest = {distance, &place};
    i += count_steps(distance - nearest.distance);
  }
  return nearest;
}

/// Where the tool is likely to be nearest to a point: at the end of its way, or where what holds it is.
const PressureContact::Place* PressureContact::find_near_place(const Vec3& p) const {
  const Place* near = &m_places.back();
  if (m_tool.is_ball() || m_places.size() == 1) return near;
  const auto distance = [&](const Place& place) {
    return m_tool.find_least_distance(place.turn * (p - place.position));
  };
  double least = distance(*near);
  for (const Place& place : m_places)
    if (const double found = distance(place); found < least) {
      least = found;
      near = &place;
    }
  return near;
}

/// Of a tool that has to come nearer by so much: at least so many places farther on.
int PressureContact::count_steps(double nearer) const {
  const double step = m_way / static_cast<double>(m_places.size() - (m_yielding == Yielding::yes ? 1 : 0));
  return nearer < step ? 1 : static_cast<int>(std::min(nearer / step, static_cast<double>(kMostPlaces)));
}

/// The same where the tool passes the surface: from all that it has swept since it was outside. That is
/// convex along the way where the tool is.
PressureContact::LeastDistance PressureContact::find_passage_distance(const Vec3& p, double reach) {
  const Place& tool = m_places.back();
  const Vec3& inward = m_passage->inward;
  const Vec3 to_centre = tool.position + tool.turn.transpose() * m_tool.centre() - p;
  const double along = to_centre.dot(inward);
  double low = std::clamp(along - m_tool.radius(), -m_passage->retreat, m_passage->length);
  double high = std::clamp(along + m_tool.radius(), -m_passage->retreat, m_passage->length);
  const double middle = std::clamp(along, low, high);
  LeastDistance least{{(to_centre - middle * inward).norm() - m_tool.radius(), inward}, &tool, middle};
  if (m_tool.is_ball() || least.distance >= reach) return least;
  constexpr int kHalvings = 10;
  constexpr double kFlat = 0.03;  // slope at which the distance is near its least
  least.distance = kAnywhere;
  double s = middle;
  for (int i = 0; i < kHalvings; ++i) {
    const ToolDistance found = find_distance(p + s * inward, tool);
    if (found.distance < least.distance) {
      least.distance = found.distance;
      least.along = s;
    }
    const double slope = found.outward.dot(inward);
    (slope < 0.0 ? low : high) = s;
    if (std::abs(slope) < kFlat || least.distance - (high - low) >= reach) break;
    s = 0.5 * (low + high);
  }
  return least;
}

/// How far a point inside the tool is from its surface along a direction [m]: by Newton's method, from
/// outside where the surface is steep, in steps that are four times the distance at most.
double PressureContact::find_way_out(const Vec3& p, const Vec3& direction, const Place& place) {
  constexpr int kMostSteps = 20;
  constexpr double kLeastSlope = 0.25;
  double way = 0.0;
  for (int step = 0; step < kMostSteps; ++step) {
    const ToolDistance found = find_distance(p + way * direction, place);
    if (step > 0 && std::abs(found.distance) < 1e-7 * m_tool.radius()) break;
    const double slope = found.outward.dot(direction);
    if (step == 0 && slope < kLeastSlope) {
      const Vec3 from_centre = p - (place.position + place.turn.transpose() * m_tool.centre());
      const double along = from_centre.dot(direction);
      way = std::sqrt(std::max(
                0.0, along * along + m_tool.radius() * m_tool.radius() - from_centre.squaredNorm())) -
            along;
      continue;
    }
    way -= found.distance / std::max(kLeastSlope, slope);
  }
  return way;
}

/// Of a point inside the tool when the body keeps its shape: 1 where the way out through the body is the
/// shorter one, 0 where that through the outside is; in between by degrees near the tool's middle.
double PressureContact::find_held_facing(const Vec3& p, const Vec3& normal, const Place& place) {
  constexpr double kFull = 0.05;  // difference of both, over their sum, beyond which all of it counts
  const double through_body = find_way_out(p, -normal, place);
  const double through_outside = find_way_out(p, normal, place);
  const double difference = through_outside - through_body;
  return std::clamp(difference / (kFull * (through_outside + through_body)), 0.0, 1.0);
}

/// Mean over the way of the depth below the tool's surface, which is linear between its places. Where a step
/// finds how far the body yields, it is for a point that the tool touches at either end of its way the depth
/// at the end, even below zero: the body is to meet the tool there. With a mean it would lag ahead of the
/// tool and not behind it, where it comes back by itself.
PressureContact::PointDepth PressureContact::find_depth(const Vec3& p) {
  if (m_passage) return find_passage_depth(p);
  if (m_tool.is_ball() && m_is_solved_for && m_places.size() == 2) {
    // The usual case of what follows.
    const double begin = -find_ball_distance(p, m_places.front());
    const ToolDistance end = m_tool.find_from_ball(p - m_places.back().position);
    if (begin > 0.0 || end.distance < 0.0) return {-end.distance, begin, -end.distance, 1.0, end.outward};
    if (begin < 0.0 && end.distance > 0.0) return {0.0, begin, -end.distance, 0.0, end.outward};
  }
  if (m_places.size() == 1) {
    const ToolDistance found = find_distance(p, m_places.front(), finds_near() ? kAnywhere : 0.0);
    const double depth = -found.distance;
    return {std::max(0.0, depth), depth, depth, depth > 0.0 ? 1.0 : 0.0, found.outward};
  }
  PointDepth point;
  const double pieces = static_cast<double>(m_places.size() - 1);
  // From a place that is farther away, the tool does not come to the point in one piece of its way.
  const double far = m_way / pieces;
  ToolDistance before = find_distance(p, m_places.front(), far);
  point.begin = point.end = -before.distance;
  ToolDistance end;
  if (m_is_solved_for) {
    end = find_distance(p, m_places.back());
    if (point.begin > 0.0 || end.distance < 0.0)
      return {-end.distance, point.begin, -end.distance, 1.0, end.outward};
  }
  point.outward = std::max(0.0, point.end) * before.outward;
  const std::size_t last = m_places.size() - 1;
  for (std::size_t i = 0; i < last;) {
    // None of the places that are left out is below the surface, nor is the next one.
    i = std::min(last, i + static_cast<std::size_t>(count_steps(before.distance)));
    const ToolDistance found = find_distance(p, m_places[i], far);
    point.end = -found.distance;
    const double high = -std::min(before.distance, found.distance);
    const double low = -std::max(before.distance, found.distance);
    const double share = low >= 0.0 ? 1.0 : high > 0.0 ? high / (high - low) : 0.0;
    point.share += share / pieces;
    point.mean += 0.5 * share * (high + std::max(0.0, low)) / pieces;
    point.outward += std::max(0.0, point.end) * found.outward;
    before = found;
  }
  if (m_is_solved_for) {
    before = end;
    point.end = -end.distance;
  }
  const double length = point.outward.norm();
  point.outward = length > 0.0 ? Vec3(point.outward / length) : before.outward;
  return point;
}

/// The same straight into a body that keeps its shape, so that ∫ depth dA is the volume that the two share.
PressureContact::PointDepth PressureContact::find_held_depth(const Vec3& p, const Vec3& normal) {
  if (m_passage) return find_passage_depth(p);
  PointDepth point;
  const double places = static_cast<double>(m_places.size());
  for (const Place& place : m_places) {
    const ToolDistance found = find_distance(p, place, 0.0);
    if (!(found.distance < 0.0)) continue;
    double share = facing_share(found.outward, normal);
    if (share < 1.0) share = std::max(share, find_held_facing(p, normal, place));
    point.mean += share * find_way_out(p, -normal, place) / places;
  }
  point.end = point.mean;
  point.outward = -normal;
  return point;
}

/// Where the tool passes the surface, how far its front has gone past the point. In clay that yields no more
/// than the tool is thick. When tool and body are apart in the end, its rear has gone past, too.
PressureContact::PointDepth PressureContact::find_passage_depth(const Vec3& p) {
  const Vec3& inward = m_passage->inward;
  PointDepth point;
  point.outward = inward;
  const LeastDistance least = find_passage_distance(p, 0.0);
  point.begin = point.end = -least.distance;
  if (!(least.distance < 0.0)) return point;
  const Place& tool = m_places.back();
  const Vec3 inside = p + least.along * inward;
  const double front = least.along + find_way_out(inside, inward, tool);
  const Vec3 from_tool = p + front * inward - tool.position;
  const double step = inward.dot(m_step + from_tool - m_turn * from_tool);  // of the front in this interval
  const double most = m_yielding == Yielding::yes ? m_tool.thickness() : kAnywhere;
  const double chord =
      m_passage->has_left ? front - least.along + find_way_out(inside, -inward, tool) : kAnywhere;
  const double before = std::min(front - step, chord);
  const double after = std::min(front, chord);
  point.begin = std::min(before, most);
  point.end = front < chord ? std::min(front, most) : chord - front;
  if (std::abs(step) > 1e-9 * m_tool.radius()) {
    point.mean = (integrate_limited(after, most) - integrate_limited(before, most)) / step;
    point.share = (std::max(0.0, after) - std::max(0.0, before)) / step;
  } else {
    point.mean = std::max(0.0, point.end);
    point.share = point.end > 0.0 ? 1.0 : 0.0;
  }
  return point;
}

/// 1 for a surface that faces the way out of the tool, 0 for one that looks along it; in between by degrees
/// near the right angle.
double PressureContact::facing_share(const Vec3& outward, const Vec3& normal) {
  return std::clamp(-outward.dot(normal) / kFull, 0.0, 1.0);
}

}  // namespace argil::contact
