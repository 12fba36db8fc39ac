// What stands around the rows of a recording, and files that are no text. Values by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "support/utf16.h"
#include "unit/device/recordings.h"

namespace argil::device {
namespace {

using test::expect_refused;
using test::has_note;
using test::read;

const std::string kTable = "t,x,y,z\n0,1,2,3\n0.5,4,5,6\n";

void expect_table(const Trace& trace, const std::string& text) {
  ASSERT_EQ(trace.samples.size(), 2U) << text;
  EXPECT_EQ(trace.time, (std::vector<double>{0.0, 0.5})) << text;
  EXPECT_EQ(trace.samples[1].position, Vec3(4, 5, 6)) << text;
}

TEST(RecordingFiles, MayHaveFreeTextAboveTheNames) {
  for (const auto& [above, count] : std::vector<std::pair<std::string, std::string>>{
           {"Recorded with a tracker\n", "1 line above the names, from line 1, is not used"},
           {"Recorded with a tracker\nRate: 1000 Hz\n", "2 lines above the names"},
           {"Version 2.1\nDate: 2024-01-02\n# free\nSubject, 7\n\n", "3 lines above the names"},
           {"Format,1.23,Take,1\n\nType,Marker,Marker,Marker\nName,tip,tip,tip\n", "3 lines above the names"},
           {"sep=,\n", "1 line above the names"}}) {
    const Trace trace = read(above + kTable);
    expect_table(trace, above);
    EXPECT_TRUE(has_note(trace, count)) << above;
  }
  expect_table(read("Tracker 2.1\nt,x,y,z\ns,mm,mm,mm\n0,1000,2000,3000\n0.5,4000,5000,6000\n"), "units");
  expect_table(read("Tracker 2.1\nt;x;y;z\n0,0;1;2;3\n0,5;4;5;6\n"), "semicolons");
}

TEST(RecordingFiles, MayHaveFreeTextAboveColumnsThatTheUserNames) {
  TraceOptions options;
  options.columns = {"t", "x", "y", "z"};
  for (const std::string names : {"", "a,b,c,d\n", "a,b,c,d\n[s],[m],[m],[m]\n", "0,NA,NA,NA\n"}) {
    const Trace trace = read("Tracker 2.1\nSubject, 7\n" + names + "0,1,2,3\n0.5,4,5,6\n", options);
    expect_table(trace, names);
    EXPECT_TRUE(has_note(trace, "2 lines above the table, from line 1, are not used")) << names;
  }
}

/// A second row of names does not turn the rows above it into free text.
TEST(RecordingFiles, WithNumbersAboveTheNamesAreRefused) {
  expect_refused("0,1,2,3\n0.1,1,2,3\n" + kTable, "line 1", "nothing names these 4 numbers");
  expect_refused("t,x,y,z\n0,oops,2,3\n0.1,1,2,3\n0.2,1,2,3\n" + kTable, "line 2, column 2", "'oops'");
}

TEST(RecordingFiles, MayHaveCommentsAmongTheRows) {
  const Trace trace = read("t,x,y,z\n0,1,2,3\n# mark\n0.5,4,5,6\n% end\n");
  expect_table(trace, "comments");
  EXPECT_TRUE(has_note(trace, "comment lines among the rows, not used: 2, the first in line 3"));
}

TEST(RecordingFiles, MayEndLinesByACarriageReturn) {
  std::string text = kTable;
  std::replace(text.begin(), text.end(), '\n', '\r');
  expect_table(read(text), "CR");
  expect_refused("t,x,y,z\r0,1,2,3\r0.5,4,oops,6\r", "line 3, column 3", "'oops' is not a number");
}

TEST(RecordingFiles, InUtf16WithoutAByteOrderMarkAreRefusedByName) {
  expect_refused(argil::test::to_utf16(kTable, false), "is text in UTF-16LE without a byte order mark",
                 "iconv -f UTF-16LE -t UTF-8 ");
  expect_refused(argil::test::to_utf16(kTable, true), "is text in UTF-16BE without a byte order mark",
                 "iconv -f UTF-16BE -t UTF-8 ");
}

TEST(RecordingFiles, ThatArePackedAreRefusedWithTheWayToUnpackThem) {
  const auto zip_of = [](const std::string& name) {
    std::string bytes = "PK\x03\x04";
    bytes.resize(26, '\0');
    return bytes + static_cast<char>(name.size()) + std::string(3, '\0') + name + "\x01\x02";
  };
  expect_refused(zip_of("arr_0.npy"), "holds several arrays of NumPy's, the first 'arr_0.npy'",
                 "trace.csv, and give one of its files (.npy)");
  expect_refused(zip_of("a.csv"), "is packed by zip, the first 'a.csv'", "unpack it: unzip ");
  expect_refused(zip_of("[Content_Types].xml"), "is a workbook", "save the sheet as CSV");
  expect_refused("PK\x03\x04", "is packed by zip", "unzip");
  expect_refused("\x1F\x8B\x08 and more", "is packed by gzip, not text", "unpack it: gunzip -k ");
}

TEST(RecordingFiles, WithBytesOfNoTextAreRefusedByTheirLine) {
  expect_refused(kTable + std::string(9, '\0'), "line 4", "holds the byte 0x00, so it is no text");
  expect_refused("t,x,y,z\n0,1,2,\x1B[3\n", "line 2", "holds the byte 0x1B");
}

/// However long the names and cells are.
TEST(RecordingFiles, AreRefusedByShortMessages) {
  std::string names;
  for (int i = 0; i < 1000; ++i) names += "column" + std::to_string(i) + ",";
  try {
    read(names + "\n");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_LT(std::string(error.what()).size(), 600U);
    EXPECT_NE(std::string(error.what()).find("'column0', 'column1', "), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find(" more; "), std::string::npos) << error.what();
  }
  try {
    read("t,x,y,z\n0,0,0," + std::string(5000, 'a') + "\n");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_LT(std::string(error.what()).size(), 400U);
  }
}

TEST(RecordingFiles, LeaveOutRowsWhosePlaceIsLost) {
  for (const std::string lost : {"nan,nan,nan", "NaN,NaN,NaN", "NA,NA,NA", ",,", "null,,", "-nan,,"}) {
    for (const std::string& text : {"t,x,y,z\n0,1,2,3\n0.25," + lost + "\n0.5,4,5,6\n",
                                    "t,x,y,z\n-0.25," + lost + "\n0,1,2,3\n0.5,4,5,6\n"}) {
      TraceOptions options;
      const Trace trace = read(text, options);
      expect_table(trace, text);
      EXPECT_TRUE(has_note(trace, "rows without a place, left out: 1, the first in line ")) << text;
    }
  }
  // One alone is no lost place but a number that went wrong.
  expect_refused("t,x,y,z\n0,1,2,3\n0.25,4,NaN,6\n0.5,4,5,6\n", "line 3, column 3", "'NaN' is not finite");
  // What is not used may be anything; what is used of a row with a place is a number.
  expect_table(read("t,x,y,z,f\n0,1,2,3,nan\n0.5,4,5,6,NA\n"), "unused");
  expect_table(
      read("t,x,y,z,qx,qy,qz,qw\n0,1,2,3,0,0,0,1\nnan,nan,nan,nan,nan,nan,nan,nan\n0.5,4,5,6,0,0,0,1\n"),
      "all");
  expect_refused("t,x,y,z,qx,qy,qz,qw\n0,1,2,3,nan,nan,nan,nan\n", "line 2, column 5", "'nan' is not finite");
  expect_refused("t,x,y,z\n0,nan,nan,nan\n0.5,4,5,6\n1,,,\n", "line 2", "2 of 3 rows have no place, as here");
}

TEST(RecordingFiles, SayThatAColumnWithoutANameIsNotUsed) {
  const Trace trace = read(",t,x,y,z\n0,0,1,2,3\n1,0.5,4,5,6\n");
  expect_table(trace, "index");
  EXPECT_TRUE(has_note(trace, "columns not used: column 1 (without a name)"));
}

}  // namespace
}  // namespace argil::device
