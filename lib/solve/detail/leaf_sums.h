// Sums at the targets of one leaf: its expansion plus its near charges.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "solve/detail/far_field.h"
#include "solve/detail/lattice_block.h"
#include "solve/detail/row.h"

namespace innermap {

// Keeps its memory from leaf to leaf. Gradients are in world units.
class LeafSums {
 public:
  // At points[order[i]], i < count, in the units of the charges.
  void atPoints(const FarField& field, const Points& points, const std::uint32_t* order,
                std::size_t count, const Expansion& expansion, const NearCharges& near,
                bool gradients);

  // At a block whose points are `spacing` apart, in the units of the charges; what was not wanted
  // lacks the near charges.
  void atBlock(const FarField& field, const LatticeBlock& polynomial,
               const std::array<std::uint64_t, 8>& wanted, double spacing,
               const Expansion& expansion, const NearCharges& near, bool gradients);

  // values()[stride() * channel + i], gradients()[stride() * (3 channel + axis) + i]
  std::size_t stride() const { return stride_; }
  const double* values() const { return values_.data(); }
  const double* gradients() const { return gradients_.empty() ? nullptr : gradients_.data(); }

 private:
  void start(std::size_t stride, std::size_t groups, bool gradients);
  void setTargets(std::size_t count);
  void setPoints(const Points& points, const std::uint32_t* order, std::size_t count,
                 const Vec3& center);
  void addPolynomial(const FarField& field, const Expansion& expansion);
  // Adds near charges at the targets to the places of theirs. radius: of their ball.
  void addNear(const FarField& field, const NearCharges& near, double radius);

  std::size_t stride_ = 0;
  simd::Row values_, gradients_;
  std::vector<std::uint16_t> places_;  // of each target, below stride()
  simd::Row x_, y_, z_;                // of targets, about the ball's centre
  simd::Row harmonics_, sums_, slopes_, scaledX_, scaledY_, scaledZ_;
};

}  // namespace innermap
