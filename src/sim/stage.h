#pragma once

namespace argil::sim {

/// What is timed of a tick. Several functions of step.cpp may share one, and cheap ones have none: `solve`
/// has also deflection and clay kernel, `kinematics` the energy check, `plasticity` the surface.
enum class Stage { contact, water, assemble, solve, kinematics, plasticity, count };

/// Watches the stages from outside, for instance with a clock; the simulation itself never looks at one.
class StageObserver {
 public:
  virtual ~StageObserver() = default;
  virtual void begin(Stage stage) = 0;
  virtual void end(Stage stage) = 0;
};

/// Tells `observer` (may be null) that a stage lasts as long as this object.
class StageScope {
 public:
  StageScope(StageObserver* observer, Stage stage) : m_observer(observer), m_stage(stage) {
    if (m_observer) m_observer->begin(m_stage);
  }
  ~StageScope() {
    if (m_observer) m_observer->end(m_stage);
  }
  StageScope(const StageScope&) = delete;
  StageScope& operator=(const StageScope&) = delete;

 private:
  StageObserver* m_observer;
  Stage m_stage;
};

}  // namespace argil::sim
