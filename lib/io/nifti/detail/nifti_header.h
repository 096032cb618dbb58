// The headers of NIfTI-1 and NIfTI-2 files: R. W. Cox and others, nifti1.h and nifti2.h of
// nifti.nimh.nih.gov.
//
// They are read and written here: the packaged library takes memory by the header's counts before
// it looks whether the file has as many, ends the process where there is none, holds matrices in
// single precision and writes to files by their names alone.
#pragma once

#include <openvdb/openvdb.h>

#include <array>
#include <cstdint>
#include <string>

namespace innermap {

constexpr std::size_t kNifti1Header = 348, kNifti2Header = 540;
constexpr std::int64_t kNiftiVector = 1007;  // NIFTI_INTENT_VECTOR

struct NiftiHeader {
  bool swapped = false;  // the file has the other byte order
  std::array<std::int64_t, 8> dim{};
  std::array<double, 8> pixdim{};
  std::int64_t datatype = 0, offset = 0, qform = 0, sform = 0, units = 0, intent = 0;
  double slope = 0, inter = 0;
  std::array<double, 3> quaternion{}, qoffset{};
  std::array<std::array<double, 4>, 3> srow{};
  std::string intentName;

  // Index to world, row vectors, millimetres where the file says its unit; by sform, else qform.
  // Throws FileError where neither is there (saying what to do) or a matrix that is not invertible.
  openvdb::Mat4d indexToWorld(const std::string& path) const;
  // Voxels along the axes, as long as pixdim says, the first at the origin.
  openvdb::Mat4d asVoxels(const std::string& path) const;
};

// Of the first bytes of a file, unpacked; kNifti2Header of them are enough. Throws FileError for
// what is no header of one file, or with counts that make no sense.
NiftiHeader parseNiftiHeader(const std::string& path, const std::string& bytes);

// The 352 bytes before a NIfTI-1 file's values: what `header` says, with sform, and qform where the
// axes are at right angles. place: of voxel 0, 0, 0 on; row vectors.
std::string niftiHeaderBytes(const NiftiHeader& header, std::size_t bytesPerValue,
                             const openvdb::Mat4d& place);

}  // namespace innermap
