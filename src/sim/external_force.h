#pragma once

#include <utility>
#include <vector>

#include "sim/contact_load.h"
#include "sim/nodal_force.h"

namespace argil::sim {

/// Forces on the nodes of the body, without gravity: loads that stay and contacts that come and go.
class ExternalForce {
 public:
  /// `loads`: 3×n [N], the same in every step.
  explicit ExternalForce(Points loads)
      : m_loads(std::move(loads)), m_total(m_loads), m_contacts(m_loads.cols()) {
    m_forced.reserve(static_cast<std::size_t>(m_loads.cols()));
    m_changed.reserve(static_cast<std::size_t>(2 * m_loads.cols()));
  }

  /// The contacts of another step.
  void set_contacts(const ContactLoad& load, const ContactSurface& surface) {
    m_contacts.clear();
    for (const SurfaceForce& force : load.forces) surface.add_force(force, m_contacts);
    for (const solid::PointStiffness& entry : load.stiffness)  // a step may make these press, too
      for (std::size_t i = 0; entry.is_near && i < entry.count(); ++i) m_contacts.list(entry.vertex[i]);
    m_contacts.sort();
    if (load.scale == 1.0) return;
    for (const int n : m_contacts.nodes()) m_contacts.at.col(n) *= load.scale;
  }
  /// That step is solved.
  void update_total() {
    m_changed = m_forced;
    m_changed.insert(m_changed.end(), m_contacts.nodes().begin(), m_contacts.nodes().end());
    for (const int n : m_changed) m_total.col(n) = m_contacts.at.col(n) + m_loads.col(n);
    m_forced = m_contacts.nodes();
  }

  const Points& loads() const { return m_loads; }
  const Points& total() const { return m_total; }  ///< of the last step that was solved, where it began
  /// Nodes where that may be another than in the one before.
  const std::vector<int>& changed() const { return m_changed; }
  /// Of the contacts; a step lets it fall to what acted.
  NodalForce& contacts() { return m_contacts; }
  const NodalForce& contacts() const { return m_contacts; }

 private:
  Points m_loads, m_total;
  NodalForce m_contacts;
  std::vector<int> m_forced;  // by contacts
  std::vector<int> m_changed;
};

}  // namespace argil::sim
