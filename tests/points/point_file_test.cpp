// Files of points in CSV, NPY and PLY: reading returns what was written, and errors of invalid
// files name the line or row. Also lists of suns, grids of points, and points of triangles.
#include "points/point_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "dapple/error.hpp"
#include "points/number_table.hpp"

namespace dapple {
namespace {

class PointFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("points_" + std::to_string(getpid()) + "_" +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_ / name).string();
  }
  [[nodiscard]] std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }
  static void expect_says(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  }
  template <class Read>
  static void expect_error(const std::string& file, const std::string& part, const Read& read) {
    try {
      read(file);
      FAIL() << file;
    } catch (const Error& error) {
      expect_says(error.what(), part);
    }
  }
  static void expect_error(const std::string& file, const std::string& part) {
    expect_error(file, part, read_points);
  }
  static void expect_suns_error(const std::string& file, const std::string& part) {
    expect_error(file, part, [](const std::string& name) { return read_suns(name); });
  }

 private:
  std::filesystem::path folder_;
};

TEST_F(PointFile, WhatIsWrittenIsReadAgainWithEndingsInAnyCase) {
  PointList list;
  list.points = {{0.1f, -2.5f, 1e-20f}, {3e7f, 0, 1.0f / 3}};
  list.normals = {V3f(0, 1, 0), V3f(1, 2, 3).normalized()};
  for (const char* name : {"a.csv", "a.npy", "a.ply", "b.CSV", "b.Npy", "b.PLY"}) {
    write_points(path(name), list, {{"ao", {0.25f, 0.5f}}});
    const PointList again = read_points(path(name));
    ASSERT_EQ(again.points.size(), 2u) << name;
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(again.points[i], list.points[i]) << name;
      EXPECT_LT((again.normals[i] - list.normals[i]).length(), 1e-6f) << name;
    }
  }
  const NumberTable table = read_npy(path("a.npy"));
  EXPECT_EQ(table.find("ao"), 6);
  EXPECT_EQ(table.values.at(13), 0.5);
}

TEST_F(PointFile, CsvMayHaveNamesCommentsAndAnySeparator) {
  const PointList named =
      read_points(write("n.csv", "id;z;y;x\r\n7;3;2;1\r\n\r\n# nothing\n8;6;5;4"));
  ASSERT_EQ(named.points.size(), 2u);
  EXPECT_EQ(named.points[1], V3f(4, 5, 6));
  EXPECT_EQ(named.normals[1], V3f(0, 1, 0));
  const PointList plain = read_points(write("p.csv", "1 2 3 0 0 -2\n"));
  EXPECT_EQ(plain.points.at(0), V3f(1, 2, 3));
  EXPECT_EQ(plain.normals.at(0), V3f(0, 0, -1));
}

TEST_F(PointFile, OtherColumnsOfNumbersAreWrittenAgainInAllThreeFormats) {
  const PointList list = read_points(write(
      "n.csv", "plot no;x;y;z;id;ao;plot no;\n0.1;1;2;3;16777217;0.9;5;\n;4;5;6;8;0.8;6;7\n"));
  ASSERT_EQ(list.extra.size(), 5u);
  EXPECT_TRUE(list.notes.empty());
  for (const char* name : {"a.csv", "a.npy", "a.ply"}) {
    write_points(path(name), list, {{"ao", {0.25f, 0.5f}}});
    const PointList again = read_points(path(name));
    ASSERT_EQ(again.extra.size(), 5u) << name;
    EXPECT_EQ(again.extra[0].name, "plot_no") << name;
    EXPECT_EQ(again.extra[0].values[0], 0.1) << name;
    EXPECT_TRUE(std::isnan(again.extra[0].values[1])) << name;
    EXPECT_EQ(again.extra[1].name, "id") << name;
    EXPECT_EQ(again.extra[1].values, (std::vector<double>{16777217, 8})) << name;
    EXPECT_EQ(again.extra[2].name, "column_7") << name << ": its own name was taken";
    EXPECT_EQ(again.extra[3].name, "column_8") << name;
    EXPECT_EQ(again.extra[4].name, "ao") << name;
    EXPECT_EQ(again.extra[4].values, (std::vector<double>{0.25, 0.5})) << name << ": the result";
  }
  const PointList plain = read_points(write("p.csv", "1 2 3 7\n"));
  ASSERT_EQ(plain.extra.size(), 1u);
  EXPECT_EQ(plain.extra[0].name, "column_4");
  EXPECT_EQ(plain.extra[0].values, std::vector<double>{7});
  const PointList twice = read_points(write("x.csv", "x,y,z,x\n1,2,3,7\n"));
  EXPECT_EQ(twice.extra.at(0).name, "column_4");
  const PointList thrice = read_points(write("t.csv", "x,y,z,column_5,x,x\n1,2,3,4,5,6\n"));
  EXPECT_EQ(thrice.extra.at(0).name, "column_5");
  EXPECT_EQ(thrice.extra.at(1).name, "column_6");
  EXPECT_EQ(thrice.extra.at(2).name, "column_7");
}

TEST_F(PointFile, ColumnsOfTextAreLeftOutWithANote) {
  const PointList list = read_points(write("n.csv", "plot,x,y,z,id\nA1,1,2,3,4\n"));
  EXPECT_EQ(list.extra.at(0).name, "id");
  expect_says(list.notes.at(0), "plot holds text (\"A1\" in line 2)");
  const std::vector<SunDirection> suns =
      read_suns(write("s.csv", "time,azimuth,elevation,irradiance\n2026-06-21 12:00,180,63,800\n"));
  EXPECT_EQ(suns.at(0).irradiance, 800);
}

TEST_F(PointFile, CsvHasWholeNumbersInFullAndTheDigitsOfExtraColumns) {
  const std::string names = "x,y,z,nx,ny,nz,id,most,east,share";
  const std::string row = "1,2,3,0,1,0,123456792,-9007199254740992,-2097152.25,0.1";
  write_points(path("out.csv"), read_points(write("in.csv", names + "\n" + row + "\n")),
               {{"ao", {0.1f}}});
  std::ifstream out(path("out.csv"));
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(out), {}), names + ",ao\n" + row + ",0.1\n");
}

TEST_F(PointFile, QuotedFieldsMayHoldSeparatorsAndQuotes) {
  const PointList list = read_points(write("q.csv",
                                           "\"plot, tree\",\"x\",y,z,\"h \"\"m\"\"\"\r\n"
                                           "\"a, \"\"b\"\"; c\",\"1.5\", \"2\" ,3,\"4\"\r\n"));
  EXPECT_EQ(list.points.at(0), V3f(1.5f, 2, 3));
  EXPECT_EQ(list.extra.at(0).name, "h__m_");
  EXPECT_EQ(list.extra.at(0).values, std::vector<double>{4});
  expect_says(list.notes.at(0), "plot__tree holds text (\"a, \"b\"; c\" in line 2)");
  EXPECT_EQ(read_points(write("s.csv", "x y z plot\n1 2 3 \"a, b\"\n")).points.at(0), V3f(1, 2, 3));
  expect_error(write("o.csv", "x,y,z,plot\n1,2,3,\"a\n"), "line 2 has a quote that is not closed");
}

TEST_F(PointFile, NamesThatAreNotUtf8GetOtherLetters) {
  std::ofstream(path("latin.csv")) << "x,y,z,H\xf6he,\xc3\xb6\n1,2,3,4,5\n";
  const PointList list = read_points(path("latin.csv"));
  ASSERT_EQ(list.extra.size(), 2u);
  EXPECT_EQ(list.extra[0].name, "H_he");
  EXPECT_EQ(list.extra[1].name, "\xc3\xb6");
}

TEST_F(PointFile, NormalsOfAnyLengthBecomeUnit) {
  const PointList list = read_points(write("n.csv", "0,0,0,0,1e300,0\n0,0,0,1e-300,0,0\n"));
  EXPECT_EQ(list.normals.at(0), V3f(0, 1, 0));
  EXPECT_EQ(list.normals.at(1), V3f(1, 0, 0));
}

TEST_F(PointFile, ErrorsOfInvalidFilesNameTheLineOrRow) {
  expect_error(write("a.csv", "1,2,3\n1,2\n"), "line 2");
  expect_error(write("b.csv", "1,2,3\n1,two,3\n"), "\"two\"");
  expect_error(write("e.csv", "1,2,3,0,0,0\n"), "normal");
  expect_error(write("f.csv", "1,2,3\n1e300,2,3\n"), "line 2: x is 1e+300; it must be within 1e");
  expect_error(write("g.csv", "\"\"\n1,2,3\n"), "line 1 has no columns");
  expect_error(write("h.csv", "x,y,z,nx\n1,2,3,1\n"), "all of the columns nx, ny, nz");
  expect_error(write("a.npy", "no"), "not an NPY");
  expect_error(write("a.ply", "ply\nformat binary_big_endian 1.0\nend_header\n"), "big_endian");
  expect_error(write("b.ply",
                     "ply\nformat binary_little_endian 1.0\nelement vertex 9\nproperty float x\n"
                     "property float y\nproperty float z\nend_header\n12"),
               "9 vertices");
  const auto of_count = [](const std::string& count) {
    return "ply\nformat ascii 1.0\nelement vertex " + count +
           "\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n";
  };
  expect_error(write("c.ply", of_count("three")), "'three'");
  const std::string binary =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty uchar x\n"
      "property uchar y\nproperty uchar z\ncomment no end_header\n";
  expect_error(write("g.ply", binary + "abc"), "end_header");
  expect_error(write("h.ply", binary + "end_header"), "end_header");
  for (const char* end : {"end_header\nabc", "end_header\r\nabc"})
    EXPECT_EQ(read_points(write("i.ply", binary + end)).points.at(0), V3f('a', 'b', 'c'));
  expect_error(write("d.ply", of_count("-1")), "'-1'");
  for (const char* count : {"2000000000000000000000", "6148914691236517206", "9000"})
    expect_error(write("e.ply", of_count(count)), std::string(count) + " vertices");
  EXPECT_EQ(read_points(write("f.ply", of_count("1"))).points.size(), 1u);
  expect_error(write("a.txt", "1 2 3"), ".csv");
  expect_error(path("missing.csv"), "missing.csv");
}

/// The bytes of an NPY file.
std::string npy(const std::string& descr, const std::string& shape, const std::string& values) {
  std::string header = "{'descr': " + descr + ", 'fortran_order': False, 'shape': " + shape + ", }";
  header.append(63 - (10 + header.size()) % 64, ' ');
  header += '\n';
  std::string bytes = std::string("\x93NUMPY\x01\0", 8);
  const auto length = static_cast<std::uint16_t>(header.size());
  bytes.append(reinterpret_cast<const char*>(&length), 2);
  return bytes + header + values;
}

template <class... T>
std::string bytes_of_all(T... values) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
  return bytes;
}

TEST_F(PointFile, VerticesOfAsciiPlyHaveLinesOfTheirOwn) {
  const auto ply = [](const std::string& rows) {
    return "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty "
           "float z\nend_header\n" +
           rows;
  };
  const PointList list = read_points(write("a.ply", ply("\n 0 +0.5\t1 \r\n\n2 3 4")));
  ASSERT_EQ(list.points.size(), 2u);
  EXPECT_EQ(list.points[0], V3f(0, 0.5f, 1));
  EXPECT_EQ(list.points[1], V3f(2, 3, 4));
  expect_error(write("b.ply", ply("0 1 2 255\n3 4 5\n")), "vertex 0: its line has more than 3");
  expect_error(write("c.ply", ply("0 1 2\n3 4\n5 6\n")), "vertex 1: its line must have 3");
  expect_error(write("d.ply", ply("0 0.5.1\n3 4 5\n")), "vertex 0: its line must have 3");
  expect_error(write("e.ply", ply("0 1 2\n")), "vertex 1: its line must have 3");
  expect_error(write("f.ply",
                     "ply\nelement vertex 1\nproperty float x\nproperty float y\nproperty "
                     "float z\nend_header\n0 1 2\n"),
               "no line format");
}

TEST_F(PointFile, PaddedFieldsOfNpyAreAnError) {
  const std::string row = bytes_of_all(1.0f, 2.0f, 3.0f, 0u);
  for (const char* descr : {"[('x', '<f4'), ('y', '<f4'), ('z', '<f4'), ('', '|V4')]",
                            "[('x', '<f4'), ('', '|V4'), ('y', '<f4'), ('z', '<f4')]"})
    expect_error(write("padded.npy", npy(descr, "(1,)", row)), "has padding between its fields");
}

TEST_F(PointFile, LinesMayEndAsOnOldMacs) {
  const PointList list = read_points(write("mac.csv", "x,y,z\r0,0,0\r1,2,3\r"));
  ASSERT_EQ(list.points.size(), 2u);
  EXPECT_EQ(list.points[1], V3f(1, 2, 3));
  expect_error(write("short.csv", "x,y,z\r0,0,0\r1,2\r"), "line 3 has 2 columns");
}

TEST_F(PointFile, TwoSeparatorsInALineAreAnError) {
  expect_error(write("a.csv", "x;y;z\n0,5;0,25;0,1\n"),
               "line 2 has commas and semicolons; columns need one separator");
  expect_error(write("b.csv", "0,5;0;0\n"), "line 1 has commas and semicolons");
  expect_error(write("c.csv", "1\t2,3\n"), "line 1 has commas and tabs");
}

TEST_F(PointFile, FilesWithoutRowsAreErrors) {
  for (const char* bytes : {"", "\n", "# x,y,z\n"})
    expect_error(write("empty.csv", bytes), "empty.csv: there are no rows");
  for (const char* bytes : {"", "azimuth,elevation,irradiance\n"})
    expect_suns_error(write("suns.csv", bytes), "suns.csv: there are no rows");
}

TEST_F(PointFile, NamesAloneAndArraysWithoutRowsHaveANote) {
  for (const std::string& file :
       {write("names.csv", "x,y,z\n"), write("rows.npy", npy("'<f4'", "(0, 3)", ""))})
    EXPECT_EQ(read_points(file).notes, std::vector<std::string>{file + ": no points"});
}

TEST_F(PointFile, NamesMayBeInTheCommentBeforeTheRows) {
  for (const char* text : {"# written by me\n# z,y,x,plot\n3,2,1,7\n", "#z y x plot\n3 2 1 7\n"}) {
    const PointList list = read_points(write("a.csv", text));
    ASSERT_EQ(list.points.size(), 1u);
    EXPECT_EQ(list.points[0], V3f(1, 2, 3)) << text;
    ASSERT_EQ(list.extra.size(), 1u);
    EXPECT_EQ(list.extra[0].name, "plot");
  }
  // Other comments name nothing.
  for (const char* text :
       {"# z,y,x\n# no names\n1,2,3\n", "# z,y,x,w\n1,2,3\n", "# a,b,c\n1,2,3\n"})
    EXPECT_EQ(read_points(write("b.csv", text)).points[0], V3f(1, 2, 3)) << text;
}

TEST_F(PointFile, ErrorsOfColumnsNameThoseThatAreThere) {
  expect_error(write("a.csv", "X,Y,Z [m]\n1,2,3\n"),
               "(and nx, ny, nz); it has X, Y, Z [m]; names are lower case, without units");
  expect_error(write("b.csv", "1,2\n"),
               "(x, y, z), or 6 (and nx, ny, nz), or names; it has 2 columns without names");
  expect_suns_error(write("s.csv", "Azimuth,azimuth [deg],zenith,DNI\n1,2,3,4\n"),
                    "it has Azimuth, azimuth [deg], zenith, DNI; names are lower case, without");
  expect_says(read_points(write("c.csv", "7,1,2,3\n")).notes.at(0),
              "has 4 columns without names; the first are read as x, y, z");
}

TEST_F(PointFile, ErrorsOfValuesNameThePlaceAndTheColumn) {
  expect_error(write("a.csv", "x,y,z\n# no\n1,,3\n"), "line 3: y is empty; it must be a number");
  expect_error(write("b.csv", "z,y,x\n1,2,nan\n"), "line 2: x is nan; it must be a finite number");
  const std::string values = bytes_of_all(1.0f, 2.0f, INFINITY);
  expect_error(write("d.npy", npy("'<f4'", "(1, 3)", values)), "row 0: z is inf");
  const std::string names = "azimuth,elevation,irradiance\n";
  expect_suns_error(write("s.csv", names + "1,2,3\n0,9,-5\n"), "line 3: irradiance is -5; it must");
  expect_suns_error(write("s.csv", names + "0,9,\n"), "line 2: irradiance is empty");
  expect_suns_error(write("s.csv", names + "0,9,high\n"), "line 2: irradiance is \"high\"");
  expect_suns_error(write("s.csv", names + "0,91,1\n"), "line 2: elevation is 91; it must be from");
  expect_suns_error(write("s.csv", "x,y,z,irradiance\n0,0,0,1\n"), "line 2: the direction");
}

TEST_F(PointFile, ArraysOfFloatsAndWholeNumbersAreRead) {
  const std::string doubles = bytes_of_all(1.0, 2.0, 3.0, 4.0, 5.0, 6.0);
  EXPECT_EQ(read_points(write("d.npy", npy("'<f8'", "(2, 3)", doubles))).points.at(1),
            V3f(4, 5, 6));
  const std::string singles = bytes_of_all(1.0f, 2.0f, 3.0f, 0.0f, 0.0f, 5.0f);
  EXPECT_EQ(read_points(write("s.npy", npy("'<f4'", "(1, 6)", singles))).normals.at(0),
            V3f(0, 0, 1));
  const std::string whole = bytes_of_all(std::int16_t{-1}, std::int16_t{2}, std::int16_t{300});
  EXPECT_EQ(read_points(write("i.npy", npy("'<i2'", "(1, 3)", whole))).points.at(0),
            V3f(-1, 2, 300));
  expect_error(write("h.npy", npy("'<f2'", "(2, 3)", doubles)),
               "its type is '<f2'; it must be little-endian float32, float64 or whole numbers "
               "(numpy: .astype('<f4'))");
  expect_error(write("b.npy", npy("'>f8'", "(2, 3)", doubles)), "(numpy: .astype('<f8'))");
  expect_error(write("u.npy", npy("'<U4'", "(1, 3)", doubles)), "whole numbers");
  expect_error(write("t.npy", npy("'<f8'", "(9, 3)", doubles)), "9 rows");
  expect_error(write("o.npy", npy("'<f8'", "(6,)", doubles)), "1 dimension;");
}

// As NumPy writes names with an apostrophe.
TEST_F(PointFile, NamesOfFieldsMayBeInDoubleQuotes) {
  const std::string fields = "[('x', '<f4'), ('y', '<f4'), ('z', '<f4'), (\"it's\", '<f4')]";
  const std::string row = bytes_of_all(1.0f, 2.0f, 3.0f, 4.0f);
  const PointList list = read_points(write("q.npy", npy(fields, "(1,)", row)));
  EXPECT_EQ(list.points.at(0), V3f(1, 2, 3));
  ASSERT_EQ(list.extra.size(), 1u);
  EXPECT_EQ(list.extra[0].name, "it_s");
  EXPECT_EQ(list.extra[0].values.at(0), 4);
}

TEST_F(PointFile, FieldsOfStructuredArraysHaveTheirOwnTypes) {
  const std::string row = bytes_of_all(std::int64_t{-(1ll << 40)}, 1.0f, std::uint8_t{255}, 2.0,
                                       std::int32_t{-3}, std::uint32_t{4'000'000'000}) +
                          std::string("A1\0\0", 4) + bytes_of_all(U'\u00e9', U'x') +
                          bytes_of_all(true);
  const PointList list = read_points(write(
      "f.npy", npy("[('id', '<i8'), ('x', '<f4'), ('flag', '|u1'), ('y', '<f8'), ('z', '<i4'), "
                   "('big', '<u4'), ('plot', '|S4'), ('kind', '<U2'), ('on', '|b1')]",
                   "(1,)", row)));
  EXPECT_EQ(list.points.at(0), V3f(1, 2, -3));
  ASSERT_EQ(list.extra.size(), 4u);
  EXPECT_EQ(list.extra[0].values.at(0), -static_cast<double>(1ll << 40));
  EXPECT_EQ(list.extra[1].values.at(0), 255);
  EXPECT_EQ(list.extra[2].values.at(0), 4e9);
  EXPECT_EQ(list.extra[3].values.at(0), 1);
  expect_says(list.notes.at(0), "plot holds text (\"A1\" in row 0)");
  expect_says(list.notes.at(1), "\"?x\"");
  expect_error(write("x.npy", npy("[('x', '<U2'), ('y', '<f4'), ('z', '<f4')]", "(1,)", row)),
               "row 0: x is \"");
  expect_error(write("b.npy", npy("[('x', '<f4'), ('y', '>f4')]", "(1,)", row)),
               "its field \"y\" is '>f4'; it must be little-endian");
  expect_error(write("a.npy", npy("[('x', '<f4'), ('rgb', '|u1', (3,))]", "(1,)", row)),
               "several values in each \"rgb\"");
}

TEST_F(PointFile, SunsAreDirectionsOrAngles) {
  const auto suns =
      read_suns(write("s.csv", "azimuth,elevation,irradiance\n0,0,1\n90,0,2\n0,90,3\n"));
  ASSERT_EQ(suns.size(), 3u);
  EXPECT_LT((suns[0].direction - V3f(0, 0, -1)).length(), 1e-6f) << "north";
  EXPECT_LT((suns[1].direction - V3f(1, 0, 0)).length(), 1e-6f) << "east";
  EXPECT_LT((suns[2].direction - V3f(0, 1, 0)).length(), 1e-6f);
  EXPECT_EQ(suns[2].irradiance, 3);
  expect_suns_error(write("w.csv", "1,2,3\n"), "it has 3 columns without names");
}

TEST_F(PointFile, SunsThatMayBeInRadiansHaveANote) {
  std::vector<std::string> notes;
  for (const char* suns : {"0,0,8\n", "7,1,8\n", "6,2,8\n", "6,1,8\n7,1,8\n", "6,1,8\n5,-1.5,8\n"})
    read_suns(write("s.csv", std::string("azimuth,elevation,irradiance\n") + suns), &notes);
  EXPECT_EQ(notes.size(), 1u) << "only the last";
}

}  // namespace
}  // namespace dapple
