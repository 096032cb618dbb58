// The innermost loops of the proof, on eight places at a time, for the machine's instruction set.
#pragma once

#include <tbb/cache_aligned_allocator.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "proof/detail/step_expansion.h"

namespace innermap::proof {

using Lanes = double[kLanes];
using Numbers = std::vector<double, tbb::cache_aligned_allocator<double>>;

// Eight sets of points: center + (convex hull of the vertices and their mirror images about the
// centre) + a ball of radius `slack`. All lie within `radius` of their centres.
struct alignas(64) LaneSets {
  Lanes center[3];
  Lanes vertex[4][3];  // about the centre
  Lanes slack;
  Lanes radius;
};

struct alignas(64) LaneRemainders {
  Lanes gradient, value, gradientMagnitude, valueMagnitude;
};

// What one step does to the eight sets.
struct alignas(64) LaneFindings {
  Lanes excess;       // S of the header prove.h; not below 1: nothing is known
  Lanes determinant;  // of the derivative, at the centre
  Lanes least;        // bound of its absolute value on the set, where excess < 1
  LaneSets image;     // encloses what the sets become
};

// Eight numbers a charge: x, y, z, three weights, the weight's length, 0.
constexpr std::size_t kChargeStride = 8;
// Charges nearer than radius / kNearRatio to a centre leave nothing known about that set.
constexpr double kNearRatio = 0.8;

// The farther a charge, the lower the order that it is expanded to.
constexpr std::array<int, 4> kOrders = {kOrder, 7, 5, 3};

// From which square of distance / radius on a charge enters a ball's expansion, by order: rising.
using OrderLimits = std::array<double, kOrders.size()>;
// The place in kOrders of what does not enter.
constexpr std::int32_t kNotExpanded = kOrders.size();

// The place in kOrders by that square.
inline std::int32_t orderPlace(const OrderLimits& limits, double square) {
  std::int32_t passed = 0;
  for (const double l : limits) passed += square > l ? 1 : 0;
  return passed > 0 ? passed - 1 : kNotExpanded;
}

// That of some charges for a ball.
void orderPlaces(const double* charges, const std::uint32_t* list, std::size_t count,
                 const Vec3& center, double radius, const OrderLimits& limits,
                 std::int32_t* places);

// Some charges, those of the highest order first; behind all of them those that are left out.
struct OrderedCharges {
  std::vector<std::uint32_t> list;
  std::array<std::size_t, kOrders.size()> ends = {};  // of the charges of each order
  std::size_t count() const { return ends.back(); }
};

// By the place in kOrders of each; kNotExpanded is left out.
void arrange(const std::uint32_t* charges, const std::vector<std::int32_t>& places,
             OrderedCharges& out);

// Tells which lanes have no charge nearer than kNearRatio allows. nearest[i]: the least over the
// lanes of (distance / radius)^2 of charge list[i].
std::uint8_t measure(const double* charges, const std::uint32_t* list, std::size_t count,
                     const LaneSets& sets, double* nearest);

// Adds the expansions of charges about the eight centres, kCoefficients x kLanes in the order of
// lanes-inl.h, and what they add to the remainders; that is infinite where nothing is known.
void addCharges(const double* charges, const OrderedCharges& some, const LaneSets& sets,
                double* coefficients, LaneRemainders& remainders);

// Adds charges to an expansion that holds in a ball of that radius about its centre.
void addCharges(const double* charges, const OrderedCharges& some, double radius,
                StepExpansion& expansion);

// The expansion's degrees up to `order`, about eight other centres or one: exact. Overwrites all
// coefficients, kCoefficients x kLanes or kCoefficients; those above are 0.
void moveExpansion(const StepExpansion& from, int order, const LaneSets& sets,
                   double* coefficients);
void moveExpansion(const StepExpansion& from, int order, const Vec3& center, double* coefficients);

// The test of whole sets.
void examine(const double* coefficients, const LaneRemainders& remainders, const LaneSets& sets,
             LaneFindings& out);

}  // namespace innermap::proof
