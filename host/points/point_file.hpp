// Points and results as files: CSV, NPY and PLY by the name's ending. In: a path. Out: points, or a
// file with columns.
#pragma once

#include <string>
#include <vector>

#include "dapple/points.hpp"

namespace dapple {

struct PointList {
  std::vector<V3f> points;
  std::vector<V3f> normals;  ///< unit; +Y where the file has none
};

/// Reads columns x, y, z and, if there are, nx, ny, nz:
/// - .csv: numbers by commas, semicolons, tabs or spaces; a first line of names may order them
/// - .npy: a 2-dimensional array of 3 or 6 columns of float32 or float64, in C order, or a
///   structured array with these names
/// - .ply: element vertex, ascii or binary_little_endian
/// Normals are scaled to length 1. Throws Error input, "PATH: ..." with the line or row.
PointList read_points(const std::string& path);

/// Reads suns: x, y, z (towards the sun) or azimuth, elevation (degrees; azimuth from -Z, north,
/// to +X, east), then irradiance in W/m^2. CSV as above, with a line of names. Throws Error input.
std::vector<SunDirection> read_suns(const std::string& path);

/// Throws Error usage unless write_points() can write a file with this ending.
void check_point_output(const std::string& path);

/// Writes x, y, z, nx, ny, nz and the columns: text (.csv), a structured array of float32 (.npy),
/// or a binary PLY. Throws Error usage for other endings, failed if the file cannot be written.
void write_points(const std::string& path, const PointList& list,
                  const std::vector<PointColumn>& columns);

}  // namespace dapple
