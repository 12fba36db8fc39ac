#pragma once

#include <string>

#include "sim/simulation.h"

namespace argil::run {

/// The full model of a run that leaves things out, fed the same motion: what tells the true error of the
/// force at the hand. It takes the hand's motion as it comes, also of a simulated hand that feels the other's
/// force.
class FullModel {
 public:
  FullModel(const sim::Body& body, const mesh::TriangleMesh& tool, sim::Params params,
            const device::DeviceSample& start);

  StepStatus tick(const device::DeviceSample& sample) { return m_simulation.tick(sample); }
  /// After a tick of both: how far the force of `simulation` is off.
  void compare(const sim::Simulation& simulation);
  /// The largest error [N] since the last call.
  double take_error();

  /// Adds its state to a checkpoint, or takes it back.
  void save(Snapshot& snapshot);
  void restore(const Snapshot& snapshot, const std::string& origin);

 private:
  sim::Simulation m_simulation;
  double m_error = 0.0;
};

}  // namespace argil::run
