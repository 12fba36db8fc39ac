#pragma once

#include <memory>
#include <string>

#include "live/session.h"

namespace argil::live {

/// A file that another program may read while it grows (HDF5, single writer and multiple readers): forces
/// tick by tick, pictures of the surface at their own rate.
class Watch {
 public:
  /// What is drawn is the skin, or else the cage. Throws IoError.
  Watch(const std::string& file, const sim::Simulation& simulation);
  ~Watch();
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  void append(const HandTick& tick);
  /// Readers see it, and all ticks before it, when this returns.
  void append(const sim::Frame& frame);

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace argil::live
