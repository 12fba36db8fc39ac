#pragma once

#include <string>
#include <utility>
#include <vector>

#include "live/distribution.h"
#include "live/session.h"

namespace argil::live {

/// How well a session kept its times, in figures.
class Figures {
 public:
  void add(const HandTick& tick);
  void add(const BodyStep& step);
  /// From the hand's giving of a step to its picture, in the file that others watch [s].
  void add_picture(double delay) { m_picture_delay.add(delay); }

  /// As /timing keeps them; seconds but where a name begins with num_.
  std::vector<std::pair<std::string, double>> list() const;
  /// A few lines for a person.
  std::string print() const;
  /// One line while the session runs, for so many seconds now; `water_capacity` [kg] of the whole body.
  std::string print_now(double seconds, double water_capacity) const;

 private:
  Distribution m_wake_late{1e-6}, m_work{1e-6}, m_step_work{1e-5}, m_picture_delay{1e-4};  // [s]
  Distribution m_sample_age{1e-4};                                                         // [s]
  Distribution m_force_age{1.0}, m_surface_age{1.0};                                       // [ticks]
  std::int64_t m_missed = 0;                                                               // periods
  std::int64_t m_late_steps = 0, m_late_ticks = 0;
  std::int64_t m_limited = 0;   // steps whose motion was limited
  std::int64_t m_repeated = 0;  // ticks without a new sample
  std::int64_t m_gated = 0;     // ticks in which the gate had to do something
  Tick m_seen_step = 0, m_seen_begun_at = 0, m_begun_at = 0;
  HandTick m_last;
  double m_water = 0.0;  // [kg]
};

}  // namespace argil::live
