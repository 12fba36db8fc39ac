#include "study/point_lock.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.h"

namespace argil::study {

PointLock::PointLock(const std::string& folder, std::int64_t index) {
  const std::string file = folder + "/lock";
  m_descriptor = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (m_descriptor < 0) throw IoError(file, std::string("cannot be opened: ") + std::strerror(errno));
  struct flock range {};
  range.l_type = F_WRLCK;
  range.l_whence = SEEK_SET;
  range.l_start = index;
  range.l_len = 1;
  if (fcntl(m_descriptor, F_OFD_SETLK, &range) == 0 || errno == ENOSYS) return;
  const int reason = errno;
  ::close(m_descriptor);
  if (reason == EAGAIN || reason == EACCES)
    throw IoError(folder,
                  "point " + std::to_string(index) + " is being computed by another process; wait for it");
  throw IoError(file, std::string("cannot be locked: ") + std::strerror(reason));
}

PointLock::~PointLock() {
  ::close(m_descriptor);
}

}  // namespace argil::study
