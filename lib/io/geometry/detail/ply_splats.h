// Gaussian splats among a PLY's vertices, told by their properties: scale_0..2, rot_0..3, opacity
// and, for colours of degree d, f_rest_0 to f_rest_N with N + 1 = 3 ((d + 1)^2 - 1). These are the
// names of the reference implementation of Kerbl et al. (2023), gaussian_model.py: save_ply().
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/ply_body.h"
#include "innermap/transfer/geometry.h"

namespace innermap {

class PlySplats {
 public:
  PlySplats() = default;
  // Throws FileError for splats that lack something, have it twice or as whole numbers, and for
  // numbers of f_rest that fit no degree.
  PlySplats(const std::string& path, const PlyElement& vertices);

  int degree() const { return degree_; }  // -1: the vertices are no splats

  // What of a splat each property is: a number for valueOf(), kNone of others.
  const std::vector<int>& parts() const { return parts_; }

  static constexpr int kNone = -1, kOpacity = 7;
  static double& valueOf(Splat& splat, int part);

  // Throws FileError where `row`, which `splat` is, has numbers that say nothing. body: behind it.
  static void check(const PlyBody& body, std::uint64_t row, Splat& splat, int degree);

  // Of the next row.
  Splat read(PlyBody& body, const PlyElement& vertices) const;

 private:
  int degree_ = -1;
  std::vector<int> parts_;  // #properties
};

// Bytes that a file of so many bytes takes while it is carried, by its first ones; 0 where these
// are not those of splats.
std::uint64_t plySplatsMemory(const FileBytes& head, std::uint64_t size);

}  // namespace innermap
