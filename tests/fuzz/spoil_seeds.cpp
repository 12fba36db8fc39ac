// The fuzzers without libFuzzer: spoil_seeds FOLDER gives the reader that ARGIL_FUZZ_READER names every file
// of FOLDER as it is, cut short, and changed at places that are the same every time. Ends as a fuzzer would
// at what a reader may not do.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "base/read_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed);

namespace {

constexpr std::size_t kLargestInput = 4096;  // as scripts/fuzz gives
constexpr unsigned kCuts = 24;
constexpr unsigned kChanges = 200;

void give(const std::vector<std::uint8_t>& input, std::size_t size) {
  LLVMFuzzerTestOneInput(input.data(), size);
}

void spoil(const std::string& file) {
  const std::string bytes = argil::read_file(file);
  const std::size_t size = std::min(bytes.size(), kLargestInput);
  std::vector<std::uint8_t> input(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
  for (unsigned cut = 1; cut <= kCuts; ++cut) give(input, size * cut / kCuts);
  input.resize(kLargestInput);
  std::size_t changed_size = size;
  for (unsigned change = 0; change < kChanges; ++change) {
    if (change % 8 == 0) {  // some changes one after another, then from the start again
      std::copy_n(bytes.begin(), size, input.begin());
      changed_size = size;
    }
    changed_size = LLVMFuzzerCustomMutator(input.data(), changed_size, kLargestInput, change);
    give(input, changed_size);
  }
}

}  // namespace

/// What libFuzzer has: here one byte put in, left out or changed.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size) {
  static std::minstd_rand random(1);
  const std::size_t place = random() % std::max<std::size_t>(size, 1);
  const auto byte = static_cast<std::uint8_t>(random() >> 8U);
  const auto kind = random() % 4;
  if (kind == 0 && size < max_size) {
    std::copy_backward(data + place, data + size, data + size + 1);
    data[place] = byte;
    return size + 1;
  }
  if (kind == 1 && size > 1) {
    std::copy(data + place + 1, data + size, data + place);
    return size - 1;
  }
  if (size > 0) data[place] = byte;
  return size;
}

int main(int count, char** arguments) {
  if (count != 2) {
    std::fputs("usage: ARGIL_FUZZ_READER=NAME spoil_seeds FOLDER\n", stderr);
    return 2;
  }
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(arguments[1]))
    files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  for (const std::string& file : files) spoil(file);
  std::printf("%zu files, each cut short %u times and changed %u times: no crash\n", files.size(), kCuts,
              kChanges);
  return files.empty() ? 1 : 0;
}
