#pragma once

#include <cstdint>
#include <string>

namespace argil::study {

/// A point of a sweep that this process alone computes, as long as the object lives: byte `index` of
/// FOLDER/lock, which the system frees however the process ends. Throws IoError when another process has it.
/// On a file system without locks every process gets it.
class PointLock {
 public:
  PointLock(const std::string& folder, std::int64_t index);
  ~PointLock();
  PointLock(const PointLock&) = delete;
  PointLock& operator=(const PointLock&) = delete;

 private:
  int m_descriptor;
};

}  // namespace argil::study
