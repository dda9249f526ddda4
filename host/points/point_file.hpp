// Points and results as files: CSV, NPY and PLY by the name's ending. In: a path. Out: points, or a
// file with columns.
#pragma once

#include <string>
#include <vector>

#include "dapple/points.hpp"

namespace dapple {

/// A column of a points file that is not read, only written again, such as a sensor's number.
struct ExtraColumn {
  std::string name;
  std::vector<double> values;
};

struct PointList {
  std::vector<V3f> points;
  std::vector<V3f> normals;  ///< unit; +Y where the file has none
  std::vector<ExtraColumn> extra;
  std::vector<std::string> notes;  ///< such as columns that were left out
};

/// Reads columns x, y, z and, if there are, nx, ny, nz:
/// - .csv: numbers by commas, semicolons, tabs or spaces; a first line of names may order them
/// - .npy: a 2-dimensional array of 3 or 6 columns of float32 or float64, in C order, or a
///   structured array with these names
/// - .ply: element vertex, ascii or binary_little_endian
/// Normals are scaled to length 1. Other columns of numbers are `extra`, under their names or as
/// column_N, N from 1. Notes tell columns of text, files without points, and columns without names
/// that are neither 3 nor 6. Throws Error input, "PATH: ..." with the line of a CSV file, from 1,
/// or the row, from 0.
PointList read_points(const std::string& path);

/// Reads suns: x, y, z (towards the sun) or azimuth, elevation (degrees; azimuth from -Z, north,
/// to +X, east), then irradiance in W/m^2. CSV as above, with a line of names. Adds a note to
/// `notes`, if given, where angles may be radians. Throws Error input.
std::vector<SunDirection> read_suns(const std::string& path,
                                    std::vector<std::string>* notes = nullptr);

/// Throws Error usage unless write_points() can write a file with this ending, in any case.
void check_point_output(const std::string& path);

/// Writes x, y, z, nx, ny, nz, the extra columns that have no result's name, and the results:
/// text (.csv), a structured array (.npy), or a binary PLY. Throws Error usage for other endings,
/// failed if the file cannot be written.
void write_points(const std::string& path, const PointList& list,
                  const std::vector<PointColumn>& results);

}  // namespace dapple
