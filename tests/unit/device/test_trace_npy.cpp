// Tables of NumPy's as traces. The bytes are those of the format's description (numpy.lib.format); files that
// NumPy itself wrote are in unit/run/test_new.py.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "base/error.h"
#include "device/trace.h"
#include "support/temp_folder.h"

namespace argil::device {
namespace {

std::string make_file(const std::string& descr, const std::string& order, const std::string& shape,
                      const std::string& data, char version = 1) {
  std::string header = "{'descr': '" + descr + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }";
  header.resize(117, ' ');
  header += '\n';
  const auto length = static_cast<std::uint32_t>(header.size());
  std::string text = std::string("\x93NUMPY") + version + '\0';
  for (int i = 0; i < (version == 1 ? 2 : 4); ++i) text += static_cast<char>(length >> 8 * i & 0xFF);
  return text + header + data;
}

template <class Real>
std::string bytes_of(const std::vector<double>& values, bool is_swapped = false) {
  std::string text;
  for (const double value : values) {
    const auto real = static_cast<Real>(value);
    char bytes[sizeof(Real)];
    std::memcpy(bytes, &real, sizeof bytes);
    text += is_swapped ? std::string(std::rbegin(bytes), std::rend(bytes)) : std::string(bytes, sizeof bytes);
  }
  return text;
}

// Three samples of a device that also wrote a temperature, by rows and by columns.
const std::vector<double> kByRows = {0,    0.1, 20,   -0.25, 1.0 / 3, 0.01, 0.2,  21,
                                     -0.5, 0.5, 0.02, 0.3,   22,      1e-9, 0.625};
const std::vector<double> kByColumns = {0,  0.01,  0.02, 0.1,  0.2,     0.3, 20,   21,
                                        22, -0.25, -0.5, 1e-9, 1.0 / 3, 0.5, 0.625};

class Npy : public testing::Test {
 protected:
  argil::test::TempFolder folder;
  TraceOptions options;

  Npy() { options.columns = {"t", "x", "-", "y", "z"}; }
  Trace read(const std::string& bytes) { return read_trace(folder.write("hand.npy", bytes), options); }
  template <class Real>
  void expect_samples(const Trace& trace) {
    ASSERT_EQ(trace.samples.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      const double* row = kByRows.data() + 5 * i;
      EXPECT_EQ(trace.time[i], static_cast<double>(static_cast<Real>(row[0])));
      for (const auto& [k, column] : {std::pair{0, 1}, {1, 3}, {2, 4}})
        EXPECT_EQ(trace.samples[i].position(k), static_cast<double>(static_cast<Real>(row[column])));
    }
  }
  void expect_refused(const std::string& bytes, const std::string& words) {
    ARGIL_EXPECT_THROW_WITH(read(bytes), InputError, words);
  }
};

TEST_F(Npy, NumbersComeToTheBitInEveryForm) {
  const std::string shape = "(3, 5)";
  expect_samples<double>(read(make_file("<f8", "False", shape, bytes_of<double>(kByRows))));
  expect_samples<double>(read(make_file("<f8", "True", shape, bytes_of<double>(kByColumns))));
  expect_samples<double>(read(make_file(">f8", "False", shape, bytes_of<double>(kByRows, true))));
  expect_samples<double>(read(make_file("<f8", "False", shape, bytes_of<double>(kByRows), 2)));
  expect_samples<float>(read(make_file("<f4", "False", shape, bytes_of<float>(kByRows))));
  expect_samples<float>(read(make_file("<f4", "True", shape, bytes_of<float>(kByColumns))));
}

TEST_F(Npy, WhatTheFileDoesNotSayAKeyDoes) {
  const std::string file = make_file("<f8", "False", "(3, 5)", bytes_of<double>(kByRows));
  options.columns = {"-", "x", "", "y", "z"};
  expect_refused(
      file,
      "hand.npy: no time column and no sampling rate; name a column t [s] or give the rate in Hz by "
      "/trace/default_rate_hz, for instance 1000");
  options.default_rate_hz = 100.0;
  options.length_unit = LengthUnit::cm;
  const Trace trace = read(file);
  EXPECT_DOUBLE_EQ(trace.time[2], 0.02);
  EXPECT_DOUBLE_EQ(trace.samples[1].position.x(), 0.002);
  options.columns = {};
  expect_refused(file,
                 "3 × 5 numbers without names of the columns; name them from the left by /trace/columns");
  options.columns = {"t", "x", "y", "z", "a", "b"};
  expect_refused(file, "6 columns are named by /trace/columns, but there are 5");
}

TEST_F(Npy, WhatIsNoTableOfNumbersIsRefused) {
  const std::string data = bytes_of<double>(kByRows);
  expect_refused(make_file("<f8", "False", "(1, 3, 5)", data),
                 "is 1 × 3 × 5, not a table of rows and columns; save one motion");
  expect_refused(make_file("<f8", "False", "(15,)", data), "is 15, not a table");
  expect_refused(make_file("<f8", "False", "()", data), "is a single number, not a table");
  expect_refused(make_file("<i8", "False", "(3, 5)", data),
                 "is an array of '<i8', not of float32 or float64");
  expect_refused(make_file("|O", "False", "(3, 5)", data), "not of float32 or float64");
  expect_refused(make_file("<f8", "False", "(4, 5)", data), "holds 120 bytes of numbers, not those of 4 × 5");
  expect_refused(make_file("<f8", "False", "(6148914691236517206, 3)", data),
                 "holds 120 bytes");  // 3 times it wraps round
  expect_refused(make_file("<f8", "False", "(0, 5)", ""), "holds 0 bytes");
  std::vector<double> broken = kByRows;
  for (const std::size_t place : {6U, 8U, 9U}) broken[place] = std::numeric_limits<double>::quiet_NaN();
  const Trace found = read(make_file("<f8", "False", "(3, 5)", bytes_of<double>(broken)));
  EXPECT_EQ(found.time, (std::vector<double>{0.0, 0.02}));
  EXPECT_EQ(found.notes, (std::vector<std::string>{"rows without a place, left out: 1, the first in row 1"}));
  broken[14] = std::numeric_limits<double>::infinity();
  expect_refused(make_file("<f8", "False", "(3, 5)", bytes_of<double>(broken)),
                 "hand.npy: row 2, column 4: is inf");
  broken = kByRows;
  broken[7] = std::numeric_limits<double>::infinity();  // of a column that is left out
  expect_samples<double>(read(make_file("<f8", "False", "(3, 5)", bytes_of<double>(broken))));
  broken[10] = 0.01;
  expect_refused(make_file("<f8", "False", "(3, 5)", bytes_of<double>(broken)),
                 "hand.npy: row 2: time 0.01 s does not come after");
}

TEST_F(Npy, ATableThatLiesTheOtherWayRoundIsRefused) {
  const std::vector<double> numbers(4 * 60, 0.5);
  const auto file = [&](const std::string& shape) {
    return make_file("<f8", "False", shape, bytes_of<double>(numbers));
  };
  for (const auto& columns : {std::vector<std::string>{"t", "x", "y", "z"}, std::vector<std::string>{}}) {
    options.columns = columns;
    expect_refused(file("(4, 60)"), "hand.npy: is 4 × 60, fewer rows than columns");
    expect_refused(file("(4, 60)"), "save it the other way round, numpy.save(file, a.T)");
  }
  options.default_rate_hz = 100.0;
  options.columns = {"x", "y", "z"};
  EXPECT_EQ(read(file("(60, 4)")).samples.size(), 60U);
  options.columns.resize(60, "-");  // as the message proposes
  EXPECT_EQ(read(file("(4, 60)")).samples.size(), 4U);
}

TEST_F(Npy, FilesCutAtEveryByteAreRefused) {
  const std::string whole = make_file("<f8", "False", "(3, 5)", bytes_of<double>(kByRows));
  for (std::size_t length = 6; length < whole.size(); ++length)
    EXPECT_THROW(read(whole.substr(0, length)), InputError) << length;
  EXPECT_NO_THROW(read(whole));
}

}  // namespace
}  // namespace argil::device
