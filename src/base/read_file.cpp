#include "base/read_file.h"

#include <sys/stat.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "base/error.h"

namespace argil {

// C streams, because errno after theirs says why. One byte more than the file has is asked for, so that its
// end is seen at once; a pipe, whose size is 0, is read in blocks.
std::string read_file(const std::string& file) {
  const auto fail = [&](int code) {
    throw IoError(file, std::string("cannot be read: ") + std::strerror(code != 0 ? code : EIO));
  };
  errno = 0;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), std::fclose);
  if (!stream) fail(errno);
  std::setbuf(stream.get(), nullptr);
  struct stat status {};
  if (fstat(fileno(stream.get()), &status) != 0) fail(errno);
  if (S_ISDIR(status.st_mode)) fail(EISDIR);
  constexpr std::size_t kBlock = std::size_t{1} << 20;
  std::size_t wanted = status.st_size > 0 ? static_cast<std::size_t>(status.st_size) + 1 : kBlock;
  std::string bytes;
  while (std::feof(stream.get()) == 0) {
    const std::size_t used = bytes.size();
    bytes.resize(used + wanted);
    bytes.resize(used + std::fread(bytes.data() + used, 1, wanted, stream.get()));
    if (std::ferror(stream.get()) != 0) fail(errno);
    wanted = kBlock;
  }
  return bytes;
}

}  // namespace argil
