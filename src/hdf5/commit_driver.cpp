// A file driver for the library under which a file changes by whole flushes. What lies beyond the file's end
// is written at once, for nothing refers to it yet; what changes within it is held back in pages and put in
// at the flush, after a journal of them. A process killed at any moment leaves the file of its last flush, or
// that and a whole journal (recover()).

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstring>
#include <memory>
#include <string>
#include <utility>

#include "hdf5/internal.h"
#include "hdf5/journal.h"

namespace argil::hdf5::internal {
namespace {

struct CommitFile {
  H5FD_t base = {};  // first: the library sees nothing else
  int descriptor = -1;
  std::string journal_name;
  int journal = -1;
  dev_t device = 0;
  ino_t inode = 0;
  haddr_t end_of_space = 0;    // what the library has allotted
  haddr_t size = 0;            // of the file as the library sees it
  std::uint64_t held_end = 0;  // pages before this one are changed by a flush alone
  Pages pages;
  bool has_failed = false;  // a write did: the file stays as of the last flush
  int reason = 0;           // errno of it; the library hides some failures, so the next flush says it again
  bool is_torn = false;     // and that write was of the pages: the journal is needed
};

/// What the library hands on to open_file.
struct Settings {
  char journal[PATH_MAX] = {};
};

CommitFile& self(H5FD_t* file) {
  return *reinterpret_cast<CommitFile*>(file);
}
const CommitFile& self(const H5FD_t* file) {
  return *reinterpret_cast<const CommitFile*>(file);
}

/// Puts the system's reason on the library's stack, in the words of its own driver.
herr_t fail(const char* action) {
  const int number = errno;
  H5Epush2(H5E_DEFAULT, __FILE__, "argil", __LINE__, H5E_ERR_CLS, H5E_FILE, H5E_CANTINIT,
           "%s failed, errno = %d, error message = '%s'", action, number, std::strerror(number));
  return -1;
}

std::uint64_t count_pages(haddr_t bytes) {
  return (bytes + kPageBytes - 1) / kPageBytes;
}

/// Reads what the file on disk has; zeros beyond its end.
bool read_disk(int descriptor, char* data, std::size_t size, std::uint64_t offset) {
  while (size > 0) {
    const ssize_t got = pread(descriptor, data, size, static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return false;
    if (got == 0) {
      std::memset(data, 0, size);
      return true;
    }
    data += got;
    size -= static_cast<std::size_t>(got);
    offset += static_cast<std::uint64_t>(got);
  }
  return true;
}

/// Calls `piece(page, place in it, bytes, bytes before it)` for every page of a range.
template <class Piece>
bool for_pages(haddr_t begin, std::size_t size, Piece piece) {
  for (std::size_t done = 0; done < size;) {
    const std::uint64_t page = (begin + done) / kPageBytes;
    const std::size_t place = (begin + done) % kPageBytes;
    const std::size_t bytes = std::min(kPageBytes - place, size - done);
    if (!piece(page, place, bytes, done)) return false;
    done += bytes;
  }
  return true;
}

H5FD_t* open_file(const char* name, unsigned flags, hid_t access, haddr_t) {
  int mode = (flags & H5F_ACC_RDWR) != 0 ? O_RDWR : O_RDONLY;
  if ((flags & H5F_ACC_CREAT) != 0) mode |= O_CREAT;
  if ((flags & H5F_ACC_EXCL) != 0) mode |= O_EXCL;
  if ((flags & H5F_ACC_TRUNC) != 0) mode |= O_TRUNC;
  const int descriptor = open(name, mode | O_CLOEXEC, 0666);
  struct stat status {};
  if (descriptor < 0 || fstat(descriptor, &status) != 0) {
    fail("open");
    if (descriptor >= 0) ::close(descriptor);
    return nullptr;
  }
  auto made = std::make_unique<CommitFile>();
  made->journal_name = static_cast<const Settings*>(H5Pget_driver_info(access))->journal;
  made->descriptor = descriptor;
  made->device = status.st_dev;
  made->inode = status.st_ino;
  made->size = static_cast<haddr_t>(status.st_size);
  made->held_end = count_pages(made->size);
  return &made.release()->base;
}

herr_t close_file(H5FD_t* file) {
  const std::unique_ptr<CommitFile> f(&self(file));
  if (f->has_failed && !f->is_torn) {  // what was written beyond the end of the last flush is of no use
    const int given_back = ftruncate(f->descriptor, static_cast<off_t>(f->held_end * kPageBytes));
    static_cast<void>(given_back);
  }
  if (f->journal >= 0) {
    if (!f->is_torn) unlink(f->journal_name.c_str());
    ::close(f->journal);
  }
  return ::close(f->descriptor) == 0 ? 0 : fail("close");
}

int compare(const H5FD_t* a, const H5FD_t* b) {
  const auto key = [](const CommitFile& f) { return std::pair(f.device, f.inode); };
  return key(self(a)) < key(self(b)) ? -1 : key(self(b)) < key(self(a)) ? 1 : 0;
}

herr_t query(const H5FD_t*, unsigned long* flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
  return 0;
}

haddr_t end_of_space(const H5FD_t* file, H5FD_mem_t) {
  return self(file).end_of_space;
}

herr_t set_end_of_space(H5FD_t* file, H5FD_mem_t, haddr_t end) {
  self(file).end_of_space = end;
  return 0;
}

haddr_t end_of_file(const H5FD_t* file, H5FD_mem_t) {
  return self(file).size;
}

herr_t get_descriptor(H5FD_t* file, hid_t, void** descriptor) {
  *descriptor = &self(file).descriptor;
  return 0;
}

herr_t read_bytes(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t begin, std::size_t size, void* data) {
  const CommitFile& f = self(file);
  auto* out = static_cast<char*>(data);
  if (f.pages.empty()) return read_disk(f.descriptor, out, size, begin) ? 0 : fail("read");
  const bool ok =
      for_pages(begin, size, [&](std::uint64_t page, std::size_t place, std::size_t bytes, std::size_t done) {
        const auto held = f.pages.find(page);
        if (held == f.pages.end()) return read_disk(f.descriptor, out + done, bytes, begin + done);
        std::memcpy(out + done, held->second.data() + place, bytes);
        return true;
      });
  return ok ? 0 : fail("read");
}

herr_t give_up(CommitFile& f) {
  f.has_failed = true;
  f.reason = errno;
  return fail("write");
}

herr_t write_bytes(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t begin, std::size_t size, const void* data) {
  CommitFile& f = self(file);
  if (f.has_failed) return 0;  // was said already; closing goes on
  const auto* from = static_cast<const char*>(data);
  const auto hold = [&](std::uint64_t page, std::size_t place, std::size_t bytes, std::size_t done) {
    std::vector<char>& held = f.pages[page];
    if (held.empty()) {
      held.resize(kPageBytes);
      if (!read_disk(f.descriptor, held.data(), kPageBytes, page * kPageBytes)) return false;
    }
    std::memcpy(held.data() + place, from + done, bytes);
    return true;
  };
  const haddr_t free_begin =
      std::max<haddr_t>(begin, f.held_end * kPageBytes);  // from here on written at once
  const std::size_t num_held =
      free_begin >= begin + size ? size : static_cast<std::size_t>(free_begin - begin);
  const bool ok = for_pages(begin, num_held, hold) &&
                  write_all(f.descriptor, from + num_held, size - num_held, begin + num_held);
  if (!ok) return give_up(f);
  f.size = std::max(f.size, begin + size);
  return 0;
}

/// The file's size follows what is allotted; a smaller one waits for the flush.
herr_t truncate(H5FD_t* file, hid_t, hbool_t) {
  CommitFile& f = self(file);
  if (f.has_failed || f.size == f.end_of_space) return 0;
  if (f.end_of_space > f.held_end * kPageBytes &&
      ftruncate(f.descriptor, static_cast<off_t>(f.end_of_space)) != 0) {
    return give_up(f);
  }
  f.size = f.end_of_space;
  return 0;
}

bool commit(CommitFile& f) {
  if (f.journal < 0) f.journal = open(f.journal_name.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (f.journal < 0 || !write_journal(f.journal, f.pages, f.size)) return false;
  f.is_torn = !apply_pages(f.descriptor, f.pages, f.size);
  return !f.is_torn && ftruncate(f.journal, 0) == 0;
}

herr_t flush(H5FD_t* file, hid_t, hbool_t) {
  CommitFile& f = self(file);
  if (f.has_failed) {
    errno = std::exchange(f.reason, 0);
    return errno != 0 ? fail("write") : 0;
  }
  // Without pages nothing refers to what was added, but in a new file.
  if (f.pages.empty() && f.held_end > 0) return 0;
  if (!f.pages.empty() && !commit(f)) return give_up(f);
  f.pages.clear();
  f.held_end = count_pages(f.size);
  return 0;
}

herr_t lock(H5FD_t* file, hbool_t exclusive) {
  if (flock(self(file).descriptor, (exclusive ? LOCK_EX : LOCK_SH) | LOCK_NB) == 0 || errno == ENOSYS)
    return 0;
  return fail("lock");
}

herr_t unlock(H5FD_t* file) {
  return flock(self(file).descriptor, LOCK_UN) == 0 || errno == ENOSYS ? 0 : fail("unlock");
}

H5FD_class_t make_class() {
  H5FD_class_t made = {};
#if H5_VERSION_GE(1, 13, 2)
  made.version = H5FD_CLASS_VERSION;
  made.value = static_cast<H5FD_class_value_t>(0x1a7);
#endif
  made.name = "argil_commit";
  made.maxaddr = (haddr_t{1} << 62) - 1;
  made.fc_degree = H5F_CLOSE_WEAK;
  made.fapl_size = sizeof(Settings);
  made.open = open_file;
  made.close = close_file;
  made.cmp = compare;
  made.query = query;
  made.get_eoa = end_of_space;
  made.set_eoa = set_end_of_space;
  made.get_eof = end_of_file;
  made.get_handle = get_descriptor;
  made.read = read_bytes;
  made.write = write_bytes;
  made.flush = flush;
  made.truncate = truncate;
  made.lock = lock;
  made.unlock = unlock;
  constexpr H5FD_mem_t kDichotomy[] = H5FD_FLMAP_DICHOTOMY;
  std::copy(std::begin(kDichotomy), std::end(kDichotomy), made.fl_map);
  return made;
}

}  // namespace

bool use_commit_driver(hid_t access, const std::string& file) {
  static const H5FD_class_t driver = make_class();
  static const hid_t id = H5FDregister(&driver);
  Settings settings;
  const std::string journal = name_journal(file);
  if (journal.size() >= sizeof settings.journal) return false;
  std::copy(journal.begin(), journal.end(), settings.journal);
  return id >= 0 && H5Pset_driver(access, id, &settings) >= 0;
}

}  // namespace argil::hdf5::internal
