#include "sim/touched_surface.h"

#include <algorithm>

namespace argil::sim {

TouchedSurface::TouchedSurface(const ContactSurface& surface) : m_surface(surface) {
  m_moved.reserve(static_cast<std::size_t>(surface.num_vertices()));
  m_before.moved.reserve(m_moved.capacity());
  m_before.x_t0.reserve(m_moved.capacity());
}

void TouchedSurface::place(const Points& x) {
  m_x_t0 = x;
  m_x_t1 = x;
  m_is_t1_known = true;
  forget_motion();
  commit();
}

void TouchedSurface::receive(StepResult& result) {
  if (!result.has_moved) return;
  if (result.is_whole) {
    m_x_t1.swap(result.surface_x);
    m_has_all_moved = true;
  } else {
    if (!m_is_t1_known && !m_has_moved) m_x_t1 = m_x_t0;
    m_is_t1_known = true;
    for (std::size_t i = 0; i < result.moved.size(); ++i)
      m_x_t1.col(result.moved[i]) = result.surface_x.col(static_cast<Eigen::Index>(i));
    m_moved.insert(m_moved.end(), result.moved.begin(), result.moved.end());
  }
  m_has_moved = true;
}

void TouchedSurface::move_to(const Points& x) {
  m_surface.find_positions(x, m_x_t1);
  m_has_all_moved = true;
  m_has_moved = true;
}

std::optional<double> TouchedSurface::find_motion() const {
  if (!m_has_moved) return 0.0;
  if (m_has_all_moved) return {};
  double motion = 0.0;
  for (const int v : m_moved)
    motion = std::max(motion, (m_x_t1.col(v) - m_x_t0.col(v)).cwiseAbs().maxCoeff());
  return motion;
}

void TouchedSurface::advance() {
  m_before.has_advanced = true;
  m_before.is_swapped = m_has_all_moved;
  m_before.x_t0.clear();
  if (m_has_all_moved) {
    m_x_t0.swap(m_x_t1);
    m_is_t1_known = false;
  } else {
    for (const int v : m_moved) m_before.x_t0.push_back(m_x_t0.col(v));
    for (const int v : m_moved) m_x_t0.col(v) = m_x_t1.col(v);
  }
  m_before.moved.swap(m_moved);
  forget_motion();
}

void TouchedSurface::forget_motion() {
  m_has_all_moved = false;
  m_moved.clear();
  m_has_moved = false;
}

void TouchedSurface::commit() {
  m_before.has_advanced = false;
  m_before.has_moved = m_has_moved;
  m_before.has_all_moved = m_has_all_moved;
  m_before.is_t1_known = m_is_t1_known;
}

void TouchedSurface::roll_back(const Points* x) {
  if (m_before.has_advanced) {
    m_moved.swap(m_before.moved);
    if (m_before.is_swapped) m_x_t0.swap(m_x_t1);
    for (std::size_t i = m_before.x_t0.size(); i-- > 0;) m_x_t0.col(m_moved[i]) = m_before.x_t0[i];
  }
  m_has_moved = m_before.has_moved;
  m_has_all_moved = m_before.has_all_moved;
  m_is_t1_known = m_before.is_t1_known;
  m_before.has_advanced = false;
  if (x && m_has_moved) move_to(*x);
}

void TouchedSurface::serialize(Archive& archive) {
  archive.array("contact/x", m_x_t0);
  archive.number("contact/has_moved", m_has_moved);
}

void TouchedSurface::restore(const Points& x) {
  const bool has_moved = m_has_moved;
  forget_motion();
  m_is_t1_known = false;
  if (has_moved) move_to(x);
  commit();
}

}  // namespace argil::sim
