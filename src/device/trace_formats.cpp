// Files that are no text: what they are, and how to make a table of them.

#include <algorithm>
#include <cstdio>
#include <string_view>

#include "base/error.h"
#include "device/csv.h"
#include "device/trace_raw.h"

namespace argil::device::internal {
namespace {

struct Format {
  std::string_view magic;
  const char* name;
  std::string_view remedy;  // with a blank at its end, the file's name follows
};

constexpr Format kFormats[] = {
    {"\x1F\x8B", "packed by gzip", "unpack it: gunzip -k "},
    {"BZh", "packed by bzip2", "unpack it: bunzip2 -k "},
    {"\xFD"
     "7zXZ",
     "packed by xz", "unpack it: unxz -k "},
    {"\x28\xB5\x2F\xFD", "packed by zstd", "unpack it: unzstd "},
    {"7z\xBC\xAF", "packed by 7-Zip", "unpack it: 7z x "},
    {"MATLAB 5.0 MAT-file", "a MAT-file of MATLAB's", "write its table as text: writematrix(a, 'a.csv')"},
    {"PAR1", "a table of Apache Parquet's", "write it as text: pandas.read_parquet(file).to_csv('a.csv')"},
    {"#ROSBAG", "a bag of ROS's", "write the topic of poses as text: rostopic echo -b FILE -p TOPIC > a.csv"},
};

/// A folder of files, as NumPy's .npz and a workbook are.
[[noreturn]] void refuse_zip(const std::string& file, const std::string& bytes) {
  constexpr std::size_t kNameLength = 26;  // of the first entry [APPNOTE, 4.3.7]
  constexpr std::size_t kName = 30;
  std::string name;
  if (bytes.size() > kName)
    name = bytes.substr(kName, static_cast<unsigned char>(bytes[kNameLength]) +
                                   256U * static_cast<unsigned char>(bytes[kNameLength + 1]));
  if (std::any_of(name.begin(), name.end(), [](char c) { return c < ' ' || c > '~'; })) name.clear();
  if (name == "[Content_Types].xml" || name.starts_with("xl/"))
    throw InputError(file, "", "is a workbook, not text", "save the sheet as CSV");
  const bool is_numpy = name.ends_with(".npy");
  throw InputError(file, "",
                   std::string(is_numpy ? "holds several arrays of NumPy's" : "is packed by zip") +
                       (name.empty() ? "" : ", the first " + quote(name)),
                   "unpack it: unzip " + file + ", and give one of its files" + (is_numpy ? " (.npy)" : ""));
}

/// UTF-16 without a mark: of Latin letters, every second byte is zero.
void refuse_wide_letters(const std::string& file, const std::string& bytes) {
  constexpr std::size_t kLooked = 512;
  std::size_t zeros[2] = {0, 0};
  const std::size_t count = std::min(bytes.size(), kLooked) / 2;
  for (std::size_t i = 0; i < 2 * count; ++i)
    if (bytes[i] == '\0') ++zeros[i % 2];
  const auto are_wide = [&](int zero) { return 10 * zeros[zero] > 9 * count && zeros[1 - zero] == 0; };
  if (count < 2 || (!are_wide(0) && !are_wide(1))) return;
  const std::string encoding = are_wide(1) ? "UTF-16LE" : "UTF-16BE";
  throw InputError(file, "", "is text in " + encoding + " without a byte order mark",
                   "save it in UTF-8: iconv -f " + encoding + " -t UTF-8 " + file + " > utf8.csv");
}

bool is_control(char c) {
  return (c >= '\0' && c < ' ' && std::string_view("\t\n\r\f\v").find(c) == std::string_view::npos) ||
         c == '\x7F';
}

}  // namespace

void require_text(const std::string& file, const std::string& bytes) {
  if (bytes.starts_with("PK\x03\x04")) refuse_zip(file, bytes);
  for (const Format& format : kFormats)
    if (bytes.starts_with(format.magic))
      throw InputError(file, "", std::string("is ") + format.name + ", not text",
                       std::string(format.remedy) + (format.remedy.ends_with(' ') ? file : std::string()));
  refuse_wide_letters(file, bytes);
  const auto control = std::find_if(bytes.begin(), bytes.end(), is_control);
  if (control == bytes.end()) return;
  LineReader lines(bytes);
  std::string_view line;
  while (lines.next(line) &&
         bytes.begin() + static_cast<std::ptrdiff_t>(lines.line_offset() + line.size()) <= control) {
  }
  char byte[8];
  std::snprintf(byte, sizeof byte, "0x%02X", static_cast<unsigned>(static_cast<unsigned char>(*control)));
  throw InputError(file, "line " + std::to_string(lines.line_number()),
                   std::string("holds the byte ") + byte + ", so it is no text",
                   "give text (CSV), NPY or HDF5; remove what a break of the recording left there");
}

}  // namespace argil::device::internal
