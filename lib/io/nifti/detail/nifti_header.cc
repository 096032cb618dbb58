#include "io/nifti/detail/nifti_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/byte_order.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

// Numbers at their places in a header, by NIfTI-1's or NIfTI-2's types.
class Fields {
 public:
  Fields(const std::string& bytes, bool swapped) : bytes_(bytes), swapped_(swapped) {}

  template <class T>
  T at(std::size_t place) const {
    return numberAt<T>(bytes_.data() + place, swapped_);
  }
  std::string text(std::size_t place, std::size_t size) const {
    const std::string all = bytes_.substr(place, size);
    return all.substr(0, all.find('\0'));
  }

 private:
  const std::string& bytes_;
  bool swapped_;
};

NiftiHeader first(const Fields& f) {
  NiftiHeader h;
  for (std::size_t i = 0; i < 8; ++i) {
    h.dim[i] = f.at<std::int16_t>(40 + 2 * i);
    h.pixdim[i] = f.at<float>(76 + 4 * i);
  }
  h.intent = f.at<std::int16_t>(68);
  h.datatype = f.at<std::int16_t>(70);
  const float offset = f.at<float>(108);
  h.offset = offset >= 0 && offset < 1e9f ? static_cast<std::int64_t>(offset) : -1;
  h.slope = f.at<float>(112);
  h.inter = f.at<float>(116);
  h.units = f.at<std::uint8_t>(123);
  h.qform = f.at<std::int16_t>(252);
  h.sform = f.at<std::int16_t>(254);
  for (std::size_t i = 0; i < 3; ++i) {
    h.quaternion[i] = f.at<float>(256 + 4 * i);
    h.qoffset[i] = f.at<float>(268 + 4 * i);
    for (std::size_t c = 0; c < 4; ++c) h.srow[i][c] = f.at<float>(280 + 16 * i + 4 * c);
  }
  h.intentName = f.text(328, 16);
  return h;
}

NiftiHeader second(const Fields& f) {
  NiftiHeader h;
  for (std::size_t i = 0; i < 8; ++i) {
    h.dim[i] = f.at<std::int64_t>(16 + 8 * i);
    h.pixdim[i] = f.at<double>(104 + 8 * i);
  }
  h.datatype = f.at<std::int16_t>(12);
  h.offset = f.at<std::int64_t>(168);
  h.slope = f.at<double>(176);
  h.inter = f.at<double>(184);
  h.qform = f.at<std::int32_t>(344);
  h.sform = f.at<std::int32_t>(348);
  for (std::size_t i = 0; i < 3; ++i) {
    h.quaternion[i] = f.at<double>(352 + 8 * i);
    h.qoffset[i] = f.at<double>(376 + 8 * i);
    for (std::size_t c = 0; c < 4; ++c) h.srow[i][c] = f.at<double>(400 + 32 * i + 8 * c);
  }
  h.units = f.at<std::int32_t>(500);
  h.intent = f.at<std::int32_t>(504);
  h.intentName = f.text(508, 16);
  return h;
}

// From column vectors (row r: world r) to OpenVDB's row vectors; checked.
openvdb::Mat4d matrixOf(const std::string& path, const double rows[3][4], double scale) {
  openvdb::Mat4d m = openvdb::Mat4d::identity();
  double size = 0;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) {
      m(c, r) = rows[r][c] * scale;
      if (!std::isfinite(m(c, r)) || std::abs(m(c, r)) > 1e12)
        throw FileError(path,
                        "has a matrix of numbers that are not finite or far too large; "
                        "export the file again");
      if (c < 3) size = std::max(size, std::abs(m(c, r)));
    }
  if (!(std::abs(m.det()) > 1e-12 * size * size * size))
    throw FileError(path, "has a matrix that lays its voxels flat; export the file again");
  constexpr double kLeastVolume = 1e-14;  // OpenVDB takes less for singular
  if (std::abs(m.det()) < kLeastVolume)
    throw FileError(path, fmt::format("has voxels of {:.3g} mm, too small to be laid out; give its "
                                      "header a larger unit",
                                      size));
  return m;
}

double millimetres(std::int64_t units) {
  const std::int64_t space = units & 7;
  return space == 1 ? 1000 : space == 3 ? 0.001 : 1;
}

// Rotation of a unit quaternion (a, b, c, d), a >= 0: nifti_quatern_to_mat44.
void rotation(const std::array<double, 3>& q, double m[3][4]) {
  double b = q[0], c = q[1], d = q[2];
  const double left = 1 - (b * b + c * c + d * d);
  double a = 0;
  if (left < 1e-7) {
    const double scale = 1 / std::sqrt(b * b + c * c + d * d);
    b *= scale;
    c *= scale;
    d *= scale;
  } else {
    a = std::sqrt(left);
  }
  const double values[3][3] = {
      {a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)},
      {2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)},
      {2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - c * c - b * b}};
  for (int r = 0; r < 3; ++r)
    for (int k = 0; k < 3; ++k) m[r][k] = values[r][k];
}

double spacing(double pixdim) {
  const double length = std::abs(pixdim);
  return length > 0 && std::isfinite(length) ? length : 1;
}

// The inverse of rotation(): of a matrix with columns of length 1 at right angles, no mirror.
std::array<double, 3> quaternionOf(const double r[3][3]) {
  double a = r[0][0] + r[1][1] + r[2][2] + 1, b, c, d;
  if (a > 0.5) {
    a = 0.5 * std::sqrt(a);
    b = 0.25 * (r[2][1] - r[1][2]) / a;
    c = 0.25 * (r[0][2] - r[2][0]) / a;
    d = 0.25 * (r[1][0] - r[0][1]) / a;
    return {b, c, d};
  }
  const double xd = 1 + r[0][0] - (r[1][1] + r[2][2]), yd = 1 + r[1][1] - (r[0][0] + r[2][2]),
               zd = 1 + r[2][2] - (r[0][0] + r[1][1]);
  if (xd > 1) {
    b = 0.5 * std::sqrt(xd);
    c = 0.25 * (r[0][1] + r[1][0]) / b;
    d = 0.25 * (r[0][2] + r[2][0]) / b;
    a = 0.25 * (r[2][1] - r[1][2]) / b;
  } else if (yd > 1) {
    c = 0.5 * std::sqrt(yd);
    b = 0.25 * (r[0][1] + r[1][0]) / c;
    d = 0.25 * (r[1][2] + r[2][1]) / c;
    a = 0.25 * (r[0][2] - r[2][0]) / c;
  } else {
    d = 0.5 * std::sqrt(zd);
    b = 0.25 * (r[0][2] + r[2][0]) / d;
    c = 0.25 * (r[1][2] + r[2][1]) / d;
    a = 0.25 * (r[1][0] - r[0][1]) / d;
  }
  if (a < 0) return {-b, -c, -d};
  return {b, c, d};
}

template <class T>
void put(std::string& bytes, std::size_t place, T value) {
  putNumber(&bytes[place], value);
}

void putQform(std::string& bytes, const openvdb::Mat4d& place, const double length[3]) {
  double r[3][3];
  for (int k = 0; k < 3; ++k)
    for (int c = 0; c < 3; ++c) r[k][c] = place(c, k) / length[c];
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < a; ++b)
      if (std::abs(r[0][a] * r[0][b] + r[1][a] * r[1][b] + r[2][a] * r[2][b]) > 1e-6) return;
  if (place.det() < 0)
    for (auto& row : r) row[2] = -row[2];
  put<float>(bytes, 76, place.det() < 0 ? -1 : 1);
  const std::array<double, 3> q = quaternionOf(r);
  put<std::int16_t>(bytes, 252, 1);
  for (std::size_t i = 0; i < 3; ++i) {
    put(bytes, 256 + 4 * i, static_cast<float>(q[i]));
    put(bytes, 268 + 4 * i, static_cast<float>(place(3, static_cast<int>(i))));
  }
}

}  // namespace

openvdb::Mat4d NiftiHeader::indexToWorld(const std::string& path) const {
  double rows[3][4] = {};
  if (sform > 0) {
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 4; ++c) rows[r][c] = srow[r][c];
  } else if (qform > 0) {
    rotation(quaternion, rows);
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) rows[r][c] *= spacing(pixdim[c + 1]);
      if (pixdim[0] < 0) rows[r][2] = -rows[r][2];
      rows[r][3] = qoffset[r];
    }
  } else {
    throw FileError(path,
                    "says neither by sform nor by qform where its voxels are; give "
                    "--as-voxels to take them along x, y, z, as long as the file says, the "
                    "first at the origin");
  }
  return matrixOf(path, rows, millimetres(units));
}

openvdb::Mat4d NiftiHeader::asVoxels(const std::string& path) const {
  double rows[3][4] = {};
  for (std::size_t a = 0; a < 3; ++a) rows[a][a] = spacing(pixdim[a + 1]);
  return matrixOf(path, rows, millimetres(units));
}

NiftiHeader parseNiftiHeader(const std::string& path, const std::string& bytes) {
  const char* const kNone = "is no NIfTI file; give a .nii or .nii.gz file";
  if (bytes.size() < kNifti1Header + 4) throw FileError(path, kNone);
  std::int32_t size = 0;
  bool swapped = false;
  for (const bool swap : {false, true}) {
    size = Fields(bytes, swap).at<std::int32_t>(0);
    swapped = swap;
    if (size == std::int32_t(kNifti1Header) || size == std::int32_t(kNifti2Header)) break;
  }
  const bool one = size == std::int32_t(kNifti1Header);
  if (!one && (size != std::int32_t(kNifti2Header) || bytes.size() < kNifti2Header))
    throw FileError(path, kNone);
  const Fields fields(bytes, swapped);
  const std::string magic = fields.text(one ? 344 : 4, 4);
  if (magic == "ni1" || magic == "ni2")
    throw FileError(path, "is one half of a pair .hdr and .img; save it as one .nii file");
  if (magic != (one ? "n+1" : "n+2")) throw FileError(path, kNone);
  NiftiHeader header = one ? first(fields) : second(fields);
  header.swapped = swapped;
  if (header.dim[0] < 1 || header.dim[0] > 7)
    throw FileError(path, fmt::format("has {} dimensions; export the file again", header.dim[0]));
  for (std::size_t i = 1; i < 8; ++i) {
    if (static_cast<std::int64_t>(i) > header.dim[0]) header.dim[i] = 1;
    if (header.dim[i] < 1 || header.dim[i] > (std::int64_t(1) << 30))
      throw FileError(path, fmt::format("has {} voxels along dimension {}; export the file again",
                                        header.dim[i], i));
  }
  if (header.offset < (one ? 352 : 544))
    throw FileError(path, "says that its values begin within its header; export the file again");
  return header;
}

std::string niftiHeaderBytes(const NiftiHeader& header, std::size_t bytesPerValue,
                             const openvdb::Mat4d& place) {
  std::string bytes(352, '\0');
  put<std::int32_t>(bytes, 0, kNifti1Header);
  double length[3];
  put<float>(bytes, 76, 1);
  for (std::size_t i = 0; i < 8; ++i) {
    put(bytes, 40 + 2 * i, static_cast<std::int16_t>(header.dim[i]));
    if (i > 0) put<float>(bytes, 76 + 4 * i, 1);
  }
  for (int a = 0; a < 3; ++a) {
    length[a] = openvdb::Vec3d(place(a, 0), place(a, 1), place(a, 2)).length();
    put(bytes, 80 + 4 * static_cast<std::size_t>(a), static_cast<float>(length[a]));
  }
  put(bytes, 68, static_cast<std::int16_t>(header.intent));
  put(bytes, 70, static_cast<std::int16_t>(header.datatype));
  put(bytes, 72, static_cast<std::int16_t>(8 * bytesPerValue));
  put<float>(bytes, 108, 352);
  put<float>(bytes, 112, 1);
  bytes[123] = 2;  // millimetres
  std::memcpy(&bytes[148], "innermap", 8);
  put<std::int16_t>(bytes, 254, 1);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c)
      put(bytes, 280 + 16 * static_cast<std::size_t>(r) + 4 * static_cast<std::size_t>(c),
          static_cast<float>(place(c, r)));
  putQform(bytes, place, length);
  std::memcpy(&bytes[328], header.intentName.data(),
              std::min<std::size_t>(15, header.intentName.size()));
  std::memcpy(&bytes[344], "n+1", 3);
  return bytes;
}

}  // namespace innermap
