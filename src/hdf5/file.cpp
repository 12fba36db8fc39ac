#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "base/error.h"
#include "hdf5/internal.h"
#include "hdf5/journal.h"

namespace argil::hdf5 {

using namespace internal;  // NOLINT: the folder's own helpers

namespace {

Handle file_handle(hid_t id) {
  return {id, [](Id i) -> int { return H5Fclose(i); }};
}

std::string find_real_name(const std::string& name) {
  std::error_code ignored;  // a name that cannot be resolved fails later, with the system's reason
  const std::filesystem::path target = std::filesystem::weakly_canonical(name, ignored);
  return ignored ? name : target.string();
}

/// The library keeps what it knows of a file's structure, by default up to 32 MB, and of each open series the
/// last chunks, by default 1 MB of them.
bool limit_caches(hid_t access) {
  constexpr std::size_t kStructure = std::size_t{1} << 20;  // as stored; some six times as much unpacked
  constexpr std::size_t kChunks = std::size_t{128} << 10;   // some whole chunks of a series
  constexpr std::size_t kSlots = 521;                       // the library's own number
  H5AC_cache_config_t config = {};
  config.version = H5AC__CURR_CACHE_CONFIG_VERSION;
  if (H5Pget_mdc_config(access, &config) < 0) return false;
  config.max_size = config.initial_size = kStructure;
  config.min_size = kStructure / 2;
  return H5Pset_mdc_config(access, &config) >= 0 && H5Pset_cache(access, 0, kSlots, kChunks, 0.75) >= 0;
}

// `journalled`: real name of a file that is to be written; empty: it is read.
Handle access_properties(const std::string& name, const std::string& journalled) {
  Handle access = property(H5Pcreate(H5P_FILE_ACCESS));
  // Earliest formats: superblock 0 has no "open for writing" mark, so a killed run's file opens without
  // repair.
  bool ok = H5Pset_libver_bounds(access.id(), H5F_LIBVER_EARLIEST, H5F_LIBVER_V110) >= 0;
#if H5_VERSION_GE(1, 10, 7)
  ok = ok &&
       H5Pset_file_locking(access.id(), true, true) >= 0;  // true, true: go on where the system has no locks
#endif
  ok = ok && limit_caches(access.id());
  if (!journalled.empty()) ok = ok && use_commit_driver(access.id(), journalled);
  if (!ok) throw IoError(name, "cannot set up HDF5: " + take_reason());
  return access;
}

bool is_same_file(int descriptor, const std::string& name) {
  struct stat opened {};
  struct stat named {};
  return fstat(descriptor, &opened) == 0 && stat(name.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

// H5Fcreate truncates before it takes its lock, which would destroy the file of a running writer. So the old
// file is locked and removed first, and the new one is made with O_EXCL, which only one of two competitors
// can.
void remove_unless_busy(const std::string& name) {
  const int descriptor = open(name.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor < 0) {
    if (errno == ENOENT) return;
    throw IoError(name, std::string("cannot be replaced: ") + std::strerror(errno));
  }
  struct stat status {};
  bool is_busy = false;
  std::string problem;
  if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode))
    problem = "is not a regular file";
  else if (flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    is_busy = true;
  else if (is_same_file(descriptor, name) && unlink(name.c_str()) != 0)
    problem = std::string("cannot be replaced: ") + std::strerror(errno);
  else
    unlink(name_journal(name).c_str());
  ::close(descriptor);
  if (is_busy) throw BusyError(name);
  if (!problem.empty()) throw IoError(name, problem);
}

[[noreturn]] void refuse(const std::string& name, const std::string& action) {
  const std::string reason = take_reason();
  if (reason == std::strerror(EWOULDBLOCK)) throw BusyError(name);
  if (reason.find("signature not found") != std::string::npos)
    throw IoError(name, "is no HDF5 file, as results of argil run are");
  throw IoError(name, action + ": " + reason);
}

}  // namespace

BusyError::BusyError(const std::string& file)
    : IoError(file,
              "another process has this file open (a run that writes it, or a reader); wait for it or choose "
              "another name") {}

File File::create(const std::string& name) {
  start_library();
  const std::string real = find_real_name(name);
  const std::string part = real + ".part";
  remove_unless_busy(real);
  remove_unless_busy(part);
  const Handle access = access_properties(name, real);
  const Handle creation = property(H5Pcreate(H5P_FILE_CREATE));
  H5Pset_obj_track_times(creation.id(), false);
  // Most compressed arrays are one chunk or a few: the library's 32 gives the index of each 2 kB.
  constexpr unsigned kHalfIndex = 4;
  H5Pset_istore_k(creation.id(), kHalfIndex);
  Handle made = file_handle(H5Fcreate(part.c_str(), H5F_ACC_EXCL, creation.id(), access.id()));
  if (made.id() < 0) refuse(name, "cannot be written");
  File file(std::move(made), name);
  file.m_renamed_to = real;
  return file;
}

File File::create_shared(const std::string& name) {
  start_library();
  remove_unless_busy(find_real_name(name));
  const Handle access = property(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_libver_bounds(access.id(), H5F_LIBVER_V110, H5F_LIBVER_V110);
  const Handle creation = property(H5Pcreate(H5P_FILE_CREATE));
  H5Pset_obj_track_times(creation.id(), false);
  Handle made = file_handle(H5Fcreate(name.c_str(), H5F_ACC_EXCL, creation.id(), access.id()));
  if (made.id() < 0) refuse(name, "cannot be written");
  return {std::move(made), name};
}

void File::let_others_read() {
  if (H5Fstart_swmr_write(m_handle.id()) < 0) refuse(m_name, "cannot be shared");
}

File File::open_for_reading(const std::string& name) {
  start_library();
  recover(name);
  const Handle access = access_properties(name, "");
  Handle opened = file_handle(H5Fopen(name.c_str(), H5F_ACC_RDONLY, access.id()));
  if (opened.id() < 0) refuse(name, "cannot be read");
  return {std::move(opened), name};
}

File File::open_for_writing(const std::string& name) {
  start_library();
  recover(name);
  const Handle access = access_properties(name, find_real_name(name));
  Handle opened = file_handle(H5Fopen(name.c_str(), H5F_ACC_RDWR, access.id()));
  if (opened.id() < 0) refuse(name, "cannot be written");
  return {std::move(opened), name};
}

Group File::root() const {
  Handle opened = group(H5Gopen2(m_handle.id(), "/", H5P_DEFAULT));
  if (opened.id() < 0) throw IoError(m_name, "cannot open /: " + take_reason());
  return {std::move(opened), m_name, "/"};
}

void File::flush() {
  if (H5Fflush(m_handle.id(), H5F_SCOPE_LOCAL) < 0)
    throw IoError(m_name, "cannot be written: " + take_reason());
  if (m_renamed_to.empty()) return;
  if (std::rename((m_renamed_to + ".part").c_str(), m_renamed_to.c_str()) != 0)
    throw IoError(m_name, std::string("cannot be given its name: ") + std::strerror(errno));
  m_renamed_to.clear();
}

void File::sync() {
  flush();
  void* descriptor = nullptr;
  if (H5Fget_vfd_handle(m_handle.id(), H5P_DEFAULT, &descriptor) < 0)
    throw IoError(m_name, "cannot be synced: " + take_reason());
  // EINVAL: a file system that has nothing to wait for.
  if (fdatasync(*static_cast<int*>(descriptor)) != 0 && errno != EINVAL)
    throw IoError(m_name, std::string("cannot be synced: ") + std::strerror(errno));
}

File::~File() {
  if (m_handle.id() < 0 || m_renamed_to.empty()) return;
  try {
    flush();
  } catch (const IoError&) {  // already on the way out
  }
}

void File::close() {
  if (!m_renamed_to.empty()) flush();
  if (m_handle.reset() < 0) throw IoError(m_name, "cannot be closed: " + take_reason());
}

bool is_hdf5(const std::string& file) {
  start_library();
  const bool yes = H5Fis_hdf5(file.c_str()) > 0;
  H5Eclear2(H5E_DEFAULT);
  return yes;
}

}  // namespace argil::hdf5
