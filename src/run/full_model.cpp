#include "run/full_model.h"

#include <algorithm>
#include <utility>

namespace argil::run {
namespace {

const std::string kPrefix = "full/";  // of its names in a checkpoint

sim::Params make_full(sim::Params params) {
  params.fidelity.mode = sim::FidelityMode::full;
  params.extent = sim::Extent::whole;
  return params;
}

}  // namespace

FullModel::FullModel(const sim::Body& body, const mesh::TriangleMesh& tool, sim::Params params,
                     const device::DeviceSample& start)
    : m_simulation(body, tool, make_full(std::move(params)), start) {}

void FullModel::compare(const sim::Simulation& simulation) {
  const Vec3 difference = simulation.hand_state().hand_force - m_simulation.hand_state().hand_force;
  m_error = std::max(m_error, difference.norm());
}

double FullModel::take_error() {
  return std::exchange(m_error, 0.0);
}

void FullModel::save(Snapshot& snapshot) {
  for (auto& [name, array] : m_simulation.take_snapshot()) snapshot[kPrefix + name] = std::move(array);
}

void FullModel::restore(const Snapshot& snapshot, const std::string& origin) {
  Snapshot own;
  for (const auto& [name, array] : snapshot)
    if (name.starts_with(kPrefix)) own[name.substr(kPrefix.size())] = array;
  m_simulation.restore(own, origin);
}

}  // namespace argil::run
