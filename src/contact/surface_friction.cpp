#include "contact/surface_friction.h"

#include <algorithm>
#include <utility>

#include "contact/nearest.h"

namespace argil::contact {
namespace {

/// Of a contact, the vertices that carry it.
template <class Use>
void each_vertex(const Contact& contact, Use use) {
  for (std::size_t k = 0; k < 3 && contact.vertex[k] >= 0; ++k) use(contact.vertex[k], contact.weight[k]);
}

Vec3 along_surface(const Vec3& v, const Vec3& normal) {
  return v - normal.dot(v) * normal;
}

}  // namespace

SurfaceFriction::SurfaceFriction(double friction, int num_vertices)
    : m_friction(friction), m_place(static_cast<std::size_t>(num_vertices), -1) {
  for (State* state : {&m_state, &m_committed, &m_next}) {
    state->vertex.reserve(m_place.size());
    state->stretch.reserve(m_place.size());
  }
  m_limits.reserve(m_place.size());
}

void SurfaceFriction::go_on_from(const SurfaceFriction& before, const Points& x_t0, const Points& x_t1,
                                 const Points& x) {
  m_state.vertex.clear();
  m_state.stretch.clear();
  for (std::size_t i = 0; i < before.m_state.vertex.size(); ++i) {
    const int v = before.m_state.vertex[i];
    const int nearest = find_nearest_point(x, x_t1.col(v));
    const auto at = std::lower_bound(m_state.vertex.begin(), m_state.vertex.end(), nearest);
    const bool is_there = at != m_state.vertex.end() && *at == nearest;  // by another, which is as good
    if (is_there) continue;
    const Vec3 stretch = before.m_state.stretch[i] - (x_t1.col(v) - x_t0.col(v));
    m_state.stretch.insert(m_state.stretch.begin() + (at - m_state.vertex.begin()), stretch);
    m_state.vertex.insert(at, nearest);
  }
  commit();
}

/// The vertices of these contacts; those that were in touch before have gone with the body since.
void SurfaceFriction::take_over(const Points& x_t0, const Points& x_t1, const Contacts& contacts) {
  m_next.vertex.clear();
  m_next.stretch.clear();
  for (std::size_t i = 0; i < m_state.vertex.size(); ++i)
    m_place[static_cast<std::size_t>(m_state.vertex[i])] = static_cast<int>(i);
  std::vector<int>& vertices = m_next.vertex;
  for (const std::vector<Contact>* list : {&contacts.contacts, &contacts.near})
    for (const Contact& c : *list) each_vertex(c, [&](int v, double) { vertices.push_back(v); });
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for (const int v : vertices) {
    const int before = m_place[static_cast<std::size_t>(v)];
    const Vec3 stretch =
        before < 0 ? Vec3::Zero()
                   : Vec3(m_state.stretch[static_cast<std::size_t>(before)] - (x_t1.col(v) - x_t0.col(v)));
    m_next.stretch.push_back(stretch);
  }
  for (const int v : m_state.vertex) m_place[static_cast<std::size_t>(v)] = -1;
  std::swap(m_state, m_next);
  for (std::size_t i = 0; i < m_state.vertex.size(); ++i)
    m_place[static_cast<std::size_t>(m_state.vertex[i])] = static_cast<int>(i);
}

Vec3 SurfaceFriction::find_stretch(const Contact& contact) const {
  Vec3 stretch = Vec3::Zero();
  each_vertex(contact, [&](int v, double weight) {
    stretch += weight * m_state.stretch[static_cast<std::size_t>(m_place[static_cast<std::size_t>(v)])];
  });
  return along_surface(stretch, contact.normal);
}

/// Where all of a vertex's points have slid, its stretch is that at which the last of them does: those that
/// are pressed less are limited by the step. A mean would let the hardest pressed ones stick while the tool
/// slides.
void SurfaceFriction::limit_stretch(const Contacts& contacts) {
  m_limits.assign(m_state.vertex.size(), {});
  for (const Contact& c : contacts.contacts)
    each_vertex(c, [&](int v, double weight) {
      if (!(weight > 0.0)) return;
      Limit& limit = m_limits[static_cast<std::size_t>(m_place[static_cast<std::size_t>(v)])];
      limit.stretch = std::max(limit.stretch, m_friction * c.begin_force / c.spring);
      limit.normal += weight * c.spring * c.normal;
    });
  for (std::size_t i = 0; i < m_limits.size(); ++i) {
    const Limit& limit = m_limits[i];
    Vec3& stretch = m_state.stretch[i];
    if (!limit.normal.isZero(0.0)) stretch = along_surface(stretch, limit.normal.normalized());
    if (const double length = stretch.norm(); length > limit.stretch) stretch *= limit.stretch / length;
  }
}

void SurfaceFriction::stretch(const Points& x_t0, const Points& x_t1, const Pose& pose_t0,
                              const Pose& pose_t1, Contacts& contacts) {
  take_over(x_t0, x_t1, contacts);
  limit_stretch(contacts);
  const Quat turn = pose_t1.orientation * pose_t0.orientation.conjugate();
  for (std::size_t i = 0; i < m_state.vertex.size(); ++i) {
    const Vec3 x = x_t1.col(m_state.vertex[i]);
    m_state.stretch[i] += pose_t1.position + turn * (x - pose_t0.position) - x;
  }
  for (std::vector<Contact>* list : {&contacts.contacts, &contacts.near})
    for (Contact& c : *list) {
      c.friction = m_friction;
      c.resistance = c.stiffness * find_stretch(c);
    }
  contacts.sum_reactions(pose_t1.position);
  for (const int v : m_state.vertex) m_place[static_cast<std::size_t>(v)] = -1;
}

void SurfaceFriction::serialize(Archive& archive) {
  archive.list("friction/vertex", m_state.vertex);
  archive.list("friction/stretch", m_state.stretch);
  if (archive.is_restoring()) commit();
}

}  // namespace argil::contact
