#include "base/thread_team.h"

#include <chrono>
#include <memory>
#include <string>
#include <system_error>

#include "base/error.h"

namespace argil {
namespace {

constexpr int kChunksPerThread = 4;
constexpr std::chrono::microseconds kLook(100);

void rest_a_moment() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

/// What `counter` holds when that is no longer `old`.
unsigned wait_for_change(const std::atomic<unsigned>& counter, unsigned old) {
  const auto begin = std::chrono::steady_clock::now();
  do {
    for (int i = 0; i < 32; ++i) {
      if (const unsigned now = counter.load(std::memory_order_acquire); now != old) return now;
      rest_a_moment();
    }
  } while (std::chrono::steady_clock::now() - begin < kLook);
  counter.wait(old, std::memory_order_acquire);
  return counter.load(std::memory_order_acquire);
}

}  // namespace

ThreadTeam::ThreadTeam(int threads) : m_takers(static_cast<std::size_t>(threads * kChunksPerThread)) {
  try {
    for (int index = 1; index < threads; ++index) m_threads.emplace_back([this, index] { help(index); });
  } catch (const std::system_error& error) {
    stop();
    throw IoError("--threads " + std::to_string(threads),
                  std::string("the system gives no more threads (") + error.what() + "); give fewer");
  }
}

ThreadTeam::~ThreadTeam() {
  stop();
}

void ThreadTeam::stop() {
  m_job.store(nullptr, std::memory_order_relaxed);
  m_number.fetch_add(1);
  m_number.notify_all();
  for (std::thread& thread : m_threads) thread.join();
}

ThreadTeam& ThreadTeam::of_this_thread(int threads) {
  thread_local std::unique_ptr<ThreadTeam> team;
  if (!team || team->size() != threads) {
    team.reset();
    team = std::make_unique<ThreadTeam>(threads);
  }
  return *team;
}

void ThreadTeam::run_job(Job job, void* body) {
  m_job.store(job, std::memory_order_relaxed);
  m_body.store(body, std::memory_order_relaxed);
  const unsigned number = m_number.fetch_add(1) + 1;
  m_number.notify_all();
  take_chunks(number, 0);
  const auto all = number * static_cast<unsigned>(num_chunks());
  unsigned done = m_num_done.load(std::memory_order_acquire);
  while (done != all) done = wait_for_change(m_num_done, done);
}

void ThreadTeam::help(int index) {
  for (unsigned last = 0;;) {
    last = wait_for_change(m_number, last);
    if (m_job.load(std::memory_order_relaxed) == nullptr) return;
    take_chunks(last, index);
  }
}

/// From those that are this thread's by rights, whose data its processor may still have, on to all others.
void ThreadTeam::take_chunks(unsigned number, int index) {
  const Job job = m_job.load(std::memory_order_relaxed);
  void* const body = m_body.load(std::memory_order_relaxed);
  const std::size_t first = static_cast<std::size_t>(index) * kChunksPerThread;
  for (std::size_t i = 0; i < m_takers.size(); ++i) {
    const std::size_t chunk = (first + i) % m_takers.size();
    unsigned before = number - 1;
    if (!m_takers[chunk].job.compare_exchange_strong(before, number, std::memory_order_acq_rel)) continue;
    job(body, static_cast<std::ptrdiff_t>(chunk));
    m_num_done.fetch_add(1);
    if (index != 0) m_num_done.notify_one();
  }
}

}  // namespace argil
