#pragma once

#include <cstdint>
#include <optional>

namespace argil::run {

/// What stretches of a program cost: CPU time of all threads, and instructions in user mode of this one where
/// the machine counts them.
class CostMeter {
 public:
  CostMeter();
  ~CostMeter();
  CostMeter(const CostMeter&) = delete;
  CostMeter& operator=(const CostMeter&) = delete;

  void begin();
  void end();
  double cpu_seconds() const { return m_seconds; }
  std::optional<double> instructions() const;

 private:
  int m_counter = -1;  // of the kernel's; −1: none
  double m_seconds = 0.0;
  double m_begin = 0.0;
};

}  // namespace argil::run
