// Faces near a ball, eight at a time, by the formulas and in the order of operations of find_face() and
// cover_piece(): the bits do not hang on which of them measured a face.

#include <algorithm>
#include <numbers>

#include "base/lanes.h"
#include "contact/pressure.h"

namespace argil::contact {
namespace {

struct LaneVec {
  Lanes x, y, z;
};

ARGIL_INLINE void subtract(const LaneVec& a, const LaneVec& b, LaneVec& out) {
  out.x = a.x - b.x;
  out.y = a.y - b.y;
  out.z = a.z - b.z;
}

ARGIL_INLINE void square(const LaneVec& a, Lanes& out) {
  out = a.x * a.x + a.y * a.y + a.z * a.z;
}

ARGIL_INLINE void take_larger(const Lanes& a, Lanes& out) {
  out = out < a ? a : out;
}

ARGIL_INLINE void take_smaller(const Lanes& a, Lanes& out) {
  out = a < out ? a : out;
}

ARGIL_INLINE void clamp_to_share(Lanes& a) {
  const Lanes zero = {}, one = zero + 1.0;
  a = a < zero ? zero : a;
  a = one < a ? one : a;
}

/// Of points from the middle of a ball.
ARGIL_INLINE void measure_length(const LaneVec& p, const Vec3& middle, LaneVec& from_middle, Lanes& length) {
  from_middle = {p.x - middle(0), p.y - middle(1), p.z - middle(2)};
  Lanes squares;
  square(from_middle, squares);
  set_root(length, squares);
}

/// What faces are measured against.
struct BallPath {
  Vec3 begin, end;     ///< of its middle [m]
  double radius;       ///< [m]
  double way;          ///< [m]
  double margin;       ///< [m]
  double widest_band;  ///< of a face's side
  double full_facing;  ///< cosine
};

/// Of faces, what find_face() measures.
struct Measured {
  Lanes slack;     ///< by how much they are nearer than what counts at most [m]
  Lanes overlap;   ///< of their boxes with the query's [m]; negative where they are apart
  Lanes distance;  ///< of their middles from the ball [m]
  Lanes reach, area, size, band;
  Lanes share;    ///< of the area that is covered
  Lanes covered;  ///< area [m²]
  Lanes facing;   ///< of it, what faces the ball [m²]
  Lanes nearest;  ///< distance of their nearest corners [m]
};

/// Four numbers of each of eight vertices, then the same of eight others.
ARGIL_INLINE void read_corners(const double* vertices, const int (&a)[kLanes], const int (&b)[kLanes],
                               Lanes (&out)[8]) {
  for (int lane = 0; lane < kLanes; ++lane) {
    Quad first, second;
    read(vertices + 4 * static_cast<std::ptrdiff_t>(a[lane]), first);
    read(vertices + 4 * static_cast<std::ptrdiff_t>(b[lane]), second);
    out[lane] = __builtin_shufflevector(first, second, 0, 1, 2, 3, 4, 5, 6, 7);
  }
  transpose(out);
}

/// How far boxes overlap along an axis [m]; negative where they are apart.
ARGIL_INLINE void measure_overlap(const Lanes& a, const Lanes& b, const Lanes& c, double query_low,
                                  double query_high, Lanes& overlap) {
  Lanes low = a, high = a;
  take_smaller(b, low);
  take_smaller(c, low);
  take_larger(b, high);
  take_larger(c, high);
  take_smaller(high - query_low, overlap);
  take_smaller(query_high - low, overlap);
}

/// `p`, `q` and `r`: x, y and z of each corner and its distance from the ball.
ARGIL_INLINE void measure_faces(const BallPath& ball, const mesh::Box& query, const Lanes* p_at,
                                const Lanes* q_at, const Lanes* r_at, Measured& found) {
  const Lanes zero = {}, one = zero + 1.0;
  const LaneVec p = {p_at[0], p_at[1], p_at[2]}, q = {q_at[0], q_at[1], q_at[2]},
                r = {r_at[0], r_at[1], r_at[2]};
  constexpr double kThird = 1.0 / 3.0;
  const LaneVec centre = {kThird * p.x + kThird * q.x + kThird * r.x,
                          kThird * p.y + kThird * q.y + kThird * r.y,
                          kThird * p.z + kThird * q.z + kThird * r.z};
  Lanes squared_reach = zero, squares, length;
  for (const LaneVec* corner : {&p, &q, &r}) {
    LaneVec from_centre;
    subtract(*corner, centre, from_centre);
    square(from_centre, squares);
    take_larger(squares, squared_reach);
  }
  set_root(found.reach, squared_reach);
  LaneVec from_end, from_begin;
  Lanes at_end, at_begin;
  measure_length(centre, ball.end, from_end, at_end);
  measure_length(centre, ball.begin, from_begin, at_begin);
  const Lanes end_distance = at_end - ball.radius;
  const Lanes begin_distance = at_begin - ball.radius;
  found.distance = end_distance;
  take_smaller(begin_distance, found.distance);
  Lanes most = ball.widest_band * 2.0 * found.reach;
  take_larger(zero + ball.margin, most);
  most = found.reach + most;
  found.slack = most - found.distance;
  take_smaller(most - (end_distance - ball.way), found.slack);
  found.overlap = found.slack;
  measure_overlap(p.x, q.x, r.x, query.low(0), query.high(0), found.overlap);
  measure_overlap(p.y, q.y, r.y, query.low(1), query.high(1), found.overlap);
  measure_overlap(p.z, q.z, r.z, query.low(2), query.high(2), found.overlap);
  LaneVec a, b, c;
  subtract(q, p, a);
  subtract(r, p, b);
  subtract(b, a, c);
  const LaneVec normal = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  square(normal, squares);
  set_root(length, squares);
  found.area = 0.5 * length;
  const Lanes twice = 2.0 * found.area;
  Lanes longest;
  square(a, longest);
  square(b, squares);
  take_larger(squares, longest);
  square(c, squares);
  take_larger(squares, longest);
  set_root(length, longest);
  found.size = 0.5 * length;
  set_root(length, 4.0 / std::numbers::sqrt3 * found.area);
  take_larger(length, found.size);
  found.band = 0.5 * found.size * found.size / ball.radius;
  take_smaller(ball.widest_band * found.size, found.band);
  found.nearest = p_at[3];
  take_smaller(q_at[3], found.nearest);
  take_smaller(r_at[3], found.nearest);
  Lanes share = zero;
  for (const Lanes* corner : {&p_at[3], &q_at[3], &r_at[3]}) {
    Lanes part = 1.0 - *corner / found.band;
    clamp_to_share(part);
    share += part;
  }
  share /= 3.0;
  found.share = found.distance > -found.reach ? share : one;
  const LaneVec from_middle = {begin_distance < end_distance ? from_begin.x : from_end.x,
                               begin_distance < end_distance ? from_begin.y : from_end.y,
                               begin_distance < end_distance ? from_begin.z : from_end.z};
  length = begin_distance < end_distance ? at_begin : at_end;
  Lanes facing = -(from_middle.x / length * (normal.x / twice) + from_middle.y / length * (normal.y / twice) +
                   from_middle.z / length * (normal.z / twice)) /
                 ball.full_facing;
  clamp_to_share(facing);
  found.covered = found.area * found.share;
  found.facing = found.covered * facing;
}

}  // namespace

/// Places of all candidates' vertices, and how far each is from the tool along its way.
ARGIL_EVERY_PROCESSOR void PressureContact::measure_vertices(const Points& x) {
  const std::size_t count = m_vertices.number.size();
  m_vertices.placed.resize(4 * count);
  const Vec3 begin = m_places.front().position;
  const Vec3 end = m_places.back().position;
  for (std::size_t first = 0; first < count; first += kLanes) {
    const std::size_t last = std::min<std::size_t>(first + kLanes, count) - 1;
    double block[3][kLanes];
    for (std::size_t lane = 0; lane < static_cast<std::size_t>(kLanes); ++lane) {
      const double* from =
          x.data() + 3 * static_cast<std::ptrdiff_t>(m_vertices.number[std::min(first + lane, last)]);
      for (std::size_t axis = 0; axis < 3; ++axis) block[axis][lane] = from[axis];
    }
    LaneVec p, from_middle;
    read(block[0], p.x);
    read(block[1], p.y);
    read(block[2], p.z);
    Lanes at_end, at_begin;
    measure_length(p, end, from_middle, at_end);
    measure_length(p, begin, from_middle, at_begin);
    at_end -= m_tool.radius();
    at_begin -= m_tool.radius();
    take_smaller(at_begin, at_end);
    double distance[kLanes];
    write(at_end, distance);
    double* to = m_vertices.placed.data() + 4 * first;
    for (std::size_t lane = 0; lane <= last - first; ++lane) {
      for (std::size_t axis = 0; axis < 3; ++axis) to[4 * lane + axis] = block[axis][lane];
      to[4 * lane + 3] = distance[lane];
    }
  }
}

ARGIL_EVERY_PROCESSOR void PressureContact::find_ball_faces(const mesh::Box& query, const Points& x) {
  measure_vertices(x);
  const BallPath ball{m_places.front().position,
                      m_places.back().position,
                      m_tool.radius(),
                      m_places.size() > 1 ? m_way : 0.0,
                      m_margin,
                      kWidestBand,
                      kFull};
  for (std::size_t first = 0; first < m_reached.size(); first += kLanes) {
    const std::size_t count = std::min<std::size_t>(kLanes, m_reached.size() - first);
    int number[3][kLanes];
    for (std::size_t lane = 0; lane < static_cast<std::size_t>(kLanes); ++lane) {
      const auto candidate = static_cast<std::size_t>(m_reached[first + std::min(lane, count - 1)]);
      for (std::size_t k = 0; k < 3; ++k) number[k][lane] = m_candidate_corners[candidate][k];
    }
    Lanes two[8], third[8];
    read_corners(m_vertices.placed.data(), number[0], number[1], two);
    read_corners(m_vertices.placed.data(), number[2], number[2], third);
    Measured found;
    measure_faces(ball, query, two, two + 4, third, found);
    for (std::size_t i = 0; i < count; ++i) {
      const auto lane = static_cast<int>(i);
      const double area = found.area[lane], distance = found.distance[lane];
      if (!(found.slack[lane] > 0.0) || found.overlap[lane] < 0.0 || !(area > 0.0)) continue;
      const bool is_met = distance < found.reach[lane] + found.band[lane];
      const bool is_within = m_margin > 0.0 && distance < found.reach[lane] + m_margin;
      const bool may_touch = is_met && found.share[lane] == 0.0;
      const double covered = is_met ? found.covered[lane] : 0.0;
      if (!(covered > 0.0) && !may_touch && !is_within) continue;
      m_faces.push_back({m_candidates[static_cast<std::size_t>(m_reached[first + i])],
                         found.nearest[lane] <= kMargins * m_margin,
                         area,
                         found.size[lane],
                         {covered, is_met ? found.facing[lane] : 0.0, may_touch},
                         {}});
    }
  }
}

}  // namespace argil::contact
