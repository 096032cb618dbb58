// The innermost loops of the proof, on eight places at a time, for the machine's instruction set.
#pragma once

#include <cstddef>
#include <cstdint>

#include "proof/detail/step_expansion.h"

namespace innermap::proof {

using Lanes = double[kLanes];

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

// Charges are far from a set when its radius is at most this part of their distance: then they
// enter its expansion.
constexpr double kFarRatio = 0.36;
// What an expansion cuts off is some 1e-5 of all that it holds, however small a set within its node
// is; with this ratio some 1e-8, with more charges near.
constexpr double kFineFarRatio = 0.2;
// Charges nearer than radius / kNearRatio to a centre leave nothing known about that set.
constexpr double kNearRatio = 0.8;

// Tells far from near charges: bit l of farLanes[i] is set where charge list[i] is far from set l.
// Writes what both lots add to the remainders; infinite where nothing is known.
void classify(const double* charges, const std::uint32_t* list, std::size_t count,
              const LaneSets& sets, double farRatio, std::uint8_t* farLanes, LaneRemainders& far,
              LaneRemainders& near);

// Adds what an expansion about another centre brings along when it is moved.
void addInherited(const StepExpansion& from, const LaneSets& sets, LaneRemainders& remainders);

// Adds the expansions of charges about the eight centres: in lane l where bit l of
// lanes[i] ^ flip is set. coefficients: kCoefficients x kLanes.
void addCharges(const double* charges, const std::uint32_t* list, const std::uint8_t* lanes,
                std::uint8_t flip, std::size_t count, const LaneSets& sets, double* coefficients);

// Adds to an expansion about one centre, eight charges at a time; `count` is at least 1.
void addCharges(const double* charges, const std::uint32_t* list, std::size_t count,
                StepExpansion& expansion);

// The expansion about another centre, moved to the eight ones: exact. Overwrites.
void moveExpansion(const StepExpansion& from, const LaneSets& sets, double* coefficients);

// The test of whole sets.
void examine(const double* coefficients, const LaneRemainders& remainders, const LaneSets& sets,
             LaneFindings& out);

}  // namespace innermap::proof
