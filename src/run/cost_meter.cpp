#include "run/cost_meter.h"

#include <linux/perf_event.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <ctime>

namespace argil::run {
namespace {

double find_cpu_seconds() {
  timespec time = {};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

CostMeter::CostMeter() {
  perf_event_attr wanted = {};
  wanted.size = sizeof wanted;
  wanted.type = PERF_TYPE_HARDWARE;
  wanted.config = PERF_COUNT_HW_INSTRUCTIONS;
  wanted.disabled = 1;
  wanted.exclude_kernel = 1;
  wanted.exclude_hv = 1;
  m_counter = static_cast<int>(syscall(SYS_perf_event_open, &wanted, 0, -1, -1, 0));
}

CostMeter::~CostMeter() {
  if (m_counter >= 0) close(m_counter);
}

void CostMeter::begin() {
  if (m_counter >= 0) ioctl(m_counter, PERF_EVENT_IOC_ENABLE, 0);
  m_begin = find_cpu_seconds();
}

void CostMeter::end() {
  m_seconds += find_cpu_seconds() - m_begin;
  if (m_counter >= 0) ioctl(m_counter, PERF_EVENT_IOC_DISABLE, 0);
}

std::optional<double> CostMeter::instructions() const {
  std::uint64_t count = 0;
  if (m_counter < 0 || read(m_counter, &count, sizeof count) != sizeof count || count == 0) return {};
  return static_cast<double>(count);
}

}  // namespace argil::run
